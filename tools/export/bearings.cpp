#include "tools/export/bearings.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/bus/decode.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "common/core/utime.hpp"
#include "config/schema/boat.pb.h"
#include "lookout/pose_t.hpp"
#include "lookout/run_info_t.hpp"

namespace lookout::exporter {

Taken Bearings::TakePose(Bytes bytes, std::int64_t turn_utime_us) {
  const auto pose = bus::Decode<pose_t>(bytes);
  if (!pose) return Taken::kUndecodable;
  if (!UtimeFromWire(pose->utime_us)) return Taken::kInconsistent;
  // Ten seconds of poses: POSE may run before or behind the turn by as much, and memory stays small.
  constexpr std::size_t kMaxHeadings = 500;
  constexpr std::int64_t kSpanUs = 10'000'000;
  if (!std::isfinite(pose->heading_rad)) return Taken::kOk;
  if (turn_utime_us != 0 && std::abs(pose->utime_us - turn_utime_us) > kSpanUs) return Taken::kOk;
  headings_.push_back({pose->utime_us, pose->heading_rad});
  if (headings_.size() > kMaxHeadings) headings_.pop_front();
  return Taken::kOk;
}

Taken Bearings::TakeRunInfo(Bytes bytes) {
  const auto info = bus::Decode<run_info_t>(bytes);
  if (!info) return Taken::kUndecodable;
  for (std::size_t i = 0; i < info->file_name.size(); ++i) {
    if (info->file_name[i] != "boat.txtpb") continue;
    config::Boat boat;
    try {
      config::ParseText(info->file_text[i], info->file_name[i], boat);
    } catch (const config::ConfigError&) {
      return Taken::kInconsistent;
    }
    Mounting lidar;
    lidar.p_vessel_m = {boat.lidar().x_m(), boat.lidar().y_m(), boat.lidar().z_m()};
    lidar.roll_rad = DegToRad(boat.lidar().roll_deg());
    lidar.pitch_rad = DegToRad(boat.lidar().pitch_deg());
    lidar.yaw_rad = DegToRad(boat.lidar().yaw_deg());
    const auto& box = boat.own_vessel();
    boat_ = BoatOfLog{TransformVesselSensor(lidar),
                      {Eigen::Vector3d(box.min_x_m(), box.min_y_m(), box.min_z_m()), Eigen::Vector3d(box.max_x_m(), box.max_y_m(), box.max_z_m())}};
  }
  return Taken::kOk;
}

std::optional<double> Bearings::HeadingAt(std::int64_t utime_us) const {
  const auto nearest = std::ranges::min_element(headings_, {}, [utime_us](const Heading& one) { return std::abs(one.utime_us - utime_us); });
  if (nearest == headings_.end() || std::abs(nearest->utime_us - utime_us) > kMaxDistanceUs) return std::nullopt;
  return nearest->heading_rad;
}

}  // namespace lookout::exporter
