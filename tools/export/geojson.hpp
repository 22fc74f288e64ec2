// GeoJSON (RFC 7946): a feature collection, a feature in a line.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "tools/export/features.hpp"
#include "tools/export/map_geometry.hpp"

namespace lookout::exporter {

/// Appends a JSON string, quoted. Control characters and bytes that are no UTF-8 become "?".
void AppendJsonString(std::string_view text, std::string& json);

/// Appends a number, a string or null.
void AppendJsonValue(const Value& value, std::string& json);

/// Appends {"type":"Polygon","coordinates":...}, or its Multi... where it has several parts.
void AppendJsonGeometry(const Geometry& geometry, std::string& json);

/// Features with the properties `what` and `name`, then `time` and `end_time` where they are known ("2026-07-01T10:00:00.000000Z"), then their own,
/// then of a line with times `coordTimes`: a time for each of its places, in lists as its coordinates are.
std::unique_ptr<MapWriter> MakeGeoJsonWriter();

}  // namespace lookout::exporter
