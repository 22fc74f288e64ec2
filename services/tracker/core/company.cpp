#include "services/tracker/core/company.hpp"

#include <algorithm>
#include <cstddef>

#include "services/tracker/core/beside.hpp"

namespace lookout::tracker {

namespace {

using Ids = std::pair<std::int64_t, std::int64_t>;

Ids InOrder(std::int64_t one, std::int64_t other) { return {std::min(one, other), std::max(one, other)}; }

}  // namespace

std::int64_t FirstOf(std::int64_t one, std::int64_t other) {
  if ((one < 0) != (other < 0)) return std::max(one, other);
  return one < 0 ? std::max(one, other) : std::min(one, other);
}

bool IsKnown(const Track& track, Utime time) { return IsConfirmed(track) && ToSeconds(time - track.first) >= Company::kKnownS; }

bool Company::IsTogether(const Track& one, const Track& other, bool is_joined) {
  if (is_joined) return IsWithin(one, other, kLeaveM);
  return (one.velocity_mps - other.velocity_mps).norm() <= kAlikeMps && IsWithin(one, other, kJoinM);
}

void Company::Update(Utime time, std::span<const Track* const> moving, std::span<const Track* const> standing) {
  const auto before = std::exchange(pairs_, {});
  std::map<std::int64_t, std::int64_t> names;
  for (const auto* track : moving) names[track->id] = track->id;
  for (const auto* track : standing) names[track->id] = track->id;
  const auto num_scans_of = [&before](const Ids& ids) {
    const auto known = before.find(ids);
    return known == before.end() ? 0 : known->second;
  };
  const auto count = [&](const Ids& ids, int num_before) {
    pairs_[ids] = std::min(num_before + 1, kJoinScans);
    if (num_before + 1 < kJoinScans) return;
    const Ids from{names[ids.first], names[ids.second]};
    const auto name = FirstOf(from.first, from.second);
    for (auto& [track, of] : names) {
      if (of == from.first || of == from.second) of = name;
    }
  };
  for (std::size_t i = 0; i < moving.size(); ++i) {
    for (std::size_t j = i + 1; j < moving.size(); ++j) {
      const auto ids = InOrder(moving[i]->id, moving[j]->id);
      const int num_scans = num_scans_of(ids);
      if (IsTogether(*moving[i], *moving[j], num_scans >= kJoinScans)) count(ids, num_scans);
    }
    for (const auto* part : standing) {
      const auto ids = InOrder(moving[i]->id, part->id);
      const int num_scans = num_scans_of(ids);
      const bool comes_up = IsKnown(*moving[i], time) && !IsKnown(*part, time);
      if ((comes_up || num_scans > 0) && IsWithin(*moving[i], *part, kPartM)) count(ids, num_scans);
    }
  }
  renamed_.clear();
  for (const auto& [track, name] : names_) {
    const auto now = names.find(track);
    // Where the first track has left, what remains goes on under another name.
    if (now == names.end() || (track != name && names.contains(name)) || now->second == name) continue;
    if (std::ranges::find(renamed_, name, &std::pair<std::int64_t, std::int64_t>::first) == renamed_.end()) renamed_.emplace_back(name, now->second);
  }
  names_ = std::move(names);
}

void Company::Rename(std::int64_t from_track, std::int64_t to_track) {
  const auto renamed = [&](std::int64_t id) { return id == from_track ? to_track : id; };
  const auto pairs = std::exchange(pairs_, {});
  for (const auto& [ids, num_scans] : pairs) {
    const auto now = InOrder(renamed(ids.first), renamed(ids.second));
    if (now.first != now.second) pairs_[now] = std::max(pairs_[now], num_scans);
  }
  const auto names = std::exchange(names_, {});
  for (const auto& [track, name] : names) names_.try_emplace(renamed(track), renamed(name));
}

void Company::Clear() {
  pairs_.clear();
  names_.clear();
  renamed_.clear();
}

std::int64_t Company::NameOf(std::int64_t track_id) const {
  const auto found = names_.find(track_id);
  return found == names_.end() ? track_id : found->second;
}

bool Company::HasMore(std::int64_t name) const {
  return std::ranges::count(names_, name, [](const auto& item) { return item.second; }) > 1;
}

}  // namespace lookout::tracker
