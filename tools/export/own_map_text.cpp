#include "tools/export/own_map_text.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string_view>
#include <utility>

#include "common/core/angles.hpp"
#include "common/messages/words.hpp"

namespace lookout::exporter {

namespace {

// "2026-11-23"
std::string MapDayText(std::int32_t day) {
  const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::days(day))};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

// "2026-11-23T13:45:01Z", to the second, rounded down.
std::string MapTimeText(Utime time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const std::chrono::hh_mm_ss clock(seconds - std::chrono::floor<std::chrono::days>(seconds));
  return fmt::format("{}T{:02}:{:02}:{:02}Z", MapDayText(DayOf(time)), clock.hours().count(), clock.minutes().count(), clock.seconds().count());
}

// No "-0.000".
std::string FixedText(double value, int decimals) {
  auto text = fmt::format("{:.{}f}", value, decimals);
  if (text.starts_with('-') && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return text;
}

// 0.1 mm.
std::string PlaceText(const GeodeticPlace& place) {
  return fmt::format("[{},{}]", FixedText(place.longitude_deg, 9), FixedText(place.latitude_deg, 9));
}

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
  auto bearing_deg = FixedText(RadToDeg(thing.length_bearing_rad), 2);
  if (bearing_deg == "180.00") bearing_deg = "0.00";
  return fmt::format(
      R"({{"type":"Feature","geometry":{},"properties":{{"type":"thing","kind":"{}","latitude_deg":{},"longitude_deg":{},"deviation_m":{},)"
      R"("length_m":{},"width_m":{},"length_bearing_deg":{},"top_above_water_m":{},"first_seen":"{}","last_seen":"{}","gone":{},"gone_since":{},)"
      R"("days":{},"known":{},"scans":{},"scans_by_day":{{{}}}}}}})",
      GeometryOf(thing), words::WordOf(words::kTrackKind, thing.kind), FixedText(thing.latitude_deg, 9), FixedText(thing.longitude_deg, 9),
      FixedText(thing.deviation_m, 3), FixedText(thing.length_m, 3), FixedText(thing.width_m, 3), bearing_deg, FixedText(thing.top_above_water_m, 3),
      MapTimeText(thing.first), MapTimeText(thing.seen), thing.gone ? "true" : "false", thing.gone ? '"' + MapTimeText(*thing.gone) + '"' : "null",
      thing.days.size(), std::cmp_greater_equal(thing.days.size(), kKnownDays), num_scans, scans_by_day);
}

std::string FeatureOf(const MapLand& land) {
  std::string cells;
  for (const auto index : land.cells) {
    // 1 cm, of cells of half a metre.
    const auto place = earth_grid::MiddleOf({land.tile, index});
    cells += fmt::format("{}[{},{}]", cells.empty() ? "" : ",", FixedText(place.longitude_deg, 7), FixedText(place.latitude_deg, 7));
  }
  std::string days;
  for (const auto day : land.days) days += fmt::format("{}\"{}\"", days.empty() ? "" : ",", MapDayText(day));
  return fmt::format(
      R"({{"type":"Feature","geometry":{{"type":"MultiPoint","coordinates":[{}]}},"properties":{{"type":"land","cells":{},"last_seen":"{}",)"
      R"("days":{},"seen_on":[{}]}}}})",
      cells, land.cells.size(), MapTimeText(land.seen), land.days.size(), days);
}

}  // namespace

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

}  // namespace lookout::exporter
