#include "tools/archive/comparison.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/core/angles.hpp"
#include "common/core/printable.hpp"
#include "tools/archive/csv_reader.hpp"

namespace lookout::archive {

namespace {

namespace fs = std::filesystem;

constexpr double kSameTrackM = 3;
constexpr double kSameObstacleM = 2;
constexpr std::int64_t kSameAlertUs = 2'000'000;

// Latitude and longitude in degrees; or, where a look-out did not know the earth, east and north in metres of its map.
struct Place {
  double first = 0;
  double second = 0;
  bool is_relative = false;
};

// The columns of a place in a table of obstacles or tracks. A table may lack the columns of the map.
class PlaceColumns {
 public:
  explicit PlaceColumns(const CsvReader& reader) : latitude_(reader.Place("latitude_deg")), longitude_(reader.Place("longitude_deg")) {
    const auto& header = reader.header();
    const auto east = std::ranges::find(header, "east_m");
    const auto north = std::ranges::find(header, "north_m");
    if (east == header.end() || north == header.end()) return;
    east_ = static_cast<std::size_t>(east - header.begin());
    north_ = static_cast<std::size_t>(north - header.begin());
  }

  // @return nullopt: it has no place at all
  std::optional<Place> Of(const CsvReader::Row& row) const {
    const auto latitude_deg = NumberOf(row[latitude_]);
    const auto longitude_deg = NumberOf(row[longitude_]);
    if (latitude_deg && longitude_deg) return Place{*latitude_deg, *longitude_deg, false};
    if (!east_ || !north_) return std::nullopt;
    const auto east_m = NumberOf(row[*east_]);
    const auto north_m = NumberOf(row[*north_]);
    if (!east_m || !north_m) return std::nullopt;
    return Place{*east_m, *north_m, true};
  }

 private:
  std::size_t latitude_;
  std::size_t longitude_;
  std::optional<std::size_t> east_;
  std::optional<std::size_t> north_;
};

// Metres on a sphere or in the map, of points that are near each other. For counting pairs: 0.5 % do not matter. A place on the earth and one that is
// not are never near.
double DistanceM(const Place& a, const Place& b) {
  if (a.is_relative != b.is_relative) return std::numeric_limits<double>::infinity();
  if (a.is_relative) return std::hypot(a.first - b.first, a.second - b.second);
  constexpr double kMetresPerDeg = 111'320;
  const double north_m = (a.first - b.first) * kMetresPerDeg;
  const double east_m = std::remainder(a.second - b.second, 360.0) * kMetresPerDeg * std::cos(DegToRad(a.first));
  return std::hypot(north_m, east_m);
}

std::int64_t Integer(const std::string& text) {
  std::int64_t value = 0;
  const auto* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) throw std::runtime_error("a table holds '" + Printable(text) + "' where a whole number belongs");
  return value;
}

struct ChannelTotal {
  std::int64_t count = 0;
  std::string digest;
};

std::map<std::string, ChannelTotal> Totals(const fs::path& folder) {
  CsvReader reader(folder / "channels.csv");
  const auto channel = reader.Place("channel");
  const auto count = reader.Place("count");
  const auto digest = reader.Place("sha256");
  std::map<std::string, ChannelTotal> totals;
  CsvReader::Row row;
  while (reader.Next(row)) totals[row[channel]] = {Integer(row[count]), row[digest]};
  return totals;
}

struct Hashed {
  std::int64_t utime_us = 0;
  std::string hash;
};

std::map<std::string, std::vector<Hashed>> Hashes(const fs::path& folder, const std::set<std::string>& channels) {
  CsvReader reader(folder / "messages.csv");
  const auto channel = reader.Place("channel");
  const auto utime_us = reader.Place("utime_us");
  const auto hash = reader.Place("xxh3");
  std::map<std::string, std::vector<Hashed>> hashes;
  CsvReader::Row row;
  while (reader.Next(row)) {
    if (channels.contains(row[channel])) hashes[row[channel]].push_back({Integer(row[utime_us]), row[hash]});
  }
  return hashes;
}

ChannelDifference DifferenceOf(const std::string& channel, const std::vector<Hashed>& a, const std::vector<Hashed>& b) {
  ChannelDifference difference;
  difference.channel = channel;
  difference.num_a = static_cast<std::int64_t>(a.size());
  difference.num_b = static_cast<std::int64_t>(b.size());
  const auto num_both = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    if (i < num_both && a[i].hash == b[i].hash) continue;
    if (difference.num_different++ > 0) continue;
    difference.first_number = static_cast<std::int64_t>(i);
    difference.first_utime_us = i < a.size() ? a[i].utime_us : b[i].utime_us;
  }
  return difference;
}

// A track in scans in which it is confirmed, or was and coasts.
struct TrackPlace {
  std::int64_t id = 0;
  Place place;
};
using Scans = std::map<std::int64_t, std::vector<TrackPlace>>;  // by time

struct Tracks {
  Scans scans;
  std::map<std::int64_t, std::int64_t> num_scans;  // by id
  std::map<std::int64_t, std::int64_t> first_us;
};

// None where there is no file.
Tracks ReadTracks(const fs::path& file) {
  if (!fs::exists(file)) return {};
  CsvReader reader(file);
  const auto utime_us = reader.Place("utime_us");
  const auto id = reader.Place("track_id");
  const PlaceColumns columns(reader);
  const auto status = reader.Place("status");
  Tracks tracks;
  CsvReader::Row row;
  while (reader.Next(row)) {
    const auto place = columns.Of(row);
    if (!place || (row[status] != "confirmed" && row[status] != "coasting")) continue;
    const auto time = Integer(row[utime_us]);
    const auto track = Integer(row[id]);
    tracks.scans[time].push_back({track, *place});
    ++tracks.num_scans[track];
    tracks.first_us.try_emplace(track, time);
  }
  return tracks;
}

// The sure obstacles of a scan, in the order of the file. Scans come in the order of time. None where there is no file.
class ObstacleScans {
 public:
  explicit ObstacleScans(const fs::path& file) {
    if (!fs::exists(file)) return;
    reader_.emplace(file);
    columns_.emplace(*reader_);
    utime_us_ = reader_->Place("scan_utime_us");
    confidence_ = reader_->Place("confidence");
    has_row_ = reader_->Next(row_);
  }

  // @return time of the next scan; nullopt: the end
  std::optional<std::int64_t> NextTime() const {
    if (!has_row_) return std::nullopt;
    return Integer(row_[utime_us_]);
  }

  std::vector<Place> NextScan() {
    std::vector<Place> places;
    const auto time = NextTime();
    while (has_row_ && NextTime() == time) {
      const auto place = columns_->Of(row_);
      if (row_[confidence_] == "sure" && place) places.push_back(*place);
      has_row_ = reader_->Next(row_);
    }
    return places;
  }

 private:
  std::optional<CsvReader> reader_;
  std::optional<PlaceColumns> columns_;
  std::size_t utime_us_ = 0;
  std::size_t confidence_ = 0;
  CsvReader::Row row_;
  bool has_row_ = false;
};

std::int64_t NumWithout(const std::vector<Place>& places, const std::vector<Place>& others) {
  return std::ranges::count_if(places, [&others](const Place& place) {
    return std::ranges::none_of(others, [&place](const Place& other) { return DistanceM(place, other) <= kSameObstacleM; });
  });
}

struct Alert {
  std::string cause;
  std::int64_t raised_us = 0;
};

std::vector<Alert> ReadAlerts(const fs::path& file) {
  CsvReader reader(file);
  const auto id = reader.Place("alert_id");
  const auto cause = reader.Place("cause");
  const auto raised = reader.Place("raised_utime_us");
  std::map<std::pair<std::int64_t, std::int64_t>, Alert> alerts;  // by time and number
  CsvReader::Row row;
  while (reader.Next(row)) {
    const auto time = Integer(row[raised]);
    alerts.try_emplace({time, Integer(row[id])}, Alert{row[cause], time});
  }
  std::vector<Alert> list;
  list.reserve(alerts.size());
  for (auto& [key, alert] : alerts) list.push_back(std::move(alert));
  return list;
}

// Figures that are numbers.
std::map<std::string, double> ReadTruth(const fs::path& file) {
  std::map<std::string, double> figures;
  if (!fs::exists(file)) return figures;
  CsvReader reader(file);
  const auto name = reader.Place("figure");
  const auto value = reader.Place("value");
  CsvReader::Row row;
  while (reader.Next(row)) {
    if (const auto number = NumberOf(row[value])) figures[row[name]] = *number;
  }
  return figures;
}

void KeepLeast(std::optional<std::int64_t>& least, std::int64_t value) { least = std::min(least.value_or(value), value); }

// Whether both results hold a table. A channel without messages has no file: its table counts as there, and is empty. A table that a version does not
// export is not there.
class SharedTables {
 public:
  SharedTables(const fs::path& a, const fs::path& b) : a_(a), b_(b), totals_a_(Totals(a)), totals_b_(Totals(b)) {}

  bool Holds(const std::string& file, const std::string& channel) const {
    const bool is_in_a = fs::exists(a_ / file);
    const bool is_in_b = fs::exists(b_ / file);
    return (is_in_a || is_in_b) && (is_in_a || IsWithout(totals_a_, channel)) && (is_in_b || IsWithout(totals_b_, channel));
  }

 private:
  using ByChannel = std::map<std::string, ChannelTotal>;
  static bool IsWithout(const ByChannel& totals, const std::string& channel) {
    const auto place = totals.find(channel);
    return place == totals.end() || place->second.count == 0;
  }

  const fs::path& a_;
  const fs::path& b_;
  ByChannel totals_a_;
  ByChannel totals_b_;
};

}  // namespace

std::vector<ChannelDifference> DifferingChannels(const fs::path& a, const fs::path& b) {
  const auto totals_a = Totals(a);
  const auto totals_b = Totals(b);
  std::set<std::string> channels;
  const auto add_differing = [&channels](const auto& some, const auto& others) {
    for (const auto& [channel, total] : some) {
      const auto other = others.find(channel);
      if (other == others.end() || other->second.count != total.count || other->second.digest != total.digest) channels.insert(channel);
    }
  };
  add_differing(totals_a, totals_b);
  add_differing(totals_b, totals_a);
  std::vector<ChannelDifference> differences;
  if (channels.empty()) return differences;
  auto hashes_a = Hashes(a, channels);
  auto hashes_b = Hashes(b, channels);
  for (const auto& known : bus::kChannels) {  // in the order of the data
    const std::string channel(known.name);
    if (!channels.contains(channel)) continue;
    auto difference = DifferenceOf(channel, hashes_a[channel], hashes_b[channel]);
    if (difference.num_a + difference.num_b > 0) differences.push_back(std::move(difference));
  }
  std::ranges::stable_sort(differences, {}, [](const ChannelDifference& one) { return one.first_utime_us.value_or(0); });
  return differences;
}

Balance CompareTracks(const fs::path& a, const fs::path& b, std::optional<std::int64_t>& first_us) {
  const auto tracks_a = ReadTracks(a);
  const auto tracks_b = ReadTracks(b);
  std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> together;  // scans
  for (const auto& [time, some] : tracks_a.scans) {
    const auto others = tracks_b.scans.find(time);
    if (others == tracks_b.scans.end()) continue;
    for (const auto& one : some) {
      for (const auto& other : others->second) {
        if (DistanceM(one.place, other.place) <= kSameTrackM) ++together[{one.id, other.id}];
      }
    }
  }
  std::set<std::int64_t> kept_a;
  std::set<std::int64_t> kept_b;
  for (const auto& [pair, num] : together) {
    if (2 * num < std::min(tracks_a.num_scans.at(pair.first), tracks_b.num_scans.at(pair.second))) continue;
    kept_a.insert(pair.first);
    kept_b.insert(pair.second);
  }
  Balance balance;
  balance.num_a = static_cast<std::int64_t>(tracks_a.num_scans.size());
  balance.num_b = static_cast<std::int64_t>(tracks_b.num_scans.size());
  balance.num_lost = balance.num_a - static_cast<std::int64_t>(kept_a.size());
  balance.num_gained = balance.num_b - static_cast<std::int64_t>(kept_b.size());
  for (const auto& [id, time] : tracks_a.first_us) {
    if (!kept_a.contains(id)) KeepLeast(first_us, time);
  }
  return balance;
}

Balance CompareObstacles(const fs::path& a, const fs::path& b) {
  ObstacleScans scans_a(a);
  ObstacleScans scans_b(b);
  Balance balance;
  for (;;) {
    const auto time_a = scans_a.NextTime();
    const auto time_b = scans_b.NextTime();
    if (!time_a && !time_b) return balance;
    std::vector<Place> places_a;
    std::vector<Place> places_b;
    if (time_a && (!time_b || *time_a <= *time_b)) places_a = scans_a.NextScan();
    if (time_b && (!time_a || *time_b <= *time_a)) places_b = scans_b.NextScan();
    balance.num_a += static_cast<std::int64_t>(places_a.size());
    balance.num_b += static_cast<std::int64_t>(places_b.size());
    balance.num_lost += NumWithout(places_a, places_b);
    balance.num_gained += NumWithout(places_b, places_a);
  }
}

Balance CompareAlerts(const fs::path& a, const fs::path& b, std::optional<std::int64_t>& first_us) {
  const auto alerts_a = fs::exists(a) ? ReadAlerts(a) : std::vector<Alert>();
  const auto alerts_b = fs::exists(b) ? ReadAlerts(b) : std::vector<Alert>();
  std::vector<bool> is_taken(alerts_b.size(), false);
  Balance balance{static_cast<std::int64_t>(alerts_a.size()), static_cast<std::int64_t>(alerts_b.size()), 0, 0};
  for (const auto& alert : alerts_a) {
    std::optional<std::size_t> nearest;
    const auto gap_us = [&](std::size_t i) { return std::abs(alerts_b[i].raised_us - alert.raised_us); };
    for (std::size_t i = 0; i < alerts_b.size(); ++i) {
      if (is_taken[i] || alerts_b[i].cause != alert.cause || gap_us(i) > kSameAlertUs) continue;
      if (!nearest || gap_us(i) < gap_us(*nearest)) nearest = i;
    }
    if (nearest) {
      is_taken[*nearest] = true;
    } else {
      ++balance.num_lost;
      KeepLeast(first_us, alert.raised_us);
    }
  }
  balance.num_gained = std::ranges::count(is_taken, false);
  return balance;
}

UnitComparison CompareUnit(const fs::path& a, const fs::path& b) {
  UnitComparison comparison;
  comparison.differences = DifferingChannels(a, b);
  const SharedTables shared(a, b);
  if (shared.Holds("tracks.csv", "TRACKS")) comparison.tracks = CompareTracks(a / "tracks.csv", b / "tracks.csv", comparison.first_lost_us);
  if (shared.Holds("obstacles.csv", "OBSTACLES")) comparison.obstacles = CompareObstacles(a / "obstacles.csv", b / "obstacles.csv");
  if (shared.Holds("alerts.csv", "ALERTS")) comparison.alerts = CompareAlerts(a / "alerts.csv", b / "alerts.csv", comparison.first_lost_us);
  comparison.truth_a = ReadTruth(a / "truth.csv");
  comparison.truth_b = ReadTruth(b / "truth.csv");
  return comparison;
}

}  // namespace lookout::archive
