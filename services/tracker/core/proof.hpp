// Whether the course of a moving track is proven, or may be a ghost's.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>

#include "common/core/utime.hpp"
#include "services/tracker/core/picture.hpp"

namespace lookout::tracker {

/// A track that jumps from one piece of a hull, or from one crest, to the next seems to run, and is gone a second later. A boat gets where its course
/// leads. So a moving track is proven when it was seen for speed / kGainMps2 (kLeastS to kMostS) and has gone half of speed x time. If it is unproven
/// after 6 s, its course starts again; a stop shorter than kPauseS does not restart it.
///
/// A track that began to move within kBesideM of something that stands (a quay, a boat at its berth) is most often a piece of that: as the own boat
/// moves, now one end of the quay is seen and now the other. Such a track, slow or fast, must also have gone kLeavesM and be more than kTouchM off
/// everything that stands, or have gone kPassesM. While it is unproven it may be acted on, but not before it has gone kLeavesM.
///
/// A boat comes to water that was empty. A track that comes to where something stood before the track can have got there (Track::is_on_ground) is a
/// piece of that, and its course starts again. A proven track stays proven for kOnGroundS on such ground, since it may pass a buoy. After that it is
/// unproven, but MayBePiece stays false.
class Proof {
 public:
  static constexpr double kLeastS = 1.0;
  static constexpr double kMostS = 3.0;
  static constexpr double kYoungS = 1.0;
  /// A tentative track of this existence probability is likelier a thing than a crest.
  static constexpr double kLikely = 0.65;
  /// A speedboat gains 25 kn in 4 s; small craft with an outboard less.
  static constexpr double kGainMps2 = 4.0;

  static constexpr double kBesideM = 3.0;
  static constexpr double kTouchM = 1.0;
  static constexpr double kPauseS = 2.0;
  /// Parts of small craft are nearer to each other than that.
  static constexpr double kLeavesM = 3.0;
  static constexpr double kPassesM = 10.0;
  static constexpr double kOnGroundS = 0.5;

  /// One scan. Call Rename of that scan before.
  /// @param shore_m  remembered land with water before it, on the map
  void Update(std::span<const Track> tracks, std::span<const Eigen::Vector2d> shore_m = {});
  void Rename(std::int64_t from_track, std::int64_t to_track);
  void Clear() { courses_.clear(); }

  bool IsProven(const Track& track) const;
  /// Whether the track seems to move, and may still be a piece of something that stands.
  bool MayBePiece(std::int64_t track_id) const;
  /// Seen for so short that it may be nothing, or of another size or speed.
  static bool IsYoung(const Track& track, Utime time) { return ToSeconds(time - track.first) < kYoungS; }
  /// Seen for longer than most crests live, and likelier a thing than one: a tentative track then counts as if it were confirmed.
  static bool Lasts(const Track& track, Utime time) {
    return track.status == TrackStatus::kTentative && track.existence_probability >= kLikely && ToSeconds(time - track.first) >= kMostS;
  }

 private:
  struct Course {
    Utime begin;  // of the way that proves it
    Eigen::Vector2d begin_m = Eigen::Vector2d::Zero();
    Utime seen;                                          // last, while it moved
    double on_ground_s = 0.0;                            // for how long without a break it was seen on such ground
    Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  // where it began to move
    bool is_beside = false;                              // it began beside something that stands
    bool has_left = false;                               // it has gone kLeavesM, or did not begin beside anything
    bool was_proven = false;                             // before it came to such ground
    bool is_proven = false;
  };
  static Course CourseOf(const Track& track, std::span<const Track> tracks, std::span<const Eigen::Vector2d> shore_m);

  std::map<std::int64_t, Course> courses_;  // by track
};

}  // namespace lookout::tracker
