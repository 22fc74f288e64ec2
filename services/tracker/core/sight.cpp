#include "services/tracker/core/sight.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/frames.hpp"

namespace lookout::tracker {

namespace {

constexpr int kMostColumns = 24;  // of a thing that are looked at
// A return so much before or behind an outline is not of it: waves, overhangs and the outline's own error.
constexpr double kBesideM = 0.5;
constexpr double kAtWaterM = -0.1;  // the trough of a small wave
constexpr int kColumnsBeside = 3;
// Heights of a thing that decide its azimuth: a third up.
constexpr double kMiddleShare = 0.3;

Eigen::Isometry3d LidarOf(const Pose& pose, const Eigen::Isometry3d& T_vessel_lidar, double reference_point_above_water_m) {
  Eigen::Isometry3d T_map_vessel = Eigen::Isometry3d::Identity();
  T_map_vessel.linear() = pose.R_map_here * RotationMapVessel(pose.heading_rad, pose.pitch_rad, pose.roll_rad);
  T_map_vessel.translation() << pose.position_map_m.head<2>(), reference_point_above_water_m + pose.heave_m;
  return T_map_vessel * T_vessel_lidar;
}

}  // namespace

Sight::Sight(const Eigen::Isometry3d& T_vessel_lidar, double reference_point_above_water_m, double max_range_m)
    : T_vessel_lidar_(T_vessel_lidar), reference_point_above_water_m_(reference_point_above_water_m), max_range_m_(max_range_m) {}

bool Sight::Begin(const ScanInput& scan) {
  sweep_ = nullptr;
  if (!scan.own) return false;
  end_ = LidarOf(*scan.own, T_vessel_lidar_, reference_point_above_water_m_);
  start_ = scan.own_at_start ? LidarOf(*scan.own_at_start, T_vessel_lidar_, reference_point_above_water_m_) : end_;
  if (!scan.sweep || scan.sweep->azimuth_rad.empty() || !scan.own_at_start) return false;
  sweep_ = &*scan.sweep;
  ring_.clear();
  for (const float elevation_rad : sweep_->elevation_rad) {
    const auto [sine, cosine] = SinCosOf(elevation_rad);
    ring_.emplace_back(cosine, sine);
  }
  column_.clear();
  unwrapped_rad_.clear();
  for (const float azimuth_rad : sweep_->azimuth_rad) {
    const auto [sine, cosine] = SinCosOf(azimuth_rad);
    column_.emplace_back(cosine, sine);
    // A head that steps back by rounding steps by nothing.
    const double last = unwrapped_rad_.empty() ? static_cast<double>(azimuth_rad) : unwrapped_rad_.back();
    unwrapped_rad_.push_back(last + std::max(0.0, WrapToPi(azimuth_rad - last)));
  }
  return true;
}

Eigen::Isometry3d Sight::PoseAt(int column) const {
  const double share = static_cast<double>(column) / static_cast<double>(std::max<std::size_t>(1, column_.size() - 1));
  Eigen::Isometry3d pose;
  pose.matrix() = start_.matrix() + share * (end_.matrix() - start_.matrix());  // of a rotation by 3 deg a scan, off by 1e-4
  return pose;
}

// The first column at or after an azimuth; the number of columns where there is none.
int Sight::ColumnAt(double azimuth_rad) const {
  const double unwrapped = unwrapped_rad_.front() + WrapTo2Pi(azimuth_rad - unwrapped_rad_.front());
  return static_cast<int>(std::ranges::lower_bound(unwrapped_rad_, unwrapped) - unwrapped_rad_.begin());
}

Sight::Span Sight::ColumnsOf(std::span<const Eigen::Vector2d> outline_m) const {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& corner : outline_m) middle += corner / static_cast<double>(outline_m.size());
  const auto azimuth_of = [](const Eigen::Vector2d& place_m, const Eigen::Isometry3d& pose) {
    const Eigen::Vector3d offset(place_m.x() - pose.translation().x(), place_m.y() - pose.translation().y(), -kMiddleShare * pose.translation().z());
    const Eigen::Vector3d place = pose.linear().transpose() * offset;
    return Atan2(-place.y(), place.x());
  };
  // The boat turns while the head goes round: first by the pose of the middle, then by the pose of the column that this gives.
  const int num_columns = static_cast<int>(column_.size());
  Eigen::Isometry3d pose = PoseAt(num_columns / 2);
  pose = PoseAt(std::min(ColumnAt(azimuth_of(middle, pose)), num_columns - 1));
  const double middle_rad = azimuth_of(middle, pose);
  double from_rad = 0.0;
  double to_rad = 0.0;
  double least_m = std::numeric_limits<double>::infinity();
  double most_m = 0.0;
  const Eigen::Vector2d lidar_m = pose.translation().head<2>();
  for (const auto& corner : outline_m) {
    const double off_rad = WrapToPi(azimuth_of(corner, pose) - middle_rad);
    from_rad = std::min(from_rad, off_rad);
    to_rad = std::max(to_rad, off_rad);
    most_m = std::max(most_m, (corner - lidar_m).norm());
  }
  const std::array<Eigen::Vector2d, 1> point{lidar_m};
  least_m = GapOf(outline_m, point).distance_m;
  // Corners lie on columns, whose azimuths are single precision.
  constexpr double kOfRoundingRad = 2e-6;
  const int first = ColumnAt(middle_rad + from_rad - kOfRoundingRad);
  const int end = ColumnAt(middle_rad + to_rad + kOfRoundingRad);
  int count = end - first;
  if (count < 0) count += num_columns;
  return {first, count, least_m, std::max(most_m, least_m)};
}

Look Sight::At(std::span<const Eigen::Vector2d> outline_m, double top_m) const {
  Look look;
  if (sweep_ == nullptr) return look;
  const auto span = ColumnsOf(outline_m);
  if (span.near_m <= 0.0 || span.near_m > max_range_m_) return look;
  const int num_columns = static_cast<int>(column_.size());
  const int num_rings = static_cast<int>(ring_.size());
  const int step = std::max(1, (span.count + kMostColumns - 1) / kMostColumns);
  int num_looked = 0;
  for (int i = step / 2; i < std::max(span.count, 1); i += step) {
    const int column = (span.first + i) % num_columns;
    const Eigen::Isometry3d pose = PoseAt(column);
    ++num_looked;
    for (int ring = 0; ring < num_rings; ++ring) {
      const auto& [cosine, sine] = std::pair(ring_[static_cast<std::size_t>(ring)].x(), ring_[static_cast<std::size_t>(ring)].y());
      const auto& azimuth = column_[static_cast<std::size_t>(column)];
      const Eigen::Vector3d direction = pose.linear() * Eigen::Vector3d(cosine * azimuth.x(), -cosine * azimuth.y(), sine);
      const double flat = Hypot(direction.x(), direction.y());
      const double rise = direction.z() / flat;
      const double near_z = pose.translation().z() + span.near_m * rise;
      const double far_z = pose.translation().z() + span.far_m * rise;
      if (std::min(near_z, far_z) > top_m || std::max(near_z, far_z) < kAtWaterM) continue;
      const double range_m =
          flat * sweep_->range_m[static_cast<std::size_t>(column) * static_cast<std::size_t>(num_rings) + static_cast<std::size_t>(ring)];
      if (range_m > 0.0 && range_m < span.near_m - kBesideM) {
        look.num_hidden += 1.0;
        continue;
      }
      look.num_open += 1.0;
      if (range_m > 0.0 && range_m < span.far_m + kBesideM) look.num_met += 1.0;
    }
  }
  const double all = num_looked > 0 ? static_cast<double>(std::max(span.count, 1)) / num_looked : 0.0;
  return {all * look.num_open, all * look.num_met, all * look.num_hidden};
}

bool Sight::Reaches(const Eigen::Vector2d& corner_m, double side_m) const {
  const Eigen::Vector2d beside = (from_m() - corner_m).cwiseMax(0.0).cwiseMin(side_m) + corner_m;
  return sweep_ != nullptr && (beside - from_m()).norm() < max_range_m_;
}

bool Sight::IsFree(const Eigen::Vector2d& place_m, double top_m) const {
  // An object there reached so far behind the place at most, where a beam passes it on a slant or the place is off.
  constexpr double kBehindM = 1.5;
  constexpr double kMostBesideRad = 0.01;
  if (sweep_ == nullptr) return false;
  const int num_columns = static_cast<int>(column_.size());
  const int num_rings = static_cast<int>(ring_.size());
  const auto azimuth_of = [&place_m](const Eigen::Isometry3d& pose) {
    const Eigen::Vector3d offset(place_m.x() - pose.translation().x(), place_m.y() - pose.translation().y(), -kMiddleShare * pose.translation().z());
    const Eigen::Vector3d place = pose.linear().transpose() * offset;
    return Atan2(-place.y(), place.x());
  };
  int column = std::min(ColumnAt(azimuth_of(PoseAt(num_columns / 2))), num_columns - 1);
  const Eigen::Isometry3d pose = PoseAt(column);
  const double azimuth_rad = azimuth_of(pose);
  column = std::min(ColumnAt(azimuth_rad), num_columns - 1);
  if (std::abs(WrapToPi(azimuth_rad - unwrapped_rad_[static_cast<std::size_t>(column)])) > kMostBesideRad) return false;  // lost packets
  const auto& azimuth = column_[static_cast<std::size_t>(column)];
  const double distance_m = (place_m - pose.translation().head<2>()).norm();
  if (distance_m > max_range_m_) return false;
  int num_passed = 0;
  for (int ring = 0; ring < num_rings; ++ring) {
    const auto& elevation = ring_[static_cast<std::size_t>(ring)];
    const Eigen::Vector3d direction = pose.linear() * Eigen::Vector3d(elevation.x() * azimuth.x(), -elevation.x() * azimuth.y(), elevation.y());
    const double flat = Hypot(direction.x(), direction.y());
    const double z = pose.translation().z() + distance_m * direction.z() / flat;
    if (z > top_m || z < -kAtWaterM) continue;
    const double range_m =
        flat * sweep_->range_m[static_cast<std::size_t>(column) * static_cast<std::size_t>(num_rings) + static_cast<std::size_t>(ring)];
    if (range_m > 0.0 && range_m < distance_m - kBesideM) continue;  // hidden
    if (range_m > 0.0 && range_m < distance_m + kBehindM) return false;
    ++num_passed;
  }
  return num_passed > 0;
}

Sides Sight::SidesOf(std::span<const Eigen::Vector2d> outline_m, double top_m) const {
  Sides sides;
  sides.from_m = from_m();
  if (sweep_ == nullptr) return sides;
  const auto span = ColumnsOf(outline_m);
  sides.from_m = PoseAt(span.first % static_cast<int>(column_.size())).translation().head<2>();
  if (span.near_m <= 0.0) return {sides.from_m, true, true};
  const int num_columns = static_cast<int>(column_.size());
  const int num_rings = static_cast<int>(ring_.size());
  // Two columns wide gaps are lost packets.
  const double step_rad = kTwoPi / num_columns;
  const auto is_hidden = [&](int end, int sign) {
    for (int i = 1; i <= kColumnsBeside; ++i) {
      const int column = ((end + sign * i) % num_columns + num_columns) % num_columns;
      const int before = ((end + sign * (i - 1)) % num_columns + num_columns) % num_columns;
      const double apart_rad =
          std::abs(WrapToPi(unwrapped_rad_[static_cast<std::size_t>(column)] - unwrapped_rad_[static_cast<std::size_t>(before)]));
      if (apart_rad > 3.0 * step_rad) return true;
      const Eigen::Isometry3d pose = PoseAt(column);
      for (int ring = 0; ring < num_rings; ++ring) {
        const auto& azimuth = column_[static_cast<std::size_t>(column)];
        const auto& elevation = ring_[static_cast<std::size_t>(ring)];
        const Eigen::Vector3d direction = pose.linear() * Eigen::Vector3d(elevation.x() * azimuth.x(), -elevation.x() * azimuth.y(), elevation.y());
        const double flat = Hypot(direction.x(), direction.y());
        const double z = pose.translation().z() + span.near_m * direction.z() / flat;
        if (z > top_m || z < kAtWaterM) continue;
        const double range_m =
            flat * sweep_->range_m[static_cast<std::size_t>(column) * static_cast<std::size_t>(num_rings) + static_cast<std::size_t>(ring)];
        if (range_m > 0.0 && range_m < span.near_m - kBesideM) return true;
      }
    }
    return false;
  };
  const bool is_first_hidden = is_hidden(span.first, -1);
  const bool is_last_hidden = is_hidden(span.first + std::max(span.count, 1) - 1, +1);
  const bool is_upright = end_.linear()(2, 2) > 0.0;  // azimuths grow clockwise: the first column is the left end
  sides.is_left_hidden = is_upright ? is_first_hidden : is_last_hidden;
  sides.is_right_hidden = is_upright ? is_last_hidden : is_first_hidden;
  return sides;
}

std::vector<Sight::Return> Sight::Returns() const {
  std::vector<Return> returns;
  if (sweep_ == nullptr || sweep_->label.empty()) return returns;
  const std::size_t num_rings = ring_.size();
  const auto& pieces = sweep_->piece.empty() ? sweep_->label : sweep_->piece;
  for (std::size_t column = 0; column < column_.size(); ++column) {
    const Eigen::Isometry3d pose = PoseAt(static_cast<int>(column));
    for (std::size_t ring = 0; ring < num_rings; ++ring) {
      const std::size_t cell = column * num_rings + ring;
      if (sweep_->label[cell] <= 0) continue;
      const double range_m = sweep_->range_m[cell];
      const Eigen::Vector3d place = pose * Eigen::Vector3d(range_m * ring_[ring].x() * column_[column].x(),
                                                           -range_m * ring_[ring].x() * column_[column].y(), range_m * ring_[ring].y());
      returns.push_back({place.head<2>(), place.z(), sweep_->label[cell], pieces[cell]});
    }
  }
  return returns;
}

}  // namespace lookout::tracker
