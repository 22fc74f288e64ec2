// The outputs of lookout-export: a row for each table in each of its formats. --help, the refusals and the makers come from these rows.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tools/export/export.hpp"
#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// Options of the command line that not every output has; a row holds the bits of those that it has.
enum Option : unsigned {
  kNoOption = 0,
  kSpanOption = 1,       // --from and --to
  kNearOption = 2,       // --near
  kScanOption = 4,       // --scan NUMBER
  kLastScanOption = 8,   // --scan last means another thing than no --scan: a map is of all scans
  kAllScansOption = 16,  // --scan all
  kConfigOption = 32,    // --config, which must be given then
  kFrameOption = 64,     // --frame
  kLidarOption = 128,    // --lidar 2
};

struct Output {
  std::string_view table;
  std::string_view format;
  unsigned options;  // bits of Option
  /// @throws config::ConfigError
  std::unique_ptr<Sink> (*make)(const Request& request);
  bool is_by_time = false;                                  // reads the logs in the order of their times, not in the order given
  std::string_view when_empty = "the input holds no scan";  // the missing part of the log where the output is empty
};

/// All rows: for each table a row per format, csv first.
const std::vector<Output>& Outputs();

/// @return nullptr where the table is not written in that format
const Output* FindOutput(std::string_view table, std::string_view format);

/// The formats, each once, in the order of --help.
std::vector<std::string> FormatNames();

/// "csv; ply of returns; svg of returns, merges and pose": in which formats each table is written.
std::string FormatsText();

/// "csv of every table but map; kml and gpx of obstacles": where an option can be given.
std::string PlacesText(Option option);

/// Whether a cloud is of one scan: neither --scan all nor --from or --to is given.
bool IsOfOneScan(const Request& request);

/// The fault of table, format and options of the request; empty when there is none.
std::string OutputFault(const Request& request);

}  // namespace lookout::exporter
