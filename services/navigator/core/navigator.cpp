#include "services/navigator/core/navigator.hpp"

namespace lookout::navigator {

namespace {

using PosePeriods = std::chrono::duration<std::int64_t, std::ratio<1, 50>>;
static_assert(PosePeriods(1) == Navigator::kPosePeriod);

// Least multiple of the pose period that is not before `time`.
Utime CeilToPose(Utime time) { return std::chrono::ceil<PosePeriods>(time); }

}  // namespace

Navigator::Navigator(const NavigatorParams& params) : params_(params), interpreter_(params), estimator_(params.pose) {}

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

void Navigator::Reset() {
  counts_.unusable_fix += estimator_.antenna().num_unusable();
  counts_.late_fix += estimator_.antenna().num_late();
  estimator_ = PoseEstimator(params_.pose);
  interpreter_.Reset();
  time_.reset();
}

void Navigator::GivePosesUntil(Utime time, NavigatorOutput& output) {
  while (next_pose_ <= time) GivePose(output);
}

void Navigator::GivePose(NavigatorOutput& output) {
  output.poses.push_back(estimator_.At(next_pose_));
  next_pose_ += kPosePeriod;
}

void Navigator::OnSentence(const Item& item, NavigatorOutput& output) {
  const auto reading = interpreter_.Read(item);
  if (reading.fix) TakeFix(*reading.fix, output);
  if (reading.velocity) estimator_.antenna().Add(*reading.velocity);
  if (reading.attitude) TakeAttitude(*reading.attitude, output);
}

void Navigator::TakeFix(const GnssFix& fix, NavigatorOutput& output) {
  output.fix = fix;
  estimator_.antenna().Add(fix);
}

void Navigator::TakeAttitude(const Attitude& attitude, NavigatorOutput& output) {
  output.attitude = attitude;
  if (!estimator_.attitude().Add(attitude)) ++counts_.late_attitude;
}

std::vector<Counter> Navigator::counters() const {
  auto counters = interpreter_.counters();
  counters.push_back({"unusable_fix", counts_.unusable_fix + estimator_.antenna().num_unusable()});
  counters.push_back({"late_fix", counts_.late_fix + estimator_.antenna().num_late()});
  counters.push_back({"late_attitude", counts_.late_attitude});
  counters.push_back({"time_jump", counts_.time_jump});
  return counters;
}

}  // namespace lookout::navigator
