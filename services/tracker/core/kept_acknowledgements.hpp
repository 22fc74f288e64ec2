// Acknowledgements that outlive the tracks they were given for.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/tracker.hpp"

namespace lookout::tracker {

/// When lidar, navigator or the process begin anew, tracks get other ids, and what still holds is raised again. Nobody should have to take note of
/// the same buoy twice: an alert, no graver, of a track that stands where the old one would be by now, is acknowledged too; and one
/// of land where one of land was, on that side of the boat (60 deg) and no nearer than half as far.
class KeptAcknowledgements {
 public:
  /// Sources: a track is confirmed again within 2 s and its alert comes up within one more; a track 5 m off may be another boat.
  static constexpr std::chrono::seconds kKeptFor{10};
  static constexpr double kSamePlaceM = 5.0;

  /// Must be called before the tracks are forgotten; or at the begin, with those that the process before left. Earlier kept ones stay: they may not
  /// have been raised again yet. The nearest kept one of the same thing is replaced.
  void Keep(Utime time, const Datum& datum, std::span<const Alert> alerts, std::span<const Track> tracks);

  /// With a scan: acknowledgements for the alerts that came up since. Each that is kept is of one alert, the nearest that came up: once at its level,
  /// and before that as the caution that the alert began with. It counts on the map of its datum alone.
  std::vector<Acknowledgement> Take(Utime time, const Datum& datum, std::span<const Alert> alerts, std::span<const Track> tracks);

 private:
  struct Kept {
    Utime time;  // when it was kept
    Datum datum;
    AlertLevel level;
    std::optional<Eigen::Vector2d> position_m;  // map of the datum; nullopt: of land
    Eigen::Vector2d velocity_mps;
    double distance_m = kNan;  // of land, as the alert told it
    double bearing_rad = kNan;
    std::optional<std::int64_t> alert_id = std::nullopt;  // that it is of by now

    bool IsSameLand(const Alert& alert) const;
    // Precondition: not of land.
    Eigen::Vector2d ExpectedAt(Utime at) const;
  };

  void Forget(Utime time);
  static std::optional<double> DistanceTo(const Kept& kept, Utime time, const Alert& alert, const Track* track);
  static std::vector<Kept>::iterator FindSame(std::vector<Kept>& older, const Kept& kept);

  std::vector<Kept> kept_;
};

}  // namespace lookout::tracker
