// Water that was watched: whether beams had looked at a place before something came up there, and had found nothing.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <vector>

#include "common/core/utime.hpp"
#include "services/tracker/core/sight.hpp"

namespace lookout::tracker {

/// How many scans before the first sighting of a thing looked at its place.
struct Watched {
  int num_looks = 0;  // scans whose beams came there, between the water and the thing's top
  int num_empty = 0;  // of these, scans that met nothing near the place

  friend bool operator==(const Watched&, const Watched&) = default;
};

/// Log odds that the thing came up when it was seen first: how unlikely it is that it was there before, and was missed each time.
/// @param seen_share  share of the scans that saw the thing, of those that could
double CameUpLogOdds(const Watched& watched, double seen_share);

/// The beams of the last scans, with 2 bytes a shot, which is all that this question needs. A VLP-16 has 300 000 shots a second, so 1.9 MB.
class WatchedWater {
 public:
  static constexpr double kKeptS = 3.0;
  static constexpr std::size_t kMostScans = 100;
  static constexpr double kWatchedS = 2.0;  // before something came up: long enough to say that nothing was there

  /// @param time  of the scan's end; later than all before
  void Add(const Sight& sight, Utime time);
  /// @param top_m   of the thing, above the water
  /// @param before  end of the scan in which it was seen first: scans of the 2 s before that count
  Watched At(const Eigen::Vector2d& place_m, double top_m, Utime before) const;
  void Clear() { scans_.clear(); }

 private:
  struct Scan {
    Utime time;
    Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  // T_map_lidar, z over the water
    Eigen::Isometry3d end = Eigen::Isometry3d::Identity();
    double max_range_m = 0.0;
    std::vector<Eigen::Vector2d> ring;         // cosine and sine of the elevation
    std::vector<float> unwrapped_rad;          // [columns]
    std::vector<std::uint16_t> range_cm = {};  // [columns x rings] 0: nothing was met
  };
  enum class Look { kNone, kEmpty, kMet };
  static Look LookAt(const Scan& scan, const Eigen::Vector2d& place_m, double top_m);

  std::deque<Scan> scans_;
};

}  // namespace lookout::tracker
