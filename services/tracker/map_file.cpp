#include "services/tracker/map_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::tracker {

namespace {

using nlohmann::json;

constexpr std::array<std::pair<TrackKind, std::string_view>, 5> kKinds{{{TrackKind::kObstacle, "obstacle"},
                                                                        {TrackKind::kBuoy, "buoy"},
                                                                        {TrackKind::kBoat, "boat"},
                                                                        {TrackKind::kStructure, "structure"},
                                                                        {TrackKind::kUnknown, "unknown"}}};

// No "-0.000".
std::string Fixed(double value, int decimals) {
  auto text = fmt::format("{:.{}f}", value, decimals);
  if (text.starts_with('-') && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return text;
}

// 0.1 mm.
std::string PlaceText(const GeodeticPlace& place) { return fmt::format("[{},{}]", Fixed(place.longitude_deg, 9), Fixed(place.latitude_deg, 9)); }

std::string GeometryOf(const MapThing& thing) {
  const LocalFrame here({thing.latitude_deg, thing.longitude_deg, 0.0});
  std::string text;
  for (const auto& corner_m : thing.outline_m) text += (text.empty() ? "" : ",") + PlaceText(here.Reverse({corner_m.x(), corner_m.y(), 0.0}));
  if (thing.outline_m.size() == 1) return R"({"type":"Point","coordinates":)" + text + "}";
  if (thing.outline_m.size() == 2) return R"({"type":"LineString","coordinates":[)" + text + "]}";
  const auto& first_m = thing.outline_m.front();
  return R"({"type":"Polygon","coordinates":[[)" + text + "," + PlaceText(here.Reverse({first_m.x(), first_m.y(), 0.0})) + "]]}";
}

std::string FeatureOf(const MapThing& thing) {
  std::int64_t num_scans = 0;
  std::string scans_by_day;
  for (const auto& day : thing.days) {
    num_scans += day.num_scans;
    scans_by_day += fmt::format("{}\"{}\":{}", scans_by_day.empty() ? "" : ",", MapDayText(day.day), day.num_scans);
  }
  auto bearing_deg = Fixed(RadToDeg(thing.length_bearing_rad), 2);
  if (bearing_deg == "180.00") bearing_deg = "0.00";
  const auto* const kind = std::ranges::find(kKinds, thing.kind, &std::pair<TrackKind, std::string_view>::first);
  return fmt::format(
      R"({{"type":"Feature","geometry":{},"properties":{{"type":"thing","kind":"{}","latitude_deg":{},"longitude_deg":{},"deviation_m":{},)"
      R"("length_m":{},"width_m":{},"length_bearing_deg":{},"top_above_water_m":{},"first_seen":"{}","last_seen":"{}","gone":{},"gone_since":{},)"
      R"("days":{},"known":{},"scans":{},"scans_by_day":{{{}}}}}}})",
      GeometryOf(thing), kind->second, Fixed(thing.latitude_deg, 9), Fixed(thing.longitude_deg, 9), Fixed(thing.deviation_m, 3),
      Fixed(thing.length_m, 3), Fixed(thing.width_m, 3), bearing_deg, Fixed(thing.top_above_water_m, 3), MapTimeText(thing.first),
      MapTimeText(thing.seen), thing.gone ? "true" : "false", thing.gone ? '"' + MapTimeText(*thing.gone) + '"' : "null", thing.days.size(),
      std::cmp_greater_equal(thing.days.size(), kKnownDays), num_scans, scans_by_day);
}

std::string FeatureOf(const MapLand& land) {
  std::string cells;
  for (const auto index : land.cells) {
    // 1 cm, of cells of half a metre.
    const auto place = earth_grid::MiddleOf({land.tile, index});
    cells += fmt::format("{}[{},{}]", cells.empty() ? "" : ",", Fixed(place.longitude_deg, 7), Fixed(place.latitude_deg, 7));
  }
  std::string days;
  for (const auto day : land.days) days += fmt::format("{}\"{}\"", days.empty() ? "" : ",", MapDayText(day));
  return fmt::format(
      R"({{"type":"Feature","geometry":{{"type":"MultiPoint","coordinates":[{}]}},"properties":{{"type":"land","cells":{},"last_seen":"{}",)"
      R"("days":{},"seen_on":[{}]}}}})",
      cells, land.cells.size(), MapTimeText(land.seen), land.days.size(), days);
}

std::optional<int> Digits(std::string_view text) {
  int value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || !std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; }) || result.ec != std::errc()) return std::nullopt;
  return value;
}

std::optional<std::int32_t> ToDay(std::string_view text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  const auto year = Digits(text.substr(0, 4));
  const auto month = Digits(text.substr(5, 2));
  const auto day = Digits(text.substr(8, 2));
  if (!year || !month || !day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;
  const auto number = static_cast<std::int32_t>(std::chrono::sys_days(date).time_since_epoch().count());
  if (number < kLeastMapDay || number > kMostMapDay) return std::nullopt;
  return number;
}

std::optional<Utime> ToTime(std::string_view text) {
  if (text.size() != 20 || text[10] != 'T' || text[13] != ':' || text[16] != ':' || text[19] != 'Z') return std::nullopt;
  const auto day = ToDay(text.substr(0, 10));
  const auto hour = Digits(text.substr(11, 2));
  const auto minute = Digits(text.substr(14, 2));
  const auto second = Digits(text.substr(17, 2));
  if (!day || !hour || !minute || !second || *hour > 23 || *minute > 59 || *second > 59) return std::nullopt;
  return std::chrono::sys_days(std::chrono::days(*day)) + std::chrono::hours(*hour) + std::chrono::minutes(*minute) + std::chrono::seconds(*second);
}

// One feature, which is named where something is wrong with it.
class Feature {
 public:
  Feature(const json& feature, std::size_t number) : number_(number) {
    if (!feature.is_object() || feature.value("type", json()) != "Feature") Refuse("type", "must be Feature");
    geometry_ = Object(feature, "geometry");
    properties_ = Object(feature, "properties");
  }

  [[noreturn]] void Refuse(std::string_view what, std::string_view why) const {
    throw MapFileError(fmt::format("feature {}: {}: {}", number_, what, why));
  }

  const json& Get(const char* name) const {
    const auto found = properties_->find(name);
    if (found == properties_->end()) Refuse(name, "is missing");
    return *found;
  }
  std::string_view Text(const char* name) const {
    const auto& value = Get(name);
    if (!value.is_string()) Refuse(name, "must be a text");
    return value.get_ref<const std::string&>();
  }
  double Number(const char* name, double least, double most) const {
    const auto& value = Get(name);
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(number >= least && number <= most)) Refuse(name, fmt::format("must be a number from {} to {}", least, most));
    return number;
  }
  Utime Time(const char* name) const {
    const auto time = ToTime(Text(name));
    if (!time) Refuse(name, "must be a time as 2026-11-23T13:45:01Z, of 1900 to 2199");
    return *time;
  }
  std::int32_t Day(const char* name, std::string_view text) const {
    const auto day = ToDay(text);
    if (!day) Refuse(name, "must have days as 2026-11-23, of 1900 to 2199");
    return *day;
  }

  /// Places of an array of at most `most`.
  std::vector<GeodeticPlace> Places(const json& list, std::size_t most) const {
    if (!list.is_array() || list.empty() || list.size() > most) Refuse("coordinates", fmt::format("must hold 1 to {} places", most));
    std::vector<GeodeticPlace> places;
    places.reserve(list.size());
    for (const auto& one : list) {
      const bool is_place = one.is_array() && one.size() >= 2 && one[0].is_number() && one[1].is_number();
      const GeodeticPlace place{is_place ? one[1].get<double>() : std::nan(""), is_place ? one[0].get<double>() : std::nan(""), 0.0};
      if (!(std::abs(place.latitude_deg) <= 90.0 && std::abs(place.longitude_deg) <= 180.0)) {
        Refuse("coordinates", "each must be [longitude, latitude] in degrees");
      }
      places.push_back(place);
    }
    return places;
  }
  std::vector<GeodeticPlace> Outline() const {
    const auto type = geometry_->value("type", json());
    const auto coordinates = geometry_->find("coordinates");
    if (coordinates == geometry_->end()) Refuse("coordinates", "are missing");
    if (type == "Point") return Places(json::array({*coordinates}), 1);
    if (type == "LineString") return Places(*coordinates, 2);
    if (type != "Polygon") Refuse("geometry", "must be a Polygon, a LineString or a Point");
    if (!coordinates->is_array() || coordinates->size() != 1) Refuse("coordinates", "must be one ring, without holes");
    auto ring = Places(coordinates->front(), kMostMapOutline + 1);
    ring.pop_back();  // the first again
    if (ring.size() < 3) Refuse("coordinates", "a ring has three corners or more");
    return ring;
  }
  std::vector<GeodeticPlace> Cells(std::size_t most) const {
    if (geometry_->value("type", json()) != "MultiPoint") Refuse("geometry", "must be a MultiPoint");
    const auto coordinates = geometry_->find("coordinates");
    if (coordinates == geometry_->end()) Refuse("coordinates", "are missing");
    return Places(*coordinates, most);
  }

 private:
  const json* Object(const json& feature, const char* name) const {
    const auto found = feature.find(name);
    if (found == feature.end() || !found->is_object()) Refuse(name, "is missing");
    return &*found;
  }

  std::size_t number_;
  const json* geometry_ = nullptr;
  const json* properties_ = nullptr;
};

MapThing ToThing(const Feature& feature, std::int64_t id) {
  MapThing thing;
  thing.id = id;
  const auto kind = std::ranges::find(kKinds, feature.Text("kind"), &std::pair<TrackKind, std::string_view>::second);
  if (kind == kKinds.end()) feature.Refuse("kind", "must be obstacle, buoy, boat, structure or unknown");
  thing.kind = kind->first;
  thing.latitude_deg = feature.Number("latitude_deg", -90.0, 90.0);
  thing.longitude_deg = feature.Number("longitude_deg", -180.0, 180.0);
  thing.deviation_m = feature.Number("deviation_m", 0.0, kMostMapThingM);
  thing.length_m = feature.Number("length_m", 0.0, kMostMapThingM);
  thing.width_m = feature.Number("width_m", 0.0, kMostMapThingM);
  thing.length_bearing_rad = DegToRad(feature.Number("length_bearing_deg", 0.0, 180.0));
  thing.top_above_water_m = feature.Number("top_above_water_m", -kMostMapThingM, kMostMapThingM);
  thing.first = feature.Time("first_seen");
  thing.seen = feature.Time("last_seen");
  if (thing.seen < thing.first) feature.Refuse("last_seen", "is before first_seen");
  if (!feature.Get("gone_since").is_null()) thing.gone = feature.Time("gone_since");

  const auto& scans_by_day = feature.Get("scans_by_day");
  if (!scans_by_day.is_object() || scans_by_day.empty() || scans_by_day.size() > kMostMapDays) {
    feature.Refuse("scans_by_day", fmt::format("must hold 1 to {} days", kMostMapDays));
  }
  for (const auto& [day, count] : scans_by_day.items()) {
    if (!count.is_number_integer() || count < 0 || count > kMostDayScans) feature.Refuse("scans_by_day", "must be counts of scans");
    AddScans({feature.Day("scans_by_day", day), count.get<std::int32_t>()}, thing.days);
  }

  const LocalFrame here({thing.latitude_deg, thing.longitude_deg, 0.0});
  constexpr double kMostCornerM = 1.5 * kMostMapThingM;  // each of east and north is at most that on the wire
  for (const auto& corner : feature.Outline()) {
    const Eigen::Vector2d corner_m = here.Forward(corner).head<2>();
    if (!(corner_m.norm() <= kMostCornerM)) feature.Refuse("coordinates", "lie farther than 1.5 km from latitude_deg and longitude_deg");
    thing.outline_m.push_back(corner_m);
  }
  return thing;
}

void AddLand(const Feature& feature, std::size_t most_cells, std::vector<MapLand>& land) {
  MapLand each;
  each.seen = feature.Time("last_seen");
  const auto& seen_on = feature.Get("seen_on");
  if (!seen_on.is_array() || seen_on.empty() || seen_on.size() > kMostMapDays) {
    feature.Refuse("seen_on", fmt::format("must hold 1 to {} days", kMostMapDays));
  }
  for (const auto& day : seen_on) AddDay(feature.Day("seen_on", day.is_string() ? day.get_ref<const std::string&>() : ""), each.days);
  std::map<MapTile, std::vector<std::int16_t>> cells;
  for (const auto& place : feature.Cells(most_cells)) {
    const auto cell = earth_grid::CellAt(place.latitude_deg, place.longitude_deg);
    cells[cell.tile].push_back(cell.index);
  }
  for (auto& [tile, indexes] : cells) {
    std::ranges::sort(indexes);
    indexes.erase(std::unique(indexes.begin(), indexes.end()), indexes.end());
    each.tile = tile;
    each.cells = std::move(indexes);
    land.push_back(each);
  }
}

json ToJson(std::string_view text) {
  // Else a file of brackets takes a hundred times its size.
  constexpr int kMostDepth = 12;
  constexpr std::size_t kMostValues = 4'000'000;
  std::size_t num_values = 0;
  const auto check = [&](int depth, json::parse_event_t event, const json& /*parsed*/) {
    if (event != json::parse_event_t::key && event != json::parse_event_t::object_end && event != json::parse_event_t::array_end) ++num_values;
    if (depth > kMostDepth || num_values > kMostValues) throw MapFileError("is nested too deep, or holds too many values");
    return true;
  };
  try {
    return json::parse(text, check);
  } catch (const json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    throw MapFileError(fmt::format("line {}: is no JSON", 1 + std::count(text.begin(), end, '\n')));
  } catch (const json::exception&) {  // it names no line
    throw MapFileError("holds a number that is too large");
  }
}

}  // namespace

std::string MapDayText(std::int32_t day) {
  const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::days(day))};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

std::string MapTimeText(Utime time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const std::chrono::hh_mm_ss clock(seconds - std::chrono::floor<std::chrono::days>(seconds));
  return fmt::format("{}T{:02}:{:02}:{:02}Z", MapDayText(DayOf(time)), clock.hours().count(), clock.minutes().count(), clock.seconds().count());
}

std::string MapText(const OwnMap& map) {
  std::string text = R"({"type":"FeatureCollection","lookout_map":1,"features":[)";
  std::string_view separator = "\n";
  const auto add = [&](const auto& one) {
    text += separator;
    text += FeatureOf(one);
    separator = ",\n";
  };
  for (const auto& thing : map.things) add(thing);
  for (const auto& land : map.land) add(land);
  return text + "\n]}\n";
}

OwnMap ParseMap(std::string_view text) {
  if (text.size() > kMaxMapBytes) throw MapFileError("has more than 32 MB");
  const auto root = ToJson(text);
  if (!root.is_object() || root.value("type", json()) != "FeatureCollection" || root.value("lookout_map", json()) != 1) {
    throw MapFileError("is no map of lookout-export: a FeatureCollection with \"lookout_map\": 1");
  }
  const auto features = root.find("features");
  if (features == root.end() || !features->is_array()) throw MapFileError("has no features");
  OwnMap map;
  std::size_t num_cells = 0;
  for (std::size_t i = 0; i < features->size(); ++i) {
    const Feature feature((*features)[i], i + 1);
    const auto type = feature.Text("type");
    if (type == "thing") {
      if (map.things.size() == kMostMapThings) throw MapFileError(fmt::format("has more than {} things", kMostMapThings));
      map.things.push_back(ToThing(feature, std::ssize(map.things) + 1));
    } else if (type == "land") {
      const auto before = map.land.size();
      AddLand(feature, kMostMapCells, map.land);
      for (auto land = before; land < map.land.size(); ++land) num_cells += map.land[land].cells.size();
      if (num_cells > kMostMapCells) throw MapFileError(fmt::format("has more than {} cells of land", kMostMapCells));
      if (map.land.size() > kMostMapTiles) throw MapFileError(fmt::format("has land in more than {} tiles", kMostMapTiles));
    } else {
      feature.Refuse("type", "must be thing or land");
    }
  }
  return map;
}

OwnMap ReadMapFile(const std::filesystem::path& file) try {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw MapFileError("is no file that can be read");
  if (std::filesystem::file_size(file, error) > kMaxMapBytes || error) throw MapFileError("has more than 32 MB");
  std::ifstream input(file, std::ios::binary);
  std::string text(kMaxMapBytes + 1, '\0');
  input.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!input.is_open() || input.bad()) throw MapFileError("cannot be read");
  text.resize(static_cast<std::size_t>(input.gcount()));
  return ParseMap(text);
} catch (const MapFileError& error) {
  throw MapFileError("'" + file.string() + "' " + error.what());
}

}  // namespace lookout::tracker
