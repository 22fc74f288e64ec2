#include "services/tracker/core/told_places.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

#include "common/core/angles.hpp"

namespace lookout::tracker {

namespace {

// Below it a distance that halves is the sway of a boat in its berth.
constexpr double kLeastNearerM = 0.5;
constexpr double kDrawnBack = 2.0;
constexpr double kOtherSideRad = DegToRad(60.0);
// How far apart two points may be to be one place: cells of land and errors of the pose, and the step from one bearing bin to the next.
constexpr double kSamePlaceM = 2.0;
constexpr double kSamePlacePerRange = 0.1;
// One shore: places no farther apart than two bins, of which no later one is nearer by more than its roughness.
constexpr double kNextRad = DegToRad(10.0);
constexpr double kRoughM = 0.2;
constexpr double kRoughPerRange = 0.02;
// A thing without a track, from one scan to the next: its outline changes by a metre, and it goes by at most 10 m/s.
constexpr double kFollowedM = 2.0;
// Land that has left a bearing or a place for so long is new when it comes back: alerts are cleared after 3 s (clear_s), and a boat that yaws comes
// back sooner than 10 s.
constexpr std::chrono::seconds kBearingKeptFor{3};
constexpr std::chrono::seconds kPlaceKeptFor{10};
// A thing that was not seen for so long may be another one: to ring again is the safe error.
constexpr std::chrono::seconds kThingKeptFor{1};
// 72 bins of land and some acknowledgements of it; beyond, the oldest are forgotten, which rings.
constexpr std::size_t kMostTold = 1000;

// Both ways, so that a time that goes back forgets too.
bool IsWithin(Utime time, Utime since, std::chrono::microseconds longest) { return std::chrono::abs(time - since) <= longest; }

bool IsMuchNearer(double range_m, double told_m) { return range_m < 0.5 * told_m && told_m - range_m > kLeastNearerM; }

// Land forward of the beam that is to count as more of what was told elsewhere: a quay that goes on ahead keeps its offset to one side of the bow,
// a wall across the bow does not.
bool IsAsFarAside(const DangerPlace& place, double told_bearing_rad, double told_range_m) {
  const auto [sine, cosine] = SinCosOf(place.bearing_rad);
  if (cosine <= 0.0) return true;
  const double told_aside_m = told_range_m * SinCosOf(told_bearing_rad).sin;
  const double aside_m = place.range_m * sine;
  return aside_m * told_aside_m >= 0.0 && std::fabs(aside_m) >= 0.5 * std::fabs(told_aside_m);
}

bool IsOnAnotherSide(double bearing_rad, double told_rad) {
  return std::fabs(WrapToPi(bearing_rad)) < 0.5 * kPi && std::fabs(WrapToPi(bearing_rad - told_rad)) > kOtherSideRad;
}

}  // namespace

double DistanceOf(const DangerPlace& one, const DangerPlace& other) {
  if (!one.position_map_m.hasNaN() && !other.position_map_m.hasNaN()) return (one.position_map_m - other.position_map_m).norm();
  const auto in_vessel = [](const DangerPlace& place) {
    const auto [sine, cosine] = SinCosOf(place.bearing_rad);
    return Eigen::Vector2d(place.range_m * cosine, -place.range_m * sine);
  };
  return (in_vessel(one) - in_vessel(other)).norm();
}

void ToldPlaces::Tell(Utime time, std::span<const DangerPlace> places) {
  // The person has just been told where they are by now.
  if (kind_ == Kind::kThings) told_.clear();
  for (const auto& place : places) told_.push_back({place, place.range_m, place.bearing_rad, time, time});
  if (told_.size() > kMostTold) told_.erase(told_.begin(), told_.end() - static_cast<std::ptrdiff_t>(kMostTold));
}

void ToldPlaces::ForgetMap() {
  for (auto& told : told_) told.last.position_map_m.setConstant(kNan);
}

std::optional<DangerPlace> ToldPlaces::Untold(Utime time, std::span<const DangerPlace> places) {
  std::vector<bool> is_told(places.size(), false);
  if (kind_ == Kind::kThings) {
    FollowThings(time, places, is_told);
  } else {
    FindTold(time, places, is_told);
    std::erase_if(
        told_, [time](const Told& told) { return !IsWithin(time, told.seen, kPlaceKeptFor) && !IsWithin(time, told.bearing_seen, kBearingKeptFor); });
  }
  std::optional<DangerPlace> nearest;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!is_told[i] && (!nearest || places[i].range_m < nearest->range_m)) nearest = places[i];
  }
  return nearest;
}

void ToldPlaces::FindTold(Utime time, std::span<const DangerPlace> places, std::vector<bool>& is_told) {
  std::vector<std::size_t> by_bearing(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) by_bearing[i] = i;
  std::ranges::stable_sort(by_bearing, {}, [&places](std::size_t i) { return places[i].bearing_rad; });
  const std::size_t num = places.size();
  std::vector<Match> matches(num);
  for (std::size_t i = 0; i < num; ++i) {
    matches[i] = MatchLand(time, places[i]);
    is_told[i] = matches[i] == Match::kTold;
  }
  for (std::size_t start = 0; start < num; ++start) {
    if (matches[by_bearing[start]] != Match::kTold) continue;
    for (const std::size_t step : {std::size_t{1}, num - 1}) {
      double farthest_m = places[by_bearing[start]].range_m;
      for (std::size_t at = start, next = (at + step) % num; next != start; at = next, next = (at + step) % num) {
        const auto& place = places[by_bearing[next]];
        if (std::fabs(WrapToPi(place.bearing_rad - places[by_bearing[at]].bearing_rad)) > kNextRad) break;
        farthest_m = std::max(farthest_m, place.range_m);
        const bool has_changed = matches[by_bearing[next]] == Match::kChanged;
        const double rough_m = has_changed ? 0.0 : kRoughM + kRoughPerRange * place.range_m;
        if (place.range_m < farthest_m - rough_m) break;
        const auto& before = places[by_bearing[at]];
        if (!IsAsFarAside(place, before.bearing_rad, before.range_m)) break;
        is_told[by_bearing[next]] = true;
      }
    }
  }
}

// Every told place that it confirms is marked as seen, whatever the answer.
ToldPlaces::Match ToldPlaces::MatchLand(Utime time, const DangerPlace& place) {
  auto match = Match::kNone;
  const auto add = [&match](bool is_told) { match = std::max(match, is_told ? Match::kTold : Match::kChanged); };
  for (auto& told : told_) {
    const bool is_placed = !told.last.position_map_m.hasNaN() && !place.position_map_m.hasNaN();
    if (is_placed && IsWithin(time, told.seen, kPlaceKeptFor) &&
        (told.last.position_map_m - place.position_map_m).norm() <= kSamePlaceM + kSamePlacePerRange * place.range_m) {
      told.seen = time;
      add(!IsMuchNearer(place.range_m, told.told_range_m) && !IsOnAnotherSide(place.bearing_rad, told.told_bearing_rad));
    }
    if (IsWithin(time, told.bearing_seen, kBearingKeptFor) && std::fabs(WrapToPi(place.bearing_rad - told.told_bearing_rad)) <= kBesideRad) {
      if (IsMuchNearer(place.range_m, told.told_range_m)) {
        add(false);
      } else if (IsAsFarAside(place, told.told_bearing_rad, told.told_range_m)) {
        add(true);
        // Land that has drawn back to twice the distance is other land, or wants to be told anew when it comes back.
        if (place.range_m <= kDrawnBack * told.told_range_m) told.bearing_seen = time;
      }
    }
  }
  return match;
}

// Nearest pairs first: one place, one thing.
void ToldPlaces::FollowThings(Utime time, std::span<const DangerPlace> places, std::vector<bool>& is_told) {
  std::erase_if(told_, [time](const Told& told) { return !IsWithin(time, told.seen, kThingKeptFor); });
  struct Pair {
    double distance_m;
    std::size_t told;
    std::size_t place;
  };
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < told_.size(); ++k) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double distance_m = DistanceOf(told_[k].last, places[i]);
      if (distance_m <= kFollowedM) pairs.push_back({distance_m, k, i});
    }
  }
  std::ranges::sort(pairs, {}, [](const Pair& pair) { return std::tuple(pair.distance_m, pair.told, pair.place); });
  std::vector<bool> is_used(told_.size(), false);
  std::vector<bool> is_taken(places.size(), false);
  for (const auto& pair : pairs) {
    if (is_used[pair.told] || is_taken[pair.place]) continue;
    is_used[pair.told] = is_taken[pair.place] = true;
    auto& told = told_[pair.told];
    told.last = places[pair.place];
    told.seen = time;
    is_told[pair.place] = !IsMuchNearer(told.last.range_m, told.told_range_m) && !IsOnAnotherSide(told.last.bearing_rad, told.told_bearing_rad);
  }
}

}  // namespace lookout::tracker
