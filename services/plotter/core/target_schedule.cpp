#include "services/plotter/core/target_schedule.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

namespace lookout::plotter {

std::vector<const Target*> TargetSchedule::Due(std::span<const Target> targets, std::chrono::microseconds now) {
  constexpr int kDangerousWeight = 4;
  constexpr std::chrono::microseconds kNewAndDangerous = std::chrono::microseconds::max();
  std::vector<std::pair<std::chrono::microseconds, const Target*>> due;
  for (const auto& target : targets) {
    const auto found = sent_.find(target.id);
    const auto last = found == sent_.end() ? std::nullopt : found->second.time;
    if (last && now - *last < period_) continue;
    const bool is_dangerous = IsDangerous(target);
    // A new target counts as if it had waited for four periods before.
    const auto waited = last ? now - *last : now - new_.try_emplace(target.id, now).first->second + kDangerousWeight * period_;
    due.emplace_back(!is_dangerous ? waited : last ? kDangerousWeight * waited : kNewAndDangerous, &target);
  }
  std::ranges::stable_sort(due, std::greater(), &std::pair<std::chrono::microseconds, const Target*>::first);
  std::vector<const Target*> ordered;
  ordered.reserve(due.size());
  for (const auto& one : due) ordered.push_back(one.second);
  return ordered;
}

void TargetSchedule::NoteSent(const Target& target, Utime target_time, int number, std::chrono::microseconds now) {
  new_.erase(target.id);
  sent_.insert_or_assign(target.id, Sent{target, target_time, number, now});
}

std::vector<TargetSchedule::Sent> TargetSchedule::TakeEnded(std::span<const Target> targets) {
  std::set<std::int64_t> ids;
  for (const auto& target : targets) ids.insert(target.id);
  std::erase_if(new_, [&ids](const auto& one) { return !ids.contains(one.first); });
  std::vector<Sent> ended;
  for (auto sent = sent_.begin(); sent != sent_.end();) {
    if (ids.contains(sent->first)) {
      ++sent;
      continue;
    }
    ended.push_back(std::move(sent->second));
    ended.back().target.state = TargetState::kLost;
    sent = sent_.erase(sent);
  }
  return ended;
}

void TargetSchedule::SendAnew() {
  for (auto& [id, sent] : sent_) sent.time.reset();
}

Target EndedAt(const TargetSchedule::Sent& ended, Utime time) {
  constexpr double kMostS = 5.0;
  auto target = ended.target;
  const double ahead_s = std::clamp(ToSeconds(time - ended.target_time), 0.0, kMostS);
  target.position = Propagated(target.position, target.velocity_east_mps, target.velocity_north_mps, ahead_s);
  return target;
}

}  // namespace lookout::plotter
