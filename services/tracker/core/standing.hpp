// What stands: things that this process has seen stand, and those of the map that was given.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "services/tracker/core/own_map.hpp"
#include "services/tracker/core/scan.hpp"
#include "services/tracker/core/sight.hpp"
#include "services/tracker/core/tracker.hpp"

namespace lookout::tracker {

/// Which track stands where a thing stood before, and which things are not where they were. Tracks do not depend on it: it only reads them, and
/// writes Track::known_days, which nothing else reads.
///
/// Once a second of message time: a confirmed track that stands is the thing nearest to it, within SamePlaceM of both deviations and of about its
/// length; one that has stood for 10 s where no thing is becomes one, while there are fewer than kMostMapThings beside those given. A thing in reach
/// without a track is gone when in 20 such seconds beams passed through all of it, 100 beams together, and nothing was hit; what is hit there begins
/// the count anew.
class StandingThings {
 public:
  /// What a file says, maybe nothing: once. Until then Update does nothing.
  void Give(const std::vector<MapThing>& things);

  /// After a scan with an own pose.
  /// @param sight  nullptr: what could have been seen is not known
  void Update(const ScanInput& scan, const Sight* sight, double max_range_m, std::vector<Track>& tracks);

  /// Tracks are forgotten; what they showed of things is not.
  void ForgetTracks() { thing_of_.clear(); }

  /// Things that this process has seen or found gone, of which something has changed since the last call: of those given, with what this process saw.
  std::vector<MapThing> TakeChanged();

  std::int64_t num_given() const { return num_given_; }
  /// Of those given: what was seen on kKnownDays or more, and is seen by this process.
  std::int64_t num_known_seen() const;
  /// Of those given: found gone by this process.
  std::int64_t num_gone() const;
  std::int64_t num_over_limit() const { return num_over_limit_; }

 private:
  struct Thing {
    MapThing now;
    std::optional<MapThing> given;
    // On the map: where it was given, or else was seen last.
    Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector2d> outline_m;
    bool is_tracked = false;
    bool is_changed = false;
    int num_looks = 0;  // without it
    double num_beams = 0.0;

    const MapThing& reference() const { return given ? *given : now; }
  };

  void PlaceOnMap(const Datum& datum);
  static void Place(const LocalFrame& map, const Datum& datum, Thing& thing);
  void NoteSeen(const ScanInput& scan, std::vector<Track>& tracks);
  void LetGo(const std::vector<Track>& tracks);
  void Match(const ScanInput& scan, const std::vector<Track>& tracks);
  void Measure(const ScanInput& scan, const std::vector<Track>& tracks);
  void LookThrough(Utime now, const Sight& sight, double max_range_m);

  std::vector<Thing> things_;                     // by id
  std::map<std::int64_t, std::size_t> thing_of_;  // by track
  std::optional<Datum> datum_;
  std::optional<Utime> second_;  // when tracks and things were compared last
  std::size_t next_looked_ = 0;
  bool has_begun_ = false;
  std::int64_t num_given_ = 0;
  std::int64_t num_over_limit_ = 0;
};

}  // namespace lookout::tracker
