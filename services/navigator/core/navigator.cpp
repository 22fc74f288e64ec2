#include "services/navigator/core/navigator.hpp"

namespace lookout::navigator {

namespace {

using PosePeriods = std::chrono::duration<std::int64_t, std::ratio<1, 50>>;
static_assert(PosePeriods(1) == Navigator::kPosePeriod);

// Least multiple of the pose period that is not before `time`.
Utime CeilToPose(Utime time) { return std::chrono::ceil<PosePeriods>(time); }

bool IsOfLidarImu(const Item& item) { return item.source == kLidarSource && item.sentence.starts_with("$VNIMU"); }

}  // namespace

Navigator::Navigator(const NavigatorParams& params) : params_(params), interpreter_(params), filter_(params.filter) {}

NavigatorOutput Navigator::Consume(const Item& item) {
  if (item.kind == ItemKind::kStart) Reset();
  if (!time_) relative_.Begin(item.time);
  if (!time_) next_pose_ = CeilToPose(item.time);
  if (time_ && item.time - *time_ > kMaxGap) {
    ++num_time_jumps_;
    relative_.Skip(item.time - *time_);
    next_pose_ = CeilToPose(item.time);
  }
  time_ = item.time;
  NavigatorOutput output;
  if (item.kind == ItemKind::kSentence && item.source == kOdometerSource) {
    if (params_.use_lidar_odometry) OnOdometry(item);
  } else if (item.kind == ItemKind::kSentence && (params_.use_lidar_imu || !IsOfLidarImu(item))) {
    OnSentence(item, output);
  }
  if (item.imu) filter_.Add(InVesselFrame(item.time, *item.imu));
  if (item.kind == ItemKind::kTick) filter_.AdvanceTo(item.time);
  while (next_pose_ <= item.time) AppendPose(output);
  if (item.kind == ItemKind::kEnd && next_pose_ - item.time < kPosePeriod) AppendPose(output);
  return output;
}

NavigatorOutput Navigator::Flush() {
  NavigatorOutput output;
  if (time_ && next_pose_ > *time_ && next_pose_ - *time_ < kPosePeriod) AppendPose(output);
  return output;
}

void Navigator::Reset() {
  filter_.Reset();
  interpreter_.Reset();
  last_pose_.reset();
  last_motion_.reset();
  last_motion_ahead_.reset();
  time_.reset();
}

void Navigator::AppendPose(NavigatorOutput& output) {
  last_pose_ = filter_.At(next_pose_);
  if (params_.use_lidar_odometry) last_pose_ = relative_.At(*last_pose_, params_.filter.unmeasured_tilt_sd_rad);
  output.poses.push_back(*last_pose_);
  next_pose_ += kPosePeriod;
}

void Navigator::OnOdometry(const Item& item) {
  const auto motion = ParseOdometry(item.sentence);
  if (!motion) {
    ++num_bad_motions_;
    return;
  }
  ++num_motions_;
  last_motion_ = item.time;
  relative_.NoteMotion();
  if (motion->end > item.time + kMaxAhead) {
    ++num_motions_ahead_;
    last_motion_ahead_ = item.time;
    return;
  }
  filter_.Add(*motion);
  if (relative_.Wants(item.time)) relative_.Add(*motion);
}

void Navigator::OnSentence(const Item& item, NavigatorOutput& output) {
  relative_.NoteSentence();
  const auto reading = interpreter_.Read(item);
  if (reading.fix) filter_.Add(*reading.fix);
  if (reading.velocity) filter_.Add(*reading.velocity);
  if (reading.attitude) filter_.Add(*reading.attitude);
  if (reading.imu) filter_.Add(*reading.imu);
  output.fix = reading.fix;
  output.attitude = reading.attitude;
}

bool Navigator::IsRecent(const std::optional<Utime>& came) const { return came && *time_ - *came <= std::chrono::seconds(2); }

std::vector<Counter> Navigator::counters() const {
  auto counters = interpreter_.counters();
  filter_.counts().AppendTo(counters);
  counters.push_back({"time_jump", num_time_jumps_});
  counters.push_back({"odometry_used", num_motions_});
  counters.push_back({"odometry_bad", num_bad_motions_});
  counters.push_back({"odometry_ahead", num_motions_ahead_});
  counters.push_back({"relative_frames", relative_.num_frames()});
  return counters;
}

}  // namespace lookout::navigator
