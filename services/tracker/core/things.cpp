#include "services/tracker/core/things.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <set>

#include "services/tracker/core/beside.hpp"
#include "services/tracker/core/danger.hpp"

namespace lookout::tracker {

namespace {

// Longer than the boats around: a piece of a pier, a barge.
constexpr double kLongM = 8.0;

bool IsLikely(const Track& track) { return track.status == TrackStatus::kTentative && track.existence_probability >= Proof::kLikely; }
bool IsStructure(const Track& track) { return track.kind == TrackKind::kStructure || track.rectangle.length_m >= kLongM; }

// Of two the one that names both: land, then what was confirmed first, then what is tentative.
std::int64_t NameOf(std::int64_t one, std::int64_t other) {
  if ((one < 0) != (other < 0)) return std::max(one, other);
  return one < 0 ? std::max(one, other) : std::min(one, other);
}

// How far apart two that stand may be, neither of land or a structure, and are one all the same.
double GapOfOne(const Track& track, const Track& other, Utime time, bool is_own_still) {
  if (is_own_still) return Things::kBesideM;
  const auto is_known = [time](const Track& of) { return IsConfirmed(of) && ToSeconds(time - of.first) >= Things::kKnownS; };
  return is_known(track) != is_known(other) ? Things::kPartM : Things::kTouchM;
}

}  // namespace

void Things::Update(Utime time, std::span<const Track> tracks, std::span<const Eigen::Vector2d> shore_m, const Proof* proof, bool is_own_still) {
  merged_.clear();
  std::vector<const Track*> standing;
  standing.reserve(tracks.size());
  std::set<std::int64_t> ids;
  for (const auto& track : tracks) {
    const bool stands = track.velocity_mps.isZero(0.0) || (proof != nullptr && proof->MayBePiece(track.id));
    if ((!IsConfirmed(track) && !IsLikely(track)) || !stands || track.outline_m.empty()) continue;
    standing.push_back(&track);
    ids.insert(track.id);
    auto& member = members_.try_emplace(track.id, Member{track.id, 0, false, false}).first->second;
    ++member.num_scans;
    member.is_of_structure = member.is_of_structure || IsStructure(track);
  }
  std::erase_if(members_, [&ids](const auto& item) { return !ids.contains(item.first); });
  RenameOrphans();
  for (const auto* track : standing) {
    const auto& member = members_.at(track->id);
    if (member.thing == kLandTrack || member.num_scans < kStandsScans) continue;
    if (IsWithinAny(*track, shore_m, kBesideM)) Join(member.thing, kLandTrack);
  }
  for (const auto* track : standing) {
    const auto& own = members_.at(track->id);
    if (own.num_scans < kStandsScans) continue;
    for (const auto* other : standing) {
      const auto& with = members_.at(other->id);
      if (with.thing == own.thing) continue;
      const bool belongs = with.thing == kLandTrack || with.is_of_structure;
      if (!IsWithin(*track, *other, belongs ? kBesideM : GapOfOne(*track, *other, time, is_own_still))) continue;
      const auto name = NameOf(own.thing, with.thing);
      Join(name == own.thing ? with.thing : own.thing, name);
    }
  }
}

// A thing is named by its first track. Where that casts off, the rest belongs to it no more.
void Things::RenameOrphans() {
  std::map<std::int64_t, std::int64_t> renamed;
  for (auto& [track, member] : members_) {
    if (member.thing == kLandTrack || members_.contains(member.thing)) continue;
    const auto [name, is_first] = renamed.try_emplace(member.thing, track);
    name->second = NameOf(name->second, track);
  }
  for (auto& [track, member] : members_) {
    const auto name = renamed.find(member.thing);
    if (name != renamed.end() && !members_.contains(member.thing)) member.thing = name->second;
  }
  merged_.insert(merged_.end(), renamed.begin(), renamed.end());
}

void Things::Join(std::int64_t from_thing, std::int64_t to_thing) {
  if (from_thing == to_thing) return;
  const auto is_of_both = [&](const auto& item) { return item.second.thing == from_thing || item.second.thing == to_thing; };
  const bool is_of_structure = std::ranges::any_of(members_, [&](const auto& item) { return is_of_both(item) && item.second.is_of_structure; });
  for (auto& [track, member] : members_) {
    if (member.thing != from_thing && member.thing != to_thing) continue;
    member.thing = to_thing;
    member.is_joined = true;
    member.is_of_structure = is_of_structure;
  }
  merged_.emplace_back(from_thing, to_thing);
}

void Things::Rename(std::int64_t from_track, std::int64_t to_track) {
  auto moved = members_.extract(from_track);
  if (!moved) return;
  const auto known = members_.find(to_track);
  const std::int64_t to_thing = known == members_.end() ? to_track : known->second.thing;
  if (moved.mapped().thing == from_track) {
    for (auto& [track, member] : members_) {
      if (member.thing == from_track) member.thing = to_thing;
    }
    moved.mapped().thing = to_thing;
  }
  moved.key() = to_track;
  members_.insert(std::move(moved));
}

void Things::Clear() {
  members_.clear();
  merged_.clear();
}

std::int64_t Things::ThingOf(std::int64_t track_id) const {
  const auto found = members_.find(track_id);
  return found == members_.end() ? track_id : found->second.thing;
}

bool Things::IsGroup(std::int64_t thing) const {
  return thing == kLandTrack ||
         std::ranges::any_of(members_, [thing](const auto& item) { return item.second.thing == thing && item.second.is_joined; });
}

}  // namespace lookout::tracker
