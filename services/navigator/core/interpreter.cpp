#include "services/navigator/core/interpreter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"
#include "services/navigator/core/mavlink_lines.hpp"
#include "services/navigator/core/mavlink_messages.hpp"

namespace lookout::navigator {

namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;

// The first sentence that a lidar repeats is of now when its time is so near: clocks of small computers are off by seconds, not by more.
constexpr std::chrono::seconds kMaxFirstLidarAge(10);
// Less is the fit of the clocks that settles.
constexpr std::chrono::milliseconds kMinScaleStep(100);
// Receivers send GST with each epoch, or once in some.
constexpr std::chrono::seconds kMaxAccuracyAge(5);

// VTG of a receiver that says 0 N 0 E is no more worth than that; it comes with each epoch.
constexpr std::chrono::seconds kMaxNullAge(2);

// GPS_RAW_INT comes once a second, ArduPilot's default, or more often. An estimate without one of its receiver's fixes is dead reckoning.
constexpr std::chrono::seconds kMaxAutopilotGpsAge(2);
// An autopilot's place is its filter's estimate, whose errors last: it counts neither as a phase solution (RTK) nor as two antennas, by which alone
// the filter takes errors for noise. Its time is its arrival besides: 0.2 m are 40 ms at 5 m/s. The heading's is heading_sd_deg of navigator.proto.
constexpr double kMinAutopilotSdM = 0.2;
constexpr double kMinAutopilotVelocitySdMps = 0.1;  // 50 ms in a turn of 20 deg/s at 5 m/s
constexpr double kMinAutopilotHeadingSdRad = DegToRad(1.0);

// By SentenceFault.
constexpr std::array kFaultCounts{"", "no_checksum", "bad_checksum", "bad_field", "implausible_value"};

std::size_t IndexOf(SentenceType type) { return static_cast<std::size_t>(type); }

double WrapHeading(double angle_rad) { return std::isnan(angle_rad) ? kNan : WrapTo2Pi(angle_rad); }
double WrapTilt(double angle_rad) { return std::isnan(angle_rad) ? kNan : WrapToPi(angle_rad); }

// The first of them that is known.
double Or(double value, double otherwise) { return std::isnan(value) ? otherwise : value; }

// A boat at rest has no course: a receiver states the direction of its noise there. Twice velocity_sd_mps of navigator.proto.
constexpr double kRestMps = 0.2;
double CourseOf(double speed_mps, double course_rad) { return speed_mps < kRestMps ? kNan : course_rad; }

// Values of receivers that have no place yet, or have lost it, whatever their status. As precise as a sentence states a place; a boat that is there
// misses a fix.
bool IsNull(const GeodeticPlace& place) {
  constexpr double kMetreDeg = 1e-5;
  return std::abs(place.latitude_deg) < kMetreDeg && std::abs(place.longitude_deg) < kMetreDeg;
}

// A lidar repeats the last sentence of a receiver that has gone: an old one is not used until it changes.
bool IsStale(Utime arrival, const ParseResult& parsed) {
  const auto& sentence = parsed.sentence;
  const bool tells_time = sentence.type == SentenceType::kRmc || sentence.type == SentenceType::kGga;
  return tells_time && sentence.time_of_day && !TimeOfMeasurement(arrival, sentence.time_of_day, sentence.date, kMaxFirstLidarAge).is_from_sentence;
}

void KeepRole(Role role, Reading& reading) {
  const bool uses_all = role == Role::kAll;
  const bool uses_heading = uses_all || role == Role::kHeading || role == Role::kAttitude;
  if (!uses_all && role != Role::kGnss) {
    reading.fix.reset();
    reading.velocity.reset();
  }
  if (!uses_heading) {
    reading.attitude.reset();
    reading.turn_rate.reset();
  }
  if (reading.attitude && role == Role::kHeading) {
    auto& attitude = *reading.attitude;
    attitude.pitch_rad = attitude.roll_rad = attitude.heave_m = attitude.pitch_sd_rad = attitude.roll_sd_rad = kNan;
  }
  if (!uses_all && role != Role::kImu) reading.imu.reset();
}

// Whether a message is newer than the last one. An autopilot may send by two ways, of which one is slower: a message that is older by up to
// kMaxLateMs came before. A message that is older by more comes from an autopilot that began anew.
bool IsNewer(std::uint32_t boot_ms, std::optional<std::uint32_t>& last_boot_ms) {
  constexpr std::uint32_t kMaxLateMs = 5000;
  if (last_boot_ms && *last_boot_ms - boot_ms <= kMaxLateMs) return false;
  last_boot_ms = boot_ms;
  return true;
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
    source.understood_name = name + "_understood";
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
    source.time_zone = {};
    source.standing_utc = {};
    source.null_fix.reset();
    source.declination_rad = kNan;
    source.arrivals = {};
    source.told_by = {};
    source.autopilot_gps.reset();
    source.attitude_boot_ms.reset();
    source.position_boot_ms.reset();
  }
}

// The lidar repeats the last sentence that it has in every position packet, 140 times a second.
bool Interpreter::IsRepeated(const Item& item) {
  if (item.source != kLidarSource) return false;
  if (item.sentence == last_lidar_sentence_) return true;
  last_lidar_sentence_ = item.sentence;
  return false;
}

// The protocol of its source decides: bytes of an autopilot come by its own input alone, whatever stands in a sentence of another.
ParseResult Interpreter::Parse(const Item& item, const Source& source) {
  if (source.params.protocol == Protocol::kMavlink) return ParseMavlinkLine(item.sentence);
  if (item.sentence.find(kMavlinkAddress) == 1) {
    ++counts_["unexpected_mavlink"];
    return {SentenceFault::kBadField, {}};
  }
  return ParseSentence(item.sentence, source.params.requires_checksum);
}

Reading Interpreter::Read(const Item& item) {
  const bool is_first_of_lidar = item.source == kLidarSource && last_lidar_sentence_.empty();
  if (IsRepeated(item)) {
    ++counts_["repeated_sentence"];
    return {};
  }
  auto& source = SourceOf(item.source);
  const auto parsed = Parse(item, source);
  if (is_first_of_lidar && IsStale(item.time, parsed)) {
    ++counts_["stale_lidar_sentence"];
    return {};
  }
  if (parsed.fault != SentenceFault::kNone) {
    ++source.num_refused;
    counts_.Add(kFaultCounts[static_cast<std::size_t>(parsed.fault)]);
    return {};
  }
  if (parsed.sentence.type != SentenceType::kOther) {
    ++source.num_understood;
    ++counts_["understood_sentence"];
    // An input that is only recorded does not correct the clock either.
    if (source.params.role == Role::kNothing) {
      ++counts_["outside_role"];
      return {};
    }
  }
  // Before arrivals are timed: what comes by a second way says nothing of them.
  auto* const boot_ms = parsed.sentence.type == SentenceType::kMavAttitude   ? &source.attitude_boot_ms
                        : parsed.sentence.type == SentenceType::kMavPosition ? &source.position_boot_ms
                                                                             : nullptr;
  if (boot_ms != nullptr && !IsNewer(*parsed.sentence.time_boot_ms, *boot_ms)) {
    ++counts_["repeated_mavlink"];
    return {};
  }
  source.is_in_time = source.arrivals[IndexOf(parsed.sentence.type)].Add(item.time);
  auto reading = ReadUnderstood(item, source, parsed.sentence);
  const bool had_something = !IsEmpty(reading);
  KeepRole(source.params.role, reading);
  if (had_something && IsEmpty(reading)) ++counts_["outside_role"];
  return reading;
}

// Tells the date to the sentences that have none.
void Interpreter::ReadDate(const Item& item, Source& source, const Sentence& zda) {
  if (!zda.date || !zda.time_of_day) return;
  if (source.time_zone.IsLocal(item.time, zda)) {
    ++counts_["local_time"];
    return;
  }
  const auto when = TimeOfMeasurement(item.time - clock_.host_minus_utc(), zda.time_of_day, zda.date, params_.max_sentence_latency);
  if (when.is_date_refused) ++counts_["date_unusable"];
  source.time_zone.Know(item.time, zda);
  clock_.OnDate(source.clock, item.time, when.is_date_refused ? when.time : *zda.date + *zda.time_of_day);
}

Reading Interpreter::ReadUnderstood(const Item& item, Source& source, const Sentence& sentence) {
  switch (sentence.type) {
    case SentenceType::kOther:
      ++counts_["other_sentence"];
      if (sentence.name == "XDR") ++counts_["xdr_not_used"];
      return {};
    case SentenceType::kZda:
      ReadDate(item, source, sentence);
      return {};
    case SentenceType::kGst:
      // A GST of an older epoch counts too: deviations change slowly.
      source.accuracy = Accuracy{item.time, sentence};
      return {};
    case SentenceType::kRmc:
    case SentenceType::kGga:
    case SentenceType::kGns:
    case SentenceType::kGll:
    case SentenceType::kVnIns:
      return ReadFix(item, source, sentence);
    case SentenceType::kVtg:
      return ReadVelocity(item, source, sentence);
    case SentenceType::kRot:
      return ReadTurnRate(item, source, sentence);
    case SentenceType::kMavAttitude:
      return ReadAutopilotAttitude(item, source, sentence);
    case SentenceType::kMavPosition:
      return ReadAutopilotPosition(item, source, sentence);
    case SentenceType::kMavGps:
      source.autopilot_gps = Accuracy{item.time, sentence};
      return {};
    case SentenceType::kXdr:
    case SentenceType::kTntHtm:
    case SentenceType::kHdt:
    case SentenceType::kPashr:
    case SentenceType::kMagnetic:
    case SentenceType::kPsatHpr:
    case SentenceType::kVnYmr:
    case SentenceType::kVnImu:
      return ReadAttitude(item, source, sentence);
  }
  return {};
}

// Time of a sentence without one; nullopt: it waited in a queue for an unknown time. The first behind a timed one of its input was as late as that.
std::optional<MeasurementTime> Interpreter::WhenArrived(const Item& item, Source& source, SentenceType type) {
  if (source.is_in_time) return clock_.OfArrival(source.clock, item.time, source.params.latency);
  auto& told_by = source.told_by[IndexOf(type)];
  if (!UtcClock::IsBehindTimedSentence(source.clock, item.time) || told_by == source.clock.last_utc) {
    ++counts_["queued_sentence"];
    return std::nullopt;
  }
  told_by = source.clock.last_utc;
  return clock_.OfArrival(source.clock, item.time, source.params.latency, microseconds(0));
}

// nullopt: the source's time runs backwards, or is not known.
std::optional<MeasurementTime> Interpreter::When(const Item& item, Source& source, const Sentence& sentence, bool is_measured) {
  if (!sentence.time_of_day) return WhenArrived(item, source, sentence.type);
  if (source.time_zone.IsLocal(item.time, sentence)) {
    ++counts_["local_time"];
    // Behind the fix of its epoch it is of the same instant.
    if (!source.epoch) return WhenArrived(item, source, sentence.type);
    const auto& epoch = source.epoch->fix.when;
    if (item.time - epoch.arrival <= UtcClock::kBurst) return epoch;
    // The sentence tells the place of an epoch that is over: at its arrival it would draw a boat that moves back.
    constexpr std::chrono::seconds kTimedFixes(2);
    if (epoch.has_sentence_utc && item.time - epoch.arrival <= kTimedFixes) return std::nullopt;
    return WhenArrived(item, source, sentence.type);
  }
  source.time_zone.Know(item.time, sentence);
  if (sentence.position && is_measured && source.standing_utc.Stands(item.time, sentence)) {
    ++counts_["standing_utc"];
    return WhenArrived(item, source, sentence.type);
  }
  const auto when = clock_.OfSentence(source.clock, item.time, *sentence.time_of_day, sentence.date, source.params.latency, is_measured);
  if (!when) {
    ++counts_["time_backwards"];
  } else if (when->is_date_refused) {
    ++counts_["date_unusable"];
  }
  return when;
}

// Sentences of one instant of one receiver are one fix: each gets what those before it said.
void Interpreter::CompleteFix(Source& source, GnssFix& fix) {
  if (fix.position && fix.when.has_sentence_utc && !fix.when.is_from_sentence) ++counts_["sentence_time_unusable"];
  const bool is_gga = fix.is_gga();
  const auto is_of_epoch = [&fix](const Epoch& epoch) {
    return epoch.fix.when.utc == fix.when.utc && epoch.fix.when.num_leaps == fix.when.num_leaps;
  };
  if (source.epoch && fix.when.has_sentence_utc && is_of_epoch(*source.epoch)) {
    const auto& known = source.epoch->fix;
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
    source.epoch = Epoch{fix, is_gga};
  }
  if (fix.position && IsMeasured(fix.quality) && fix.when.is_from_sentence) {
    const auto time_scale = clock_.pose_minus_even_utc();
    fix.begins_time_scale = time_scale_ && std::chrono::abs(time_scale - *time_scale_) >= kMinScaleStep;
    time_scale_ = time_scale;
  }
  const auto& accuracy = source.accuracy;
  const bool has_accuracy = accuracy && fix.when.arrival - accuracy->arrival <= kMaxAccuracyAge && IsMeasured(fix.quality);
  if (has_accuracy) {
    fix.horizontal_sd_m = Or(fix.horizontal_sd_m, accuracy->said.horizontal_sd_m);
    fix.vertical_sd_m = Or(fix.vertical_sd_m, accuracy->said.vertical_sd_m);
  }
  fix.horizontal_sd_m = fix.position ? Or(fix.horizontal_sd_m, HorizontalSdM(fix.quality, fix.hdop, params_.position_sd_m)) : kNan;
}

Reading Interpreter::ReadFix(const Item& item, Source& source, const Sentence& said) {
  const bool is_vectornav = said.type == SentenceType::kVnIns;
  Sentence sentence = said;
  const bool is_null = said.position && IsNull(*said.position);
  if (is_null) {
    ++counts_["null_fix"];
    source.null_fix = item.time;
    sentence.position.reset();
    // VectorNav's knows time and attitude before its place.
    if (!is_vectornav) static_cast<FixValues&>(sentence) = {};
  } else if (said.position) {
    source.null_fix.reset();
  }
  const bool is_measured = IsMeasured(sentence.quality);
  // A sentence at 0 N 0 E beside measured ones does not unlearn the clock that they taught.
  const auto when = When(item, source, sentence, is_measured || (is_null && source.clock.has_measured));
  if (!when) return {};
  if (is_measured) source.declination_rad = Or(sentence.declination_rad, source.declination_rad);
  Reading reading;
  auto& fix = reading.fix.emplace(GnssFix{static_cast<const FixValues&>(sentence), *when, item.source, sentence.name});
  if (!is_vectornav) fix.course_rad = CourseOf(fix.speed_mps, fix.course_rad);
  CompleteFix(source, fix);
  if (is_vectornav) reading.attitude = MakeAttitude(item, source, sentence, *when, sentence.heading_rad);
  return reading;
}

Reading Interpreter::ReadVelocity(const Item& item, Source& source, const Sentence& vtg) {
  // Behind the fix of its epoch it is of the same instant; it has no time of its own.
  if (source.null_fix && item.time - *source.null_fix <= kMaxNullAge) return {};  // a receiver without a place has no speed
  const bool is_of_epoch = source.epoch && item.time - source.epoch->fix.when.arrival <= UtcClock::kBurst;
  // RMC of the same instant is the same measurement.
  if (is_of_epoch && !std::isnan(source.epoch->fix.speed_mps)) return {};
  const auto when = is_of_epoch ? std::optional(source.epoch->fix.when) : WhenArrived(item, source, vtg.type);
  if (!when) return {};
  Reading reading;
  reading.velocity = GroundVelocity{when->time, vtg.speed_mps, CourseOf(vtg.speed_mps, vtg.course_rad), item.source};
  return reading;
}

Reading Interpreter::ReadTurnRate(const Item& item, Source& source, const Sentence& rot) {
  Reading reading;
  if (std::isnan(rot.turn_rate_radps)) return reading;
  if (const auto when = WhenArrived(item, source, rot.type)) reading.turn_rate = TurnRate{when->time, rot.turn_rate_radps};
  return reading;
}

Reading Interpreter::ReadAttitude(const Item& item, Source& source, const Sentence& sentence) {
  const bool may_be_empty = sentence.imu || sentence.type == SentenceType::kPashr || sentence.type == SentenceType::kPsatHpr;
  const bool is_empty = std::isnan(sentence.heading_rad) && std::isnan(sentence.pitch_rad) && std::isnan(sentence.roll_rad);
  // A compass that has lost its heading still sends the sentence, empty.
  if (is_empty && !may_be_empty) {
    ++counts_["empty_attitude"];
    return {};
  }
  double heading_rad = sentence.heading_rad;
  if (sentence.type == SentenceType::kMagnetic) {
    const double deviation_rad = Or(sentence.deviation_rad, source.params.deviation_rad.value_or(kNan));
    const double declination_rad = Or(sentence.declination_rad, Or(source.params.declination_rad.value_or(kNan), source.declination_rad));
    if (std::isnan(deviation_rad) || std::isnan(declination_rad)) {
      ++(std::isnan(deviation_rad) ? counts_["no_deviation"] : counts_["no_declination"]);
      return {};
    }
    heading_rad = heading_rad + deviation_rad + declination_rad;
  }
  const auto when = When(item, source, sentence);
  if (!when) return {};
  if (sentence.type == SentenceType::kPashr && sentence.time_of_day && !when->is_from_sentence) ++counts_["sentence_time_unusable"];
  Reading reading;
  if (sentence.type != SentenceType::kVnImu) reading.attitude = MakeAttitude(item, source, sentence, *when, heading_rad);
  if (sentence.imu) reading.imu = InVesselFrame(when->time, *sentence.imu);
  return reading;
}

// nullptr: there is none of now.
const Sentence* Interpreter::AutopilotGps(const Item& item, const Source& source) const {
  const auto& gps = source.autopilot_gps;
  return gps && item.time - gps->arrival <= kMaxAutopilotGpsAge ? &gps->said : nullptr;
}

Reading Interpreter::ReadAutopilotAttitude(const Item& item, Source& source, const Sentence& sentence) {
  const auto when = WhenArrived(item, source, sentence.type);
  if (!when) return {};
  Reading reading;
  auto& attitude = reading.attitude.emplace(MakeAttitude(item, source, sentence, *when, sentence.heading_rad));
  const auto* gps = AutopilotGps(item, source);
  if (gps != nullptr && !std::isnan(gps->heading_sd_rad)) attitude.heading_sd_rad = std::max(gps->heading_sd_rad, kMinAutopilotHeadingSdRad);
  reading.turn_rate = TurnRate{when->time, sentence.turn_rate_radps};
  return reading;
}

Reading Interpreter::ReadAutopilotPosition(const Item& item, Source& source, const Sentence& sentence) {
  if (IsNull(*sentence.position)) {
    ++counts_["null_fix"];
    return {};
  }
  const auto when = WhenArrived(item, source, sentence.type);
  if (!when) return {};
  Reading reading;
  auto& fix = reading.fix.emplace(GnssFix{static_cast<const FixValues&>(sentence), *when, item.source, sentence.name});
  fix.course_rad = CourseOf(fix.speed_mps, fix.course_rad);
  const auto* gps = AutopilotGps(item, source);
  if (gps == nullptr || !IsMeasured(gps->quality)) {
    ++counts_["unmeasured_mavlink"];
    return reading;  // FixQuality::kNone
  }
  fix.quality = gps->quality;
  fix.num_satellites = gps->num_satellites;
  fix.hdop = gps->hdop;
  fix.geoid_separation_m = gps->geoid_separation_m;
  fix.velocity_sd_mps = std::isnan(gps->velocity_sd_mps) ? kNan : std::max(gps->velocity_sd_mps, kMinAutopilotVelocitySdMps);
  // Where the receiver states no accuracy its fix counts as one without correction: how far the estimate follows a better one is not known.
  const double horizontal_sd_m = Or(gps->horizontal_sd_m, HorizontalSdM(FixQuality::kGnss, gps->hdop, params_.position_sd_m));
  fix.horizontal_sd_m = std::max(horizontal_sd_m, kMinAutopilotSdM);
  fix.vertical_sd_m = std::isnan(gps->vertical_sd_m) ? kNan : std::max(gps->vertical_sd_m, kMinAutopilotSdM);
  return reading;
}

Attitude Interpreter::MakeAttitude(const Item& item, const Source& source, const Sentence& sentence, const MeasurementTime& when,
                                   double heading_rad) const {
  Attitude attitude{static_cast<const AttitudeValues&>(sentence), when, item.source, sentence.name};
  attitude.heading_rad = WrapHeading(heading_rad + params_.heading_offset_rad);
  attitude.pitch_rad = WrapTilt(source.params.pitch_sign * sentence.pitch_rad + params_.pitch_offset_rad);
  attitude.roll_rad = WrapTilt(source.params.roll_sign * sentence.roll_rad + params_.roll_offset_rad);
  return attitude;
}

std::vector<Counter> Interpreter::counters() const {
  std::vector<Counter> counters;
  counts_.AppendTo(counters);
  for (const auto& [name, source] : sources_) {
    counters.push_back({source.understood_name, source.num_understood});
    counters.push_back({source.refused_name, source.num_refused});
  }
  return counters;
}

}  // namespace lookout::navigator
