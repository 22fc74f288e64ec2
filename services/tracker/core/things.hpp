// Groups tracks to things: land, structures, and the tracks that stand beside them.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/core/utime.hpp"
#include "services/tracker/core/picture.hpp"
#include "services/tracker/core/proof.hpp"

namespace lookout::tracker {

/// A pier in pieces is one thing, and so is a quay with all that is moored to it: a track that stands for a while within kBesideM of land, or of a
/// track that belongs to land, belongs to it; one that stands beside a structure belongs to that, and any two that stand side by side are one. It
/// stays so, since outlines and kinds flicker, until it moves or is no track any more. So a boat that casts off is a thing of its own.
///
/// A track that came up within kPartM of a known one, or is not confirmed yet, is a part of that. Around a boat that lies still all tracks that stand
/// within kBesideM are its berth: it steers nowhere.
class Things {
 public:
  static constexpr double kBesideM = 3.0;
  /// Of any two that stand: nobody steers between them.
  static constexpr double kTouchM = 1.0;
  /// A thing is seen in so many parts.
  static constexpr double kPartM = 2.0;
  static constexpr double kKnownS = 3.0;
  /// One less than raise an alert, so that it comes up as one. What moves is known to within a second, and leaves again.
  static constexpr int kStandsScans = 2;

  /// One scan. Call Rename of that scan before.
  /// @param shore_m  remembered land with water before it, on the map
  /// @param proof    which of what seems to move may be a piece of what stands; nullptr: none
  void Update(Utime time, std::span<const Track> tracks, std::span<const Eigen::Vector2d> shore_m, const Proof* proof = nullptr,
              bool is_own_still = false);
  void Rename(std::int64_t from_track, std::int64_t to_track);
  void Clear();

  /// The thing that a track belongs to: land, the first track of its structure, or it alone.
  std::int64_t ThingOf(std::int64_t track_id) const;
  /// Whether the thing has more than one track.
  bool IsGroup(std::int64_t thing) const;
  /// In the last Update: things that became part of others, or have another name since the track left that named them (from, to).
  const std::vector<std::pair<std::int64_t, std::int64_t>>& merged() const { return merged_; }

 private:
  struct Member {
    std::int64_t thing = 0;
    int num_scans = 0;             // in which it stood
    bool is_joined = false;        // with others, or land
    bool is_of_structure = false;  // it is one, or of one
  };
  void Join(std::int64_t from_thing, std::int64_t to_thing);
  void RenameOrphans();

  std::map<std::int64_t, Member> members_;  // by track
  std::vector<std::pair<std::int64_t, std::int64_t>> merged_;
};

}  // namespace lookout::tracker
