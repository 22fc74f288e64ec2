// What the sentences of all sources measured, and when: from an item to measurements.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/core/health.hpp"
#include "services/navigator/core/arrivals.hpp"
#include "services/navigator/core/item.hpp"
#include "services/navigator/core/measurement.hpp"
#include "services/navigator/core/source_params.hpp"
#include "services/navigator/core/utc_clock.hpp"

namespace lookout::navigator {

/// What one sentence gave.
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
  // Added to the sensors' angles to give those of the vessel frame.
  double heading_offset_rad = 0.0;
  double pitch_offset_rad = 0.0;
  double roll_offset_rad = 0.0;
  std::vector<SourceParams> sources;  // one that is not here has the defaults
};

class Interpreter {
 public:
  explicit Interpreter(const InterpreterParams& params);

  /// @param item  a sentence
  Reading Read(const Item& item);

  /// A start mark: all but the counters is void.
  void Reset();

  /// Computer's clock less UTC; 0 while it is taken for UTC.
  std::chrono::microseconds host_minus_utc() const { return clock_.host_minus_utc(); }

  /// Of all sources, and then of each.
  std::vector<Counter> counters() const;

 private:
  /// What is known of the epoch of a receiver.
  struct Epoch {
    Utime utc;
    GnssFix fix;
    bool has_gga = false;
  };
  /// Deviations out of GST.
  struct Accuracy {
    Utime arrival;
    double horizontal_sd_m = kNan;
    double vertical_sd_m = kNan;
  };
  struct Source {
    SourceParams params;
    // Names of its counters.
    std::string taken_name;
    std::string refused_name;
    std::int64_t num_taken = 0;
    std::int64_t num_refused = 0;
    // Void at a start mark.
    SourceClock clock;
    std::optional<Epoch> epoch;
    std::optional<Accuracy> accuracy;
    double declination_rad = kNan;  // out of RMC
    std::array<Arrivals, std::variant_size_v<Sentence>> arrivals;
    // Of the sentence that is read.
    std::size_t kind = 0;
    bool is_in_time = true;
    // The last timed sentence that told how late one of a queue was; by kind.
    std::array<std::optional<Utime>, std::variant_size_v<Sentence>> told_by;
  };

  Source& SourceOf(const std::string& name);
  bool IsRepeated(const Item& item);
  Reading ReadParsed(const Item& item, const ParseResult& parsed);

  Reading On(const Item& item, Source& source, const OtherSentence& sentence);
  Reading On(const Item& item, Source& source, const Rmc& rmc);
  Reading On(const Item& item, Source& source, const Gga& gga);
  Reading On(const Item& item, Source& source, const Gns& gns);
  Reading On(const Item& item, Source& source, const Xdr& xdr);
  Reading On(const Item& item, Source& source, const TntHtm& htm);
  Reading On(const Item& item, Source& source, const Gll& gll);
  Reading On(const Item& item, Source& source, const Gst& gst);
  Reading On(const Item& item, Source& source, const Zda& zda);
  Reading On(const Item& item, Source& source, const Vtg& vtg);
  Reading On(const Item& item, Source& source, const Hdt& hdt);
  Reading On(const Item& item, Source& source, const MagneticHeading& heading);
  Reading On(const Item& item, Source& source, const Rot& rot);
  Reading On(const Item& item, Source& source, const Pashr& pashr);
  Reading On(const Item& item, Source& source, const PsatHpr& hpr);
  Reading On(const Item& item, Source& source, const VnIns& ins);
  Reading On(const Item& item, Source& source, const VnYmr& ymr);
  Reading On(const Item& item, Source& source, const VnImu& imu);

  std::optional<MeasurementTime> When(const Item& item, Source& source, std::optional<std::chrono::microseconds> time_of_day,
                                      std::optional<std::chrono::sys_days> date, bool is_measured = true);
  std::optional<MeasurementTime> WhenArrived(const Item& item, Source& source);
  Reading OnQualified(const Item& item, Source& source, const Gga& gga, std::string_view sentence_type);
  Reading WholeFix(Source& source, GnssFix fix);
  Attitude MakeAttitude(const Item& item, const Source& source, const char* sentence_type, const MeasurementTime& when, double heading_rad,
                        double pitch_rad, double roll_rad) const;
  static ImuSample MakeImu(Utime time, const StrapdownSample& sample);

  InterpreterParams params_;
  UtcClock clock_;
  std::map<std::string, Source> sources_;
  std::string last_lidar_sentence_;
  std::optional<std::chrono::microseconds> time_scale_;  // that of the last fix: POSE less UTC

  struct Counts {
    std::int64_t no_checksum = 0;
    std::int64_t bad_checksum = 0;
    std::int64_t bad_field = 0;
    std::int64_t implausible_value = 0;
    std::int64_t other_sentence = 0;
    std::int64_t repeated_sentence = 0;
    std::int64_t understood_sentence = 0;
    std::int64_t outside_role = 0;
    std::int64_t sentence_time_unusable = 0;
    std::int64_t time_backwards = 0;
    std::int64_t queued_sentence = 0;
    std::int64_t date_unusable = 0;
    std::int64_t stale_lidar_sentence = 0;
    std::int64_t no_deviation = 0;
    std::int64_t no_declination = 0;
  };
  Counts counts_;
};

}  // namespace lookout::navigator
