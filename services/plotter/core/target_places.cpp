#include "services/plotter/core/target_places.hpp"

#include <algorithm>
#include <set>

namespace lookout::plotter {

int TargetPlaces::Of(std::int64_t target_id, std::chrono::microseconds now) {
  if (const auto found = place_of_.find(target_id); found != place_of_.end()) return found->second;
  auto place = std::ranges::find_if(places_, [now](const Place& one) { return !one.is_used && now - one.freed >= kQuarantine; });
  if (place == places_.end()) place = places_.insert(places_.end(), Place());
  place->is_used = true;
  const auto number = static_cast<int>(place - places_.begin()) + 1;
  place_of_.emplace(target_id, number);
  return number;
}

void TargetPlaces::Keep(std::span<const Target> targets, std::chrono::microseconds now) {
  std::set<std::int64_t> ids;
  for (const auto& target : targets) ids.insert(target.id);
  std::erase_if(place_of_, [&](const auto& one) {
    if (ids.contains(one.first)) return false;
    places_.at(static_cast<std::size_t>(one.second) - 1) = {.is_used = false, .freed = now};
    return true;
  });
}

}  // namespace lookout::plotter
