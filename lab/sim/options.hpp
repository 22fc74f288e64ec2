// The command line of lookout-sim.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "lab/sim/faulty_network.hpp"
#include "lab/sim/simulation.hpp"

namespace lookout::sim {

struct Options {
  std::filesystem::path config_folder;
  std::string scene;  // name or path, as in FindScene
  double seconds = 0.0;
  std::string lidar;  // of HeadNames(); empty: as the scene says
  // Where to: one of the three is not empty.
  std::filesystem::path pcap_file;
  std::string udp_host;
  std::filesystem::path log_file;      // LogSink
  std::filesystem::path truth_folder;  // empty: none
  bool force = false;                  // existing files are replaced
  // Start of a capture, 2026-06-15 14:10:00 UTC: any date serves, as long as it is always the same.
  std::int64_t start_utime_us = 1'781'532'600'000'000;
  double speed = 1.0;           // to udp_host, times real time; 0 = without waiting
  SimulationParams simulation;  // seed, faults, and values of lidar and navigation that no config file has
  Effects effects;              // values set here override the scene's
  FaultParams network;
};

/// Exits here for --help, --version, --list-scenes and wrong lines.
///
/// @throws std::invalid_argument  for a wrong --fault
/// @throws config::ConfigError    for a wrong scene file, with --list-scenes
Options ParseOptions(int argc, char** argv);

}  // namespace lookout::sim
