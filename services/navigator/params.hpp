// Config of the navigator process (navigator.txtpb, boat.txtpb) as checked values.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/navigator/core/navigator.hpp"

namespace lookout::navigator {

/// Where the sentences of one source come from, live.
struct Connection {
  enum class Kind { kUdp, kSerial, kTcp, kGpsd, kTextLog };

  std::string name;  // of the source
  Kind kind = Kind::kUdp;
  std::string address;                            // kUdp: to bind; kTcp, kGpsd: of the server; numeric
  int port = 0;                                   // kUdp, kTcp, kGpsd
  std::filesystem::path file;                     // kSerial: the device; kTextLog: the log
  int baud = 0;                                   // kSerial
  double speed = 1.0;                             // kTextLog: times as fast; 0 = as fast as can be; of all text logs the same
  std::optional<std::chrono::sys_days> day = {};  // kTextLog: of the log's first time, where no sentence has a date
};

struct Params {
  bool reads_nav_raw = false;  // reads NAV_RAW and nothing else, and publishes none; else reads sources and LIDAR_NMEA
  bool use_lidar_nmea = true;
  NavigatorParams navigator;

  // The sources to open, for main. Text logs alone, or others and no text log.
  std::vector<Connection> connections;
  // For replay: the source of each UDP port of a capture.
  std::map<int, std::string> source_of_port;
};

/// A day as config and command lines write it.
///
/// @return the day of "2026-07-01"; nullopt when it is written in another way, or is no day from 1970 to 2199
std::optional<std::chrono::sys_days> ParseDay(std::string_view text);

/// @param config_folder  the boat's folder, holding boat.txtpb and navigator.txtpb
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

/// The words of --check besides the values: each source, and the meaning of its signs. Lines of a comment.
std::string InWords(const Params& params);

}  // namespace lookout::navigator
