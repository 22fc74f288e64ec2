#include "services/segmenter/core/paper/component_clustering.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "common/core/elementary.hpp"
#include "services/segmenter/core/union_find.hpp"

namespace lookout::segmenter {

namespace {

// Cells about a third as wide as the reach: wide enough to hold something, narrow enough to leave most of the circle out.
constexpr double kSectorsPerReach = 3.0;
constexpr double kMaxSectors = 360.0;
constexpr double kBandsPerReach = 3.0;
constexpr int kMaxBands = 64;
// Bounds are widened by this part, so that rounding loses no pair.
constexpr double kMargin = 1e-9;

// How far apart compatible components can be at most, in azimuth and in distance from the sensor.
class PairReach {
 public:
  PairReach(std::span<const ComponentCentroid> components, const ClusteringParams& params) : params_(params) {
    azimuth_rad_ = AzimuthReach(components);
    // (b) is d_short / d_long >= sin e2 / sin(t + e2), by the law of sines; t is at most acos e1.
    const double max_between_rad = Acos(std::clamp(params.e1_cosine, -1.0, 1.0));
    const double sin_e2 = Sin(params.e2_angle_rad);
    const double widest_rad = params.e2_angle_rad + max_between_rad;
    least_ratio_ = widest_rad >= kPi / 2.0 ? sin_e2 : sin_e2 / Sin(widest_rad);
  }

  double azimuth_rad() const { return azimuth_rad_; }

  /// Greatest distance of a component compatible with one at `distance_m` or nearer.
  double DistanceFrom(double distance_m) const {
    double by_angle_m = least_ratio_ > 0.0 ? distance_m / least_ratio_ : std::numeric_limits<double>::infinity();
    if (params_.e2_max_distance_m > 0.0) by_angle_m = std::min(by_angle_m, distance_m + params_.e2_max_distance_m);
    return std::max(by_angle_m, distance_m + params_.e3_distance_m) * (1.0 + kMargin) + kMargin;
  }

 private:
  // hav(between) = hav(elevations) + cos(elevation 1) cos(elevation 2) hav(azimuths) bounds the azimuths by the steepest components.
  double AzimuthReach(std::span<const ComponentCentroid> components) const {
    if (params_.e1_cosine <= 0.0) return kPi;
    double least_cos_elevation = 1.0;
    for (const auto& component : components) {
      if (component.distance_m > 0.0) least_cos_elevation = std::min(least_cos_elevation, component.direction.head<2>().norm());
    }
    const double sin_half_between = std::sqrt(std::max(0.0, (1.0 - params_.e1_cosine) / 2.0)) + kMargin;
    if (sin_half_between >= least_cos_elevation) return kPi;
    return 2.0 * Asin(sin_half_between / least_cos_elevation) + kMargin;
  }

  ClusteringParams params_;
  double azimuth_rad_;
  double least_ratio_;
};

// Components sorted into sectors of azimuth x bands of distance.
class PolarGrid {
 public:
  PolarGrid(std::span<const ComponentCentroid> components, const PairReach& reach) {
    num_sectors_ = static_cast<int>(std::clamp(std::floor(kTwoPi * kSectorsPerReach / reach.azimuth_rad()), 1.0, kMaxSectors));
    const double sector_width_rad = kTwoPi / num_sectors_;
    sector_reach_ = std::min(num_sectors_ / 2, static_cast<int>(reach.azimuth_rad() / sector_width_rad) + 1);
    double max_distance_m = 0.0;
    for (const auto& component : components) max_distance_m = std::max(max_distance_m, component.distance_m);
    const double band_width_m = std::max({max_distance_m / kMaxBands, reach.DistanceFrom(0.0) / kBandsPerReach});
    num_bands_ = std::min(kMaxBands, static_cast<int>(max_distance_m / band_width_m) + 1);
    for (int band = 0; band < num_bands_; ++band) {
      last_band_[Index(band)] = static_cast<int>(std::min(num_bands_ - 1.0, reach.DistanceFrom((band + 1) * band_width_m) / band_width_m));
    }
    for (int band = 0, first = 0; band < num_bands_; ++band) {
      while (last_band_[Index(first)] < band) ++first;
      first_band_[Index(band)] = first;
    }
    std::vector<std::int32_t> cell_of(components.size());
    begin_.assign(Index(num_cells()) + 1, 0);
    for (std::size_t i = 0; i < components.size(); ++i) {
      const auto& component = components[i];
      const double azimuth_rad = WrapTo2Pi(-Atan2(component.p_m.y(), component.p_m.x()));
      const int sector = std::min(num_sectors_ - 1, static_cast<int>(azimuth_rad / sector_width_rad));
      const int band = std::min(num_bands_ - 1, static_cast<int>(component.distance_m / band_width_m));
      cell_of[i] = Cell(sector, band);
      ++begin_[Index(cell_of[i]) + 1];
    }
    for (std::size_t cell = 1; cell < begin_.size(); ++cell) begin_[cell] += begin_[cell - 1];
    members_.resize(components.size());
    auto next = begin_;
    for (std::size_t i = 0; i < components.size(); ++i) members_[Index(next[Index(cell_of[i])]++)] = static_cast<std::int32_t>(i);
  }

  /// Calls `visit(cell, other)` for each pair of cells that may hold compatible components, also for a cell with itself; both hold some.
  ///
  /// @param max_steps  only cells that are at most so many sectors and bands apart
  template <typename Visit>
  void ForEachPair(int max_steps, Visit visit) const {
    for (int cell = 0; cell < num_cells(); ++cell) {
      if (IsEmpty(cell)) continue;
      const int sector = cell / num_bands_;
      const int band = cell % num_bands_;
      const int last_band = std::min(last_band_[Index(band)], band + max_steps);
      for (int step = 0; step <= std::min(sector_reach_, max_steps); ++step) {
        const int first_other = (sector + step) % num_sectors_ * num_bands_;
        const int first_band = step == 0 ? band : std::max(first_band_[Index(band)], band - max_steps);
        for (int other = first_other + first_band; other <= first_other + last_band; ++other) {
          if (!IsEmpty(other)) visit(cell, other);
        }
      }
    }
  }

  int num_cells() const { return num_sectors_ * num_bands_; }
  bool IsEmpty(int cell) const { return begin_[Index(cell)] == begin_[Index(cell) + 1]; }
  std::span<const std::int32_t> Members(int cell) const {
    const auto begin = Index(begin_[Index(cell)]);
    return {members_.data() + begin, Index(begin_[Index(cell) + 1]) - begin};
  }

 private:
  static std::size_t Index(int number) { return static_cast<std::size_t>(number); }
  int Cell(int sector, int band) const { return sector * num_bands_ + band; }

  int num_sectors_ = 1;
  int sector_reach_ = 0;  // sectors to either side
  int num_bands_ = 1;
  std::array<int, kMaxBands> first_band_{};  // nearest band that reaches this one
  std::array<int, kMaxBands> last_band_{};   // farthest band within reach of this one
  std::vector<std::int32_t> begin_;          // [cells + 1] into members_
  std::vector<std::int32_t> members_;        // components, by cell
};

// Unites compatible components cell by cell.
class Uniter {
 public:
  Uniter(std::span<const ComponentCentroid> components, const PolarGrid& grid, const CompatibilityRule& rule)
      : components_(components), grid_(grid), rule_(rule), sets_(components.size()), is_one_(static_cast<std::size_t>(grid.num_cells()), 0) {}

  void Join(int cell, int other_cell) {
    const auto members = grid_.Members(cell);
    const auto others = grid_.Members(other_cell);
    const bool are_sets = IsOneSet(cell) && IsOneSet(other_cell);
    if (are_sets && sets_.Find(members.front()) == sets_.Find(others.front())) return;
    for (const std::int32_t one : members) {
      for (const std::int32_t other : others) {
        if (sets_.Find(one) == sets_.Find(other)) continue;
        if (!rule_.AreCompatible(components_[static_cast<std::size_t>(one)], components_[static_cast<std::size_t>(other)])) continue;
        sets_.Join(one, other);
        if (are_sets) return;
      }
    }
  }

  std::int32_t SetOf(std::int32_t component) { return sets_.Find(component); }

 private:
  bool IsOneSet(int cell) {
    char& is_one = is_one_[static_cast<std::size_t>(cell)];
    if (is_one != 0) return true;
    const auto members = grid_.Members(cell);
    const std::int32_t first = sets_.Find(members.front());
    is_one = std::ranges::all_of(members, [&](std::int32_t member) { return sets_.Find(member) == first; }) ? 1 : 0;
    return is_one != 0;
  }

  std::span<const ComponentCentroid> components_;
  const PolarGrid& grid_;
  const CompatibilityRule& rule_;
  UnionFind sets_;
  std::vector<char> is_one_;  // [cells] 1 = known to be of one set
};

}  // namespace

CompatibilityRule::CompatibilityRule(const ClusteringParams& params)
    : e1_cosine_(params.e1_cosine),
      sin_e2_(Sin(params.e2_angle_rad)),
      cos_e2_(Cos(params.e2_angle_rad)),
      squared_e3_m2_(params.e3_distance_m * params.e3_distance_m),
      squared_e2_max_m2_(params.e2_max_distance_m > 0.0 ? params.e2_max_distance_m * params.e2_max_distance_m
                                                        : std::numeric_limits<double>::infinity()) {}

std::vector<ComponentCentroid> Centroids(std::span<const Return> returns, const Groups& components) {
  struct Sum {
    Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
    int count = 0;
  };
  std::vector<Sum> sums(static_cast<std::size_t>(components.count));
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (components.of_return[i] == Groups::kNone) continue;
    Sum& sum = sums[static_cast<std::size_t>(components.of_return[i])];
    sum.p_m += Eigen::Vector3d(returns[i].point.x_m, returns[i].point.y_m, returns[i].point.z_m);
    ++sum.count;
  }
  std::vector<ComponentCentroid> centroids;
  centroids.reserve(sums.size());
  for (const auto& sum : sums) centroids.emplace_back(Eigen::Vector3d(sum.p_m / sum.count));
  return centroids;
}

std::vector<std::int32_t> ClusterComponents(std::span<const ComponentCentroid> components, const ClusteringParams& params) {
  const CompatibilityRule rule(params);
  const PolarGrid grid(components, PairReach(components, params));
  Uniter uniter(components, grid, rule);
  // Near components first: most of the others are then of one cluster already.
  for (const int max_steps : {0, 1, std::max(kMaxBands, static_cast<int>(kMaxSectors))}) {
    grid.ForEachPair(max_steps, [&uniter](int cell, int other) { uniter.Join(cell, other); });
  }

  std::vector<std::int32_t> cluster_of(components.size());
  std::int32_t num_clusters = 0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const std::int32_t first = uniter.SetOf(static_cast<std::int32_t>(i));  // the least: its number is known already, unless it is this one
    cluster_of[i] = static_cast<std::size_t>(first) == i ? num_clusters++ : cluster_of[static_cast<std::size_t>(first)];
  }
  return cluster_of;
}

}  // namespace lookout::segmenter
