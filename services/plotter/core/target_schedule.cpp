#include "services/plotter/core/target_schedule.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace lookout::plotter {

std::vector<const Target*> TargetSchedule::Due(std::span<const Target> targets, std::chrono::microseconds now) const {
  using Time = std::optional<std::chrono::microseconds>;
  std::vector<std::pair<Time, const Target*>> due;
  for (const auto& target : targets) {
    const auto found = sent_.find(target.id);
    const Time last = found == sent_.end() ? std::nullopt : found->second.time;
    if (last && now - *last < period_) continue;
    due.emplace_back(IsDangerous(target) ? std::nullopt : last, &target);
  }
  // nullopt is before every time.
  std::ranges::stable_sort(due, {}, [](const auto& one) { return std::pair(!IsDangerous(*one.second), one.first); });
  std::vector<const Target*> ordered;
  for (const auto& one : due) ordered.push_back(one.second);
  return ordered;
}

void TargetSchedule::NoteSent(const Target& target, int number, std::chrono::microseconds now) {
  sent_.insert_or_assign(target.id, Sent{target, number, now});
}

std::vector<TargetSchedule::Sent> TargetSchedule::TakeEnded(std::span<const Target> targets) {
  std::set<std::int64_t> ids;
  for (const auto& target : targets) ids.insert(target.id);
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

}  // namespace lookout::plotter
