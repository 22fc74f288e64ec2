// Compact things that the segmenter calls land, until they are seen to move.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "common/core/utime.hpp"
#include "services/tracker/core/body.hpp"
#include "services/tracker/core/sight.hpp"

namespace lookout::tracker {

/// A barge under way looks like a quay. Compact land that may be a barge is followed here, unpublished. It is no land once it has left a place where
/// it stood, so that beams pass there, or has come where beams had passed before. A part of a quay or a bank, cut otherwise in each scan, seems to
/// move, but leaves nothing free and comes to no free place. Memory: at most kMostPieces of 1 kB.
class LandPieces {
 public:
  static constexpr std::size_t kMostPieces = 64;
  static constexpr double kGreatestRadiusM = 25.0;

  struct Seen {
    std::size_t index = 0;  // in the scan
    std::vector<Eigen::Vector2d> outline_m;
    std::span<const Eigen::Vector2d> places_m;  // returns
    std::span<const double> heights_m;          // of the returns, over the water
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    double radius_m = 0.0;
    double range_m = 0.0;
    Eigen::Matrix2d noise_m2 = Eigen::Matrix2d::Zero();  // covariance of its position relative to the own boat
    Sides sides;
  };

  /// A piece that is proven to move.
  struct Proven {
    std::size_t index = 0;  // in the scan
    Utime first;
    int num_hits = 0;
    Eigen::Vector2d first_m = Eigen::Vector2d::Zero();
    Body body;
  };

  void Predict(double dt_s);
  /// @param seen  compact land of the scan
  /// @param seems_moving  [seen] set where it may move: then it is not to be remembered as land
  std::vector<Proven> Update(std::span<const Seen> seen, const Sight& sight, Utime time, std::vector<bool>& seems_moving);
  void Clear() { pieces_.clear(); }
  std::size_t size() const { return pieces_.size(); }

 private:
  struct Piece {
    Utime first;
    Utime seen;
    Utime anchored;
    int num_hits = 1;
    int num_proofs = 0;  // in a row
    Eigen::Vector2d first_m = Eigen::Vector2d::Zero();
    double radius_m = 0.0;
    std::vector<Eigen::Vector3d> stood_m;  // returns of its near side at first, with their heights
    std::vector<Eigen::Vector3d> free_m;   // where their beams had passed before it
    Body body;
  };

  static void Anchor(Piece& piece, const Seen& seen, const Eigen::Vector2d& from_m, Utime time);
  static bool HasMoved(const Piece& piece, const Seen& seen, bool is_whole, const Sight& sight);

  std::deque<Piece> pieces_;  // by age
};

}  // namespace lookout::tracker
