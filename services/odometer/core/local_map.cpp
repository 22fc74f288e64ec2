#include "services/odometer/core/local_map.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

namespace lookout::odometer {

namespace {

// Whole numbers of a cube in 21 bits each.
constexpr int kBits = 21;
constexpr std::int64_t kOffset = std::int64_t{1} << (kBits - 1);
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
constexpr std::size_t kLeastSlots = 1024;

std::uint64_t KeyOf(const Eigen::Vector3i& cube) {
  const auto part = [](int value) { return static_cast<std::uint64_t>(value + kOffset) & kMask; };
  return (part(cube.x()) << (2 * kBits)) | (part(cube.y()) << kBits) | part(cube.z());
}

std::size_t SlotOf(std::uint64_t key, std::size_t num_slots) {
  return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 32U) & (num_slots - 1);
}

// A direction in which the points around a place spread by less than this is across a surface: hulls, walls and piles with their noise.
constexpr double kThinM = 0.15;
// Foliage is no surface: the difference to its nearest point says a little.
constexpr double kFoliageWeight = 0.05;
constexpr int kLeastPointsOfShape = 3;
// A shape is computed again after so many scans, or when its own cube changed.
constexpr std::int64_t kShapeScans = 10;

}  // namespace

void CubeIndex::Clear() {
  slots_.clear();
  size_ = 0;
}

std::int32_t CubeIndex::Find(const Eigen::Vector3i& cube) const {
  if (slots_.empty()) return kNone;
  const auto key = KeyOf(cube);
  for (std::size_t slot = SlotOf(key, slots_.size());; slot = (slot + 1) & (slots_.size() - 1)) {
    if (slots_[slot].number == kNone || slots_[slot].key == key) return slots_[slot].number;
  }
}

std::pair<std::int32_t, bool> CubeIndex::Insert(const Eigen::Vector3i& cube) {
  if (2 * (size_ + 1) > slots_.size()) Grow();
  const auto key = KeyOf(cube);
  std::size_t slot = SlotOf(key, slots_.size());
  while (slots_[slot].number != kNone && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
  if (slots_[slot].number != kNone) return {slots_[slot].number, false};
  slots_[slot] = {key, static_cast<std::int32_t>(size_++)};
  return {slots_[slot].number, true};
}

void CubeIndex::Grow() {
  const std::vector<Slot> before = std::exchange(slots_, std::vector<Slot>(std::max(kLeastSlots, 2 * slots_.size())));
  for (const auto& one : before) {
    if (one.number == kNone) continue;
    std::size_t slot = SlotOf(one.key, slots_.size());
    while (slots_[slot].number != kNone) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = one;
  }
}

Eigen::Vector3i CubeOf(const Eigen::Vector3d& p_m, double side_m) {
  const auto whole = [side_m](double value_m) { return static_cast<int>(std::floor(value_m / side_m)); };
  return {whole(p_m.x()), whole(p_m.y()), whole(p_m.z())};
}

std::vector<std::size_t> FirstOfEachCube(const std::vector<Eigen::Vector3d>& points_m, double side_m) {
  std::vector<std::size_t> first;
  first.reserve(points_m.size());
  CubeIndex index;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (index.Insert(CubeOf(points_m[i], side_m)).second) first.push_back(i);
  }
  return first;
}

void LocalMap::Clear() {
  index_.Clear();
  cubes_.clear();
}

void LocalMap::Add(const Eigen::Vector3d& p_m) {
  const auto place = CubeOf(p_m, kSideM);
  const auto [number, is_new] = index_.Insert(place);
  if (is_new) cubes_.emplace_back().place = place;
  Cube& cube = cubes_[static_cast<std::size_t>(number)];
  const auto num_points = static_cast<std::size_t>(cube.num_points);
  if (num_points == kMaxPointsPerCube) return;
  const Eigen::Vector3f p = p_m.cast<float>();
  for (std::size_t i = 0; i < num_points; ++i) {
    if ((cube.points_m[i] - p).squaredNorm() < static_cast<float>(kMinSpacingM * kMinSpacingM)) return;
  }
  cube.points_m[num_points] = p;
  ++cube.num_points;
}

void LocalMap::Forget(const Eigen::Vector3d& center_m, double radius_m) {
  std::vector<Cube> kept;
  kept.reserve(cubes_.size());
  index_.Clear();
  for (const auto& cube : cubes_) {
    if (((cube.place.cast<double>() * kSideM) - center_m).squaredNorm() > radius_m * radius_m) continue;
    index_.Insert(cube.place);
    kept.push_back(cube);
  }
  cubes_ = std::move(kept);
}

void LocalMap::UpdateShape(Cube& cube) {
  cube.shape_points = cube.num_points;
  cube.shape_version = version_;
  const Eigen::Vector3d origin_m = (cube.place.cast<double>() + Eigen::Vector3d::Constant(0.5)) * kSideM;
  int num_points = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 27; ++k) {
    const auto number = index_.Find(cube.place + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
    if (number == CubeIndex::kNone) continue;
    const Cube& other = cubes_[static_cast<std::size_t>(number)];
    for (int i = 0; i < other.num_points; ++i) {
      const Eigen::Vector3d d = other.points_m[static_cast<std::size_t>(i)].cast<double>() - origin_m;
      sum += d;
      squares += d * d.transpose();
    }
    num_points += other.num_points;
  }
  cube.has_shape = num_points >= kLeastPointsOfShape;
  if (!cube.has_shape) return;
  const Eigen::Vector3d mean = sum / num_points;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / num_points - mean * mean.transpose());
  cube.weight.setZero();
  if (solver.eigenvalues()[0] > kThinM * kThinM) {
    cube.weight = kFoliageWeight * Eigen::Matrix3d::Identity();
    return;
  }
  for (int i = 0; i < 3; ++i) {
    if (solver.eigenvalues()[i] > kThinM * kThinM) continue;
    const Eigen::Vector3d direction = solver.eigenvectors().col(i);
    cube.weight += direction * direction.transpose();
  }
}

std::optional<Match> LocalMap::Nearest(const Eigen::Vector3d& p_m, double radius_m) {
  const Eigen::Vector3i low = CubeOf(p_m - Eigen::Vector3d::Constant(radius_m), kSideM);
  const Eigen::Vector3i high = CubeOf(p_m + Eigen::Vector3d::Constant(radius_m), kSideM);
  double nearest_m2 = radius_m * radius_m;
  std::int32_t nearest_cube = CubeIndex::kNone;
  Eigen::Vector3d nearest_m = Eigen::Vector3d::Zero();
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        const auto number = index_.Find({x, y, z});
        if (number == CubeIndex::kNone) continue;
        const Cube& cube = cubes_[static_cast<std::size_t>(number)];
        for (int i = 0; i < cube.num_points; ++i) {
          const Eigen::Vector3d q_m = cube.points_m[static_cast<std::size_t>(i)].cast<double>();
          const double distance_m2 = (q_m - p_m).squaredNorm();
          if (distance_m2 >= nearest_m2) continue;
          nearest_m2 = distance_m2;
          nearest_cube = number;
          nearest_m = q_m;
        }
      }
    }
  }
  if (nearest_cube == CubeIndex::kNone) return std::nullopt;
  Cube& cube = cubes_[static_cast<std::size_t>(nearest_cube)];
  if (cube.shape_points != cube.num_points || version_ - cube.shape_version >= kShapeScans) UpdateShape(cube);
  if (!cube.has_shape) return std::nullopt;
  return Match{nearest_m, cube.weight};
}

}  // namespace lookout::odometer
