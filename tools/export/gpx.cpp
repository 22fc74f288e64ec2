#include <fmt/format.h>

#include <cstddef>
#include <iterator>
#include <optional>

#include "tools/export/map_formats.hpp"
#include "tools/export/map_text.hpp"

namespace lookout::exporter {

namespace {

// lat="43.700000000" lon="7.100000000"
std::string Attributes(const MapPlace& place) {
  std::string longitude_and_latitude;
  AppendPlace(place, ' ', longitude_and_latitude);
  const auto blank = longitude_and_latitude.find(' ');
  const auto longitude = longitude_and_latitude.substr(0, blank);
  // GPX has no longitude of 180: its longitudes go from -180 to less than 180.
  return fmt::format("lat=\"{}\" lon=\"{}\"", longitude_and_latitude.substr(blank + 1), longitude == "180.000000000" ? "179.999999999" : longitude);
}

// "status ok, length_m 3.5000"
std::string Description(const Feature& feature) {
  std::string words;
  for (const auto& [name, value] : feature.properties) {
    const auto one = TextOf(value);
    if (!one.empty()) fmt::format_to(std::back_inserter(words), "{}{} {}", words.empty() ? "" : ", ", name, one);
  }
  return words;
}

class GpxWriter final : public MapWriter {
 public:
  void Begin(std::string& text) override {
    text +=
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<gpx version=\"1.1\" creator=\"lookout-export\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n";
  }

  bool Append(const Feature& feature, std::string& text) override {
    if (feature.geometry.HasTimes()) {
      AppendTrack(feature);
      return true;
    }
    if (feature.geometry.kind != Geometry::Kind::kPoint) return false;
    fmt::format_to(std::back_inserter(text), "<wpt {}>", Attributes(feature.geometry.parts.front().front()));
    // A feature that lasts gets the time of its end, as its place is that of the end.
    const auto utime_us = feature.end_utime_us ? feature.end_utime_us : feature.utime_us;
    if (utime_us) fmt::format_to(std::back_inserter(text), "<time>{}</time>", IsoTime(*utime_us));
    fmt::format_to(std::back_inserter(text), "<name>{}</name><desc>{}</desc><type>{}</type></wpt>\n", XmlText(feature.name),
                   XmlText(Description(feature)), XmlText(feature.what));
    return true;
  }

  void End(std::string& text) override {
    text += tracks_;
    if (name_) text += "</trk>\n";
    text += "</gpx>\n";
  }

 private:
  void AppendTrack(const Feature& feature) {
    if (name_ != feature.name) {
      if (name_) tracks_ += "</trk>\n";
      fmt::format_to(std::back_inserter(tracks_), "<trk><name>{}</name><type>{}</type>\n", XmlText(feature.name), XmlText(feature.what));
      name_ = feature.name;
    }
    for (std::size_t i = 0; i < feature.geometry.parts.size(); ++i) {
      tracks_ += "<trkseg>\n";
      for (std::size_t k = 0; k < feature.geometry.parts[i].size(); ++k) {
        fmt::format_to(std::back_inserter(tracks_), "<trkpt {}><time>{}</time></trkpt>\n", Attributes(feature.geometry.parts[i][k]),
                       IsoTime(feature.geometry.utimes_us[i][k]));
      }
      tracks_ += "</trkseg>\n";
    }
  }

  std::string tracks_;
  std::optional<std::string> name_;  // of the track that is open
};

}  // namespace

std::unique_ptr<MapWriter> MakeGpxWriter() { return std::make_unique<GpxWriter>(); }

}  // namespace lookout::exporter
