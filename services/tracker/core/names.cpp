#include "services/tracker/core/names.hpp"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

namespace lookout::tracker {

void Names::Give(std::int64_t id, const std::string& name, Utime time) {
  if (name.empty()) {
    names_.erase(id);
  } else if (names_.size() >= kMost && !names_.contains(id)) {
    ++num_over_limit_;
  } else {
    names_[id] = {name, time};
  }
}

// Where both have one the older thing's stays.
void Names::Rename(std::int64_t from, std::int64_t to) {
  auto moved = names_.extract(from);
  if (!moved) return;
  moved.key() = to;
  names_.insert(std::move(moved));
}

void Names::Update(Utime time, std::span<const Track> tracks, std::span<const Alert> alerts) {
  if (names_.empty()) return;
  std::set<std::int64_t> ids;
  for (const auto& track : tracks) ids.insert(track.id);
  for (const auto& alert : alerts) ids.insert(alert.thing);
  for (auto& [id, given] : names_) {
    if (ids.contains(id)) given.borne = time;
  }
  std::erase_if(names_, [time](const auto& item) { return std::chrono::abs(time - item.second.borne) > kKeptFor; });
}

std::string Names::Of(std::int64_t id, std::int64_t or_else) const {
  for (const auto one : {id, or_else}) {
    if (const auto found = names_.find(one); found != names_.end()) return found->second.name;
  }
  return {};
}

std::vector<std::pair<std::int64_t, std::string>> Names::All() const {
  std::vector<std::pair<std::int64_t, std::string>> all;
  all.reserve(names_.size());
  for (const auto& [id, given] : names_) all.emplace_back(id, given.name);
  return all;
}

void KeptNames::Keep(Utime time, const Datum& datum, std::span<const std::pair<std::int64_t, std::string>> names, std::span<const Track> tracks) {
  for (const auto& [id, name] : names) {
    const auto track = std::ranges::find(tracks, id, &Track::id);
    if (track == tracks.end()) continue;
    const auto is_same = [&taken = name, &position_m = track->position_m](const Kept& kept) {
      return kept.name == taken && (kept.position_m - position_m).norm() <= KeptAcknowledgements::kSamePlaceM;
    };
    std::erase_if(kept_, is_same);
    kept_.push_back({time, datum, name, track->position_m, track->velocity_mps});
  }
}

// The nearest pair first: of two things side by side the one that is confirmed first does not take the other's name.
std::vector<Order> KeptNames::Take(Utime time, const Datum& datum, std::span<const Track> tracks, const Names& names) {
  std::erase_if(kept_, [time](const Kept& kept) { return time < kept.time || time - kept.time > Names::kKeptFor; });
  std::vector<std::tuple<double, std::size_t, std::int64_t>> pairs;  // distance, index of kept_, track
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    if (!datum.IsSameAs(kept_[k].datum)) continue;
    const Eigen::Vector2d expected_m = kept_[k].position_m + ToSeconds(time - kept_[k].time) * kept_[k].velocity_mps;
    for (const auto& track : tracks) {
      const double away_m = (track.position_m - expected_m).norm();
      if (track.status != TrackStatus::kConfirmed || track.first < kept_[k].time || !names.Of(track.id).empty()) continue;
      if (away_m <= KeptAcknowledgements::kSamePlaceM) pairs.emplace_back(away_m, k, track.id);
    }
  }
  std::ranges::sort(pairs);
  std::vector<Order> orders;
  std::set<std::int64_t> named;
  std::vector<bool> is_given(kept_.size(), false);
  for (const auto& [away_m, k, id] : pairs) {
    if (is_given[k] || !named.insert(id).second) continue;
    is_given[k] = true;
    orders.push_back({time, 0, "tracker", OrderKind::kName, {}, id, kept_[k].name});
  }
  std::vector<Kept> left;
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    if (!is_given[k]) left.push_back(std::move(kept_[k]));
  }
  kept_ = std::move(left);
  return orders;
}

}  // namespace lookout::tracker
