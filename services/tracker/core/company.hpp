// Groups tracks that move together.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/core/utime.hpp"
#include "services/tracker/core/picture.hpp"

namespace lookout::tracker {

/// The pieces of a long hull, a tug with its barge, kayaks side by side: tracks with about one velocity, so near to each other that nobody steers
/// between them. A pair is one from its second such scan on, for as long as both move and are not farther apart than kLeaveM. Each pair counts, so a
/// row of pieces is one.
///
/// What comes up within kPartM of a known one that moves, and seems to stand, is a part of that for as long as it is so near.
class Company {
 public:
  static constexpr double kJoinM = 3.0;
  static constexpr double kLeaveM = 6.0;
  static constexpr double kAlikeMps = 0.5;
  static constexpr int kJoinScans = 2;
  static constexpr double kPartM = 2.0;
  static constexpr double kKnownS = 3.0;

  /// One scan. Call Rename of that scan before.
  /// @param moving    tracks with outlines, by id
  /// @param standing  the same, which belong to nothing else
  void Update(Utime time, std::span<const Track* const> moving, std::span<const Track* const> standing);
  void Rename(std::int64_t from_track, std::int64_t to_track);
  void Clear();

  /// The first track of the company; a track that is in none: itself.
  std::int64_t NameOf(std::int64_t track_id) const;
  bool HasMore(std::int64_t name) const;
  /// In the last Update: companies that have another name, as they became part of another or their first track is in them no more (from, to).
  const std::vector<std::pair<std::int64_t, std::int64_t>>& renamed() const { return renamed_; }

 private:
  static bool IsTogether(const Track& one, const Track& other, bool is_joined);

  std::map<std::pair<std::int64_t, std::int64_t>, int> pairs_;  // of ids, the lesser first: scans together
  std::map<std::int64_t, std::int64_t> names_;                  // by track
  std::vector<std::pair<std::int64_t, std::int64_t>> renamed_;
};

/// Whether it has been confirmed, and seen first so long ago.
bool IsKnown(const Track& track, Utime time);

/// Of two tracks the one that names both: what was confirmed first, then what is tentative.
std::int64_t FirstOf(std::int64_t one, std::int64_t other);

}  // namespace lookout::tracker
