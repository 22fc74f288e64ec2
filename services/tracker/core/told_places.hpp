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
/// - *Land* is covered if (1) it lies at a told place of the map; or (2) land was told on that bearing (kBesideRad to both sides) and has been seen
///   there since, at most twice as far, as a quay beside a boat that sails along it; or (3) it continues covered land without coming nearer, as the
///   rest of a quay does. Forward of the beam (2) and (3) need the same side of the bow line, and at least half of the offset from it that the
///   covered land has: so a wall ahead is not covered.
/// - *A thing without a track* is followed from scan to scan, to the nearest place: on the map, or from the vessel where the pose is not known.
///
/// A covered place is untold again when it comes nearer than half of the told distance, or lies forward of the beam and more than 60 degrees from the
/// told bearing: the boat has turned towards it. All other places are untold.
class ToldPlaces {
 public:
  enum class Kind : std::uint8_t { kLand, kThings };

  /// Bearings of land told at an acknowledgement cover so far to both sides; the bins in which GuardZoneDangers looks for the nearest land are half
  /// as wide.
  static constexpr double kBesideRad = 0.175;  // 10 deg

  explicit ToldPlaces(Kind kind) : kind_(kind) {}

  /// An acknowledgement of all these places.
  void Tell(Utime time, std::span<const DangerPlace> places);

  /// The map has another datum: earlier positions lie elsewhere on it.
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
