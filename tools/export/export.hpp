// From logs to a table, a map, a cloud or a picture.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "tools/export/cloud.hpp"
#include "tools/export/selection.hpp"

namespace lookout::exporter {

struct Request {
  std::vector<std::filesystem::path> inputs;  // lcm-logs, read in this order as one
  std::string table;
  std::string format = "csv";                                  // format of the table; outputs.hpp lists formats, and the options of each
  std::optional<std::filesystem::path> output = std::nullopt;  // nullopt = standard output
  bool force = false;                                          // an existing output is replaced
  std::optional<std::int64_t> scan = std::nullopt;             // seq of the scan; nullopt = the last whole one (maps: all)
  bool is_last_scan = false;                                   // maps: the last whole one
  bool all_scans = false;                                      // merges as csv, pcd, las: all scans in place of one
  CloudFrame frame = CloudFrame::kLidar;                       // pcd and las
  std::optional<std::filesystem::path> config = std::nullopt;  // merges: the boat's folder, by which scans are segmented again
  int lidar = 1;                                               // 2: of the second lidar's channels
  std::string from = {};                                       // csv and maps: as FindTime; empty = the start
  std::string to = {};                                         // the first time that is left out; empty = the end
  Span span = {};                                              // csv and maps: times of measurement; of `from` and `to` where they are given
  std::optional<Circle> near = std::nullopt;                   // csv and maps of obstacles, tracks, pose: places within
  std::FILE* progress = nullptr;                               // for people, where the output is a file; nullptr: silent
};

inline constexpr int kExitFine = 0;
inline constexpr int kExitFailed = 1;  // an input cannot be read, the output not written, or the log holds nothing of the table's channel
inline constexpr int kExitUsage = 2;   // wrong command line or config

/// Ends as failed, without output file, when the program is asked to stop (io::CatchStopSignals).
///
/// @param errors  gets faults and skipped data, a line each
/// @return exit code
int Run(const Request& request, std::ostream& errors);

}  // namespace lookout::exporter
