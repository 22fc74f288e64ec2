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

/// When lidar, navigator or the process begin anew, tracks get other ids, and alerts that still hold are raised again. Nobody should have to
/// acknowledge the same buoy twice. So an alert of a track that stands where the acknowledged one would be by now is acknowledged too, if it is no
/// graver; and an alert of land where land was acknowledged, on that side of the boat (60 deg) and no nearer than half as far.
class KeptAcknowledgements {
 public:
  /// Sources: a track is confirmed again within 2 s and its alert comes up within one more; a track 5 m off may be another boat.
  static constexpr std::chrono::seconds kKeptFor{10};
  static constexpr double kSamePlaceM = 5.0;

  /// Must be called before the tracks are forgotten; or at the begin, with the alerts and tracks that the process before left. Acknowledgements kept
  /// earlier stay, since their alerts may not have been raised again yet; one of the same thing, the nearest, is replaced.
  void Keep(Utime time, const Datum& datum, std::span<const Alert> alerts, std::span<const Track> tracks);

  /// With a scan: acknowledgements for the alerts that came up since. Each kept acknowledgement goes to one new alert, the nearest. It is given again
  /// when that alert rises from caution to the kept level, and is then used up. It counts on the map of its datum alone.
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
    std::optional<std::int64_t> alert_id = std::nullopt;  // the alert that it went to

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
