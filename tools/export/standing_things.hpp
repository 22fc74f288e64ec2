// Standing things: those that one process of the tracker has seen stand.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/core/pose.hpp"
#include "lookout/track_t.hpp"
#include "services/tracker/core/sight.hpp"
#include "tools/export/own_map.hpp"

namespace lookout::exporter {

/// A track that stands, confirmed or coasting.
struct StandingTrack {
  std::int64_t id = 0;
  bool is_confirmed = true;
  bool is_seen = false;                                  // in this scan
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  // map
  MapThing look;                                         // the thing, as it is known now
};

/// @return nullopt: the track moves, is tentative or lost, its place is not known to 10 m, or one of its numbers is impossible
std::optional<StandingTrack> ToStandingTrack(const track_t& track);

/// TRACKS of one scan.
struct StandingScan {
  Utime time;  // first firing
  Utime end_time;
  Datum datum;
  std::vector<StandingTrack> tracks;  // by id
};

/// Once a second of measurement time: a confirmed track that stands is the thing nearest to it, within SamePlaceM of both deviations and of about its
/// length; one that has stood for 10 s where no thing is becomes one, while there are fewer than kMostMapThings. A thing in reach without a track is
/// gone when in 20 such seconds beams passed through all of it, 100 beams together, and nothing was hit; a hit there begins the count anew.
class StandingThings {
 public:
  /// @param given  of processes before, by number: they are looked through, too
  explicit StandingThings(const std::map<std::int64_t, MapThing>& given);

  /// Scans in the order in which the process told them.
  /// @param sight  nullptr: sight is not known
  void Update(const StandingScan& scan, const tracker::Sight* sight);

  /// The things that this process has seen stand.
  std::vector<MapThing> Seen() const;
  /// Numbers of given things that were found gone, and when.
  std::vector<std::pair<std::int64_t, Utime>> GivenGone() const;
  /// Seconds in which a thing was not kept, since there are too many; each thing counts.
  std::int64_t num_over_limit() const { return num_over_limit_; }

 private:
  struct Thing {
    MapThing now;
    std::int64_t given_number = 0;  // 0: seen by this process
    // On the map, where it was seen last.
    Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector2d> outline_m;
    bool is_tracked = false;
    int num_looks = 0;  // looks in which the thing was not there
    double num_beams = 0.0;
  };

  void PlaceOnMap(const Datum& datum);
  static void Place(const LocalFrame& map, const Datum& datum, Thing& thing);
  void NoteSeen(const StandingScan& scan);
  void LetGo(const std::vector<StandingTrack>& tracks);
  void Match(const StandingScan& scan);
  void Measure(const StandingScan& scan);
  void LookThrough(Utime now, const tracker::Sight& sight);

  std::vector<Thing> things_;                     // things that were given come first
  std::map<std::int64_t, std::size_t> thing_of_;  // by track
  std::optional<Datum> datum_;
  std::optional<std::int64_t> second_;  // in which tracks and things were compared last
  std::size_t num_given_ = 0;
  std::size_t next_looked_ = 0;
  std::int64_t num_over_limit_ = 0;
};

}  // namespace lookout::exporter
