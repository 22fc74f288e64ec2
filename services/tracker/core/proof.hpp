// Whether a fast course has shown itself, or may be a ghost.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>

#include "common/core/utime.hpp"
#include "services/tracker/core/picture.hpp"

namespace lookout::tracker {

/// Where one of two pieces of a hull or a crest behind another is taken for the thing itself, it seems to run, as fast as both are apart, and is gone
/// a second later. A boat gets where its course leads. So a moving track is proven when it was seen for as long as a boat needs to gain that speed, a
/// second at least, and has gone half of the way by then. A track that has not shown itself for 6 s begins anew. One that seems to stand for less
/// than kPauseS goes on.
///
/// A track that began to move within kBesideM of something that stands (a quay, a boat at its berth) is, most often, a piece of that: as the own boat
/// moves, now one end of it is seen and now the other. It is proven, slow or fast, when it has besides gone kLeavesM and is off by kTouchM, or has
/// gone kPassesM; it may be acted on before that, but not before it has gone kLeavesM.
///
/// A boat comes to water that was empty. A track that comes to where something stood before it can have been there (Track::is_on_ground) is a piece
/// of that, and its way begins anew. What is proven stays so for kOnGroundS, as it passes a buoy; then it is doubted, but is no piece.
class Proof {
 public:
  static constexpr double kLeastS = 1.0;
  static constexpr double kMostS = 3.0;
  static constexpr double kYoungS = 1.0;
  /// Existence of a tentative track that is no crest, rather than one.
  static constexpr double kLikely = 0.65;
  /// A speedboat gains 25 kn in 4 s; small craft with an outboard less.
  static constexpr double kGainMps2 = 4.0;

  static constexpr double kBesideM = 3.0;
  static constexpr double kTouchM = 1.0;
  static constexpr double kPauseS = 2.0;
  /// More than the parts of small craft are apart.
  static constexpr double kLeavesM = 3.0;
  static constexpr double kPassesM = 10.0;
  static constexpr double kOnGroundS = 0.5;

  /// One scan. Call Rename of that scan before.
  /// @param shore_m  remembered land with water before it, on the map
  void Update(std::span<const Track> tracks, std::span<const Eigen::Vector2d> shore_m = {});
  void Rename(std::int64_t from_track, std::int64_t to_track);
  void Clear() { courses_.clear(); }

  bool IsProven(const Track& track) const;
  /// Whether it seems to move, and may still be a piece of something that stands beside it.
  bool MayBePiece(std::int64_t track_id) const;
  /// Seen for so short that it may be nothing, or of another size or speed.
  static bool IsYoung(const Track& track, Utime time) { return ToSeconds(time - track.first) < kYoungS; }
  /// Seen for longer than most crests live, and likelier a thing than one: a tentative track then counts as if it were confirmed.
  static bool Lasts(const Track& track, Utime time) {
    return track.status == TrackStatus::kTentative && track.existence_probability >= kLikely && ToSeconds(time - track.first) >= kMostS;
  }

 private:
  struct Course {
    Utime begin;  // of the way by which it shows itself
    Eigen::Vector2d begin_m = Eigen::Vector2d::Zero();
    Utime seen;                                          // moving, last
    double on_ground_s = 0.0;                            // on end, seen
    Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  // where it was seen to move first
    bool is_beside = false;                              // it began so
    bool has_left = false;                               // or it did not begin beside anything
    bool was_proven = false;                             // and is doubted
    bool is_proven = false;
  };
  static Course CourseOf(const Track& track, std::span<const Track> tracks, std::span<const Eigen::Vector2d> shore_m);

  std::map<std::int64_t, Course> courses_;  // by track
};

}  // namespace lookout::tracker
