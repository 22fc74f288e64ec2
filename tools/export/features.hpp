// Features of a map, whatever its format: things with a place, a time and properties.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tools/export/csv.hpp"
#include "tools/export/map_geometry.hpp"

namespace lookout::exporter {

/// Printed as in a table; an unknown value (not finite, Empty) is null in GeoJSON and is left out elsewhere.
using Value = std::variant<Empty, std::int64_t, Fixed, Shortest, Direction, std::string>;

struct Property {
  std::string_view name;
  Value value;
};

/// @return the number or the text of a cell, not escaped; empty when it is not known
std::string TextOf(const Value& value);

struct Feature {
  std::string what;  // "track", "outline", ...: one word for all of a sort
  std::string name;  // for people
  Geometry geometry;
  std::optional<std::int64_t> utime_us = std::nullopt;      // time of the feature; a line with times may have none
  std::optional<std::int64_t> end_utime_us = std::nullopt;  // end of the feature, where it lasts
  std::vector<Property> properties = {};
};

/// Writes features one after the other. Times are within the bounds of UtimeFromWire.
class MapWriter {
 public:
  virtual ~MapWriter() = default;

  virtual void Begin(std::string& text) = 0;

  /// A feature that the format has no place for is left out. @return whether it was written
  virtual bool Append(const Feature& feature, std::string& text) = 0;

  virtual void End(std::string& text) = 0;
};

}  // namespace lookout::exporter
