// How far the surface of a thing has moved, by its returns alone.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "common/core/utime.hpp"

namespace lookout::tracker {

/// A displacement of the surface that is seen.
struct SurfaceShift {
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();            // map
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();  // of the match; large along a plain wall
  double over_s = 0.0;
  double new_s = 0.0;  // the part of over_s that no earlier shift covered
};

/// Matches the returns of one thing with its returns of up to a second before (iterative closest point, with the normals of the surface). A return
/// without a counterpart counts nothing. So it does not matter how much of the thing is seen, whereas the outline of a large thing mostly tells that.
///
/// Points are matched in three dimensions, since beams of other elevations meet other parts of a hull, and shifted in two. Along a plain wall nothing
/// tells how far it moved; a lone return, as of a mast, tells it roughly.
///
/// P. J. Besl and N. D. McKay, "A Method for Registration of 3-D Shapes", 1992; A. Segal, D. Haehnel and S. Thrun, "Generalized-ICP", 2009.
/// Cost: 0.1 ms for 64 returns, 0.5 ms for 1000, of which the means of at most 64 cells are matched; 50 kB.
class SurfaceMotion {
 public:
  /// Returns of one more scan.
  /// @param time  of the returns, after that of the last call
  /// @param places_m  map
  /// @param heights_m  over the water, of each place; fewer: they are not known, and there is no match
  /// @param velocity_mps  with which a match is looked for, besides that of a thing that stands. nullopt: where something nearer cuts the thing off.
  ///     Posts behind a gap that moves would match their neighbours one by one, and the right match would lack one.
  /// @return nullopt where fewer than kLeastReturns are seen, or too few of them are found again
  std::optional<SurfaceShift> Update(Utime time, std::span<const Eigen::Vector2d> places_m, std::span<const double> heights_m,
                                     const std::optional<Eigen::Vector2d>& velocity_mps);
  /// What was seen until now was of something else, too.
  void Clear();
  /// The own position was off by so much, and all places on the map with it.
  void Translate(const Eigen::Vector2d& by_m);

  static constexpr std::size_t kLeastReturns = 12;

 private:
  struct Point {
    Eigen::Vector3d place_m;
    Eigen::Matrix2d weight;  // inverse of the covariance of a counterpart about it
  };
  struct Look {
    Utime time;
    std::vector<Point> points;
  };
  struct Match;
  static Look LookOf(Utime time, std::span<const Eigen::Vector2d> places_m, std::span<const double> heights_m);
  static Match MatchFrom(const Look& before, const Look& now, const Eigen::Vector2d& start_m);
  static Match BestOf(const Look& before, const Look& now, std::span<const Eigen::Vector2d> velocities_mps);
  Match MatchWith(const Look& before, const Look& now, const std::optional<Eigen::Vector2d>& velocity_mps) const;

  std::deque<Look> looks_;
  Utime matched_ = Utime::min();
  Eigen::Vector2d last_mps_ = Eigen::Vector2d::Zero();
};

}  // namespace lookout::tracker
