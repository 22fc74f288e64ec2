#include "tools/export/standing_things.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <tuple>
#include <utility>

#include "common/core/elementary.hpp"

namespace lookout::exporter {

namespace {

constexpr double kStandsForS = 10.0;  // how long a track stands until it is a thing of the map
constexpr double kMostMapThingM = 1000.0;
constexpr double kMostPlaceVarianceM2 = 100.0;  // greatest variance of a place that is kept
constexpr std::size_t kMostMapOutline = 64;
// A place where a thing was is looked through: bounds for one second, and for all looks until the thing is gone.
constexpr double kLeastBeams = 3.0;
constexpr double kMostMetShare = 0.1;
constexpr int kLooksUntilGone = 20;
constexpr double kBeamsUntilGone = 100.0;
constexpr std::size_t kMostLooked = 200;  // things a second

bool IsStanding(const track_t& track) {
  return (track.status == track_t::STATUS_CONFIRMED || track.status == track_t::STATUS_COASTING) && track.velocity_map_mps[0] == 0.0 &&
         track.velocity_map_mps[1] == 0.0;
}

// Whether a map may hold its numbers. A log may hold any.
bool HasNumbersOfAThing(const track_t& track) {
  const auto is_within = [](double value, double least, double most) { return value >= least && value <= most; };
  const auto are_near = [](const std::vector<float>& values_m, double middle_m) {
    return std::ranges::all_of(values_m, [middle_m](float value_m) { return std::abs(value_m - middle_m) <= kMostMapThingM; });
  };
  return UtimeFromWire(track.first_utime_us) && UtimeFromWire(track.seen_utime_us) && track.kind >= track_t::KIND_OBSTACLE &&
         track.kind <= track_t::KIND_UNKNOWN && is_within(track.latitude_deg, -90.0, 90.0) && is_within(track.longitude_deg, -180.0, 180.0) &&
         is_within(track.length_m, 0.0, kMostMapThingM) && is_within(track.width_m, 0.0, kMostMapThingM) &&
         is_within(track.length_bearing_rad, 0.0, 4.0) && is_within(track.top_above_water_m, -kMostMapThingM, kMostMapThingM) &&
         is_within(track.covariance[0][0], 0.0, kMostPlaceVarianceM2) && is_within(track.covariance[1][1], 0.0, kMostPlaceVarianceM2) &&
         is_within(track.covariance[0][1], -kMostPlaceVarianceM2, kMostPlaceVarianceM2) && !track.outline_east_m.empty() &&
         track.outline_east_m.size() == track.outline_north_m.size() && are_near(track.outline_east_m, track.position_map_m[0]) &&
         are_near(track.outline_north_m, track.position_map_m[1]);
}

// Deviation of a place, along its worst direction.
double WorstDeviationM(const track_t& track) {
  const double half_trace = 0.5 * (track.covariance[0][0] + track.covariance[1][1]);
  const double half_difference = 0.5 * (track.covariance[0][0] - track.covariance[1][1]);
  return std::sqrt(std::max(0.0, half_trace + Hypot(half_difference, track.covariance[0][1])));
}

}  // namespace

std::optional<StandingTrack> ToStandingTrack(const track_t& track) {
  if (!IsStanding(track) || !HasNumbersOfAThing(track)) return std::nullopt;
  StandingTrack standing;
  standing.id = track.id;
  standing.is_confirmed = track.status == track_t::STATUS_CONFIRMED;
  standing.is_seen = track.num_segments > 0;
  standing.position_m = {track.position_map_m[0], track.position_map_m[1]};
  auto& look = standing.look;
  look.kind = track.kind;
  look.latitude_deg = track.latitude_deg;
  look.longitude_deg = track.longitude_deg;
  look.deviation_m = WorstDeviationM(track);
  look.length_m = track.length_m;
  look.width_m = track.width_m;
  look.length_bearing_rad = track.length_bearing_rad;
  look.top_above_water_m = track.top_above_water_m;
  look.first = *UtimeFromWire(track.first_utime_us);
  look.seen = *UtimeFromWire(track.seen_utime_us);
  // An outline with more corners than a map allows keeps each second, third, ... corner: a convex outline gets a little smaller.
  const auto step = (track.outline_east_m.size() + kMostMapOutline - 1) / kMostMapOutline;
  for (std::size_t i = 0; i < track.outline_east_m.size(); i += step) {
    look.outline_m.emplace_back(track.outline_east_m[i] - track.position_map_m[0], track.outline_north_m[i] - track.position_map_m[1]);
  }
  return standing;
}

StandingThings::StandingThings(const std::map<std::int64_t, MapThing>& given) : num_given_(given.size()) {
  things_.reserve(given.size());
  for (const auto& [number, thing] : given) {
    auto& kept = things_.emplace_back();
    kept.now = thing;
    kept.given_number = number;
  }
}

void StandingThings::PlaceOnMap(const Datum& datum) {
  if (datum_ && datum_->IsSameAs(datum)) return;
  datum_ = datum;
  const LocalFrame map = datum.Map();
  for (auto& thing : things_) Place(map, datum, thing);
}

// On the height of the datum: things float as the boat does, which began there.
void StandingThings::Place(const LocalFrame& map, const Datum& datum, Thing& thing) {
  const double height_m = std::isnan(datum.ellipsoid_height_m) ? 0.0 : datum.ellipsoid_height_m;
  thing.place_m = map.Forward({thing.now.latitude_deg, thing.now.longitude_deg, height_m}).head<2>();
  thing.outline_m.clear();
  for (const auto& corner_m : thing.now.outline_m) thing.outline_m.emplace_back(thing.place_m + corner_m);
}

void StandingThings::Update(const StandingScan& scan, const tracker::Sight* sight) {
  PlaceOnMap(scan.datum);
  NoteSeen(scan);
  const auto second = std::chrono::floor<std::chrono::seconds>(scan.time).time_since_epoch().count();
  if (second_ == second) return;
  second_ = second;
  LetGo(scan.tracks);
  Match(scan);
  Measure(scan);
  if (sight != nullptr) LookThrough(scan.end_time, *sight);
}

void StandingThings::NoteSeen(const StandingScan& scan) {
  for (const auto& track : scan.tracks) {
    const auto found = thing_of_.find(track.id);
    if (found == thing_of_.end() || !track.is_seen || !track.is_confirmed) continue;
    auto& thing = things_[found->second];
    thing.now.gone.reset();
    // A clock that was set back makes no thing that was seen before it was seen first.
    thing.now.first = std::min(thing.now.first, scan.end_time);
    thing.now.seen = std::max(thing.now.seen, scan.end_time);
    AddScans({DayOf(scan.end_time), 1}, thing.now.days);
    thing.num_looks = 0;
    thing.num_beams = 0.0;
  }
}

// Lets go things whose tracks ended, move, or stand elsewhere by now.
void StandingThings::LetGo(const std::vector<StandingTrack>& tracks) {
  for (auto& thing : things_) thing.is_tracked = false;
  std::erase_if(thing_of_, [&](const auto& one) {
    const auto track = std::ranges::lower_bound(tracks, one.first, {}, &StandingTrack::id);
    if (track == tracks.end() || track->id != one.first) return true;
    auto& thing = things_[one.second];
    if ((track->position_m - thing.place_m).norm() > SamePlaceM(thing.now.deviation_m, track->look.deviation_m)) return true;
    thing.is_tracked = true;
    return false;
  });
}

void StandingThings::Match(const StandingScan& scan) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;  // distance, thing, track
  for (std::size_t k = 0; k < scan.tracks.size(); ++k) {
    const auto& track = scan.tracks[k];
    if (!track.is_confirmed || thing_of_.contains(track.id)) continue;
    for (std::size_t i = num_given_; i < things_.size(); ++i) {
      const auto& thing = things_[i];
      if (thing.is_tracked) continue;
      const double apart_m = (track.position_m - thing.place_m).norm();
      if (apart_m > SamePlaceM(thing.now.deviation_m, track.look.deviation_m)) continue;
      if (AreOfOneThing(track.look.length_m, thing.now.length_m)) pairs.emplace_back(apart_m, i, k);
    }
  }
  std::ranges::sort(pairs);
  for (const auto& [apart_m, i, k] : pairs) {
    if (things_[i].is_tracked || thing_of_.contains(scan.tracks[k].id)) continue;
    things_[i].is_tracked = true;
    thing_of_.emplace(scan.tracks[k].id, i);
  }
  for (const auto& track : scan.tracks) {
    if (!track.is_confirmed || thing_of_.contains(track.id) || ToSeconds(track.look.seen - track.look.first) < kStandsForS) continue;
    if (things_.size() - num_given_ >= kMostMapThings) {
      ++num_over_limit_;
      continue;
    }
    auto& thing = things_.emplace_back();
    thing.now = track.look;
    thing.now.days = {{DayOf(scan.end_time), 1}};
    thing.is_tracked = true;
    thing_of_.emplace(track.id, things_.size() - 1);
  }
}

void StandingThings::Measure(const StandingScan& scan) {
  const LocalFrame map = scan.datum.Map();
  for (const auto& [id, i] : thing_of_) {
    const auto track = std::ranges::lower_bound(scan.tracks, id, {}, &StandingTrack::id);
    auto& thing = things_[i];
    if (!track->is_confirmed || thing.now.gone) continue;
    MapThing look = track->look;
    look.first = thing.now.first;
    look.seen = thing.now.seen;
    look.days = std::move(thing.now.days);
    thing.now = std::move(look);
    Place(map, scan.datum, thing);
  }
}

void StandingThings::LookThrough(Utime now, const tracker::Sight& sight) {
  std::size_t num_looked = 0;
  for (std::size_t n = 0; n < things_.size() && num_looked < kMostLooked; ++n) {
    next_looked_ = next_looked_ < things_.size() ? next_looked_ : 0;
    auto& thing = things_[next_looked_++];
    if (thing.is_tracked || thing.now.gone || (thing.place_m - sight.from_m()).norm() > sight.max_range_m()) continue;
    ++num_looked;
    const auto look = sight.At(thing.outline_m, thing.now.top_above_water_m);
    if (look.num_open < kLeastBeams) continue;
    if (look.num_met > kMostMetShare * look.num_open) {  // something is there
      thing.num_looks = 0;
      thing.num_beams = 0.0;
      continue;
    }
    ++thing.num_looks;
    thing.num_beams += look.num_open;
    if (thing.num_looks >= kLooksUntilGone && thing.num_beams >= kBeamsUntilGone) thing.now.gone = now;
  }
}

std::vector<MapThing> StandingThings::Seen() const {
  std::vector<MapThing> seen;
  seen.reserve(things_.size() - num_given_);
  for (std::size_t i = num_given_; i < things_.size(); ++i) seen.push_back(things_[i].now);
  return seen;
}

std::vector<std::pair<std::int64_t, Utime>> StandingThings::GivenGone() const {
  std::vector<std::pair<std::int64_t, Utime>> gone;
  for (const auto& thing : things_) {
    if (thing.given_number != 0 && thing.now.gone) gone.emplace_back(thing.given_number, *thing.now.gone);
  }
  return gone;
}

}  // namespace lookout::exporter
