// The measurements of the sentences of all sources, and their times: from an item to measurements.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/health.hpp"
#include "services/navigator/core/arrivals.hpp"
#include "services/navigator/core/item.hpp"
#include "services/navigator/core/measurement.hpp"
#include "services/navigator/core/standing_utc.hpp"
#include "services/navigator/core/time_zone.hpp"
#include "services/navigator/core/utc_clock.hpp"

namespace lookout::navigator {

/// Which measurements of a source are used. All its sentences are recorded, whatever the role. The numbers of config.
enum class Role {
  kAll = 1,
  kGnss,      // positions and velocities
  kHeading,   // headings and rates of turn
  kAttitude,  // headings, roll, pitch, rates of turn
  kImu,       // raw angular velocity and specific force
  kNothing,   // recorded only
};

/// How a source speaks. The numbers of config.
enum class Protocol { kNmea0183 = 1, kMavlink };

/// The settings of one source of sentences, as far as they concern its sentences.
struct SourceParams {
  std::string name;  // as in NAV_RAW
  Role role = Role::kAll;
  Protocol protocol = Protocol::kNmea0183;
  int mavlink_system_id = 1;  // of the autopilot
  bool requires_checksum = true;
  // From the instant of a measurement to the arrival of its sentence, where the sentence has no time of its own; nullopt: not known, 0 counts, and
  // the source does not correct the computer's clock below max_sentence_latency.
  std::optional<std::chrono::microseconds> latency;
  // Factors that turn the sensor's signs into ours: +1 where roll is positive starboard down, and pitch positive bow up.
  double roll_sign = 1.0;
  double pitch_sign = 1.0;
  // Deviation and declination of the compass, where the sentence says none; positive east.
  std::optional<double> deviation_rad;
  std::optional<double> declination_rad;
};

/// The measurements of one sentence.
struct Reading {
  std::optional<GnssFix> fix;
  std::optional<Attitude> attitude;
  std::optional<GroundVelocity> velocity;
  std::optional<TurnRate> turn_rate;
  std::optional<ImuSample> imu;
};

struct InterpreterParams {
  std::chrono::microseconds max_sentence_latency{0};
  double position_sd_m = 0.0;  // of a fix without correction at HDOP 1, per axis
  // Offsets that are added to the sensors' angles to give the angles of the vessel frame.
  double heading_offset_rad = 0.0;
  double pitch_offset_rad = 0.0;
  double roll_offset_rad = 0.0;
  std::vector<SourceParams> sources;  // a source that is not listed has the defaults
};

class Interpreter {
 public:
  explicit Interpreter(const InterpreterParams& params);

  /// @param item  a sentence
  Reading Read(const Item& item);

  /// A start mark: all but the counters is void.
  void Reset();

  /// Computer's clock less UTC; 0 while it counts as UTC.
  std::chrono::microseconds host_minus_utc() const { return clock_.host_minus_utc(); }

  /// Counters of all sources together, and then of each.
  std::vector<Counter> counters() const;

 private:
  /// The known values of the epoch of a receiver.
  struct Epoch {
    GnssFix fix;
    bool has_gga = false;
  };
  struct Accuracy {
    Utime arrival;
    Sentence said;
  };
  struct Source {
    SourceParams params;
    // Names of its counters.
    std::string understood_name;
    std::string refused_name;
    std::int64_t num_understood = 0;
    std::int64_t num_refused = 0;
    // Void at a start mark.
    SourceClock clock;
    std::optional<Epoch> epoch;
    std::optional<Accuracy> accuracy;
    TimeZoneCheck time_zone;
    StandingUtc standing_utc;
    std::optional<Utime> null_fix;                  // arrival of the last sentence at 0 N 0 E
    double declination_rad = kNan;                  // out of RMC
    std::optional<Accuracy> autopilot_gps;          // last fix of the autopilot's receiver, measured or not
    std::optional<std::uint32_t> attitude_boot_ms;  // time_boot_ms of the last message of each kind
    std::optional<std::uint32_t> position_boot_ms;
    std::array<Arrivals, kNumSentenceTypes> arrivals;
    bool is_in_time = true;  // of the sentence that is read
    // The last timed sentence from which a queued sentence without a time got its lateness; by type.
    std::array<std::optional<Utime>, kNumSentenceTypes> told_by;
  };

  Source& SourceOf(const std::string& name);
  bool IsRepeated(const Item& item);
  ParseResult Parse(const Item& item, const Source& source);

  void ReadDate(const Item& item, Source& source, const Sentence& zda);
  Reading ReadUnderstood(const Item& item, Source& source, const Sentence& sentence);
  Reading ReadFix(const Item& item, Source& source, const Sentence& sentence);
  Reading ReadVelocity(const Item& item, Source& source, const Sentence& sentence);
  Reading ReadTurnRate(const Item& item, Source& source, const Sentence& sentence);
  Reading ReadAttitude(const Item& item, Source& source, const Sentence& sentence);
  Reading ReadAutopilotAttitude(const Item& item, Source& source, const Sentence& sentence);
  Reading ReadAutopilotPosition(const Item& item, Source& source, const Sentence& sentence);
  const Sentence* AutopilotGps(const Item& item, const Source& source) const;

  std::optional<MeasurementTime> When(const Item& item, Source& source, const Sentence& sentence, bool is_measured = true);
  std::optional<MeasurementTime> WhenArrived(const Item& item, Source& source, SentenceType type);
  void CompleteFix(Source& source, GnssFix& fix);
  Attitude MakeAttitude(const Item& item, const Source& source, const Sentence& sentence, const MeasurementTime& when, double heading_rad) const;

  InterpreterParams params_;
  UtcClock clock_;
  std::map<std::string, Source> sources_;
  std::string last_lidar_sentence_;
  std::optional<std::chrono::microseconds> time_scale_;  // POSE less UTC at the last fix

  static constexpr auto kCountNames = std::to_array<std::string_view>(
      {"understood_sentence", "other_sentence",    "repeated_sentence",  "outside_role",           "no_checksum",       "bad_checksum",
       "bad_field",           "implausible_value", "null_fix",           "sentence_time_unusable", "time_backwards",    "local_time",
       "standing_utc",        "queued_sentence",   "date_unusable",      "stale_lidar_sentence",   "no_deviation",      "no_declination",
       "empty_attitude",      "xdr_not_used",      "unexpected_mavlink", "repeated_mavlink",       "unmeasured_mavlink"});
  Counts<kCountNames> counts_;
};

}  // namespace lookout::navigator
