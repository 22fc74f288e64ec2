#include "common/core/cover_watch.hpp"

#include <algorithm>
#include <utility>

#include "common/core/elementary.hpp"
#include "common/core/frames.hpp"

namespace lookout {

namespace {

constexpr double kLongestStepS = 0.5;  // while no scan came nobody knows what it would have shown
constexpr double kCoverTimeS = 2.0;
constexpr double kLastsShare = 0.75;
constexpr double kIsOverShare = 0.4;
// The hull and what is fixed to it are seen in each scan; a crew moves, spray comes and goes. The share starts at 0, so it takes 23 s.
constexpr double kOwnTimeS = 10.0;
constexpr double kOwnShare = 0.9;
constexpr int kLeastOwn = 2;
// A single return may be a stray one.
constexpr int kMostStrays = 1;
// Covered sectors with so many between in which nothing is seen are one.
constexpr std::size_t kMostBetween = 6;
// And of a scan, of so many shots each.
constexpr std::int64_t kShotsOfAStray = 1000;
// What was seen is not there any more after so long unseen: as long as a track stays.
constexpr double kStaysS = 30.0;
constexpr double kToldForS = 10.0;
// A sector at which the lidar has not fired for so long is none; the packets of one may be lost.
constexpr double kUnfiredS = 2.0;
constexpr double kMostSkippedS = 5.0;

}  // namespace

bool Darkness::Add(std::int64_t num_returns, std::int64_t most_strays) {
  const bool is_empty = num_returns <= most_strays;
  if (!is_dark_) is_dark_ = is_empty && std::ranges::all_of(last_, [](std::int64_t returns) { return returns >= kMuch; });
  std::shift_right(last_.begin(), last_.end(), 1);
  last_.front() = num_returns;
  if (is_dark_) is_dark_ = std::ranges::any_of(last_, [most_strays](std::int64_t returns) { return returns <= most_strays; });
  return is_dark_;
}

CoverWatch::CoverWatch(const CoverParams& params) : params_(params), own_vessel_(params.own_vessel_box_m, params.T_vessel_lidar) {}

bool CoverWatch::IsOwn(double azimuth_rad, double elevation_rad, double range_m) const {
  if (range_m < params_.min_range_m) return true;
  return own_vessel_.ReachesTo(range_m) && own_vessel_.Contains(range_m * BeamDirection(azimuth_rad, elevation_rad));
}

void CoverWatch::AddColumn(double azimuth_rad, std::span<const float> azimuth_offset_rad, std::span<const float> elevation_rad,
                           std::span<const float> range_m) {
  for (std::size_t ring = 0; ring < range_m.size(); ++ring) {
    const double beam_rad = azimuth_rad + static_cast<double>(azimuth_offset_rad[ring]);
    auto& sector = now_[IndexOf(beam_rad)];
    ++sector.num_shots;
    const auto range = static_cast<double>(range_m[ring]);
    if (range <= 0.0) continue;
    ++sector.num_returns;
    if (!IsOwn(beam_rad, static_cast<double>(elevation_rad[ring]), range)) continue;
    ++sector.num_own;
    if (range < kNearM) ++sector.num_near;
  }
}

void CoverWatch::End(Utime time) {
  const double step_s = newest_ ? std::clamp(ToSeconds(time - *newest_), 0.0, kLongestStepS) : 0.0;
  newest_ = time;
  std::int64_t num_shots = 0;
  std::int64_t num_returns = 0;
  for (const auto& sector : now_) {
    num_shots += sector.num_shots;
    num_returns += sector.num_returns;
  }
  const bool is_dark = darkness_.Add(num_returns, std::max<std::int64_t>(kMostStrays, num_shots / kShotsOfAStray));
  FindCovers(is_dark, step_s);
  KeepWide();
  Learn(step_s);
  Tell(step_s);
  WatchForNothing(num_returns <= kMostStrays && !is_dark, step_s);
}

void CoverWatch::Skip(Utime time) {
  covers_any_ = covers_anew_ = false;
  for (auto& state : sectors_) state.cover = Cover::kNo;
  if (!newest_ || ToSeconds(time - *newest_) < kMostSkippedS) return;
  for (auto& state : sectors_) {
    state.lasting = Cover::kNo;
    state.cover_share = 0.0;
  }
  nothing_s_ = 0.0;
  sees_nothing_ = false;
  Tell(0.0);
}

void CoverWatch::FindCovers(bool is_dark, double step_s) {
  for (std::size_t i = 0; i < kNumSectors; ++i) {
    auto& state = sectors_[i];
    const auto& seen = now_[i];
    const bool is_fired = seen.num_shots > 0;
    const bool is_taken = params_.field_of_view.Contains((static_cast<double>(i) + 0.5) * kTwoPi / kNumSectors);
    state.unfired_s = is_fired ? 0.0 : state.unfired_s + step_s;
    state.is_looked_at = is_taken && (is_fired || (state.is_looked_at && state.unfired_s < kUnfiredS));
    state.cover = Cover::kNo;
    if (!is_taken || !is_fired) continue;
    if (is_dark) {
      state.cover = Cover::kDark;
    } else if (2 * seen.num_near >= seen.num_shots) {
      state.cover = Cover::kNear;
    } else if (seen.num_returns <= kMostStrays && state.own_share >= kOwnShare) {
      state.cover = Cover::kOwnGone;
    }
  }
}

// Bridges sectors in which nothing is seen behind as many covered ones, and leaves out what is narrow.
void CoverWatch::KeepWide() {
  const auto covers = [this](std::size_t i) { return sectors_[i % kNumSectors].cover != Cover::kNo; };
  const auto is_silent = [this](std::size_t i) {
    const auto& seen = now_[i % kNumSectors];
    return seen.num_shots > 0 && seen.num_returns <= kMostStrays;
  };
  std::array<Cover, kNumSectors> bridged{};
  for (std::size_t i = 0; i < kNumSectors; ++i) {
    if (!covers(i)) continue;
    std::size_t before = 1;
    while (before < kMostBetween && covers(i + kNumSectors - before)) ++before;
    std::size_t next = i + 1;
    while (next - i <= before && !covers(next) && is_silent(next)) ++next;
    if (!covers(next)) next = i + 1;
    for (std::size_t k = i; k < next; ++k) bridged[k % kNumSectors] = sectors_[i].cover;
  }
  const auto is_none = [&bridged](std::size_t i) { return bridged[i % kNumSectors] == Cover::kNo; };
  for (std::size_t i = 0; i < kNumSectors; ++i) {
    std::size_t before = 0;
    std::size_t behind = 0;
    while (before < kLeastSectors && !is_none(i + kNumSectors - before)) ++before;
    while (behind < kLeastSectors && !is_none(i + behind)) ++behind;
    sectors_[i].cover = before + behind > kLeastSectors ? bridged[i] : Cover::kNo;
  }
}

void CoverWatch::Learn(double step_s) {
  covers_any_ = covers_anew_ = false;
  for (std::size_t i = 0; i < kNumSectors; ++i) {
    auto& state = sectors_[i];
    const auto& seen = now_[i];
    if (!state.is_looked_at) state.cover_share = 0.0;
    if (state.cover_share == 0.0) state.lasting = Cover::kNo;
    if (seen.num_shots == 0) continue;
    const bool is_covered = state.cover != Cover::kNo;
    covers_any_ |= is_covered;
    covers_anew_ |= is_covered && state.has_looked;
    state.covered_s = is_covered ? state.covered_s + step_s : 0.0;
    state.has_looked = !is_covered || (state.has_looked && state.covered_s < kStaysS);
    state.cover_share += step_s / kCoverTimeS * ((is_covered ? 1.0 : 0.0) - state.cover_share);
    // Where nothing is seen the own boat is not forgotten: a cover may be drawn over the lidar slowly, and stay.
    if (is_covered || seen.num_returns <= kMostStrays) {
      if (state.own_share < kOwnShare) state.own_share -= step_s / kOwnTimeS * state.own_share;
    } else {
      state.own_share += step_s / kOwnTimeS * ((seen.num_own >= kLeastOwn ? 1.0 : 0.0) - state.own_share);
    }
    if (state.cover_share < kIsOverShare) {
      state.lasting = Cover::kNo;
    } else if (is_covered && (state.cover_share > kLastsShare || state.lasting != Cover::kNo)) {
      state.lasting = state.cover;
    }
  }
}

void CoverWatch::Tell(double step_s) {
  const auto lasts = [](const State& state) { return state.lasting != Cover::kNo; };
  const auto num_new = std::ranges::count_if(sectors_, [&](const State& state) { return lasts(state) && !state.was_told; });
  num_lasting_ = std::ranges::count_if(sectors_, lasts);
  is_all_round_ = num_lasting_ > 0 && std::ranges::all_of(sectors_, [&](const State& state) { return lasts(state) || !state.is_looked_at; });
  const bool is_new = std::cmp_greater_equal(num_new, kLeastSectors);
  if (is_new) ++num_told_;
  for (auto& state : sectors_) {
    state.free_s = lasts(state) ? 0.0 : state.free_s + step_s;
    state.was_told = (lasts(state) && is_new) || (state.was_told && state.free_s < kToldForS);
  }
}

std::vector<CoveredPart> CoverWatch::parts() const {
  const auto bearing_of = [this](std::size_t edge) {
    const Eigen::Vector3d direction = params_.T_vessel_lidar.linear() * BeamDirection(static_cast<double>(edge) * kTwoPi / kNumSectors, 0.0);
    return WrapTo2Pi(Atan2(-direction.y(), direction.x()));
  };
  const bool is_upright = params_.T_vessel_lidar.linear()(2, 2) > 0.0;
  const auto why_at = [this](std::size_t i) { return sectors_[i % kNumSectors].lasting; };
  std::vector<CoveredPart> parts;
  for (std::size_t i = 0; i < kNumSectors; ++i) {
    if (why_at(i) == Cover::kNo) continue;
    const bool is_first = why_at(i + kNumSectors - 1) != why_at(i);
    if (!is_first && !(i == 0 && std::ranges::all_of(sectors_, [&](const State& state) { return state.lasting == why_at(0); }))) continue;
    std::size_t count = 1;
    while (count < kNumSectors && why_at(i + count) == why_at(i)) ++count;
    const double width_rad = static_cast<double>(count) * kTwoPi / kNumSectors;
    parts.push_back({why_at(i), {count == kNumSectors ? 0.0 : bearing_of(is_upright ? i : i + count), width_rad}});
  }
  return parts;
}

void CoverWatch::WatchForNothing(bool is_nothing, double step_s) {
  if (is_nothing) {
    nothing_s_ = std::min(kNothingS, nothing_s_ + step_s);
  } else {
    nothing_s_ = sees_nothing_ ? nothing_s_ - step_s * kNothingS / kSomethingS : 0.0;
  }
  if (nothing_s_ >= kNothingS) sees_nothing_ = true;
  if (nothing_s_ <= 0.0) sees_nothing_ = false;
}

}  // namespace lookout
