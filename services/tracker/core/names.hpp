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

/// A name belongs to the track that people gave it to. Pieces of a structure (Things) that have no name of their own are told by the name of another
/// piece: of several by the one given last. When the named piece ends, its name passes to another piece of the structure. A name lives as long as its
/// track, or an alert of that track, and for kKeptFor after, since a thing that is found again by then is the same.
class Names {
 public:
  static constexpr std::size_t kMost = 100;
  static constexpr std::chrono::seconds kKeptFor{10};

  /// An empty name takes away the name of the track; of a nameless piece that of its structure. A name too many is dropped, and counted.
  void Give(std::int64_t track_id, const std::string& name, Utime time);
  /// One track became part of another. If both have a name, the name given last stays, and the earlier one is counted (num_merged).
  void Rename(std::int64_t from, std::int64_t to);
  void Clear() { names_.clear(); }

  /// One scan, before names are given: notes to which thing each named track belongs. Call Things::Update of that scan before.
  void Follow(std::span<const Track> tracks, const Things& things);
  /// One scan, at its end: forgets names of ended tracks.
  void Update(Utime time, std::span<const Track> tracks, std::span<const Alert> alerts);

  /// The name given to the track; "": none.
  std::string Of(std::int64_t track_id) const;
  /// The name of an alert: that of its nearest track, else that of this track's structure, else, where no track is seen any more, that of the thing.
  std::string Of(const Alert& alert) const;
  /// By id of the track.
  std::vector<std::pair<std::int64_t, std::string>> All() const;
  std::int64_t num_over_limit() const { return num_over_limit_; }
  /// Number of names that were lost when their track became one with a track of a later name.
  std::int64_t num_merged() const { return num_merged_; }
  /// Now: number of names that are not told, since another piece of the structure has a later name.
  std::int64_t num_beside() const;

 private:
  struct GivenName {
    std::string name;
    std::int64_t order = 0;  // in which names were given
    Utime borne;             // when a track or an alert bore it last
    bool is_structure = false;
    std::int64_t thing = kUnnamed;  // to which its track belongs
  };
  using Item = std::pair<const std::int64_t, GivenName>;
  const Item* FindOfStructure(std::int64_t thing) const;
  void PassOn(std::span<const Track> tracks, const Things& things);

  std::map<std::int64_t, GivenName> names_;          // by track
  std::map<std::int64_t, std::int64_t> structures_;  // by track that is a piece of a structure now: the thing
  std::int64_t num_given_ = 0;
  std::int64_t num_over_limit_ = 0;
  std::int64_t num_merged_ = 0;
};

/// When lidar, navigator or the process begin anew, tracks get other ids. Then a name passes to the track that stands where the old one would be by
/// now, the nearest within KeptAcknowledgements::kSamePlaceM, by an order of the tracker itself.
class KeptNames {
 public:
  /// Must be called before the tracks are forgotten; or at the start, with the names that the process before left.
  void Keep(Utime time, const Datum& datum, std::span<const std::pair<std::int64_t, std::string>> names, std::span<const Track> tracks);

  /// With each scan: orders for its tracks. Each name is given once, to a confirmed track that was seen first since Keep and has no name.
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
