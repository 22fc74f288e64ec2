#include "services/ais/params.hpp"

#include <algorithm>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/ais.pb.h"
#include "config/schema/segmenter.pb.h"

namespace lookout::ais {

Params LoadParams(const std::filesystem::path& config_folder) {
  config::FaultList faults;
  const auto boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  const auto segmenter = faults.Take([&] { return config::Load<config::Segmenter>(config_folder, "segmenter.txtpb"); });
  const auto message = faults.Take([&] { return config::Load<config::Ais>(config_folder, "ais.txtpb"); });
  faults.ThrowIfAny();

  constexpr double kWholeCircleDeg = 360.0;
  Params params;
  auto& watcher = params.watcher;
  watcher.own_mmsi = message->own_mmsi();
  watcher.list_range_m = message->list_range_m();
  watcher.association.sure_probability = message->sure_probability();
  watcher.sight.range_m = std::min(message->sight_range_m(), segmenter->max_range_m());
  watcher.sight.min_range_m = segmenter->min_range_m();
  if (segmenter->field_of_view_width_deg() < kWholeCircleDeg) {
    watcher.sight.field_of_view = {DegToRad(segmenter->field_of_view_start_deg()), DegToRad(segmenter->field_of_view_width_deg())};
  }
  watcher.sight.T_vessel_lidar = boat->T_vessel_lidar;
  params.wait_timeout = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::duration<double>(message->wait_timeout_s()));
  return params;
}

}  // namespace lookout::ais
