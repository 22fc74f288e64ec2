#include "tools/export/map_merge.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

#include "services/tracker/core/land.hpp"
#include "services/tracker/map_file.hpp"
#include "services/tracker/map_wire.hpp"

namespace lookout::exporter {

namespace {

using tracker::DayScans;
using tracker::MapLand;
using tracker::MapThing;

constexpr double kStandsForS = 10.0;  // as in the tracker, until it is a thing
constexpr double kMostPairM = 5.0;    // more than SamePlaceM ever is
constexpr double kLeastDegM = 110'000.0;

MapThing ToThing(const track_t& track) {
  MapThing thing;
  thing.kind = static_cast<tracker::TrackKind>(track.kind);
  thing.state = MapThing::State::kSeen;
  thing.latitude_deg = track.latitude_deg;
  thing.longitude_deg = track.longitude_deg;
  const auto& covariance = track.covariance;
  const double half_difference = 0.5 * (covariance[0][0] - covariance[1][1]);
  thing.deviation_m = std::sqrt(std::max(0.0, 0.5 * (covariance[0][0] + covariance[1][1]) + std::hypot(half_difference, covariance[0][1])));
  thing.length_m = track.length_m;
  thing.width_m = track.width_m;
  thing.length_bearing_rad = track.length_bearing_rad;
  thing.top_above_water_m = track.top_above_water_m;
  thing.first = Utime(std::chrono::microseconds(track.first_utime_us));
  thing.seen = Utime(std::chrono::microseconds(track.seen_utime_us));
  thing.days = {{tracker::DayOf(thing.seen), 1}};
  for (std::size_t i = 0; i < track.outline_east_m.size(); ++i) {
    thing.outline_m.emplace_back(track.outline_east_m[i] - track.position_map_m[0], track.outline_north_m[i] - track.position_map_m[1]);
  }
  return thing;
}

// A track that stands, with numbers that can be a thing's.
bool CanBeThing(const track_t& track) {
  const auto is_within = [](double value, double least, double most) { return value >= least && value <= most; };
  const auto first = UtimeFromWire(track.first_utime_us);
  const auto seen = UtimeFromWire(track.seen_utime_us);
  constexpr double kMostM = tracker::kMostMapThingM;
  return first && seen && ToSeconds(*seen - *first) >= kStandsForS && track.velocity_map_mps[0] == 0.0 && track.velocity_map_mps[1] == 0.0 &&
         (track.status == track_t::STATUS_CONFIRMED || track.status == track_t::STATUS_COASTING) && track.kind >= track_t::KIND_OBSTACLE &&
         track.kind <= track_t::KIND_UNKNOWN && is_within(track.latitude_deg, -90.0, 90.0) && is_within(track.longitude_deg, -180.0, 180.0) &&
         is_within(track.length_m, 0.0, kMostM) && is_within(track.width_m, 0.0, kMostM) && is_within(track.length_bearing_rad, 0.0, 4.0) &&
         is_within(track.top_above_water_m, -kMostM, kMostM) && is_within(track.covariance[0][0], 0.0, 100.0) &&
         is_within(track.covariance[1][1], 0.0, 100.0) && is_within(track.covariance[0][1], -100.0, 100.0) && !track.outline_east_m.empty() &&
         track.outline_east_m.size() == track.outline_north_m.size() && track.outline_east_m.size() <= tracker::kMostMapOutline &&
         std::ranges::all_of(track.outline_east_m, [&](float east_m) { return std::abs(east_m - track.position_map_m[0]) <= kMostM; }) &&
         std::ranges::all_of(track.outline_north_m, [&](float north_m) { return std::abs(north_m - track.position_map_m[1]) <= kMostM; });
}

double ApartM(const MapThing& one, const MapThing& other) {
  const LocalFrame here({one.latitude_deg, one.longitude_deg, 0.0});
  return here.Forward({other.latitude_deg, other.longitude_deg, 0.0}).head<2>().norm();
}

bool AreOnePlace(const MapThing& one, const MapThing& other, double apart_m) {
  return apart_m <= tracker::SamePlaceM(one.deviation_m, other.deviation_m) && tracker::AreOfOneThing(one.length_m, other.length_m);
}

// By what was seen last; what is gone, before what is not.
bool IsOlder(const MapThing& one, const MapThing& other) {
  return std::tuple(!one.gone, one.seen, one.latitude_deg, one.longitude_deg) <
         std::tuple(!other.gone, other.seen, other.latitude_deg, other.longitude_deg);
}

}  // namespace

bool MapMerge::Add(const map_t& message) {
  auto map = tracker::ToOwnMap(message);
  if (!map) return false;
  auto& process = processes_[{*UtimeFromWire(message.begin_utime_us), message.begin_seq}];
  if (message.source == map_t::SOURCE_GIVEN) {
    for (auto& thing : map->things) process.given.insert_or_assign(thing.id, std::move(thing));
    std::ranges::move(map->land, std::back_inserter(process.given_land));
    return true;
  }
  // In the order in which the process told it, whatever its clock did.
  if (message.seq >= process.kept_seq) {
    process.kept_seq = message.seq;
    process.kept_time = *UtimeFromWire(message.end_utime_us);
  }
  for (auto& thing : map->things) {
    auto& told = process.kept[thing.id];
    if (told.what.id == 0 || told.seq <= message.seq) told = {message.seq, std::move(thing)};
  }
  const Datum datum{message.datum_latitude_deg, message.datum_longitude_deg, message.datum_ellipsoid_height_m};
  if (!std::isfinite(datum.latitude_deg) || !std::isfinite(datum.longitude_deg)) return true;
  for (auto& land : map->land) {
    auto& told = process.land[{*UtimeFromWire(message.land_begin_utime_us), land.tile}];
    if (told.what.land.days.empty() || told.seq <= message.seq) told = {message.seq, {std::move(land), datum, message.water_up_m}};
  }
  return true;
}

bool MapMerge::Add(const tracks_t& message) {
  const auto time = UtimeFromWire(message.utime_us);
  const auto begin = UtimeFromWire(message.begin_utime_us);
  if (!time || !begin) return false;
  auto& process = processes_[{*begin, message.begin_seq}];
  if (*time < process.tracks_time) return true;
  if (*time > process.tracks_time) process.tracked.clear();
  process.tracks_time = *time;
  for (const auto& track : message.tracks) {
    if (CanBeThing(track)) process.tracked.insert_or_assign(track.id, ToThing(track));
  }
  return true;
}

// What stands in the last TRACKS is a thing that was told, seen since, or a new one.
void MapMerge::AddTracked(Process& process) {
  const auto last_id = [](const auto& things) { return things.empty() ? 0 : things.rbegin()->first; };
  auto next_id = std::max(last_id(process.given), last_id(process.kept)) + 1;
  std::vector<std::pair<std::int64_t, MapThing>> seen;
  for (const auto& entry : process.tracked) {
    const MapThing& tracked = entry.second;
    if (process.kept_time && tracked.seen <= *process.kept_time) continue;
    std::optional<std::pair<double, std::int64_t>> nearest;
    const auto look_at = [&](std::int64_t id, const MapThing& thing) {
      if (std::abs(thing.latitude_deg - tracked.latitude_deg) > kMostPairM / kLeastDegM) return;
      const double apart_m = ApartM(thing, tracked);
      if (AreOnePlace(thing, tracked, apart_m) && (!nearest || std::pair(apart_m, id) < *nearest)) nearest = {apart_m, id};
    };
    for (const auto& [id, told] : process.kept) look_at(id, told.what);
    for (const auto& [id, given] : process.given) {
      if (!process.kept.contains(id)) look_at(id, given);
    }
    if (!nearest) {
      seen.emplace_back(next_id, tracked);
      seen.back().second.id = next_id++;
      continue;
    }
    auto [place, is_new] = process.kept.try_emplace(nearest->second);
    auto& thing = place->second.what;
    if (is_new) {
      thing = tracked;
      thing.id = nearest->second;
      continue;
    }
    thing.state = MapThing::State::kSeen;
    thing.gone.reset();
    thing.seen = std::max(thing.seen, tracked.seen);
    const auto day = tracked.days.front().day;
    if (std::ranges::find(thing.days, day, &DayScans::day) == thing.days.end()) tracker::AddScans({day, 1}, thing.days);
  }
  for (auto& [id, thing] : seen) process.kept[id].what = std::move(thing);
  process.tracked.clear();
}

std::vector<MapMerge::Account> MapMerge::Accounts() {
  std::vector<Account> accounts;
  std::size_t number = 0;
  for (auto& [begin, process] : processes_) {
    AddTracked(process);
    for (const auto& [id, given] : process.given) {
      if (!process.kept.contains(id)) accounts.push_back({number, given, given.days, {}});
    }
    for (const auto& [id, told] : process.kept) {
      Account account{number, told.what, {}, told.what.days};
      if (const auto given = process.given.find(id); given != process.given.end()) {
        account.given = given->second.days;
        account.thing.first = std::min(account.thing.first, given->second.first);
      }
      accounts.push_back(std::move(account));
    }
    ++number;
  }
  // The order of what follows depends on what is told, not on ids.
  std::ranges::sort(accounts, {}, [](const Account& one) { return std::tuple(one.thing.latitude_deg, one.thing.longitude_deg, one.process); });
  return accounts;
}

std::vector<MapThing> MapMerge::Things() {
  const auto accounts = Accounts();
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < accounts.size(); ++i) {
    for (std::size_t k = i + 1; k < accounts.size(); ++k) {
      const auto& [one, other] = std::tie(accounts[i].thing, accounts[k].thing);
      if (other.latitude_deg - one.latitude_deg > kMostPairM / kLeastDegM) break;
      if (accounts[i].process == accounts[k].process) continue;
      const double apart_m = ApartM(one, other);
      if (AreOnePlace(one, other, apart_m)) pairs.emplace_back(apart_m, i, k);
    }
  }
  std::ranges::sort(pairs);
  std::vector<std::size_t> group_of(accounts.size());
  std::iota(group_of.begin(), group_of.end(), std::size_t{0});
  std::vector<std::vector<std::size_t>> members(accounts.size());
  for (std::size_t i = 0; i < accounts.size(); ++i) members[i] = {i};
  for (const auto& [apart_m, i, k] : pairs) {
    const auto one = std::min(group_of[i], group_of[k]);
    const auto other = std::max(group_of[i], group_of[k]);
    if (one == other) continue;
    const auto have_one_process = std::ranges::any_of(members[one], [&](std::size_t a) {
      return std::ranges::any_of(members[other], [&](std::size_t b) { return accounts[a].process == accounts[b].process; });
    });
    if (have_one_process) continue;
    for (const auto member : members[other]) group_of[member] = one;
    members[one].insert(members[one].end(), members[other].begin(), members[other].end());
    members[other].clear();
  }

  std::vector<MapThing> things;
  for (const auto& group : members) {
    if (group.empty()) continue;
    const auto newest = *std::ranges::max_element(group, {}, [&](std::size_t i) {
      const auto& thing = accounts[i].thing;
      return std::tuple(thing.seen, -thing.deviation_m, accounts[i].process);
    });
    MapThing thing = accounts[newest].thing;
    thing.state = MapThing::State::kUnseen;
    thing.gone.reset();
    thing.days.clear();
    std::map<std::int32_t, std::pair<std::int64_t, std::int64_t>> days;  // as given, as seen
    std::optional<Utime> gone;
    for (const auto i : group) {
      const auto& account = accounts[i];
      thing.first = std::min(thing.first, account.thing.first);
      if (account.thing.gone && (!gone || *gone < *account.thing.gone)) gone = account.thing.gone;
      for (const auto& day : account.given) days[day.day].first = std::max<std::int64_t>(days[day.day].first, day.num_scans);
      for (const auto& day : account.own) days[day.day].second += day.num_scans;
    }
    if (gone && *gone >= thing.seen) thing.gone = gone;
    for (const auto& [day, scans] : days) {
      const auto num_scans = std::min<std::int64_t>(std::max(scans.first, scans.second), tracker::kMostDayScans);
      tracker::AddScans({day, static_cast<std::int32_t>(num_scans)}, thing.days);
    }
    things.push_back(std::move(thing));
  }
  std::erase_if(things, [](const MapThing& thing) { return thing.days.empty(); });
  if (things.size() > tracker::kMostMapThings) {
    num_things_left_out_ = std::ssize(things) - static_cast<std::int64_t>(tracker::kMostMapThings);
    std::ranges::sort(things, IsOlder);
    things.erase(things.begin(), things.begin() + num_things_left_out_);
  }
  std::ranges::sort(things, {},
                    [](const MapThing& thing) { return std::tuple(thing.latitude_deg, thing.longitude_deg, thing.seen, thing.length_m); });
  for (std::size_t i = 0; i < things.size(); ++i) things[i].id = static_cast<std::int64_t>(i) + 1;
  return things;
}

std::vector<MapLand> MapMerge::Land() {
  namespace grid = tracker::earth_grid;
  constexpr double kCellM = tracker::LandMemory::kCellM;
  std::map<grid::Cell, CellDays> cells;
  const auto add = [&cells](const grid::Cell& cell, const MapLand& land) {
    auto& [days, seen] = cells[cell];
    for (const auto day : land.days) tracker::AddDay(day, days);
    seen = std::max(seen, land.seen);
  };
  for (const auto& [begin, process] : processes_) {
    for (const auto& land : process.given_land) {
      for (const auto index : land.cells) add({land.tile, index}, land);
    }
    std::optional<std::pair<Datum, LocalFrame>> map;
    for (const auto& [key, told] : process.land) {
      const auto& [land, datum, water_up_m] = told.what;
      if (!map || !map->first.IsSameAs(datum)) map.emplace(datum, datum.Map());
      for (const auto index : land.cells) {
        const std::int32_t east = land.tile.east * tracker::kTileCells + index % tracker::kTileCells;
        const std::int32_t north = land.tile.north * tracker::kTileCells + index / tracker::kTileCells;
        const Eigen::Vector3d middle_m(kCellM * (east + 0.5), kCellM * (north + 0.5), water_up_m);
        const auto place = map->second.Reverse(middle_m);
        add(grid::CellAt(place.latitude_deg, place.longitude_deg), land);
      }
    }
  }
  std::map<std::pair<tracker::MapTile, std::vector<std::int32_t>>, MapLand> tiles;
  for (auto& [cell, one] : cells) {
    auto& [days, seen] = one;
    auto& land = tiles[{cell.tile, days}];
    land.tile = cell.tile;
    land.days = days;
    land.seen = std::max(land.seen, seen);
    land.cells.push_back(cell.index);
  }
  std::vector<MapLand> land;
  std::size_t num_cells = 0;
  for (auto& [key, tile] : tiles) {
    num_cells += tile.cells.size();
    land.push_back(std::move(tile));
  }
  if (num_cells > tracker::kMostMapCells || land.size() > tracker::kMostMapTiles) {
    std::ranges::stable_sort(land, std::ranges::greater(), &MapLand::seen);
    while (num_cells > tracker::kMostMapCells || land.size() > tracker::kMostMapTiles) {
      num_cells -= land.back().cells.size();
      num_cells_left_out_ += std::ssize(land.back().cells);
      land.pop_back();
    }
    std::ranges::stable_sort(land, {}, [](const MapLand& one) { return std::tie(one.tile, one.days); });
  }
  return land;
}

tracker::OwnMap MapMerge::Merged() {
  num_things_left_out_ = num_cells_left_out_ = 0;
  tracker::OwnMap map{.things = Things(), .land = Land()};
  for (auto& thing : map.things) thing.first = std::min(thing.first, thing.seen);
  // A file that is larger is refused: then the oldest land is left out, a tenth at a time.
  while (tracker::MapText(map).size() > tracker::kMaxMapBytes && !map.land.empty()) {
    std::ranges::stable_sort(map.land, std::ranges::greater(), &MapLand::seen);
    for (auto i = std::max<std::size_t>(1, map.land.size() / 10); i > 0; --i) {
      num_cells_left_out_ += std::ssize(map.land.back().cells);
      map.land.pop_back();
    }
    std::ranges::stable_sort(map.land, {}, [](const MapLand& one) { return std::tie(one.tile, one.days); });
  }
  return map;
}

}  // namespace lookout::exporter
