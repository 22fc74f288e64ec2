#include "tools/export/geojson.hpp"

#include <type_traits>
#include <variant>

#include "common/core/printable.hpp"
#include "tools/export/map_text.hpp"

namespace lookout::exporter {

namespace {

// Appends "[a,b,...]", where `append` writes each element.
template <typename Range, typename AppendOne>
void AppendList(const Range& range, std::string& json, const AppendOne& append) {
  json += '[';
  bool is_first = true;
  for (const auto& one : range) {
    if (!is_first) json += ',';
    is_first = false;
    append(one);
  }
  json += ']';
}

void AppendPosition(const MapPlace& place, std::string& json) {
  json += '[';
  AppendPlace(place, ',', json);
  json += ']';
}

void AppendPositions(const std::vector<MapPlace>& places, std::string& json) {
  AppendList(places, json, [&](const MapPlace& place) { AppendPosition(place, json); });
}

void AppendTimes(const Geometry& geometry, std::string& json) {
  const auto append_one = [&](std::int64_t utime_us) { AppendJsonString(IsoTime(utime_us), json); };
  if (geometry.utimes_us.size() == 1) {
    AppendList(geometry.utimes_us.front(), json, append_one);
  } else {
    AppendList(geometry.utimes_us, json, [&](const auto& part) { AppendList(part, json, append_one); });
  }
}

class GeoJsonWriter final : public MapWriter {
 public:
  void Begin(std::string& text) override { text += "{\"type\":\"FeatureCollection\",\"features\":["; }

  bool Append(const Feature& feature, std::string& text) override {
    text += is_first_ ? "\n" : ",\n";
    is_first_ = false;
    text += "{\"type\":\"Feature\",\"properties\":{\"what\":";
    AppendJsonString(feature.what, text);
    const auto add = [&](std::string_view name, const Value& value) {
      text += ',';
      AppendJsonString(name, text);
      text += ':';
      AppendJsonValue(value, text);
    };
    add("name", feature.name);
    if (feature.utime_us) add("time", IsoTime(*feature.utime_us));
    if (feature.end_utime_us) add("end_time", IsoTime(*feature.end_utime_us));
    for (const auto& [name, value] : feature.properties) add(name, value);
    if (feature.geometry.HasTimes()) {
      text += ",\"coordTimes\":";
      AppendTimes(feature.geometry, text);
    }
    text += "},\"geometry\":";
    AppendJsonGeometry(feature.geometry, text);
    text += '}';
    return true;
  }

  void End(std::string& text) override { text += "\n]}\n"; }

 private:
  bool is_first_ = true;
};

}  // namespace

std::string TextOf(const Value& value) {
  if (const auto* words = std::get_if<std::string>(&value)) return *words;
  std::string text;
  std::visit(
      [&](const auto& one) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(one)>, std::string>) AppendCell(one, text);
      },
      value);
  return text;
}

void AppendJsonString(std::string_view text, std::string& json) {
  json += '"';
  for (const char letter : PrintableLines(text)) {
    if (letter == '\n') {
      json += "\\n";
    } else {
      if (letter == '"' || letter == '\\') json += '\\';
      json += letter;
    }
  }
  json += '"';
}

void AppendJsonValue(const Value& value, std::string& json) {
  if (const auto* words = std::get_if<std::string>(&value)) {
    AppendJsonString(*words, json);
    return;
  }
  const auto number = TextOf(value);
  json += number.empty() ? "null" : number;
}

void AppendJsonGeometry(const Geometry& geometry, std::string& json) {
  const bool is_one = geometry.parts.size() == 1;
  const auto begin = [&](std::string_view type) { json.append("{\"type\":\"").append(type).append("\",\"coordinates\":"); };
  const auto append_line = [&](const std::vector<MapPlace>& part) { AppendPositions(part, json); };
  const auto append_polygon = [&](const std::vector<MapPlace>& ring) {
    json += '[';
    AppendPositions(ring, json);
    json += ']';
  };
  switch (geometry.kind) {
    case Geometry::Kind::kPoint:
      begin("Point");
      AppendPosition(geometry.parts.front().front(), json);
      break;
    case Geometry::Kind::kPoints:
      begin("MultiPoint");
      append_line(geometry.parts.front());
      break;
    case Geometry::Kind::kLine:
      begin(is_one ? "LineString" : "MultiLineString");
      is_one ? append_line(geometry.parts.front()) : AppendList(geometry.parts, json, append_line);
      break;
    case Geometry::Kind::kPolygon:
      begin(is_one ? "Polygon" : "MultiPolygon");
      is_one ? append_polygon(geometry.parts.front()) : AppendList(geometry.parts, json, append_polygon);
      break;
  }
  json += '}';
}

std::unique_ptr<MapWriter> MakeGeoJsonWriter() { return std::make_unique<GeoJsonWriter>(); }

}  // namespace lookout::exporter
