#include "services/plotter/core/target_numbers.hpp"

#include <set>
#include <utility>

namespace lookout::plotter {

void TargetNumbers::Assign(std::span<const Target> targets, std::chrono::microseconds now) {
  std::set<std::int64_t> without;
  for (const auto& target : targets) {
    if (number_of_.contains(target.id)) continue;
    const auto number = Free(IsDangerous(target) ? kNumbers : kNumbers - kReserved, now);
    if (!number) {
      if (!without_.contains(target.id)) ++num_overflows_;
      without.insert(target.id);
      continue;
    }
    slots_[static_cast<std::size_t>(*number)] = {.is_used = true, .released = std::nullopt};
    number_of_.emplace(target.id, *number);
  }
  without_ = std::move(without);
}

void TargetNumbers::Release(std::int64_t target_id, std::chrono::microseconds now) {
  const auto found = number_of_.find(target_id);
  if (found == number_of_.end()) return;
  slots_[static_cast<std::size_t>(found->second)] = {.is_used = false, .released = now};
  number_of_.erase(found);
}

std::optional<int> TargetNumbers::Of(std::int64_t target_id) const {
  const auto found = number_of_.find(target_id);
  return found == number_of_.end() ? std::nullopt : std::optional(found->second);
}

// The lowest number that was never used; else the number that has been free for longest.
std::optional<int> TargetNumbers::Free(int end, std::chrono::microseconds now) const {
  std::optional<int> best;
  for (int number = 0; number < end; ++number) {
    const Slot& slot = slots_[static_cast<std::size_t>(number)];
    if (slot.is_used || (slot.released && now - *slot.released < quarantine_)) continue;
    if (!slot.released) return number;
    if (!best || *slot.released < *slots_[static_cast<std::size_t>(*best)].released) best = number;
  }
  return best;
}

}  // namespace lookout::plotter
