#include "tools/export/map_merge.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>
#include <tuple>

#include "services/tracker/core/land.hpp"
#include "tools/export/map_geometry.hpp"
#include "tools/export/own_map_text.hpp"

namespace lookout::exporter {

namespace {

constexpr double kMostPairM = 5.0;  // more than SamePlaceM ever is
constexpr double kLeastDegM = 110'000.0;
constexpr double kLandForS = 10.0;
constexpr double kDegPerNanodeg = 1e-9;
constexpr std::chrono::seconds kIsOver(60);      // a process that was not heard for so long before another begins
constexpr std::size_t kMostProcesses = 16;       // at a time
constexpr double kMostLandPlaceM = 1'000'000.0;  // from the datum

double ApartM(const MapThing& one, const MapThing& other) {
  const LocalFrame here({one.latitude_deg, one.longitude_deg, 0.0});
  return here.Forward({other.latitude_deg, other.longitude_deg, 0.0}).head<2>().norm();
}

bool AreOnePlace(const MapThing& one, const MapThing& other, double apart_m) {
  return apart_m <= SamePlaceM(one.deviation_m, other.deviation_m) && AreOfOneThing(one.length_m, other.length_m);
}

// By when it was last seen; gone things before the others.
bool IsOlder(const MapThing& one, const MapThing& other) {
  return std::tuple(!one.gone, one.seen, one.latitude_deg, one.longitude_deg) <
         std::tuple(!other.gone, other.seen, other.latitude_deg, other.longitude_deg);
}

// The last sighting gives place and look.
MapThing Joined(MapThing older, MapThing newer) {
  if (older.seen > newer.seen) std::swap(older, newer);
  newer.first = std::min(newer.first, older.first);
  std::map<std::int32_t, std::int64_t> scans;
  for (const auto* thing : {&older, &newer}) {
    for (const auto& day : thing->days) scans[day.day] += day.num_scans;
  }
  if (!newer.gone && older.gone && *older.gone > newer.seen) newer.gone = older.gone;
  newer.days.clear();
  for (const auto& [day, num] : scans) AddScans({day, static_cast<std::int32_t>(std::min<std::int64_t>(num, kMostDayScans))}, newer.days);
  return newer;
}

}  // namespace

void MapMerge::Add(const tracker::ScanKey& begin, const StandingScan& scan, const tracker::Sight* sight) {
  auto process = processes_.find(begin);
  if (process == processes_.end()) {
    EndProcessesBefore(scan.time - kIsOver);
    process = processes_.emplace(begin, Process{StandingThings(things_), scan.end_time}).first;
  }
  process->second.standing.Update(scan, sight);
  process->second.last = scan.end_time;
}

void MapMerge::EndProcessesBefore(Utime time) {
  for (auto process = processes_.begin(); process != processes_.end();) {
    if (process->second.last >= time && processes_.size() < kMostProcesses) {
      ++process;
    } else {
      Join(process->second.standing);
      process = processes_.erase(process);
    }
  }
}

void MapMerge::Join(const StandingThings& process) {
  for (const auto& [number, time] : process.GivenGone()) {
    const auto found = things_.find(number);
    if (found != things_.end() && !found->second.gone && found->second.seen <= time) found->second.gone = time;
  }
  JoinSeen(process.Seen());
  num_over_limit_ += process.num_over_limit();
  if (things_.size() <= kMostMapThings) return;
  std::vector<std::map<std::int64_t, MapThing>::iterator> oldest;
  oldest.reserve(things_.size());
  for (auto thing = things_.begin(); thing != things_.end(); ++thing) oldest.push_back(thing);
  std::ranges::sort(oldest, IsOlder, [](const auto& thing) -> const MapThing& { return thing->second; });
  oldest.resize(things_.size() - kMostMapThings);
  for (const auto& thing : oldest) things_.erase(thing);
  num_things_left_out_ += std::ssize(oldest);
}

void MapMerge::JoinSeen(std::vector<MapThing> seen) {
  std::vector<std::pair<double, std::int64_t>> by_latitude;
  by_latitude.reserve(things_.size());
  for (const auto& [number, thing] : things_) by_latitude.emplace_back(thing.latitude_deg, number);
  std::ranges::sort(by_latitude);
  std::vector<std::tuple<double, std::int64_t, std::size_t>> pairs;  // distance, number, index of the seen thing
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const double reach_deg = kMostPairM / kLeastDegM;
    for (auto near = std::ranges::lower_bound(by_latitude, std::pair(seen[i].latitude_deg - reach_deg, std::int64_t{0}));
         near != by_latitude.end() && near->first <= seen[i].latitude_deg + reach_deg; ++near) {
      const auto& thing = things_.at(near->second);
      const double apart_m = ApartM(thing, seen[i]);
      if (AreOnePlace(thing, seen[i], apart_m)) pairs.emplace_back(apart_m, near->second, i);
    }
  }
  std::ranges::sort(pairs);
  std::set<std::int64_t> used;
  std::vector<bool> is_joined(seen.size());
  for (const auto& [apart_m, number, i] : pairs) {
    if (is_joined[i] || used.contains(number)) continue;
    used.insert(number);
    is_joined[i] = true;
    auto& thing = things_.at(number);
    thing = Joined(std::move(thing), std::move(seen[i]));
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!is_joined[i]) things_.emplace(next_number_++, std::move(seen[i]));
  }
}

void MapMerge::AddLand(Utime time, const Datum& datum, std::span<const Eigen::Vector2d> middles_m) {
  constexpr double kCellM = tracker::LandMemory::kCellM;
  auto of = std::ranges::find_if(land_, [&datum](const auto& one) { return one.first.IsSameAs(datum); });
  if (of == land_.end()) of = land_.insert(land_.end(), {datum, {}});
  for (const auto& middle_m : middles_m) {
    if (!(middle_m.cwiseAbs().maxCoeff() <= kMostLandPlaceM)) continue;
    const Cell cell(static_cast<std::int32_t>(std::floor(middle_m.x() / kCellM)), static_cast<std::int32_t>(std::floor(middle_m.y() / kCellM)));
    const auto [place, is_new] = of->second.try_emplace(cell, ToldCell{time, time, {}});
    auto& told = place->second;
    if (DayOf(time) != DayOf(told.seen)) told.first = time;
    told.seen = std::max(told.seen, time);
    if (ToSeconds(time - told.first) >= kLandForS) AddDay(DayOf(time), told.days);
  }
}

std::vector<MapLand> MapMerge::Land() {
  constexpr double kCellM = tracker::LandMemory::kCellM;
  std::map<earth_grid::Cell, std::pair<std::vector<std::int32_t>, Utime>> cells;  // days, and seen last
  for (const auto& [datum, told_cells] : land_) {
    const double height_m = std::isnan(datum.ellipsoid_height_m) ? 0.0 : datum.ellipsoid_height_m;
    const MapOfDatum map({datum.latitude_deg, datum.longitude_deg, height_m});
    for (const auto& [cell, told] : told_cells) {
      if (told.days.empty()) continue;
      const auto place = map.PlaceAt({kCellM * (cell.first + 0.5), kCellM * (cell.second + 0.5)});
      auto& [days, seen] = cells[earth_grid::CellAt(kDegPerNanodeg * static_cast<double>(place.latitude_ndeg),
                                                    kDegPerNanodeg * static_cast<double>(place.longitude_ndeg))];
      for (const auto day : told.days) AddDay(day, days);
      seen = std::max(seen, told.seen);
    }
  }
  std::map<std::pair<MapTile, std::vector<std::int32_t>>, MapLand> tiles;
  for (const auto& [cell, one] : cells) {
    const auto& [days, seen] = one;
    auto& land = tiles[{cell.tile, days}];
    land.tile = cell.tile;
    land.days = days;
    land.seen = std::max(land.seen, seen);
    land.cells.push_back(cell.index);
  }
  std::vector<MapLand> land;
  land.reserve(tiles.size());
  for (auto& [key, tile] : tiles) land.push_back(std::move(tile));
  return land;
}

// The longest unseen.
void MapMerge::LeaveOutLand(std::size_t num_tiles, std::vector<MapLand>& land) {
  std::ranges::stable_sort(land, std::ranges::greater(), &MapLand::seen);
  for (; num_tiles > 0; --num_tiles) {
    num_cells_left_out_ += std::ssize(land.back().cells);
    land.pop_back();
  }
  std::ranges::stable_sort(land, {}, [](const MapLand& one) { return std::tie(one.tile, one.days); });
}

OwnMap MapMerge::Merged() {
  for (const auto& [begin, process] : processes_) Join(process.standing);
  processes_.clear();
  OwnMap map;
  map.things.reserve(things_.size());
  for (const auto& [number, thing] : things_) map.things.push_back(thing);
  std::ranges::sort(map.things, {},
                    [](const MapThing& thing) { return std::tuple(thing.latitude_deg, thing.longitude_deg, thing.seen, thing.length_m); });
  map.land = Land();
  const auto is_too_large = [&map] {
    std::size_t num_cells = 0;
    for (const auto& land : map.land) num_cells += land.cells.size();
    return num_cells > kMostMapCells || map.land.size() > kMostMapTiles || MapText(map).size() > kMaxMapBytes;
  };
  // A tenth at a time.
  while (!map.land.empty() && is_too_large()) LeaveOutLand(std::max<std::size_t>(1, map.land.size() / 10), map.land);
  return map;
}

}  // namespace lookout::exporter
