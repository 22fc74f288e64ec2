// Names that people give to things, in place of "boat 7".
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/kept_acknowledgements.hpp"
#include "services/tracker/core/order.hpp"
#include "services/tracker/core/picture.hpp"
#include "services/tracker/core/things.hpp"

namespace lookout::tracker {

/// A name belongs to the track that people gave it to. The name of a piece of a structure is told of the whole structure that has no name of its own
/// (Things): of several the one given last. Where the piece ends its name passes to another piece of the same structure. A name lives as long as its
/// track, or an alert of it, and for kKeptFor after, since a thing found again then is the same.
class Names {
 public:
  static constexpr std::size_t kMost = 100;
  static constexpr std::chrono::seconds kKeptFor{10};

  /// An empty name takes away the given one, of a piece without its own that of its structure. A name too many is dropped, and counted.
  void Give(std::int64_t track_id, const std::string& name, Utime time);
  /// One track became the other. Where both have a name the one given last stays, and the other is counted.
  void Rename(std::int64_t from, std::int64_t to);
  void Clear() { names_.clear(); }

  /// One scan, before names are given: which things the tracks with names are of. Call Things::Update of that scan before.
  void Follow(std::span<const Track> tracks, const Things& things);
  /// One scan, at its end: forgets names of ended tracks.
  void Update(Utime time, std::span<const Track> tracks, std::span<const Alert> alerts);

  /// The name given to the track; "": none.
  std::string Of(std::int64_t track_id) const;
  /// The name of an alert: of its nearest track, else of the structure of that track, else, where the track is not seen any more, of the thing.
  std::string Of(const Alert& alert) const;
  /// By id of the track.
  std::vector<std::pair<std::int64_t, std::string>> All() const;
  std::int64_t num_over_limit() const { return num_over_limit_; }
  /// Names given to a track that became one with a track of a later name.
  std::int64_t num_merged() const { return num_merged_; }
  /// Now: names of structures that are told by a later name of another piece.
  std::int64_t num_beside() const;

 private:
  struct GivenName {
    std::string name;
    std::int64_t order = 0;  // in which they were given
    Utime borne;             // last
    bool is_structure = false;
    std::int64_t thing = kUnnamed;  // that its track is of
  };
  using Item = std::pair<const std::int64_t, GivenName>;
  const Item* FindOfStructure(std::int64_t thing) const;
  void PassOn(std::span<const Track> tracks, const Things& things);

  std::map<std::int64_t, GivenName> names_;          // by track
  std::map<std::int64_t, std::int64_t> structures_;  // tracks that are a piece of one, now, and the thing
  std::int64_t num_given_ = 0;
  std::int64_t num_over_limit_ = 0;
  std::int64_t num_merged_ = 0;
};

/// When lidar, navigator or the process begin anew tracks get other ids: the name passes to the track that stands where the old one would be by now,
/// the nearest within KeptAcknowledgements::kSamePlaceM, as an order of the tracker itself.
class KeptNames {
 public:
  /// Must be called before the tracks are forgotten; or at the begin, with the names that the process before left.
  void Keep(Utime time, const Datum& datum, std::span<const std::pair<std::int64_t, std::string>> names, std::span<const Track> tracks);

  /// With a scan, of its tracks: each name once, for a confirmed track that was seen first since and has no name.
  std::vector<Order> Take(Utime time, const Datum& datum, std::span<const Track> tracks, const Names& names);

 private:
  struct Kept {
    Utime time;
    Datum datum;
    std::string name;
    Eigen::Vector2d position_m;
    Eigen::Vector2d velocity_mps;
  };
  std::vector<Kept> kept_;
};

}  // namespace lookout::tracker
