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

namespace lookout::tracker {

/// A name is of a track; that of a structure is of all its pieces (Things). It lives as long as the track, or an alert of it, and for kKeptFor after,
/// since what is found again then is the same.
class Names {
 public:
  static constexpr std::size_t kMost = 100;
  static constexpr std::chrono::seconds kKeptFor{10};

  /// An empty name takes the one away that was given. Of too many it is dropped, and counted.
  /// @param id  a track or a thing
  void Give(std::int64_t id, const std::string& name, Utime time);
  void Rename(std::int64_t from, std::int64_t to);
  void Clear() { names_.clear(); }

  /// One scan: forgets those of what is gone.
  void Update(Utime time, std::span<const Track> tracks, std::span<const Alert> alerts);

  /// Of the first that has one; "": none has.
  std::string Of(std::int64_t id, std::int64_t or_else = kUnnamed) const;
  /// By id.
  std::vector<std::pair<std::int64_t, std::string>> All() const;
  std::int64_t num_over_limit() const { return num_over_limit_; }

 private:
  struct Given {
    std::string name;
    Utime borne;  // last
  };
  std::map<std::int64_t, Given> names_;
  std::int64_t num_over_limit_ = 0;
};

/// When lidar, navigator or the process begin anew tracks get other ids: the name passes to the track that stands where the old one would be by now,
/// the nearest within KeptAcknowledgements::kSamePlaceM, as an order of the tracker itself.
class KeptNames {
 public:
  /// Before the tracks are forgotten; or at the begin, what the process before left.
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
