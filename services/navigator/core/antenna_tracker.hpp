// Position and velocity of the GNSS antenna at a time, out of fixes, in the map frame.
#pragma once

#include <Eigen/Core>
#include <GeographicLib/LocalCartesian.hpp>
#include <chrono>
#include <cstdint>
#include <optional>

#include "common/core/utime.hpp"
#include "services/navigator/core/measurement.hpp"
#include "services/navigator/core/pose.hpp"

namespace lookout::navigator {

struct AntennaParams {
  std::optional<Datum> datum;            // nullopt: the first fix
  std::chrono::microseconds max_age{0};  // a fix and a velocity are carried on for so long
  double velocity_sd_mps = 0.0;
  double position_drift_mps = 0.0;  // growth of the position's standard deviation while a fix is carried on
};

struct VelocityEstimate {
  Eigen::Vector3d map_mps = Eigen::Vector3d::Zero();  // up is 0: a boat stays on the water
  double horizontal_sd_mps = 0.0;
  double vertical_sd_mps = 0.0;
};

struct AntennaEstimate {
  Eigen::Vector3d p_map_m = Eigen::Vector3d::Zero();
  bool has_height = false;  // else up is that of the datum's height at this place
  double horizontal_sd_m = 0.0;
  double vertical_sd_m = 0.0;
};

struct CourseEstimate {
  double course_rad = 0.0;
  double speed_mps = 0.0;
  std::chrono::microseconds age{0};
};

class AntennaTracker {
 public:
  explicit AntennaTracker(const AntennaParams& params);

  /// Takes a fix that was measured; others, and those older than the last, are counted only. Older is told by times of one kind: where one is of a
  /// sentence and the other of an arrival, the order of arrival counts. Of two sentences of the same measurement time the
  /// position of a GGA counts, for it tells height and accuracy.
  void Add(const GnssFix& fix);
  void Add(const GroundVelocity& velocity);

  const std::optional<Datum>& datum() const { return datum_; }
  /// The map frame; there when a datum is.
  const std::optional<GeographicLib::LocalCartesian>& map() const { return map_; }

  /// The last fix, carried on by the velocity; nullopt when it is older than max_age.
  std::optional<AntennaEstimate> PositionAt(Utime time) const;
  std::optional<VelocityEstimate> VelocityAt(Utime time) const;

  /// nullopt also when the receiver gives a speed without a course, as receivers do at rest.
  std::optional<CourseEstimate> CourseAt(Utime time) const;

  /// Arrival of the last fix taken.
  std::optional<Utime> last_arrival() const { return last_arrival_; }

  std::int64_t num_unusable() const { return num_unusable_; }
  std::int64_t num_late() const { return num_late_; }

 private:
  struct Fix {
    Utime time;
    bool is_time_from_sentence = false;
    GeodeticPosition position;
    double sd_m = 0.0;
  };
  struct Height {
    Utime time;
    double ellipsoid_m = 0.0;
  };
  void SetDatum(const Datum& datum);

  AntennaParams params_;
  std::optional<Datum> datum_;
  std::optional<GeographicLib::LocalCartesian> map_;
  std::optional<Fix> fix_;
  std::optional<Height> height_;
  std::optional<GroundVelocity> velocity_;
  std::optional<Utime> last_arrival_;
  std::int64_t num_unusable_ = 0;
  std::int64_t num_late_ = 0;
};

}  // namespace lookout::navigator
