#include "services/ais/core/watcher.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::ais {

namespace {

// A ship without any track near is AIS only when this is likely, and has been for so long.
constexpr double kNoneProbability = 0.9;
constexpr double kUnseenS = 3.0;
constexpr double kSeenAgainS = 1.0;
constexpr double kMostUnseenS = 6.0;
constexpr double kMostScanS = 1.0;
constexpr std::chrono::seconds kMostWithoutPose{1};
// Below, a track is no candidate worth telling.
constexpr double kLeastProbability = 0.1;

// Aids that stand on charts alone, base stations and aircraft are no things on the water.
bool MayBeTracked(const Ship& ship) { return !ship.is_virtual && ship.sender != Sender::kBase && ship.sender != Sender::kAircraft; }

}  // namespace

void Watcher::Consume(const Item& item) {
  if (item.is_start) {
    joiner_.Clear();
    ships_.Clear();
    association_.Clear();
    identities_.clear();
    unseen_s_.clear();
    last_time_.reset();
    has_heard_ = false;
    return;
  }
  const auto whole = joiner_.Add(item.time, item.source, item.sentence);
  if (!whole) return;
  const auto result = Decode(whole->payload);
  switch (result.fault) {
    case MessageFault::kNone:
      ++counts_["messages_understood"];
      has_heard_ = true;
      ships_.AdvanceTo(item.time);
      return ships_.Add(result.message, whole->is_own, item.time);
    case MessageFault::kOtherType:
      ++counts_["messages_other"];
      return;
    case MessageFault::kTooShort:
      ++counts_["messages_too_short"];
      return;
    case MessageFault::kBadMmsi:
      ++counts_["messages_bad_mmsi"];
      return;
    case MessageFault::kBadPlace:
      ++counts_["messages_bad_place"];
      return;
    case MessageFault::kBadPart:
      ++counts_["messages_bad_part"];
      return;
  }
}

// Another map or another process of the tracker: its tracks are others.
void Watcher::KeepToMap(const TracksOfScan& scan) {
  const bool is_same = map_ && map_->begin_seq == scan.begin_seq && map_->begin_time == scan.begin_time && map_->datum.IsSameAs(scan.datum);
  if (!is_same) {
    association_.Clear();
    identities_.clear();
    unseen_s_.clear();
    shore_m_.clear();
    map_ = MapKey{scan.begin_seq, scan.begin_time, scan.datum};
  }
  if (scan.shore_m) shore_m_ = *scan.shore_m;
}

Picture Watcher::Update(const TracksOfScan& scan, const std::optional<Pose>& own) {
  ships_.AdvanceTo(scan.end_time);
  KeepToMap(scan);
  Picture picture;
  picture.own_mmsi = ships_.own_mmsi();
  const bool is_on_earth = own && own->is_placed && !own->datum.IsRelative() && own->datum.IsSameAs(scan.datum);
  if (is_on_earth) {
    picture.status = Status::kOk;
    Tell(scan, *own, picture);
    return picture;
  }
  picture.status = own ? Status::kNoPosition : Status::kNoPose;
  // A pair holds over scans whose pose is missing: a name that comes and goes would be read as another ship.
  const bool is_short = last_time_ && scan.end_time - *last_time_ <= kMostWithoutPose;
  for (const auto& [mmsi, ship] : ships_.ships()) {
    if (!ship.fix) continue;
    if (picture.ships.size() == kMostTold) {
      ++counts_["ships_untold"];
      continue;
    }
    auto& told = picture.ships.emplace_back();
    told.ship = ship;
    told.place = PropagatedPlace(*ship.fix, scan.end_time);
    const auto identity = std::ranges::lower_bound(identities_, mmsi, {}, &Identity::mmsi);
    const bool is_pair = is_short && identity != identities_.end() && identity->mmsi == mmsi && identity->is_sure;
    if (!is_pair || !std::ranges::binary_search(scan.tracks, identity->track_id, {}, &TrackedThing::id)) continue;
    told.state = ShipState::kTracked;
    told.track_id = identity->track_id;
    told.probability = identity->probability;
  }
  return picture;
}

void Watcher::Tell(const TracksOfScan& scan, const Pose& own, Picture& picture) {
  const double step_s = last_time_ ? std::clamp(ToSeconds(scan.end_time - *last_time_), 0.0, kMostScanS) : 0.0;
  last_time_ = scan.end_time;
  const auto map = scan.datum.Map();
  std::vector<ShipInReach> in_reach;
  for (const auto& [mmsi, ship] : ships_.ships()) {
    if (!ship.fix) continue;
    auto predicted = Predict(ship, map, scan.end_time);
    ShipInPicture told;
    told.place = PropagatedPlace(*ship.fix, scan.end_time);
    if (predicted) {
      const Eigen::Vector2d to_m = predicted->center_map_m - own.position_map_m.head<2>();
      told.range_m = to_m.norm();
      if (told.range_m > params_.list_range_m) continue;
      const Eigen::Vector3d to_here_m = own.R_map_here.transpose() * Eigen::Vector3d(to_m.x(), to_m.y(), 0.0);
      told.bearing_rad = WrapTo2Pi(Atan2(to_here_m.x(), to_here_m.y()) - own.heading_rad);
      if (told.range_m <= kReachM && MayBeTracked(ship)) in_reach.push_back({&ship, *predicted});
    }
    told.ship = ship;
    told.predicted = std::move(predicted);
    picture.ships.push_back(std::move(told));
  }

  if (in_reach.size() > kMostCompared) {
    counts_["ships_not_compared"] += static_cast<std::int64_t>(in_reach.size() - kMostCompared);
    const auto range_m = [&own](const ShipInReach& one) { return (one.predicted.center_map_m - own.position_map_m.head<2>()).norm(); };
    std::ranges::stable_sort(in_reach, {}, range_m);
    in_reach.resize(kMostCompared);
    std::ranges::sort(in_reach, {}, [](const ShipInReach& one) { return one.ship->mmsi; });
  }
  identities_ = association_.Update(scan.end_time, in_reach, scan.tracks);
  std::erase_if(unseen_s_, [&](const auto& entry) { return !std::ranges::binary_search(identities_, entry.first, {}, &Identity::mmsi); });
  for (std::size_t i = 0; i < identities_.size(); ++i) {
    const auto& identity = identities_[i];
    auto& told = *std::ranges::lower_bound(picture.ships, identity.mmsi, {}, [](const auto& ship) { return ship.ship.mmsi; });
    const bool may_be_unseen = !identity.is_sure && identity.none_probability >= kNoneProbability;
    const bool should_be_seen = may_be_unseen && ShouldBeSeen(in_reach[i], own, scan.tracks, shore_m_, params_.sight);
    told.state = StateOf(identity, should_be_seen, step_s);
    if (told.state != ShipState::kTracked && told.state != ShipState::kUnsure) continue;
    told.track_id = identity.track_id;
    told.probability = identity.probability;
  }

  if (picture.ships.size() <= kMostTold) return;
  // Ships that are farthest away are left out; at equal ranges ships with the greater MMSI.
  counts_["ships_untold"] += static_cast<std::int64_t>(picture.ships.size() - kMostTold);
  std::ranges::stable_sort(picture.ships, {}, [](const auto& ship) { return std::isnan(ship.range_m) ? 1e9 : ship.range_m; });
  picture.ships.resize(kMostTold);
  std::ranges::sort(picture.ships, {}, [](const auto& ship) { return ship.ship.mmsi; });
}

ShipState Watcher::StateOf(const Identity& identity, bool should_be_seen, double step_s) {
  const auto was = unseen_s_.find(identity.mmsi);
  const bool was_unseen = was != unseen_s_.end() && was->second < 0.0;
  // Below 0: told as unseen, and the time that is left of it.
  double unseen_s = was == unseen_s_.end() ? 0.0 : std::abs(was->second);
  unseen_s = should_be_seen ? std::min(unseen_s + step_s, kMostUnseenS) : std::max(unseen_s - 2.0 * step_s, 0.0);
  const bool is_unseen = !identity.is_sure && unseen_s >= (was_unseen ? kSeenAgainS : kUnseenS);
  unseen_s_[identity.mmsi] = is_unseen ? -unseen_s : unseen_s;
  if (identity.is_sure) return ShipState::kTracked;
  if (is_unseen) return ShipState::kAisOnly;
  return identity.track_id != 0 && identity.probability >= kLeastProbability ? ShipState::kUnsure : ShipState::kNotInSight;
}

std::vector<Counter> Watcher::counters() const {
  std::vector<Counter> counters{{"ships", static_cast<std::int64_t>(ships_.ships().size())}};
  counts_.AppendTo(counters);
  for (const auto& some : {joiner_.counters(), ships_.counters(), association_.counters()}) counters.insert(counters.end(), some.begin(), some.end());
  return counters;
}

}  // namespace lookout::ais
