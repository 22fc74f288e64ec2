// Position, velocity and attitude of the vessel from the fixes, headings, attitudes and IMU samples that there are.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "common/core/geodesy.hpp"
#include "common/core/health.hpp"
#include "services/navigator/core/filter/aiding.hpp"
#include "services/navigator/core/filter/believed_place.hpp"
#include "services/navigator/core/filter/frozen_place.hpp"
#include "services/navigator/core/filter/motion.hpp"
#include "services/navigator/core/filter/params.hpp"
#include "services/navigator/core/filter/state.hpp"
#include "services/navigator/core/measurement.hpp"

namespace lookout::navigator {

/// Measurements that were not used, or only against the state: README.md has the meaning of each.
inline constexpr auto kFilterCountNames = std::to_array<std::string_view>(
    {"unusable_fix", "frozen_fix", "unreachable_fix", "new_place", "late_fix", "late_attitude", "late_imu", "unusable_imu", "gated_fix",
     "gated_attitude", "renewed_position", "renewed_attitude", "late_odometry", "gated_odometry"});
using FilterCounts = Counts<kFilterCountNames>;

/// An error-state Kalman filter that is run again from the instant of a late measurement: the pose of a time depends on the
/// measurements and their order, not on when it was asked.
///
/// Inputs are kept, with the state behind each, for `max_latency` and a second, and at most kMaxEvents of them.
class PoseFilter {
 public:
  /// 60 s of an IMU at 400 Hz and the other measurements would be 100 MB; so many are 18 MB, 10 s of it.
  static constexpr std::size_t kMaxEvents = 4000;

  explicit PoseFilter(const FilterParams& params);

  /// A start mark: all but the counts is void.
  void Reset();

  /// Sentences of one epoch (the same time) are one fix: RMC adds its velocity, GGA its position and height.
  void Add(const GnssFix& fix);
  /// A velocity without a time of its own counts while fixes bring none.
  void Add(const GroundVelocity& velocity);
  void Add(const Attitude& attitude);
  void Add(const ImuSample& sample);
  void Add(const OdometryMotion& motion);
  /// Time has come so far: nothing else need have.
  void AdvanceTo(Utime time);

  /// The pose from the measurements so far.
  ///
  /// @param time  not before the time of the last call
  Pose At(Utime time);

  /// Arrival of the last usable fix.
  std::optional<Utime> last_fix_arrival() const { return last_fix_arrival_; }
  /// A sensor of heading has come.
  bool has_had_heading() const { return has_had_heading_; }
  const FilterCounts& counts() const { return counts_; }
  /// Sums over all measurements that were gated: of their normalised innovations squared, and of their degrees of freedom.
  double nis_sum() const { return nis_sum_; }
  std::int64_t num_nis_degrees() const { return num_nis_degrees_; }

  /// A datum out of config that is far from the first fix, in words (common/core/datum_check.hpp); empty = none.
  const std::string& datum_complaint() const { return datum_complaint_; }

  /// Fixes that are not used at the time of the last pose, since no boat can have got there (believed_place.hpp) or since they repeat an old place
  /// (frozen_place.hpp), in words; empty = none.
  const std::string& doubted() const { return doubted_; }

  /// At the time of the last pose position or heading, whose input has stopped, is carried on by motions of the lidar.
  bool is_carried_by_lidar() const { return is_carried_by_lidar_; }
  /// At that time motions of the lidar have contradicted the state for a second and more.
  bool contradicts_lidar() const { return contradicts_lidar_; }

  /// At that time by how much a compass and the lidar's own motion have turned apart, rad; 0 while that is within what a compass errs.
  double heading_apart_rad() const { return heading_apart_rad_; }

  /// Inputs that have stopped at the time of the last pose, in words: "no position fix for 3 s", ...; empty = none.
  const std::string& stopped() const { return stopped_; }

 private:
  using Measurement = std::variant<filter::Tick, ImuSample, AttitudeValues, filter::VelocityMeasurement, filter::FixMeasurement, OdometryMotion>;
  struct Event {
    Utime time;
    Measurement measurement;
    bool is_counted = false;  // in the counts
    filter::State after;      // state after this event, once the event is processed
  };

  void SetDatum(const GeodeticPlace& datum);
  // The map frame begins anew at `time`: all before was elsewhere.
  void MoveDatum(Utime time, const GeodeticPlace& antenna);
  BelievedPlace::Verdict Judge(const GnssFix& fix, const GeodeticPlace& antenna, double sd_m);
  void NameDoubted(Utime time);
  // False: older than all that is kept.
  bool Insert(Utime time, const Measurement& measurement);
  void Touch(std::size_t index);
  void DropOld();
  // The fix of the same epoch; nullptr when there is none.
  filter::FixMeasurement* SameEpoch(const filter::FixMeasurement& fix, Utime time, std::size_t& index);
  // The sample for the interval that ends at `time`, by the events around it.
  const ImuSample* SampleFor(std::size_t next_index, Utime time) const;
  const filter::State& StateBefore(std::size_t index) const;
  void Process(Event& event, std::size_t index);
  void ProcessUntil(Utime time);

  FilterParams params_;
  std::optional<GeodeticPlace> datum_;
  std::optional<LocalFrame> map_;
  // Valid from the time of the first fix at a new place on.
  struct NextDatum {
    Utime time;
    GeodeticPlace datum;
  };
  std::optional<NextDatum> next_datum_;
  BelievedPlace believed_place_;
  FrozenPlaces frozen_places_;
  // The last believed fix but GGA, and the place believed before it.
  struct Believed {
    std::string source;
    Utime time;
    BelievedPlace before;
    bool gave_datum = false;
  };
  std::optional<Believed> last_believed_;
  std::string doubted_source_;
  std::deque<Event> events_;  // by time; at equal times attitude before position
  std::size_t num_processed_ = 0;
  std::optional<filter::State> base_;     // before events_
  std::optional<ImuSample> base_sample_;  // the last sample before events_
  Utime base_sample_time_{};
  std::optional<Utime> newest_;  // of all measurements
  std::optional<Utime> last_fix_arrival_;
  FilterCounts counts_;
  double nis_sum_ = 0.0;
  std::int64_t num_nis_degrees_ = 0;
  std::string stopped_;
  std::string datum_complaint_;
  std::string doubted_;
  bool has_had_heading_ = false;
  bool is_carried_by_lidar_ = false;
  bool contradicts_lidar_ = false;
  double heading_apart_rad_ = 0.0;
};

}  // namespace lookout::navigator
