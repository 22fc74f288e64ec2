#include "services/tracker/core/names.hpp"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

namespace lookout::tracker {

void Names::Give(std::int64_t track_id, const std::string& name, Utime time) {
  const auto piece = structures_.find(track_id);
  const auto thing = piece == structures_.end() ? kUnnamed : piece->second;
  if (name.empty()) {
    const auto* of_structure = FindOfStructure(thing);
    if (names_.erase(track_id) == 0 && of_structure != nullptr) names_.erase(of_structure->first);
  } else if (names_.size() >= kMost && !names_.contains(track_id)) {
    ++num_over_limit_;
  } else {
    names_[track_id] = {name, ++num_given_, time, piece != structures_.end(), thing};
  }
}

void Names::Rename(std::int64_t from, std::int64_t to) {
  auto moved = names_.extract(from);
  if (!moved) return;
  moved.key() = to;
  const auto placed = names_.insert(std::move(moved));
  if (placed.inserted) return;
  ++num_merged_;
  if (placed.node.mapped().order > placed.position->second.order) placed.position->second = placed.node.mapped();
}

void Names::Follow(std::span<const Track> tracks, const Things& things) {
  structures_.clear();
  for (const auto& [from, to] : things.merged()) {
    for (auto& [id, given] : names_) {
      if (given.thing == from) given.thing = to;
    }
  }
  for (const auto& track : tracks) {
    const auto thing = things.ThingOf(track.id);
    const auto named = names_.find(track.id);
    if (named != names_.end()) {
      named->second.thing = thing;
      named->second.is_structure = named->second.is_structure || track.kind == TrackKind::kStructure;
    }
    const bool is_piece = track.kind == TrackKind::kStructure || (named != names_.end() && named->second.is_structure);
    if (is_piece && thing != kLandTrack) structures_.emplace(track.id, thing);
  }
  PassOn(tracks, things);
}

// Of a piece that is gone, to the first piece of the same structure that has none.
void Names::PassOn(std::span<const Track> tracks, const Things& things) {
  std::vector<std::pair<std::int64_t, std::int64_t>> passed;
  for (const auto& [id, given] : names_) {
    const bool is_there = std::ranges::find(tracks, id, &Track::id) != tracks.end();
    if (is_there || !given.is_structure || !things.IsGroup(given.thing)) continue;
    const auto heir = std::ranges::find_if(
        structures_, [this, thing = given.thing](const auto& piece) { return piece.second == thing && !names_.contains(piece.first); });
    if (heir != structures_.end()) passed.emplace_back(id, heir->first);
  }
  for (const auto& [from, to] : passed) Rename(from, to);
}

// The name of a structure: given last to one of its pieces.
const Names::Item* Names::FindOfStructure(std::int64_t thing) const {
  const Item* last = nullptr;
  if (IsOfPlaces(thing)) return last;
  for (const auto& item : names_) {
    if (!item.second.is_structure || item.second.thing != thing) continue;
    if (last == nullptr || item.second.order > last->second.order) last = &item;
  }
  return last;
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

std::string Names::Of(std::int64_t track_id) const {
  const auto found = names_.find(track_id);
  return found == names_.end() ? std::string() : found->second.name;
}

std::string Names::Of(const Alert& alert) const {
  if (const auto found = names_.find(alert.nearest_track); found != names_.end()) return found->second.name;
  if (const auto* of_structure = FindOfStructure(alert.thing); of_structure != nullptr) return of_structure->second.name;
  return alert.nearest_track == kLandTrack ? Of(alert.thing) : std::string();
}

std::int64_t Names::num_beside() const {
  return std::ranges::count_if(names_, [this](const Item& item) {
    return item.second.is_structure && !IsOfPlaces(item.second.thing) && FindOfStructure(item.second.thing) != &item;
  });
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
