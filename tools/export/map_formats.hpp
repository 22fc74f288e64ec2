// The formats of maps: a row for each. A new format is a row here and a file that makes its writer.
#pragma once

#include <array>
#include <memory>
#include <string_view>

#include "tools/export/features.hpp"
#include "tools/export/geojson.hpp"

namespace lookout::exporter {

/// OGC KML 2.3 (12-007r2) with Google's gx:Track: a placemark for each feature, with its time, so that the slider of Google Earth shows one scan
/// after the other; the style follows `what`.
/// @param table  "obstacles", "tracks" or "pose": its fields have types
std::unique_ptr<MapWriter> MakeKmlWriter(std::string_view table);

/// GPX 1.1: points as waypoints, lines with times as tracks. Tracks stand behind all waypoints, so they are held until the end; one with the name of
/// that before it becomes another segment of it. Areas and lines without times have no place in GPX.
std::unique_ptr<MapWriter> MakeGpxWriter();

struct MapFormat {
  std::string_view name;
  std::unique_ptr<MapWriter> (*make)(std::string_view table);
};

inline constexpr std::array kMapFormats{MapFormat{"geojson", [](std::string_view) { return MakeGeoJsonWriter(); }}, MapFormat{"kml", MakeKmlWriter},
                                        MapFormat{"gpx", [](std::string_view) { return MakeGpxWriter(); }}};

}  // namespace lookout::exporter
