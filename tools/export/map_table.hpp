// The table `map`: the boat's own map out of logs of many days, as GeoJSON or CSV.
#pragma once

#include <memory>
#include <string_view>

#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// @return the header line of the table as CSV, without its end
std::string_view MapHeader();

/// @param is_geojson  else CSV, without header
std::unique_ptr<Sink> MakeMapSink(bool is_geojson);

}  // namespace lookout::exporter
