// Sensors of a boat on the cables of a computer, or in a recording: lidars and NMEA 0183.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "services/lidar/survey.hpp"
#include "tools/setup/nmea_survey.hpp"

namespace lookout::setup {

struct Heard {
  std::vector<lidar::Speaker> lidars = {};  // lidars whose packets can be read
  std::vector<std::string> unread = {};     // names of lidars whose packets cannot be read
  std::vector<NmeaHeard> nmea = {};
  std::vector<std::string> faults = {};  // sources that could not be opened, for people
  bool is_recording = false;
};

/// @param devices  serial ports; each is tried at the usual baud rates, which may last longer than `duration`
Heard Listen(std::chrono::milliseconds duration, const std::vector<std::filesystem::path>& devices);

/// Captures (pcap, pcapng) read to their end. @throws std::runtime_error when one cannot be read
Heard ReadRecordings(const std::vector<std::filesystem::path>& files);

/// A line for each lidar and source of sentences: model or types, rates, and what is missing.
std::vector<std::string> InWords(const Heard& heard);

}  // namespace lookout::setup
