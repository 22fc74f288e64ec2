// The command line of lookout-sim.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/sim/faulty_network.hpp"
#include "tools/sim/lidar.hpp"
#include "tools/sim/navigation.hpp"

namespace lookout::sim {

struct Options {
  std::filesystem::path config_folder;
  std::string scene;  // name or path, as in FindScene
  std::uint64_t seed = 1;
  double seconds = 0.0;
  std::filesystem::path pcap_file;     // empty: to udp_host
  std::string udp_host;                // empty: to pcap_file
  std::filesystem::path truth_folder;  // empty: none
  bool force = false;                  // existing files are replaced
  std::int64_t start_utime_us = 0;     // of a capture
  double speed = 1.0;                  // to udp_host, times real time; 0 = without waiting
  LidarParams lidar;
  NavigationParams navigation;
  FaultParams network;
  std::vector<TimedFault> faults;
};

/// Exits here for --help, --version, --list-scenes and wrong lines.
///
/// @throws std::invalid_argument  for a wrong --fault
/// @throws config::ConfigError    for a wrong scene file, with --list-scenes
Options ParseOptions(int argc, char** argv);

}  // namespace lookout::sim
