#include "lab/eval/report/evaluation.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <span>

#include "common/core/angles.hpp"

namespace lookout::eval {
namespace {

// A segment in the parts of SEGMENTS.
const segment_t* FindSegment(const messages::ScanMessages& scan, int id) {
  for (const auto& [part_index, message] : scan.segments) {
    const auto found = std::ranges::find(message.segments, id, &segment_t::id);
    if (found != message.segments.end()) return &*found;
  }
  return nullptr;
}

}  // namespace

void Errors::Add(const Errors& other) {
  vertex_edge_m.Add(other.vertex_edge_m);
  vertex_outside_m.Add(other.vertex_outside_m);
  position_outside_m.Add(other.position_outside_m);
}

Evaluation::Evaluation(const Truth* truth, int min_num_returns) : truth_(truth), min_num_returns_(min_num_returns) {}

void Evaluation::Add(const messages::ScanMessages& scan) {
  ++num_scans;
  const bool is_whole = !messages::IsCut(scan.obstacles.begin()->second.scan_flags);
  if (is_whole) ++num_whole_scans;
  std::vector<ObstacleRow> scan_rows;
  for (const auto& [part_index, message] : scan.obstacles) {
    for (const auto& obstacle : message.obstacles) {
      ++num_obstacles;
      ++num_by_status[obstacle.status];
      scan_rows.push_back({obstacle, "?", {}, {}});
    }
  }
  if (truth_ != nullptr) {
    const auto returns = Join(scan);
    Confusion confusion;
    for (const auto& made : returns) confusion.Add(made.object_id, made.label);
    const auto matches = confusion.Match();
    if (is_whole) Score(scan, matches);
    Measure(scan, matches, returns, scan_rows);
  }
  if (is_whole || !is_table_whole_) {
    is_table_whole_ = is_whole;
    table_utime_us = scan.obstacles.begin()->second.utime_us;
    rows = std::move(scan_rows);
  }
}

// By label, then time.
std::vector<Evaluation::JoinedReturn> Evaluation::Join(const messages::ScanMessages& scan) {
  std::vector<JoinedReturn> returns;
  for (const auto& [part_index, part] : scan.scans) {
    const auto found = scan.segments.find(part_index);
    if (found == scan.segments.end() || found->second.num_cells != part.num_cells) continue;
    truth_->ForEachReturn(part, [&](std::size_t cell, std::int64_t time_ns, const Truth::Return* truth) {
      ++num_returns;
      if (truth == nullptr) return;
      ++num_joined;
      returns.push_back({found->second.label[cell], time_ns, truth->object_id, truth->p_lidar_m});
    });
  }
  std::ranges::stable_sort(returns, {}, [](const JoinedReturn& made) { return std::pair(made.label, made.time_ns); });
  return returns;
}

void Evaluation::Score(const messages::ScanMessages& scan, const Confusion::Matches& matches) {
  Mean iou;
  for (const auto& [id, object] : matches.objects) {
    iou.Add(object.iou);
    const auto known = truth_->objects().find(id);
    auto& kind = scores_by_kind[known != truth_->objects().end() ? known->second.kind : "?"];
    kind.iou.Add(object.iou);
    if (object.num_returns >= min_num_returns_) kind.recall.Add(object.has_own_segment ? 1.0 : 0.0);
  }
  if (iou.count > 0) scan_iou.Add(iou.value());
  double num_clutter = 0.0;
  double num_sure_clutter = 0.0;
  for (const auto& [label, of_clutter] : matches.segments) {
    if (of_clutter.has_object || of_clutter.has_own_vessel) continue;
    ++num_clutter;
    const auto* segment = FindSegment(scan, label);
    if (segment != nullptr && segment->confidence == segment_t::CONFIDENCE_SURE) ++num_sure_clutter;
  }
  clutter_segments.Add(num_clutter);
  sure_clutter_segments.Add(num_sure_clutter);
  segments.Add(static_cast<double>(matches.segments.size()));
}

const Outlines& Evaluation::OutlinesFor(const obstacles_t& message) {
  const std::array<double, 3> datum{message.datum_latitude_deg, message.datum_longitude_deg, message.datum_ellipsoid_height_m};
  if (!outlines_ || datum != datum_) {
    datum_ = datum;
    const GeographicLib::LocalCartesian map(datum[0], datum[1], datum[2]);
    outlines_ = std::make_unique<Outlines>(truth_->OutlinesIn(map));
    true_poses_ = std::make_unique<TruePoses>(*truth_, map);
  }
  return *outlines_;
}

void Evaluation::Measure(const messages::ScanMessages& scan, const Confusion::Matches& matches, const std::vector<JoinedReturn>& returns,
                         std::vector<ObstacleRow>& scan_rows) {
  std::size_t row_index = 0;
  for (const auto& [part_index, message] : scan.obstacles) {
    const bool has_datum =
        std::isfinite(message.datum_latitude_deg) && std::isfinite(message.datum_longitude_deg) && std::isfinite(message.datum_ellipsoid_height_m);
    for (const auto& obstacle : message.obstacles) {
      ObstacleRow& row = scan_rows[row_index++];
      const auto segment = matches.segments.find(obstacle.id);
      const int object_id = segment == matches.segments.end() ? 0 : segment->second.majority_object;
      const auto object = truth_->objects().find(object_id);
      if (object != truth_->objects().end()) row.object_name = object->second.name;
      if (obstacle.status == obstacle_t::STATUS_OK && has_datum) {
        MeasureObstacle(message, FindSegment(scan, obstacle.id), returns, object_id, row);
        if (T_vessel_lidar_ && object_id > 0) MeasureSeen(message, returns, object_id, obstacle);
      }
    }
  }
}

void Evaluation::MeasureObstacle(const obstacles_t& message, const segment_t* segment, const std::vector<JoinedReturn>& returns, int object_id,
                                 ObstacleRow& row) {
  const obstacle_t& obstacle = row.obstacle;
  const Outlines& outlines = OutlinesFor(message);
  const auto errors_of = [this](int id) -> Errors* {
    const auto object = truth_->objects().find(id);
    return id > 0 && object != truth_->objects().end() ? &errors_by_kind[{object->second.kind, object->second.is_moving}] : nullptr;
  };

  if (auto* errors = errors_of(object_id)) {
    if (const auto outline_m = outlines.At(object_id, obstacle.utime_us)) {
      row.position_outside_m = DistanceToOutline({obstacle.position_map_m[0], obstacle.position_map_m[1]}, *outline_m).outside_m;
      errors->position_outside_m.Add(*row.position_outside_m);
    }
  }

  // A vertex is one return of the segment: its time says which, and so which object it came from, also where the segment holds two objects.
  const bool has_times = segment != nullptr && segment->num_hull == obstacle.num_map;
  for (std::size_t i = 0; i < static_cast<std::size_t>(obstacle.num_map); ++i) {
    const std::int64_t utime_us = has_times ? message.utime_us + segment->hull_time_us[i] : obstacle.utime_us;
    std::vector<int> candidates;
    if (has_times) {
      // Lasers fire 2304 ns apart, the time of a vertex is within a microsecond. In dual return two of a segment may share it.
      const std::int64_t vertex_ns = std::int64_t{segment->hull_time_us[i]} * 1000;
      const auto from = std::ranges::lower_bound(returns, std::pair(obstacle.id, vertex_ns - 1000), {},
                                                 [](const JoinedReturn& made) { return std::pair(made.label, made.time_ns); });
      for (auto made = from; made != returns.end() && made->label == obstacle.id && made->time_ns <= vertex_ns + 1000; ++made) {
        candidates.push_back(made->object_id);
      }
    } else {
      candidates.push_back(object_id);
    }
    const Eigen::Vector2d vertex_m(static_cast<double>(obstacle.footprint_east_m[i]), static_cast<double>(obstacle.footprint_north_m[i]));
    std::optional<OutlineDistance> nearest;
    Errors* errors = nullptr;
    for (const int candidate : candidates) {
      const auto outline_m = outlines.At(candidate, utime_us);
      if (!outline_m) continue;
      const auto distance = DistanceToOutline(vertex_m, *outline_m);
      if (nearest && nearest->edge_m <= distance.edge_m) continue;
      nearest = distance;
      errors = errors_of(candidate);
    }
    if (errors == nullptr) continue;
    errors->vertex_edge_m.Add(nearest->edge_m);
    errors->vertex_outside_m.Add(nearest->outside_m);
    row.vertex_outside_m = std::max(row.vertex_outside_m.value_or(0.0), nearest->outside_m);
  }
}

void Evaluation::MeasureSeen(const obstacles_t& message, const std::vector<JoinedReturn>& returns, int object_id, const obstacle_t& obstacle) {
  const std::span<const JoinedReturn> own(std::ranges::lower_bound(returns, obstacle.id, {}, &JoinedReturn::label),
                                          std::ranges::upper_bound(returns, obstacle.id, {}, &JoinedReturn::label));
  if (2 * std::ranges::count(own, object_id, &JoinedReturn::object_id) <= std::ssize(own)) return;
  std::vector<SeenReturn> seen_returns;
  for (const auto& made : own) {
    if (!made.p_lidar_m.allFinite()) return;
    seen_returns.push_back({message.utime_us + ToMicroseconds(made.time_ns), made.p_lidar_m.cast<double>()});
  }
  OutlinesFor(message);
  const auto center_m = TrueCenter(seen_returns, *T_vessel_lidar_, *true_poses_);
  if (!center_m) return;
  const auto object = truth_->objects().find(object_id);
  SeenObstacle& result = seen.emplace_back();
  result.scan_utime_us = message.utime_us;
  result.object_id = object_id;
  result.is_moving = object != truth_->objects().end() && object->second.is_moving;
  result.is_sure = obstacle.confidence == obstacle_t::CONFIDENCE_SURE;
  result.is_land = obstacle.kind == obstacle_t::KIND_LAND;
  result.range_m = static_cast<double>(obstacle.range_m);
  result.num_points = obstacle.num_points;
  result.error_m = Eigen::Vector2d(obstacle.position_map_m[0], obstacle.position_map_m[1]) - *center_m;
  result.covariance_m2 << obstacle.covariance_m2[0], obstacle.covariance_m2[1], obstacle.covariance_m2[1], obstacle.covariance_m2[2];
}

void Evaluation::Add(const pose_t& pose) {
  if (truth_ == nullptr || (pose.status != pose_t::STATUS_OK && pose.status != pose_t::STATUS_COASTING)) return;
  const auto found = truth_->poses().find(pose.utime_us);
  if (found == truth_->poses().end()) return;
  const TruthPose& truth = found->second;
  const GeographicLib::LocalCartesian here(truth.latitude_deg, truth.longitude_deg, 0.0);
  Eigen::Vector3d offset_m;
  here.Forward(pose.latitude_deg, pose.longitude_deg, 0.0, offset_m.x(), offset_m.y(), offset_m.z());
  pose_errors[0].Add(offset_m.head<2>().norm());
  pose_errors[1].Add(std::abs(RadToDeg(WrapToPi(pose.heading_rad - DegToRad(truth.heading_deg)))));
  if (!pose.has_attitude) return;
  pose_errors[2].Add(std::abs(RadToDeg(pose.roll_rad) - truth.roll_deg));
  pose_errors[3].Add(std::abs(RadToDeg(pose.pitch_rad) - truth.pitch_deg));
}

}  // namespace lookout::eval
