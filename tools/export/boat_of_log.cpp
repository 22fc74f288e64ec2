#include "tools/export/boat_of_log.hpp"

#include "common/bus/decode.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "config/schema/boat.pb.h"
#include "lookout/run_info_t.hpp"

namespace lookout::exporter {

Taken TakeRunInfo(Bytes bytes, std::optional<BoatOfLog>& boat) {
  const auto info = bus::Decode<run_info_t>(bytes);
  if (!info) return Taken::kUndecodable;
  for (std::size_t i = 0; i < info->file_name.size(); ++i) {
    if (info->file_name[i] != "boat.txtpb") continue;
    config::Boat message;
    try {
      config::ParseText(info->file_text[i], info->file_name[i], message);
    } catch (const config::ConfigError&) {
      return Taken::kInconsistent;
    }
    Mounting lidar;
    lidar.p_vessel_m = {message.lidar().x_m(), message.lidar().y_m(), message.lidar().z_m()};
    lidar.roll_rad = DegToRad(message.lidar().roll_deg());
    lidar.pitch_rad = DegToRad(message.lidar().pitch_deg());
    lidar.yaw_rad = DegToRad(message.lidar().yaw_deg());
    const auto& box = message.own_vessel();
    boat = BoatOfLog{TransformVesselSensor(lidar),
                     {Eigen::Vector3d(box.min_x_m(), box.min_y_m(), box.min_z_m()), Eigen::Vector3d(box.max_x_m(), box.max_y_m(), box.max_z_m())}};
  }
  return Taken::kOk;
}

}  // namespace lookout::exporter
