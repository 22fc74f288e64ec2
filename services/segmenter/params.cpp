#include "services/segmenter/params.hpp"

#include <algorithm>
#include <array>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/segmenter.pb.h"
#include "services/segmenter/evidence_text.hpp"

namespace lookout::segmenter {

namespace {

constexpr int kMinImageColumns = 16;
constexpr double kWholeCircleDeg = 360.0;

LookoutParams LookoutOf(const config::Segmenter& message, const std::filesystem::path& file) {
  LookoutParams params;
  if (!message.evidence().empty()) {
    std::ranges::copy(LoadEvidence(file.parent_path() / message.evidence(), kEvidenceLayouts), params.evidence.begin());
  }
  params.link = {message.link_m(), message.link_per_range()};
  params.merges.back().log_odds = message.merge_log_odds();
  params.land_probability = message.land_probability();
  params.sure_probability = message.sure_probability();
  return params;
}

// Faults of the relations between fields.
void CheckRelations(const config::Segmenter& message, const std::filesystem::path& file) {
  config::FaultList faults;
  if (message.max_range_m() <= message.min_range_m()) faults.Add(config::FaultLine(file, "max_range_m", "must be greater than min_range_m"));
  if (message.image_columns() != 0 && message.image_columns() < kMinImageColumns) {
    faults.Add(config::FaultLine(file, "image_columns", "must be 0 or at least 16, so that neighbouring pixels look much the same way"));
  }
  faults.ThrowIfAny();
}

double AboveWaterM(const config::BoatFacts& boat, const Eigen::Isometry3d& T_vessel_lidar) {
  return boat.reference_point_above_water_m + T_vessel_lidar.translation().z();
}

}  // namespace

Params LoadParams(const std::filesystem::path& config_folder) {
  const auto file = config_folder / "segmenter.txtpb";
  config::FaultList faults;
  const auto boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  const auto message = faults.Take([&] { return config::Load<config::Segmenter>(config_folder, "segmenter.txtpb"); });
  if (message) faults.Try([&] { CheckRelations(*message, file); });
  faults.ThrowIfAny();
  return ToParams(*message, *boat, file);
}

Lanes LoadLanes(const std::filesystem::path& config_folder) {
  Lanes lanes{LoadParams(config_folder), std::nullopt};
  if (const auto boat = config::LoadBoat(config_folder); boat.lidar_2) {
    lanes.second = lanes.first;
    lanes.second->filter.T_vessel_lidar = TransformVesselSensor(*boat.lidar_2);
    lanes.second->filter.field_of_view = {};
    lanes.second->lookout.lidar_above_water_m = AboveWaterM(boat, lanes.second->filter.T_vessel_lidar);
  }
  return lanes;
}

Params ToParams(const config::Segmenter& message, const config::BoatFacts& boat, const std::filesystem::path& file) {
  CheckRelations(message, file);

  Params params;
  params.filter.min_range_m = message.min_range_m();
  params.filter.max_range_m = message.max_range_m();
  params.filter.max_repeat_gap_m = message.max_repeat_gap_m();
  params.filter.field_of_view.start_rad = DegToRad(message.field_of_view_start_deg());
  params.filter.field_of_view.width_rad = message.field_of_view_width_deg() >= kWholeCircleDeg ? kTwoPi : DegToRad(message.field_of_view_width_deg());
  params.filter.own_vessel_box_m = boat.own_vessel_box_m;
  params.filter.T_vessel_lidar = boat.T_vessel_lidar;
  params.labelling.image_columns = message.image_columns();
  params.labelling.label_shadowed_returns = message.label_shadowed_returns();
  params.labelling.search.angle_rad = DegToRad(message.bfs_angle_deg());
  params.labelling.search.distance_m = message.bfs_distance_m();
  params.component_clustering = message.component_clustering();
  params.clustering.e1_cosine = message.e1_cosine();
  params.clustering.e2_angle_rad = DegToRad(message.e2_angle_deg());
  params.clustering.e3_distance_m = message.e3_distance_m();
  params.clustering.e2_max_distance_m = message.e2_max_distance_m();
  params.min_segment_points = message.min_segment_points();
  params.method = message.method() == config::Segmenter::PAPER ? Method::kPaper : Method::kLookout;
  params.lookout = LookoutOf(message, file);
  params.lookout.lidar_above_water_m = AboveWaterM(boat, boat.T_vessel_lidar);
  return params;
}

}  // namespace lookout::segmenter
