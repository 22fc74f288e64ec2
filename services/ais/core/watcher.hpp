// Ships of AIS beside the tracks of the lidar: the whole method, from sentences and tracks to what is said of each ship.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/health.hpp"
#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/ais/core/association.hpp"
#include "services/ais/core/in_sight.hpp"
#include "services/ais/core/part_joiner.hpp"
#include "services/ais/core/ships.hpp"

namespace lookout::ais {

/// One item of NAV_RAW, as far as AIS wants it.
struct Item {
  Utime time;             // arrival
  bool is_start = false;  // the navigator began anew: what was heard before is void
  std::string source;
  std::string sentence;  // not of a start mark
};

/// TRACKS of one scan.
struct TracksOfScan {
  Utime time;  // first firing
  Utime end_time;
  std::int64_t seq = 0;
  std::int64_t raw_seq = 0;
  std::int64_t begin_seq = 0;  // of the tracker's process: ids of another begin are of other tracks
  Utime begin_time;
  Datum datum;
  std::vector<TrackedThing> tracks;                     // confirmed ones, by id
  std::optional<std::vector<Eigen::Vector2d>> shore_m;  // only of a scan that tells the shore
};

/// The numbers of ais_t: why tracks and ships were compared, or why not.
enum class Status { kOk = 0, kNoPosition = 1, kNoPose = 2 };
/// The numbers of ais_ship_t.
enum class ShipState { kNotInSight = 0, kTracked = 1, kUnsure = 2, kAisOnly = 3 };

struct ShipInPicture {
  Ship ship;
  GeodeticPlace place;                     // of the antenna, propagated
  std::optional<PredictedShip> predicted;  // nullopt: the position is not usable, or there is no map
  double range_m = kNan;                   // from the own reference point to the middle of the hull
  double bearing_rad = kNan;               // from the bow, clockwise
  ShipState state = ShipState::kNotInSight;
  std::int64_t track_id = 0;  // kTracked: the track that the ship is. kUnsure: the likeliest track. Else 0
  double probability = 0.0;   // of track_id
};

struct Picture {
  Status status = Status::kNoPosition;
  std::int32_t own_mmsi = 0;
  std::vector<ShipInPicture> ships;  // by MMSI
};

struct WatcherParams {
  std::int32_t own_mmsi = 0;  // 0: as VDO tells
  double list_range_m = 20'000.0;
  AssociationParams association;
  SightParams sight;
};

class Watcher {
 public:
  /// Ships farther from the boat are no tracks of a lidar.
  static constexpr double kReachM = 500.0;
  /// The nearest are compared, so that a flood of false ships does not hold up the rest.
  static constexpr std::size_t kMostCompared = 100;
  /// The nearest are told, so that a message is not too large; where the own place is not known, those with the least MMSI.
  static constexpr std::size_t kMostTold = 200;

  explicit Watcher(const WatcherParams& params) : params_(params), ships_(params.own_mmsi), association_(params.association) {}

  /// In the order of NAV_RAW.
  void Consume(const Item& item);

  /// @param own  the pose at the end of the scan; nullopt: none came
  Picture Update(const TracksOfScan& scan, const std::optional<Pose>& own);

  /// Whether anything of AIS was understood since the start, or since the navigator began anew.
  bool has_heard() const { return has_heard_; }
  std::vector<Counter> counters() const;

 private:
  // Ids and places of tracks hold within one of these.
  struct MapKey {
    std::int64_t begin_seq = 0;
    Utime begin_time;
    Datum datum;
  };

  void KeepToMap(const TracksOfScan& scan);
  void Tell(const TracksOfScan& scan, const Pose& own, Picture& picture);
  ShipState StateOf(const Identity& identity, bool should_be_seen, double step_s);

  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"messages_understood", "messages_other", "messages_too_short", "messages_bad_mmsi", "messages_bad_place",
                                       "messages_bad_part", "ships_untold", "ships_not_compared"});

  WatcherParams params_;
  PartJoiner joiner_;
  Ships ships_;
  Association association_;
  std::vector<Identity> identities_;         // of the last scan with a position, by MMSI
  std::map<std::int32_t, double> unseen_s_;  // by MMSI: for how long the ship should have been seen and was not
  std::vector<Eigen::Vector2d> shore_m_;     // as the last scan that had it told it
  std::optional<MapKey> map_;                // of the scan before
  std::optional<Utime> last_time_;
  bool has_heard_ = false;
  Counts<kCountNames> counts_;
};

}  // namespace lookout::ais
