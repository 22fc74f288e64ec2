// Acknowledged places of things that no track names: land, and things without a track.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"

namespace lookout::tracker {

/// A point of a danger, as the vessel sees it.
struct DangerPlace {
  double range_m = 0.0;                                              // horizontal, from the vessel's origin
  double bearing_rad = 0.0;                                          // from the bow clockwise, 0 to 2 pi
  Eigen::Vector2d position_map_m = Eigen::Vector2d::Constant(kNan);  // NaN: position or heading is not known
};

/// On the map where both are known there, else as the vessel sees them.
double DistanceOf(const DangerPlace& one, const DangerPlace& other);

/// Whether a danger is what a person has acknowledged. An acknowledgement covers the places that were told when it was given:
///
/// - *Land* is covered where the place on the map is one that was told; since a quay goes on beside a boat that sails along it, where land was told
/// on
///   the same bearing from the bow and has been there since, at most twice as far; and where it goes on from covered land without coming nearer, as
///   the rest of a quay does. Forward of the beam the last two hold only for land at least half as far aside of the bow: a wall across the bow is
///   none.
/// - *A thing without a track* is followed from scan to scan, to the nearest place: on the map, or from the vessel where the pose is not known.
///
/// A covered place rings anew (is untold) when it comes nearer than half of the distance that was told, or, forward of the beam, more than 60 degrees
/// of bearing away from where it was told: the boat has turned towards it. Everything else that was not told is untold.
class ToldPlaces {
 public:
  enum class Kind : std::uint8_t { kLand, kThings };

  /// Bearings of land told at an acknowledgement cover so far to both sides; the bins in which GuardZoneDangers looks for the nearest land are half
  /// as wide.
  static constexpr double kBesideRad = 0.175;  // 10 deg

  explicit ToldPlaces(Kind kind) : kind_(kind) {}

  /// The acknowledgement: all of these are told.
  void Tell(Utime time, std::span<const DangerPlace> places);

  /// The map has another datum: positions of before are those of other places.
  void ForgetMap();

  /// One scan.
  /// @return the nearest place that is untold; nullopt: none. Before the first Tell every place is untold
  std::optional<DangerPlace> Untold(Utime time, std::span<const DangerPlace> places);

 private:
  struct Told {
    DangerPlace last;  // of land: as it was told; of a thing: where it was seen last
    double told_range_m = 0.0;
    double told_bearing_rad = 0.0;
    Utime seen;          // of land: when land was last at that place
    Utime bearing_seen;  // of land: when land was last on that bearing
  };

  // kChanged: it was told, and has come much nearer or to another side since.
  enum class Match : std::uint8_t { kNone, kChanged, kTold };
  Match MatchLand(Utime time, const DangerPlace& place);
  void FindTold(Utime time, std::span<const DangerPlace> places, std::vector<bool>& is_told);
  void FollowThings(Utime time, std::span<const DangerPlace> places, std::vector<bool>& is_told);

  Kind kind_;
  std::vector<Told> told_;
};

}  // namespace lookout::tracker
