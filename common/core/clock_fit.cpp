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
// Long enough that some datagram came without delay, short enough to follow a host's clock that is being slewed (500 ppm) within 1 ms.
constexpr microseconds kOffsetWindow = std::chrono::seconds(2);
// Datagrams come late by milliseconds. What is off by more is a bad stamp, or, when it goes on, a step of the host's clock.
constexpr microseconds kMaxLateness = std::chrono::seconds(1);
constexpr int kSamplesOfAStep = 3;
// Minima of a second hardly differ. Two seconds in a row that are off by so much are a smaller step of the host's clock.
constexpr microseconds kMaxStep = std::chrono::milliseconds(5);

double ToDouble(microseconds duration) { return static_cast<double>(duration.count()); }

}  // namespace

void ClockFit::Add(microseconds time, microseconds host_minus_sensor) {
  if (!bins_.empty()) {
    now_ = time;
    const bool is_off = std::chrono::abs(host_minus_sensor - offset()) > kMaxLateness;
    num_off_ = is_off ? num_off_ + 1 : 0;
    if (is_off && num_off_ < kSamplesOfAStep) return;
    if (is_off) {
      bins_.clear();
      num_off_ = 0;
    }
  }
  now_ = time;
  if (bins_.empty() || time >= bins_.back().end) {
    Measure();
    bins_.push_back({time + kBin, time, host_minus_sensor});
    if (bins_.size() > kMaxBins) bins_.pop_front();
  } else if (host_minus_sensor < bins_.back().least) {
    bins_.back().time = time;
    bins_.back().least = host_minus_sensor;
  }
}

microseconds ClockFit::offset() const {
  const auto at_now = [this](const Bin& bin) { return bin.least + microseconds(std::llround(slope_.value_or(0.0) * ToDouble(now_ - bin.time))); };
  microseconds least = at_now(bins_.back());
  for (auto bin = bins_.rbegin(); bin != bins_.rend() && bin->end > now_ - kOffsetWindow; ++bin) least = std::min(least, at_now(*bin));
  return least;
}

std::optional<double> ClockFit::drift_ppm() const {
  if (!slope_) return std::nullopt;
  return -1e6 * *slope_;
}

// The last bin is full.
void ClockFit::Measure() {
  const auto num_bins = bins_.size();
  if (num_bins >= 3) {
    const auto expected = [&](const Bin& bin) {
      const Bin& old = bins_[num_bins - 3];
      return old.least + microseconds(std::llround(slope_.value_or(0.0) * ToDouble(bin.time - old.time)));
    };
    const auto first_step = bins_[num_bins - 2].least - expected(bins_[num_bins - 2]);
    const auto second_step = bins_[num_bins - 1].least - expected(bins_[num_bins - 1]);
    const bool is_step =
        std::chrono::abs(first_step) > kMaxStep && std::chrono::abs(second_step) > kMaxStep && std::chrono::abs(second_step - first_step) <= kMaxStep;
    if (is_step) bins_.erase(bins_.begin(), bins_.end() - 2);  // the drift is of the crystals: it stays
  }
  if (bins_.size() < kMinBinsOfSlope) return;
  std::vector<double> slopes;
  slopes.reserve(bins_.size() * (bins_.size() - 1) / 2);
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    for (std::size_t j = i + 1; j < bins_.size(); ++j) {
      slopes.push_back(ToDouble(bins_[j].least - bins_[i].least) / ToDouble(bins_[j].time - bins_[i].time));
    }
  }
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  slope_ = *middle;
}

}  // namespace lookout
