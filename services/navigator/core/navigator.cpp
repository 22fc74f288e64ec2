#include "services/navigator/core/navigator.hpp"

#include <cmath>
#include <variant>

#include "common/core/angles.hpp"

namespace lookout::navigator {

namespace {

// The first sentence that a lidar repeats is of now when its time is so near: clocks of small computers are off by seconds, not by more.
constexpr std::chrono::seconds kMaxFirstLidarAge(10);

using PosePeriods = std::chrono::duration<std::int64_t, std::ratio<1, 50>>;
static_assert(PosePeriods(1) == Navigator::kPosePeriod);

// Least multiple of the pose period that is not before `time`.
Utime CeilToPose(Utime time) { return std::chrono::ceil<PosePeriods>(time); }

double WrapHeading(double angle_rad) { return std::isnan(angle_rad) ? kNan : WrapTo2Pi(angle_rad); }
double WrapTilt(double angle_rad) { return std::isnan(angle_rad) ? kNan : WrapToPi(angle_rad); }

}  // namespace

Navigator::Navigator(const NavigatorParams& params) : params_(params), estimator_(params.pose) {}

NavigatorOutput Navigator::Consume(const Item& item) {
  if (item.kind == ItemKind::kStart) Reset();
  if (!time_) next_pose_ = CeilToPose(item.time);
  if (time_ && item.time - *time_ > kMaxGap) {
    ++counts_.time_jump;
    next_pose_ = CeilToPose(item.time);
  }
  time_ = item.time;
  NavigatorOutput output;
  if (item.kind == ItemKind::kSentence) OnSentence(item, output);
  GivePosesUntil(item.time, output);
  if (item.kind == ItemKind::kEnd && next_pose_ - item.time < kPosePeriod) GivePose(output);
  return output;
}

NavigatorOutput Navigator::Flush() {
  NavigatorOutput output;
  if (time_ && next_pose_ > *time_ && next_pose_ - *time_ < kPosePeriod) GivePose(output);
  return output;
}

std::optional<Pose> Navigator::StateNow() const {
  if (!time_) return std::nullopt;
  return estimator_.At(*time_);
}

// A lidar goes on repeating the last sentence of a receiver that has gone. What is not of now says nothing until it changes.
bool Navigator::IsStale(Utime arrival, const ParseResult& parsed) {
  const auto is_stale = [arrival](const auto& time_of_day, const auto& date) {
    return time_of_day && !TimeOfMeasurement(arrival, time_of_day, date, kMaxFirstLidarAge).is_from_sentence;
  };
  if (const auto* rmc = std::get_if<Rmc>(&parsed.sentence)) return is_stale(rmc->time_of_day, rmc->date);
  if (const auto* gga = std::get_if<Gga>(&parsed.sentence)) return is_stale(gga->time_of_day, std::optional<std::chrono::sys_days>());
  return false;
}

void Navigator::Reset() {
  counts_.unusable_fix += estimator_.antenna().num_unusable();
  counts_.late_fix += estimator_.antenna().num_late();
  estimator_ = PoseEstimator(params_.pose);
  time_.reset();
  last_lidar_sentence_.clear();
}

void Navigator::GivePosesUntil(Utime time, NavigatorOutput& output) {
  while (next_pose_ <= time) GivePose(output);
}

void Navigator::GivePose(NavigatorOutput& output) {
  output.poses.push_back(estimator_.At(next_pose_));
  next_pose_ += kPosePeriod;
}

void Navigator::OnSentence(const Item& item, NavigatorOutput& output) {
  const bool is_first_of_lidar = item.source == kLidarSource && last_lidar_sentence_.empty();
  if (item.source == kLidarSource) {
    // The lidar repeats the last sentence that it has in every position packet, 140 times a second.
    if (item.sentence == last_lidar_sentence_) {
      ++counts_.repeated_sentence;
      return;
    }
    last_lidar_sentence_ = item.sentence;
  }
  const auto result = ParseSentence(item.sentence);
  if (is_first_of_lidar && IsStale(item.time, result)) {
    ++counts_.stale_lidar_sentence;
    return;
  }
  switch (result.fault) {
    case SentenceFault::kNone:
      std::visit([&](const auto& sentence) { OnSentence(item, sentence, output); }, result.sentence);
      break;
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
}

void Navigator::OnSentence(const Item&, const OtherSentence&, NavigatorOutput&) { ++counts_.other_sentence; }

void Navigator::OnSentence(const Item& item, const Rmc& rmc, NavigatorOutput& output) {
  GnssFix fix;
  fix.when = TimeOfMeasurement(item.time, rmc.time_of_day, rmc.date, params_.max_sentence_latency);
  fix.source = item.source;
  fix.sentence_type = "RMC";
  fix.quality = rmc.quality;
  fix.position = rmc.position;
  fix.speed_mps = rmc.speed_mps;
  fix.course_rad = rmc.course_rad;
  TakeFix(fix, output);
}

void Navigator::OnSentence(const Item& item, const Gga& gga, NavigatorOutput& output) {
  GnssFix fix;
  fix.when = TimeOfMeasurement(item.time, gga.time_of_day, std::nullopt, params_.max_sentence_latency);
  fix.source = item.source;
  fix.sentence_type = "GGA";
  fix.quality = gga.quality;
  fix.position = gga.position;
  fix.num_satellites = gga.num_satellites;
  fix.hdop = gga.hdop;
  fix.msl_height_m = gga.msl_height_m;
  fix.geoid_separation_m = gga.geoid_separation_m;
  TakeFix(fix, output);
}

void Navigator::OnSentence(const Item& item, const Vtg& vtg, NavigatorOutput&) {
  ++counts_.understood_sentence;
  estimator_.antenna().Add(GroundVelocity{item.time, vtg.speed_mps, vtg.course_rad});
}

void Navigator::OnSentence(const Item& item, const Hdt& hdt, NavigatorOutput& output) {
  Attitude attitude;
  attitude.when = TimeOfMeasurement(item.time, std::nullopt, std::nullopt, params_.max_sentence_latency);
  attitude.source = item.source;
  attitude.sentence_type = "HDT";
  attitude.heading_rad = WrapHeading(hdt.heading_rad + params_.heading_offset_rad);
  TakeAttitude(attitude, output);
}

void Navigator::OnSentence(const Item& item, const Pashr& pashr, NavigatorOutput& output) {
  Attitude attitude;
  attitude.when = TimeOfMeasurement(item.time, pashr.time_of_day, std::nullopt, params_.max_sentence_latency);
  attitude.source = item.source;
  attitude.sentence_type = "PASHR";
  attitude.heading_rad = WrapHeading(pashr.heading_rad + params_.heading_offset_rad);
  attitude.pitch_rad = WrapTilt(pashr.pitch_rad + params_.pitch_offset_rad);
  attitude.roll_rad = WrapTilt(pashr.roll_rad + params_.roll_offset_rad);
  attitude.heave_m = pashr.heave_m;
  attitude.heading_sd_rad = pashr.heading_sd_rad;
  attitude.pitch_sd_rad = pashr.pitch_sd_rad;
  attitude.roll_sd_rad = pashr.roll_sd_rad;
  if (pashr.time_of_day && !attitude.when.is_from_sentence) ++counts_.sentence_time_unusable;
  TakeAttitude(attitude, output);
}

void Navigator::TakeFix(const GnssFix& fix, NavigatorOutput& output) {
  ++counts_.understood_sentence;
  if (fix.position && !fix.when.is_from_sentence) ++counts_.sentence_time_unusable;
  if (fix.when.is_date_refused) ++counts_.date_unusable;
  output.fix = fix;
  output.fix->horizontal_sd_m = fix.position ? HorizontalSdM(fix.quality, fix.hdop, params_.position_sd_m) : kNan;
  estimator_.antenna().Add(*output.fix);
}

void Navigator::TakeAttitude(const Attitude& attitude, NavigatorOutput& output) {
  ++counts_.understood_sentence;
  output.attitude = attitude;
  if (!estimator_.attitude().Add(attitude)) ++counts_.late_attitude;
}

std::vector<Counter> Navigator::counters() const {
  return {{"understood_sentence", counts_.understood_sentence},
          {"other_sentence", counts_.other_sentence},
          {"repeated_sentence", counts_.repeated_sentence},
          {"no_checksum", counts_.no_checksum},
          {"bad_checksum", counts_.bad_checksum},
          {"bad_field", counts_.bad_field},
          {"implausible_value", counts_.implausible_value},
          {"sentence_time_unusable", counts_.sentence_time_unusable},
          {"date_unusable", counts_.date_unusable},
          {"stale_lidar_sentence", counts_.stale_lidar_sentence},
          {"unusable_fix", counts_.unusable_fix + estimator_.antenna().num_unusable()},
          {"late_fix", counts_.late_fix + estimator_.antenna().num_late()},
          {"late_attitude", counts_.late_attitude},
          {"time_jump", counts_.time_jump}};
}

}  // namespace lookout::navigator
