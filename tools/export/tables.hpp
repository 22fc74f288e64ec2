// The tables that lookout-export writes as CSV.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// Names of all tables, in the order of --help.
std::vector<std::string_view> TableNames();

/// @return the header line of a table without its end; empty when there is no such table
std::string_view TableHeader(std::string_view table);

/// @return what writes `table` as CSV, header first; nullptr when there is no such table
std::unique_ptr<Sink> MakeCsvSink(std::string_view table);

}  // namespace lookout::exporter
