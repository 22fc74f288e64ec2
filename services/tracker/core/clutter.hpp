// Density of clutter by place, learnt from segments that did not last.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace lookout::tracker {

/// False segments per square metre and scan, in sectors about the own boat: its wake, spray at the bow and rain near the lidar keep their place
/// relative to it. A drop is no buoy: segments of many returns are counted apart from those of few, by powers of two.
class ClutterMap {
 public:
  void Begin() { counts_ = {}; }
  /// @param place_vessel_m  x forward, y port
  void Add(const Eigen::Vector2d& place_vessel_m, int num_returns) { counts_[ClassOf(num_returns)][IndexOf(place_vessel_m)] += 1.0; }
  /// Ends a scan. Counts are averaged over some 5 s.
  void End(double dt_s);

  /// Density of false segments that have about as many returns, or more.
  double DensityAt(const Eigen::Vector2d& place_vessel_m, int num_returns) const;
  /// False segments of a scan, within 100 m.
  double total() const;

 private:
  static constexpr std::size_t kSectors = 12;
  static constexpr std::size_t kRings = 10;
  static constexpr double kRingM = 10.0;      // the last reaches to the end
  static constexpr std::size_t kClasses = 6;  // 1, 2 to 3, 4 to 7 and so on; the last is 32 and more
  using Counts = std::array<double, kSectors * kRings>;
  static std::size_t IndexOf(const Eigen::Vector2d& place_vessel_m);
  static std::size_t ClassOf(int num_returns);

  std::array<Counts, kClasses> counts_{};
  std::array<Counts, kClasses> means_{};
};

}  // namespace lookout::tracker
