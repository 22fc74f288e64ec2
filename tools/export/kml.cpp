#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <iterator>
#include <string_view>
#include <vector>

#include "tools/export/map_formats.hpp"
#include "tools/export/map_text.hpp"

namespace lookout::exporter {

namespace {

// Colours are alpha, blue, green, red; of Okabe and Ito, for readers who confuse red and green.
struct KmlStyle {
  std::string_view what;
  std::string_view line;
  int width;
  std::string_view area;
  double label_scale;
};
constexpr std::array kKmlStyles{KmlStyle{"own_track", "ffb27200", 3, "00000000", 0.8}, KmlStyle{"own_place", "ffb27200", 3, "00000000", 0.8},
                                KmlStyle{"obstacle", "ff005ed5", 1, "00000000", 0.0},  KmlStyle{"track", "ff739e00", 1, "00000000", 0.8},
                                KmlStyle{"outline", "ff005ed5", 2, "40005ed5", 0.0},   KmlStyle{"ellipse", "c0808080", 1, "00000000", 0.0},
                                KmlStyle{"way", "ff739e00", 2, "00000000", 0.0},       KmlStyle{"waterline", "ff7aa0b8", 3, "00000000", 0.0},
                                KmlStyle{"alert", "ff0000c0", 2, "00000000", 0.8}};

// The fields of each sort of feature of a table with their types, so that numbers are read as numbers. Only fields of the table are declared: GDAL
// gives every feature the fields of all schemas. Times in microseconds are whole numbers beyond 32 bits, which a double holds exactly: KML has no
// longer whole number.
struct KmlField {
  std::string_view type;
  std::string_view name;
};
struct KmlSchema {
  std::string_view what;
  std::vector<KmlField> fields;
};
std::vector<KmlSchema> SchemasOf(std::string_view table) {
  const KmlField status{"string", "status"};
  const KmlField kind{"string", "kind"};
  const KmlSchema own_track{"own_track", {status}};
  if (table == "obstacles") {
    const KmlField scan_seq{"int", "scan_seq"};
    const KmlField obstacle_id{"int", "obstacle_id"};
    const KmlField confidence{"string", "confidence"};
    const std::vector<KmlField> few{scan_seq, obstacle_id, confidence, kind};
    return {{"obstacle",
             {scan_seq,
              {"double", "scan_utime_us"},
              {"double", "utime_us"},
              obstacle_id,
              confidence,
              kind,
              {"double", "thing_probability"},
              {"double", "range_m"},
              {"double", "bearing_deg"},
              {"double", "length_m"},
              {"double", "width_m"},
              {"double", "height_m"},
              {"double", "top_above_water_m"},
              {"int", "num_points"},
              {"double", "cov_ee_m2"},
              {"double", "cov_en_m2"},
              {"double", "cov_nn_m2"}}},
            {"outline", few},
            {"waterline", few},
            {"ellipse", few}};
  }
  if (table == "pose") return {own_track};
  const KmlField track_id{"int", "track_id"};
  const KmlField bearing_deg{"double", "bearing_deg"};
  const KmlField cpa_m{"double", "cpa_m"};
  const KmlField tcpa_s{"double", "tcpa_s"};
  const std::vector<KmlField> few{track_id, status, kind};
  return {own_track,
          {"own_place", {}},
          {"track",
           {track_id,
            status,
            kind,
            {"double", "first_utime_us"},
            {"double", "seen_utime_us"},
            {"double", "existence_probability"},
            {"double", "moving_probability"},
            {"double", "speed_mps"},
            {"double", "course_deg"},
            {"double", "length_m"},
            {"double", "width_m"},
            {"double", "top_above_water_m"},
            {"double", "seen_share"},
            {"double", "range_m"},
            bearing_deg,
            cpa_m,
            tcpa_s,
            {"double", "cov_ee_m2"},
            {"double", "cov_en_m2"},
            {"double", "cov_nn_m2"}}},
          {"outline", few},
          {"ellipse", few},
          {"way", few},
          {"waterline", {}},
          {"alert", {{"int", "alert_id"}, {"string", "cause"}, {"string", "level"}, track_id, {"double", "distance_m"}, bearing_deg, cpa_m, tcpa_s}}};
}

class KmlWriter final : public MapWriter {
 public:
  explicit KmlWriter(std::string_view table) : schemas_(SchemasOf(table)) {}

  void Begin(std::string& text) override {
    text +=
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n<Document>\n<name>Lookout</name>\n";
    for (const auto& [what, line, width, area, label_scale] : kKmlStyles) {
      fmt::format_to(std::back_inserter(text),
                     "<Style id=\"{}\"><IconStyle><color>{}</color><scale>0.5</scale></IconStyle><LabelStyle><scale>{:.1f}</scale></LabelStyle>"
                     "<LineStyle><color>{}</color><width>{}</width></LineStyle><PolyStyle><color>{}</color></PolyStyle></Style>\n",
                     what, line, label_scale, line, width, area);
    }
    for (const auto& [what, fields] : schemas_) {
      fmt::format_to(std::back_inserter(text), "<Schema name=\"{0}\" id=\"fields_{0}\"><SimpleField type=\"string\" name=\"what\"/>", what);
      for (const auto& [type, name] : fields) fmt::format_to(std::back_inserter(text), "<SimpleField type=\"{}\" name=\"{}\"/>", type, name);
      text += "</Schema>\n";
    }
  }

  bool Append(const Feature& feature, std::string& text) override {
    fmt::format_to(std::back_inserter(text), "<Placemark><name>{}</name>", XmlText(feature.name));
    AppendTime(feature, text);
    fmt::format_to(std::back_inserter(text), "<styleUrl>#{0}</styleUrl><ExtendedData><SchemaData schemaUrl=\"#fields_{0}\">", XmlText(feature.what));
    AppendField("what", feature.what, text);
    for (const auto& [name, value] : feature.properties) {
      const auto words = TextOf(value);
      if (!words.empty()) AppendField(name, words, text);
    }
    text += "</SchemaData></ExtendedData>";
    feature.geometry.HasTimes() ? AppendTracks(feature.geometry, text) : AppendGeometry(feature.geometry, text);
    text += "</Placemark>\n";
    return true;
  }

  void End(std::string& text) override { text += "</Document>\n</kml>\n"; }

 private:
  // A line with times has them by itself.
  static void AppendTime(const Feature& feature, std::string& text) {
    if (!feature.utime_us || feature.geometry.HasTimes()) return;
    if (feature.end_utime_us) {
      fmt::format_to(std::back_inserter(text), "<TimeSpan><begin>{}</begin><end>{}</end></TimeSpan>", IsoTime(*feature.utime_us),
                     IsoTime(*feature.end_utime_us));
    } else {
      fmt::format_to(std::back_inserter(text), "<TimeStamp><when>{}</when></TimeStamp>", IsoTime(*feature.utime_us));
    }
  }

  static void AppendField(std::string_view name, std::string_view words, std::string& text) {
    fmt::format_to(std::back_inserter(text), "<SimpleData name=\"{}\">{}</SimpleData>", XmlText(name), XmlText(words));
  }

  static void AppendTracks(const Geometry& geometry, std::string& text) {
    const bool is_one = geometry.parts.size() == 1;
    if (!is_one) text += "<gx:MultiTrack><gx:interpolate>0</gx:interpolate>";
    for (std::size_t i = 0; i < geometry.parts.size(); ++i) {
      text += "<gx:Track><altitudeMode>clampToGround</altitudeMode>";
      for (const auto utime_us : geometry.utimes_us[i]) fmt::format_to(std::back_inserter(text), "<when>{}</when>", IsoTime(utime_us));
      for (const auto& place : geometry.parts[i]) {
        text += "<gx:coord>";
        AppendPlace(place, ' ', text);
        text += " 0</gx:coord>";
      }
      text += "</gx:Track>";
    }
    if (!is_one) text += "</gx:MultiTrack>";
  }

  static void AppendCoordinates(const MapPlace* begin, const MapPlace* end, std::string& text) {
    text += "<coordinates>";
    for (const auto* place = begin; place != end; ++place) {
      if (place != begin) text += ' ';
      AppendPlace(*place, ',', text);
    }
    text += "</coordinates>";
  }

  static void AppendGeometry(const Geometry& geometry, std::string& text) {
    const bool is_points = geometry.kind == Geometry::Kind::kPoint || geometry.kind == Geometry::Kind::kPoints;
    const bool is_one = geometry.parts.size() == 1 && geometry.kind != Geometry::Kind::kPoints;
    if (!is_one) text += "<MultiGeometry>";
    for (const auto& part : geometry.parts) {
      if (is_points) {
        for (const auto& place : part) {
          text += "<Point>";
          AppendCoordinates(&place, &place + 1, text);
          text += "</Point>";
        }
        continue;
      }
      const bool is_line = geometry.kind == Geometry::Kind::kLine;
      text += is_line ? "<LineString><tessellate>1</tessellate>" : "<Polygon><outerBoundaryIs><LinearRing>";
      AppendCoordinates(part.data(), part.data() + part.size(), text);
      text += is_line ? "</LineString>" : "</LinearRing></outerBoundaryIs></Polygon>";
    }
    if (!is_one) text += "</MultiGeometry>";
  }

  std::vector<KmlSchema> schemas_;
};

}  // namespace

std::unique_ptr<MapWriter> MakeKmlWriter(std::string_view table) { return std::make_unique<KmlWriter>(table); }

}  // namespace lookout::exporter
