// Acknowledgements that outlive the tracks they were given for.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <optional>
#include <span>
#include <vector>

#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/tracker.hpp"

namespace lookout::tracker {

/// When lidar or navigator begin anew, tracks get other ids, and what still holds is raised again. Nobody should have to take note of the same buoy
/// twice: an alert of the same cause, no graver, of a track that stands where the old one was, is acknowledged too.
class KeptAcknowledgements {
 public:
  /// Sources: a track is confirmed again within 2 s and its alert comes up within one more; what is 5 m off may be another boat.
  static constexpr std::chrono::seconds kKeptFor{10};
  static constexpr double kSamePlaceM = 5.0;

  /// Before the tracks are forgotten.
  void Keep(Utime time, const Datum& datum, std::span<const Alert> alerts, std::span<const Track> tracks);

  /// After a scan: acknowledgements for the alerts that came up since. Each that is kept counts once.
  std::vector<Acknowledgement> Take(Utime time, const Datum& datum, std::span<const Alert> alerts, std::span<const Track> tracks);

 private:
  struct Kept {
    Utime time;  // when it was kept
    AlertCause cause;
    AlertLevel level;
    std::optional<Eigen::Vector2d> position_m;  // map; nullopt: of land
    Eigen::Vector2d velocity_mps;
  };
  std::vector<Kept> kept_;
  Datum datum_;
};

}  // namespace lookout::tracker
