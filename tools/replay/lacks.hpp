// Missing parts of the result of a replay, and their reasons, in words.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/log/pose_counts.hpp"

namespace lookout::replay {

/// Datagrams of a capture to a port of no service.
struct OtherPort {
  std::int64_t num_datagrams = 0;
  std::int64_t num_lidar_packets = 0;  // of the size of a data packet of the VLP-16 family
  std::int64_t num_sentences = 0;      // begin as a sentence of NMEA 0183
};
using OtherPorts = std::map<int, OtherPort>;

/// Counts of input and output.
struct Seen {
  enum class Input { kCapture, kTextLog, kLog };
  Input input = Input::kCapture;
  bool wants_scans = false;   // LIDAR_SCAN is computed
  bool wants_poses = false;   // POSE is computed
  bool wants_tracks = false;  // TRACKS are computed
  int data_port = 0;
  std::vector<int> sentence_ports = {};
  std::int64_t num_lidar_packets = 0;  // messages of LIDAR_PACKETS, or datagrams to the data port
  std::int64_t num_sentences = 0;      // NAV_RAW with a sentence
  std::int64_t num_scans = 0;
  std::int64_t num_obstacles_placed = 0;
  std::int64_t num_obstacles_unplaced = 0;
  log::PoseCounts poses = {};
  OtherPorts other_ports = {};
};

/// @return "2369 (1808 datagrams, as a lidar sends them), 5000 (12 datagrams)", the busiest first; empty where there are none
std::string PortsText(const OtherPorts& ports);

/// @return a line for each thing that the result lacks; none where it has all
std::vector<std::string> Lacks(const Seen& seen);

}  // namespace lookout::replay
