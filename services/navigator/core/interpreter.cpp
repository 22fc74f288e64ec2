#include "services/navigator/core/interpreter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::navigator {

namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;

// The first sentence that a lidar repeats is of now when its time is so near: clocks of small computers are off by seconds, not by more.
constexpr std::chrono::seconds kMaxFirstLidarAge(10);
// A burst of sentences of one epoch takes less than this at 9600 baud with three of them; epochs are 50 ms apart or more.
constexpr microseconds kMaxBurst = 50ms;
// Less is the fit of the clocks that settles.
constexpr std::chrono::milliseconds kMinScaleStep(100);
// Receivers send GST with each epoch, or once in some.
constexpr std::chrono::seconds kMaxAccuracyAge(5);

double WrapHeading(double angle_rad) { return std::isnan(angle_rad) ? kNan : WrapTo2Pi(angle_rad); }
double WrapTilt(double angle_rad) { return std::isnan(angle_rad) ? kNan : WrapToPi(angle_rad); }

// The first of them that was said.
double Or(double value, double otherwise) { return std::isnan(value) ? otherwise : value; }

// A boat at rest has no course: what a receiver says there is the direction of its noise. Twice velocity_sd_mps of navigator.proto.
constexpr double kRestMps = 0.2;
double CourseOf(double speed_mps, double course_rad) { return speed_mps < kRestMps ? kNan : course_rad; }

// A lidar goes on repeating the last sentence of a receiver that has gone. What is not of now says nothing until it changes.
bool IsStale(Utime arrival, const ParseResult& parsed) {
  const auto is_stale = [arrival](const auto& time_of_day, const auto& date) {
    return time_of_day && !TimeOfMeasurement(arrival, time_of_day, date, kMaxFirstLidarAge).is_from_sentence;
  };
  if (const auto* rmc = std::get_if<Rmc>(&parsed.sentence)) return is_stale(rmc->time_of_day, rmc->date);
  if (const auto* gga = std::get_if<Gga>(&parsed.sentence)) return is_stale(gga->time_of_day, std::optional<std::chrono::sys_days>());
  return false;
}

GnssFix MakeFix(const Item& item, const MeasurementTime& when, std::string_view sentence_type, FixQuality quality) {
  GnssFix fix;
  fix.when = when;
  fix.source = item.source;
  fix.sentence_type = sentence_type;
  fix.quality = quality;
  return fix;
}

// @return whether the role takes all that a reading may hold
void KeepRole(Role role, Reading& reading) {
  const bool takes_all = role == Role::kAll;
  const bool takes_heading = takes_all || role == Role::kHeading || role == Role::kAttitude;
  if (!takes_all && role != Role::kGnss) {
    reading.fix.reset();
    reading.velocity.reset();
  }
  if (!takes_heading) {
    reading.attitude.reset();
    reading.turn_rate.reset();
  }
  if (reading.attitude && role == Role::kHeading) {
    auto& attitude = *reading.attitude;
    attitude.pitch_rad = attitude.roll_rad = attitude.heave_m = attitude.pitch_sd_rad = attitude.roll_sd_rad = kNan;
  }
  if (!takes_all && role != Role::kImu) reading.imu.reset();
}

bool IsEmpty(const Reading& reading) { return !reading.fix && !reading.attitude && !reading.velocity && !reading.turn_rate && !reading.imu; }

}  // namespace

Interpreter::Interpreter(const InterpreterParams& params) : params_(params), clock_(params.max_sentence_latency) {
  for (const auto& source : params_.sources) SourceOf(source.name).params = source;
}

Interpreter::Source& Interpreter::SourceOf(const std::string& name) {
  const auto [place, is_new] = sources_.try_emplace(name);
  auto& source = place->second;
  if (is_new) {
    source.params.name = name;
    source.taken_name = name + "_understood";
    source.refused_name = name + "_refused";
  }
  return source;
}

void Interpreter::Reset() {
  clock_ = UtcClock(params_.max_sentence_latency);
  last_lidar_sentence_.clear();
  time_scale_.reset();
  for (auto& [name, source] : sources_) {
    source.clock = {};
    source.epoch.reset();
    source.accuracy.reset();
    source.declination_rad = kNan;
    source.arrivals = {};
    source.told_by = {};
  }
}

// The lidar repeats the last sentence that it has in every position packet, 140 times a second.
bool Interpreter::IsRepeated(const Item& item) {
  if (item.source != kLidarSource) return false;
  if (item.sentence == last_lidar_sentence_) return true;
  last_lidar_sentence_ = item.sentence;
  return false;
}

Reading Interpreter::Read(const Item& item) {
  const bool is_first_of_lidar = item.source == kLidarSource && last_lidar_sentence_.empty();
  if (IsRepeated(item)) {
    ++counts_.repeated_sentence;
    return {};
  }
  auto& source = SourceOf(item.source);
  const auto parsed = ParseSentence(item.sentence, source.params.requires_checksum);
  if (is_first_of_lidar && IsStale(item.time, parsed)) {
    ++counts_.stale_lidar_sentence;
    return {};
  }
  const bool is_understood = parsed.fault == SentenceFault::kNone && !std::holds_alternative<OtherSentence>(parsed.sentence);
  source.num_refused += parsed.fault == SentenceFault::kNone ? 0 : 1;
  source.num_taken += is_understood ? 1 : 0;
  counts_.understood_sentence += is_understood ? 1 : 0;
  // What is only recorded tells nothing of the clock either.
  if (is_understood && source.params.role == Role::kNothing) {
    ++counts_.outside_role;
    return {};
  }
  auto reading = ReadParsed(item, parsed);
  const bool had_something = !IsEmpty(reading);
  KeepRole(source.params.role, reading);
  if (had_something && IsEmpty(reading)) ++counts_.outside_role;
  return reading;
}

Reading Interpreter::ReadParsed(const Item& item, const ParseResult& parsed) {
  switch (parsed.fault) {
    case SentenceFault::kNone: {
      auto& source = SourceOf(item.source);
      source.kind = parsed.sentence.index();
      source.is_in_time = source.arrivals[parsed.sentence.index()].Add(item.time);
      return std::visit([&](const auto& sentence) { return On(item, source, sentence); }, parsed.sentence);
    }
    case SentenceFault::kNoChecksum:
      ++counts_.no_checksum;
      break;
    case SentenceFault::kBadChecksum:
      ++counts_.bad_checksum;
      break;
    case SentenceFault::kBadField:
      ++counts_.bad_field;
      break;
    case SentenceFault::kImplausible:
      ++counts_.implausible_value;
      break;
  }
  return {};
}

// Of a sentence without a time; nullopt: it waited in a queue, and nobody knows how long. The first behind a timed one of its input was as late as
// that.
std::optional<MeasurementTime> Interpreter::WhenArrived(const Item& item, Source& source) {
  if (source.is_in_time) return clock_.OfArrival(source.clock, item.time, source.params.latency);
  auto& told_by = source.told_by[source.kind];
  const auto& clock = source.clock;
  const bool is_known = clock.last_utc && clock.is_forward && !clock.fit.is_empty() && clock.fit.is_settled();
  if (is_known && item.time - clock.last_arrival <= kMaxBurst && told_by != clock.last_utc) {
    told_by = clock.last_utc;
    const auto utc = *clock.last_utc + std::chrono::seconds(clock.num_leaps) + source.params.latency.value_or(microseconds(0)) + clock.fit.offset();
    const auto late = std::max<microseconds>(clock.last_arrival - utc, microseconds(0));
    auto when = clock_.OfArrival({}, item.time, source.params.latency);
    when.time -= late;
    when.utc -= late;
    return when;
  }
  ++counts_.queued_sentence;
  return std::nullopt;
}

// nullopt: the source's time runs backwards, or is not known.
std::optional<MeasurementTime> Interpreter::When(const Item& item, Source& source, std::optional<microseconds> time_of_day,
                                                 std::optional<std::chrono::sys_days> date, bool is_measured) {
  if (!time_of_day) return WhenArrived(item, source);
  const auto when = clock_.OfSentence(source.clock, item.time, *time_of_day, date, source.params.latency, is_measured);
  if (!when) {
    ++counts_.time_backwards;
  } else if (when->is_date_refused) {
    ++counts_.date_unusable;
  }
  return when;
}

// Sentences of one instant of one receiver are one fix: each is given with what those before it said.
Reading Interpreter::WholeFix(Source& source, GnssFix fix) {
  if (fix.position && !fix.when.is_from_sentence) ++counts_.sentence_time_unusable;
  const bool is_gga = fix.sentence_type == "GGA" || fix.sentence_type == "GNS";
  if (source.epoch && fix.when.has_sentence_utc && source.epoch->utc == fix.when.utc && source.epoch->fix.when.num_leaps == fix.when.num_leaps) {
    const auto& known = source.epoch->fix;
    fix.repeats_position = known.position.has_value();
    fix.repeats_velocity = !std::isnan(known.speed_mps);
    // GGA and GNS tell more of their position and quality than the others.
    if (!fix.position || (source.epoch->has_gga && !is_gga && known.position)) {
      fix.position = known.position;
      fix.quality = known.quality;
    }
    fix.num_satellites = fix.num_satellites < 0 ? known.num_satellites : fix.num_satellites;
    fix.hdop = Or(fix.hdop, known.hdop);
    fix.msl_height_m = Or(fix.msl_height_m, known.msl_height_m);
    fix.geoid_separation_m = Or(fix.geoid_separation_m, known.geoid_separation_m);
    fix.direct_ellipsoid_height_m = Or(fix.direct_ellipsoid_height_m, known.direct_ellipsoid_height_m);
    if (std::isnan(fix.speed_mps)) {
      fix.speed_mps = known.speed_mps;
      fix.course_rad = known.course_rad;
    }
    source.epoch->fix = fix;
    source.epoch->has_gga = source.epoch->has_gga || is_gga;
  } else if (fix.when.has_sentence_utc) {
    source.epoch = Epoch{fix.when.utc, fix, is_gga};
  }
  if (fix.position && IsMeasured(fix.quality) && fix.when.is_from_sentence) {
    const auto time_scale = clock_.pose_minus_even_utc();
    fix.begins_time_scale = time_scale_ && std::chrono::abs(time_scale - *time_scale_) >= kMinScaleStep;
    time_scale_ = time_scale;
  }
  const auto& accuracy = source.accuracy;
  const bool has_accuracy = accuracy && fix.when.arrival - accuracy->arrival <= kMaxAccuracyAge && IsMeasured(fix.quality);
  if (has_accuracy) {
    fix.horizontal_sd_m = Or(fix.horizontal_sd_m, accuracy->horizontal_sd_m);
    fix.vertical_sd_m = Or(fix.vertical_sd_m, accuracy->vertical_sd_m);
  }
  fix.horizontal_sd_m = fix.position ? Or(fix.horizontal_sd_m, HorizontalSdM(fix.quality, fix.hdop, params_.position_sd_m)) : kNan;
  Reading reading;
  reading.fix = std::move(fix);
  return reading;
}

Reading Interpreter::On(const Item&, Source&, const OtherSentence&) {
  ++counts_.other_sentence;
  return {};
}

Reading Interpreter::On(const Item& item, Source& source, const Rmc& rmc) {
  const auto when = When(item, source, rmc.time_of_day, rmc.date, IsMeasured(rmc.quality));
  if (!when) return {};
  if (IsMeasured(rmc.quality)) source.declination_rad = Or(rmc.declination_rad, source.declination_rad);
  auto fix = MakeFix(item, *when, "RMC", rmc.quality);
  fix.position = rmc.position;
  fix.speed_mps = rmc.speed_mps;
  fix.course_rad = CourseOf(rmc.speed_mps, rmc.course_rad);
  return WholeFix(source, std::move(fix));
}

Reading Interpreter::On(const Item& item, Source& source, const Gga& gga) { return OnQualified(item, source, gga, "GGA"); }

Reading Interpreter::On(const Item& item, Source& source, const Gns& gns) { return OnQualified(item, source, gns, "GNS"); }

Reading Interpreter::OnQualified(const Item& item, Source& source, const Gga& gga, std::string_view sentence_type) {
  const auto when = When(item, source, gga.time_of_day, std::nullopt, IsMeasured(gga.quality));
  if (!when) return {};
  auto fix = MakeFix(item, *when, sentence_type, gga.quality);
  fix.position = gga.position;
  fix.num_satellites = gga.num_satellites;
  fix.hdop = gga.hdop;
  fix.msl_height_m = gga.msl_height_m;
  fix.geoid_separation_m = gga.geoid_separation_m;
  return WholeFix(source, std::move(fix));
}

Reading Interpreter::On(const Item& item, Source& source, const Gll& gll) {
  const auto when = When(item, source, gll.time_of_day, std::nullopt, IsMeasured(gll.quality));
  if (!when) return {};
  auto fix = MakeFix(item, *when, "GLL", gll.quality);
  fix.position = gll.position;
  return WholeFix(source, std::move(fix));
}

Reading Interpreter::On(const Item& item, Source& source, const Gst& gst) {
  // Of an old epoch or not: deviations change slowly. The two axes are taken for one.
  source.accuracy = Accuracy{item.time, std::sqrt((gst.north_sd_m * gst.north_sd_m + gst.east_sd_m * gst.east_sd_m) / 2.0), gst.height_sd_m};
  // A receiver does not know its place exactly: 0 is "not known".
  if (source.accuracy->horizontal_sd_m == 0.0) source.accuracy->horizontal_sd_m = kNan;
  if (source.accuracy->vertical_sd_m == 0.0) source.accuracy->vertical_sd_m = kNan;
  return {};
}

Reading Interpreter::On(const Item& item, Source& source, const Zda& zda) {
  // Tells the date to the sentences that have none.
  if (zda.date && zda.time_of_day) clock_.OnDate(source.clock, item.time, *zda.date + *zda.time_of_day);
  return {};
}

Reading Interpreter::On(const Item& item, Source& source, const Vtg& vtg) {
  Reading reading;
  // Behind the fix of its epoch it is of the same instant; it has no time of its own.
  const bool is_of_epoch = source.epoch && item.time - source.epoch->fix.when.arrival <= kMaxBurst;
  // What RMC says of the same instant is the same measurement.
  if (is_of_epoch && !std::isnan(source.epoch->fix.speed_mps)) return reading;
  const auto when = is_of_epoch ? std::optional(source.epoch->fix.when) : WhenArrived(item, source);
  if (!when) return reading;
  reading.velocity = GroundVelocity{when->time, vtg.speed_mps, CourseOf(vtg.speed_mps, vtg.course_rad)};
  return reading;
}

Attitude Interpreter::MakeAttitude(const Item& item, const Source& source, const char* sentence_type, const MeasurementTime& when, double heading_rad,
                                   double pitch_rad, double roll_rad) const {
  Attitude attitude;
  attitude.when = when;
  attitude.source = item.source;
  attitude.sentence_type = sentence_type;
  attitude.heading_rad = WrapHeading(heading_rad + params_.heading_offset_rad);
  attitude.pitch_rad = WrapTilt(source.params.pitch_sign * pitch_rad + params_.pitch_offset_rad);
  attitude.roll_rad = WrapTilt(source.params.roll_sign * roll_rad + params_.roll_offset_rad);
  return attitude;
}

Reading Interpreter::On(const Item& item, Source& source, const Xdr& xdr) {
  Reading reading;
  if (std::isnan(xdr.pitch_rad) && std::isnan(xdr.roll_rad)) return reading;
  const auto when = WhenArrived(item, source);
  if (!when) return reading;
  reading.attitude = MakeAttitude(item, source, "XDR", *when, kNan, xdr.pitch_rad, xdr.roll_rad);
  return reading;
}

Reading Interpreter::On(const Item& item, Source& source, const TntHtm& htm) {
  Reading reading;
  if (std::isnan(htm.heading_rad) && std::isnan(htm.pitch_rad) && std::isnan(htm.roll_rad)) return reading;
  const auto when = WhenArrived(item, source);
  if (!when) return reading;
  reading.attitude = MakeAttitude(item, source, "PTNTHTM", *when, htm.heading_rad, htm.pitch_rad, htm.roll_rad);
  return reading;
}

Reading Interpreter::On(const Item& item, Source& source, const Hdt& hdt) {
  // A compass that has lost its heading goes on sending the sentence, empty.
  if (std::isnan(hdt.heading_rad)) return {};
  const auto when = WhenArrived(item, source);
  if (!when) return {};
  Reading reading;
  reading.attitude = MakeAttitude(item, source, "HDT", *when, hdt.heading_rad, kNan, kNan);
  return reading;
}

Reading Interpreter::On(const Item& item, Source& source, const MagneticHeading& heading) {
  if (std::isnan(heading.compass_rad)) return {};
  const double deviation_rad = Or(heading.deviation_rad, source.params.deviation_rad.value_or(kNan));
  const double declination_rad = Or(heading.declination_rad, Or(source.params.declination_rad.value_or(kNan), source.declination_rad));
  if (std::isnan(deviation_rad)) {
    ++counts_.no_deviation;
    return {};
  }
  if (std::isnan(declination_rad)) {
    ++counts_.no_declination;
    return {};
  }
  const auto when = WhenArrived(item, source);
  if (!when) return {};
  Reading reading;
  reading.attitude = MakeAttitude(item, source, "HDG", *when, heading.compass_rad + deviation_rad + declination_rad, kNan, kNan);
  return reading;
}

Reading Interpreter::On(const Item& item, Source& source, const Rot& rot) {
  Reading reading;
  if (std::isnan(rot.rate_radps)) return reading;
  if (const auto when = WhenArrived(item, source)) reading.turn_rate = TurnRate{when->time, rot.rate_radps};
  return reading;
}

Reading Interpreter::On(const Item& item, Source& source, const Pashr& pashr) {
  const auto when = When(item, source, pashr.time_of_day, std::nullopt);
  if (!when) return {};
  if (pashr.time_of_day && !when->is_from_sentence) ++counts_.sentence_time_unusable;
  Reading reading;
  reading.attitude = MakeAttitude(item, source, "PASHR", *when, pashr.heading_rad, pashr.pitch_rad, pashr.roll_rad);
  reading.attitude->heave_m = pashr.heave_m;
  reading.attitude->heading_sd_rad = pashr.heading_sd_rad;
  reading.attitude->pitch_sd_rad = pashr.pitch_sd_rad;
  reading.attitude->roll_sd_rad = pashr.roll_sd_rad;
  return reading;
}

Reading Interpreter::On(const Item& item, Source& source, const PsatHpr& hpr) {
  const auto when = When(item, source, hpr.time_of_day, std::nullopt);
  if (!when) return {};
  Reading reading;
  reading.attitude = MakeAttitude(item, source, "PSAT", *when, hpr.heading_rad, hpr.pitch_rad, hpr.roll_rad);
  return reading;
}

Reading Interpreter::On(const Item& item, Source& source, const VnIns& ins) {
  const bool is_in_order = !ins.has_fault && ins.mode != VnIns::Mode::kNotTracking;
  const auto when = When(item, source, ins.time_of_day, ins.date, is_in_order);
  if (!when) return {};
  const auto quality = !is_in_order ? FixQuality::kNone : ins.mode == VnIns::Mode::kGnssLost ? FixQuality::kDeadReckoning : FixQuality::kGnss;
  auto fix = MakeFix(item, *when, "VNINS", quality);
  if (is_in_order) {
    fix.position = ins.position;
    fix.direct_ellipsoid_height_m = ins.ellipsoid_height_m;
    // Zeros stand for what is not known.
    fix.horizontal_sd_m = fix.vertical_sd_m = ins.position_sd_m > 0.0 ? ins.position_sd_m : kNan;
    fix.speed_mps = Hypot(ins.velocity_ned_mps.x(), ins.velocity_ned_mps.y());
    fix.course_rad = fix.speed_mps > 0.0 ? WrapTo2Pi(Atan2(ins.velocity_ned_mps.y(), ins.velocity_ned_mps.x())) : kNan;
    fix.climb_mps = -ins.velocity_ned_mps.z();
    fix.velocity_sd_mps = ins.velocity_sd_mps > 0.0 ? ins.velocity_sd_mps : kNan;
  }
  auto reading = WholeFix(source, std::move(fix));
  // Before it tracks, its heading is that of its magnetometer; roll and pitch come from gravity and count.
  const double heading_rad = is_in_order ? ins.yaw_rad : kNan;
  reading.attitude = MakeAttitude(item, source, "VNINS", *when, heading_rad, ins.pitch_rad, ins.roll_rad);
  if (ins.attitude_sd_rad > 0.0) {
    reading.attitude->heading_sd_rad = reading.attitude->pitch_sd_rad = reading.attitude->roll_sd_rad = ins.attitude_sd_rad;
  }
  return reading;
}

ImuSample Interpreter::MakeImu(Utime time, const StrapdownSample& sample) {
  // From x forward, y to starboard, z down to x forward, y port, z up.
  const auto to_vessel = [](const Eigen::Vector3d& v) { return Eigen::Vector3d(v.x(), -v.y(), -v.z()); };
  return {time, to_vessel(sample.angular_velocity_radps), to_vessel(sample.specific_force_mps2)};
}

Reading Interpreter::On(const Item& item, Source& source, const VnYmr& ymr) {
  const auto when = WhenArrived(item, source);
  if (!when) return {};
  Reading reading;
  reading.attitude = MakeAttitude(item, source, "VNYMR", *when, ymr.yaw_rad, ymr.pitch_rad, ymr.roll_rad);
  reading.imu = MakeImu(when->time, ymr.sample);
  return reading;
}

Reading Interpreter::On(const Item& item, Source& source, const VnImu& imu) {
  const auto when = WhenArrived(item, source);
  if (!when) return {};
  Reading reading;
  reading.imu = MakeImu(when->time, imu.sample);
  return reading;
}

std::vector<Counter> Interpreter::counters() const {
  std::vector<Counter> counters{{"understood_sentence", counts_.understood_sentence},
                                {"other_sentence", counts_.other_sentence},
                                {"repeated_sentence", counts_.repeated_sentence},
                                {"outside_role", counts_.outside_role},
                                {"no_checksum", counts_.no_checksum},
                                {"bad_checksum", counts_.bad_checksum},
                                {"bad_field", counts_.bad_field},
                                {"implausible_value", counts_.implausible_value},
                                {"sentence_time_unusable", counts_.sentence_time_unusable},
                                {"time_backwards", counts_.time_backwards},
                                {"queued_sentence", counts_.queued_sentence},
                                {"date_unusable", counts_.date_unusable},
                                {"stale_lidar_sentence", counts_.stale_lidar_sentence},
                                {"no_deviation", counts_.no_deviation},
                                {"no_declination", counts_.no_declination}};
  for (const auto& [name, source] : sources_) {
    counters.push_back({source.taken_name, source.num_taken});
    counters.push_back({source.refused_name, source.num_refused});
  }
  return counters;
}

}  // namespace lookout::navigator
