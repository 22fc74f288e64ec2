#include "services/navigator/core/item_sequencer.hpp"

#include <algorithm>

namespace lookout::navigator {

namespace {

using TickPeriods = std::chrono::duration<std::int64_t, std::deci>;

// Greatest multiple of the tick period that is not after `time`.
Utime FloorToTick(Utime time) { return std::chrono::floor<TickPeriods>(time); }

}  // namespace

static_assert(TickPeriods(1) == ItemSequencer::kTickPeriod);

Item ItemSequencer::Make(Utime time, ItemKind kind, const std::string& source, const std::string& sentence) {
  last_ = last_ ? std::max(*last_, time) : time;
  return {*last_, next_seq_++, kind, source, sentence};
}

Item ItemSequencer::Start(Utime time) {
  last_.reset();
  next_seq_ = 0;
  last_host_time_ = time;
  next_tick_ = FloorToTick(time) + kTickPeriod;
  return Make(time, ItemKind::kStart);
}

std::vector<Item> ItemSequencer::AdvanceTo(Utime host_time) {
  has_host_clock_ = true;
  return Advance(host_time);
}

std::vector<Item> ItemSequencer::Advance(Utime host_time) {
  if (!last_) return {Start(host_time)};
  if (host_time < last_host_time_ - kMaxSetBack || host_time < *last_ - kMaxStepBack) {
    ++num_clock_set_back_;
    return {Start(host_time)};
  }
  last_host_time_ = std::max(last_host_time_, host_time);
  if (host_time - next_tick_ > kMaxTickGap) next_tick_ = FloorToTick(host_time);
  std::vector<Item> items;
  for (; next_tick_ <= host_time; next_tick_ += kTickPeriod) items.push_back(Make(next_tick_, ItemKind::kTick));
  return items;
}

std::vector<Item> ItemSequencer::OnLines(Utime arrival, const std::vector<std::string>& lines, const std::string& source) {
  std::vector<Item> items;
  if (!last_ || arrival > *last_) items = AdvanceTo(arrival);
  if (arrival < *last_ - kMaxStepBack) {
    num_stale_sentences_ += static_cast<std::int64_t>(lines.size());
    return items;
  }
  for (const auto& line : lines) items.push_back(Make(arrival, ItemKind::kSentence, source, line));
  return items;
}

std::vector<Item> ItemSequencer::OnImu(Utime arrival, const StrapdownSample& sample, const std::string& source) {
  std::vector<Item> items;
  if (!last_ || arrival > *last_) items = AdvanceTo(arrival);
  if (arrival < *last_ - kMaxStepBack) {
    ++num_stale_sentences_;
    return items;
  }
  items.push_back(Make(arrival, ItemKind::kImu, source));
  items.back().imu = sample;
  return items;
}

std::vector<Item> ItemSequencer::OnLidarSentence(Utime arrival, const std::string& sentence) {
  std::vector<Item> items;
  if (!last_) items.push_back(Start(arrival));
  if (arrival < *last_ - kMaxStepBack || arrival > *last_ + kMaxStepBack) {
    ++num_stale_sentences_;
    return items;
  }
  items.push_back(Make(arrival, ItemKind::kSentence, kLidarSource, sentence));
  return items;
}

std::vector<Item> ItemSequencer::OnOdometry(Utime end, const std::string& sentence) {
  std::vector<Item> items;
  if (!has_host_clock_) items = Advance(end);
  if (!last_) return {};  // behind the end mark
  items.push_back(Make(last_host_time_, ItemKind::kSentence, kOdometerSource, sentence));
  return items;
}

std::vector<Item> ItemSequencer::Finish(Utime host_time) {
  if (!last_) return {};
  std::vector<Item> items;
  if (host_time > *last_) items = AdvanceTo(host_time);
  items.push_back(Make(host_time, ItemKind::kEnd));
  last_.reset();
  return items;
}

}  // namespace lookout::navigator
