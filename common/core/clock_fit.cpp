#include "common/core/clock_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace lookout {

namespace {

using std::chrono::microseconds;

constexpr microseconds kBin = std::chrono::seconds(1);
// A minute of minima, each good to some 20 us, tells a drift to below 1 ppm.
constexpr std::size_t kMaxBins = 60;
constexpr std::size_t kMinBinsOfSlope = 10;
// Long enough that some message came without delay, short enough to follow a host's clock that is being slewed (500 ppm) within 1 ms.
constexpr microseconds kOffsetWindow = std::chrono::seconds(2);
// A message that comes so much too early may have a bad stamp, but not a row of them.
constexpr microseconds kMaxEarly = std::chrono::seconds(1);
constexpr int kSamplesOfAStep = 3;
// Minima of a second hardly differ. A message that is off by more is late, or the host's clock was stepped.
constexpr microseconds kMaxJitter = std::chrono::milliseconds(5);
// The host's clock was set forward when so long nothing comes in time. A source that sends once a second is believed within five.
constexpr microseconds kStepWindow = std::chrono::seconds(3);
constexpr microseconds kLateBin = std::chrono::milliseconds(100);
constexpr std::size_t kMaxLateBins = 100;
constexpr int kMinLateInHalf = 2;
// Spread of arrivals at random times of a busy computer, from one to the next.
constexpr microseconds kMaxGrowth = std::chrono::milliseconds(500);
constexpr int kMinSamples = 5;
// A queue that drains more slowly than by 3 % of time passes for a step.
constexpr microseconds kMaxShrinking = std::chrono::milliseconds(50);
// Messages overtake each other by less, and leap seconds are shorter.
constexpr microseconds kMaxBackward = std::chrono::seconds(2);

double ToDouble(microseconds duration) { return static_cast<double>(duration.count()); }

microseconds DriftIn(microseconds duration) { return microseconds(std::llround(ClockFit::kMaxDriftPpm * 1e-6 * std::abs(ToDouble(duration)))); }

}  // namespace

microseconds ClockFit::Carried(const Sample& sample, microseconds time) const {
  return sample.host_minus_time + microseconds(std::llround(slope_.value_or(0.0) * ToDouble(time - sample.time)));
}

void ClockFit::Add(microseconds time, microseconds host_minus_time) {
  const Sample sample{time, host_minus_time};
  if (bins_.empty() || time < now_ - kMaxBackward) {
    Begin(sample);
    return;
  }
  if (time <= now_) return;
  now_ = time;
  if (num_samples_ < kMinSamples) ++num_samples_;
  const microseconds late = host_minus_time - offset();
  const microseconds jitter = kMaxJitter + DriftIn(time - last_.time);
  if (late < -kMaxEarly && ++num_early_ < kSamplesOfAStep) return;
  if (late < -jitter) {
    // Of a source whose delays differ by more than jitter: the clocks are as sure as before.
    const bool is_still_settled = is_settled_ && late >= -kMaxEarly;
    Begin(sample);
    is_settled_ = is_still_settled;
  } else if (late > jitter) {
    num_early_ = 0;
    OnLate(sample);
  } else {
    OnTimely(sample);
  }
}

// All that was known of the offset is void. The drift is of the crystals: it stays.
void ClockFit::Begin(const Sample& sample) {
  bins_.clear();
  num_samples_ = 1;
  is_settled_ = false;
  first_ = sample;
  now_ = sample.time;
  OnTimely(sample);
}

void ClockFit::OnTimely(const Sample& sample) {
  num_early_ = 0;
  late_.clear();
  last_ = sample;
  const bool is_long = sample.time - first_.time >= kStepWindow && sample.host() - first_.host() >= kStepWindow;
  is_settled_ = is_settled_ || (num_samples_ >= kMinSamples && is_long);
  if (bins_.empty() || sample.time >= bins_.back().end) {
    Measure();
    bins_.push_back({sample.time + kBin, sample});
    if (bins_.size() > kMaxBins) bins_.pop_front();
  } else if (sample.host_minus_time < bins_.back().least.host_minus_time) {
    bins_.back().least = sample;
  }
}

void ClockFit::OnLate(const Sample& sample) {
  // Later than the message before it: it waited in a stall of its own.
  if (!late_.empty() && sample.host_minus_time > last_late_ + kMaxGrowth) late_.clear();
  last_late_ = sample.host_minus_time;
  if (late_.empty() || sample.host() - late_.back().host >= kLateBin) {
    if (late_.size() == kMaxLateBins) late_.pop_front();
    late_.push_back({sample.host(), sample});
  } else if (sample.host_minus_time < late_.back().least.host_minus_time) {
    late_.back().least = sample;
  }
  const auto is_long = [&](const Late& late) { return sample.time - late.least.time >= kStepWindow && sample.host() - late.host >= kStepWindow; };
  if (!is_long(late_.front())) return;
  while (is_long(late_[1])) late_.pop_front();
  const microseconds middle = late_.front().host + (sample.host() - late_.front().host) / 2;
  const auto second_half = std::ranges::find_if(late_, [&](const Late& late) { return late.host >= middle; });
  if (second_half - late_.begin() < kMinLateInHalf || late_.end() - second_half < kMinLateInHalf) return;
  const auto least = [](auto begin, auto end) {
    return std::min_element(begin, end, [](const Late& a, const Late& b) { return a.least.host_minus_time < b.least.host_minus_time; })->least;
  };
  const Sample now = least(second_half, late_.end());
  if (now.host_minus_time < Carried(least(late_.begin(), second_half), now.time) - kMaxShrinking) return;
  Begin(now);
  now_ = sample.time;
  is_settled_ = true;
}

microseconds ClockFit::offset() const {
  microseconds least = Carried(bins_.back().least, now_);
  // The first that are timely after a stall may be the last of its queue.
  if (bins_.size() > 1) least = std::min(least, Carried(bins_[bins_.size() - 2].least, now_));
  for (auto bin = bins_.rbegin(); bin != bins_.rend() && bin->end > now_ - kOffsetWindow; ++bin) least = std::min(least, Carried(bin->least, now_));
  return least;
}

std::optional<double> ClockFit::drift_ppm() const {
  if (!slope_) return std::nullopt;
  return std::clamp(-1e6 * *slope_, -kMaxDriftPpm, kMaxDriftPpm);
}

// The last bin is full.
void ClockFit::Measure() {
  // The seconds before it were late ones, each by too little to tell.
  for (auto i = bins_.size(); i-- > 1;) {
    const Sample& old = bins_[i - 1].least;
    const Sample& last = bins_.back().least;
    if (last.host_minus_time >= old.host_minus_time - kMaxJitter - DriftIn(last.time - old.time)) continue;
    bins_.erase(bins_.begin(), bins_.begin() + static_cast<std::ptrdiff_t>(i));
    break;
  }
  if (bins_.size() < kMinBinsOfSlope) return;
  std::vector<double> slopes;
  slopes.reserve(bins_.size() * (bins_.size() - 1) / 2);
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    for (std::size_t j = i + 1; j < bins_.size(); ++j) {
      const Sample& from = bins_[i].least;
      const Sample& to = bins_[j].least;
      slopes.push_back(ToDouble(to.host_minus_time - from.host_minus_time) / ToDouble(to.time - from.time));
    }
  }
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  slope_ = std::clamp(*middle, -1e-6 * kMaxDriftPpm, 1e-6 * kMaxDriftPpm);
}

}  // namespace lookout
