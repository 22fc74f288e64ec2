#include "services/odometer/core/local_map.hpp"

#include <algorithm>
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

// Weight of rough surfaces, such as plants that wave in the wind: they tell little about the motion.
constexpr double kRoughWeight = 0.05;
// Surfaces that look alike: within 45 deg.
constexpr float kLeastCosine = 0.7F;

bool LookAlike(const Eigen::Vector3f& normal, Shape shape, const Eigen::Vector3f& other_normal, Shape other_shape) {
  if (shape != other_shape) return false;
  return shape != Shape::kSurface || std::abs(normal.dot(other_normal)) > kLeastCosine;
}

// The slabs of cubes along one axis that reach within a radius of a value, its own first, and how far their points are away at least.
class Gaps {
 public:
  struct Gap {
    int cube;
    float squared_m2;
  };
  Gaps(double value_m, double radius_m) {
    const int own = static_cast<int>(std::floor(value_m / LocalMap::kSideM));
    Add(own, 0.0);
    for (int step = 1; step <= kMostSteps; ++step) {
      // Kept points are rounded: they may lie outside of their cubes, by less than a millimetre or two.
      const double below_m = value_m - ((own - step + 1) * LocalMap::kSideM) - kRoundingM;
      const double above_m = ((own + step) * LocalMap::kSideM) - value_m - kRoundingM;
      if (below_m > radius_m && above_m > radius_m) break;
      if (below_m <= radius_m) Add(own - step, below_m);
      if (above_m <= radius_m) Add(own + step, above_m);
    }
  }
  auto begin() const { return gaps_.begin(); }
  auto end() const { return gaps_.begin() + num_; }

 private:
  static constexpr double kRoundingM = 0.002;
  static constexpr int kMostSteps = 7;
  void Add(int cube, double gap_m) {
    const double distance_m = std::max(0.0, gap_m);
    gaps_[num_++] = {cube, static_cast<float>(distance_m * distance_m)};
  }
  std::array<Gap, 1 + 2 * kMostSteps> gaps_{};
  std::size_t num_ = 0;
};

Eigen::Matrix3d WeightOf(const Eigen::Vector3f& normal, Shape shape) {
  if (shape == Shape::kSurface) {
    const Eigen::Vector3d across = normal.cast<double>();
    return across * across.transpose();
  }
  return (shape == Shape::kPost ? 1.0 : kRoughWeight) * Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal().toDenseMatrix();
}

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

void LocalMap::Add(const MapPoint& point) {
  const auto place = CubeOf(point.p_m, kSideM);
  const auto [number, is_new] = index_.Insert(place);
  if (is_new) cubes_.emplace_back().place = place;
  Cube& cube = cubes_[static_cast<std::size_t>(number)];
  if (cube.num_points == kMaxPointsPerCube) return;
  const Eigen::Vector3f p_m = point.p_m.cast<float>();
  for (std::size_t i = 0; i < cube.num_points; ++i) {
    if ((cube.points[i].p_m - p_m).squaredNorm() < static_cast<float>(kMinSpacingM * kMinSpacingM)) return;
  }
  cube.points[cube.num_points++] = {p_m, point.normal.cast<float>(), point.shape, static_cast<float>(point.normal_sd_rad)};
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

std::optional<Match> LocalMap::Nearest(const MapPoint& point, double radius_m) const {
  const Gaps x_gaps(point.p_m.x(), radius_m);
  const Gaps y_gaps(point.p_m.y(), radius_m);
  const Gaps z_gaps(point.p_m.z(), radius_m);
  const Eigen::Vector3f p_m = point.p_m.cast<float>();
  const Eigen::Vector3f normal = point.normal.cast<float>();
  float nearest_m2 = static_cast<float>(radius_m * radius_m);
  const Kept* nearest = nullptr;
  for (const auto& [x, x_m2] : x_gaps) {
    if (x_m2 >= nearest_m2) continue;
    for (const auto& [y, y_m2] : y_gaps) {
      if (x_m2 + y_m2 >= nearest_m2) continue;
      for (const auto& [z, z_m2] : z_gaps) {
        if (x_m2 + y_m2 + z_m2 >= nearest_m2) continue;
        const auto number = index_.Find({x, y, z});
        if (number == CubeIndex::kNone) continue;
        const Cube& cube = cubes_[static_cast<std::size_t>(number)];
        for (std::size_t i = 0; i < cube.num_points; ++i) {
          const Kept& kept = cube.points[i];
          const float distance_m2 = (kept.p_m - p_m).squaredNorm();
          if (!(distance_m2 < nearest_m2) || !LookAlike(normal, point.shape, kept.normal, kept.shape)) continue;
          nearest_m2 = distance_m2;
          nearest = &kept;
        }
      }
    }
  }
  if (nearest == nullptr) return std::nullopt;
  const Eigen::Vector3d across = nearest->normal.cast<double>();
  const Eigen::Vector3d along = double{nearest->normal_sd_rad} * Eigen::Vector3d(-across.y(), across.x(), 0.0);
  return Match{nearest->p_m.cast<double>(), WeightOf(nearest->normal, nearest->shape), along};
}

}  // namespace lookout::odometer
