// Density of clutter by place, learnt from segments that did not last.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace lookout::tracker {

/// False segments per square metre and scan, in sectors about the own boat: its wake, spray at the bow and rain near the lidar stay where they are to
/// it.
class ClutterMap {
 public:
  void Begin() { counts_.fill(0.0); }
  /// @param place_vessel_m  x forward, y port
  void Add(const Eigen::Vector2d& place_vessel_m) { counts_[IndexOf(place_vessel_m)] += 1.0; }
  /// One scan is over. Memory of some 5 s.
  void End(double dt_s);

  double DensityAt(const Eigen::Vector2d& place_vessel_m) const;
  /// A scan, within 100 m.
  double total() const;

 private:
  static constexpr std::size_t kSectors = 12;
  static constexpr std::size_t kRings = 10;
  static constexpr double kRingM = 10.0;  // the last reaches to the end
  static std::size_t IndexOf(const Eigen::Vector2d& place_vessel_m);

  std::array<double, kSectors * kRings> counts_{};
  std::array<double, kSectors * kRings> means_{};
};

}  // namespace lookout::tracker
