// How the own position bears on what it places.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "services/tracker/core/step.hpp"

namespace lookout::tracker {

// The own position may become much better known within a scan: what was placed before that is left out.
void Step::LeaveOutdated() {
  constexpr double kTimes = 4.0;
  constexpr double kLeastM2 = 0.3 * 0.3;
  const auto own_m2 = [](const Seen& seen) { return (seen.covariance_m2 - seen.covariance_relative_m2).trace(); };
  if (scan_.seen.empty()) return;
  const double least_m2 = own_m2(*std::ranges::min_element(scan_.seen, {}, own_m2));
  for (std::size_t i = 0; i < scan_.seen.size(); ++i) {
    if (own_m2(scan_.seen[i]) > kTimes * least_m2 + kLeastM2) use_[i] = Use::kLeftOut;
  }
}

// The own position became much better known: all that was placed by the old one moves, to where most of it is seen now.
void Step::Settle() {
  constexpr double kSds = 3.0;
  constexpr double kSameM = 0.5;
  constexpr double kLooseM = 0.2;
  constexpr std::size_t kMost = 40;  // tracks, and segments: their square pairs are tried
  const double sd_m = std::exchange(known_.settled_sd_m, 0.0);
  if (sd_m == 0.0) return;
  std::vector<Eigen::Vector2d> from_m;
  std::vector<Eigen::Vector2d> to_m;
  for (const auto& track : known_.tracks) {
    if (track.body && from_m.size() < kMost) from_m.push_back(track.seen_m);
  }
  for (std::size_t i = 0; i < scan_.seen.size() && to_m.size() < kMost; ++i) {
    if (use_[i] == Use::kFree && scan_.seen[i].is_sure && !scan_.seen[i].is_land) to_m.push_back(middle_m_[i]);
  }
  // Of those that the shift brings to what is seen: how many, and where they come to lie in the mean.
  const auto brought_by = [&](const Eigen::Vector2d& shift_m) {
    std::pair<int, Eigen::Vector2d> brought(0, Eigen::Vector2d::Zero());
    for (const auto& from : from_m) {
      const auto nearest = std::ranges::min_element(to_m, {}, [&](const auto& to) { return (to - from - shift_m).squaredNorm(); });
      if (nearest == to_m.end() || (*nearest - from - shift_m).norm() > kSameM) continue;
      ++brought.first;
      brought.second += *nearest - from;
    }
    if (brought.first > 0) brought.second /= brought.first;
    return brought;
  };
  auto best = brought_by(Eigen::Vector2d::Zero());
  for (const auto& from : from_m) {
    for (const auto& to : to_m) {
      if ((to - from).norm() > kSds * sd_m) continue;
      if (const auto brought = brought_by(to - from); brought.first > best.first) best = brought;
    }
  }
  for (auto& track : known_.tracks) {
    track.seen_m += best.second;
    track.first_m += best.second;
    track.middle_m += best.second;
    for (auto& corner : track.outline_m) corner += best.second;
    if (!track.body) continue;
    track.body->Translate(best.second);
    track.body->Loosen(best.first > 0 ? kLooseM * kLooseM : sd_m * sd_m);
    Place(track);
  }
}

// From scan to scan all may step together: the own position and heading settle. Half of them step by less and half by more.
void Step::FindCommonStep() {
  constexpr double kReachM = 1.5;
  constexpr std::size_t kLeast = 5;
  constexpr std::size_t kMost = 100;
  std::vector<Eigen::Vector2d> to_m;
  for (std::size_t i = 0; i < scan_.seen.size(); ++i) {
    if (scan_.seen[i].is_sure) to_m.push_back(middle_m_[i]);
  }
  std::vector<double> east;
  std::vector<double> north;
  for (const auto& track : known_.tracks) {
    if (east.size() == kMost) break;
    if (!track.body || track.UnseenS(scan_.end_time) > 1.5 * dt_s_) continue;
    const auto nearest = std::ranges::min_element(to_m, {}, [&](const auto& to) { return (to - track.seen_m).squaredNorm(); });
    if (nearest == to_m.end() || (*nearest - track.seen_m).norm() >= kReachM) continue;
    east.push_back(nearest->x() - track.seen_m.x());
    north.push_back(nearest->y() - track.seen_m.y());
  }
  if (east.size() < kLeast) return;
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
  };
  common_step_m_ = {median(east), median(north)};
}

}  // namespace lookout::tracker
