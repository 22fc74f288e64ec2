// What the cables of a computer, or a recording, tell of a boat: lidars and NMEA 0183.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "services/lidar/survey.hpp"
#include "tools/setup/nmea_survey.hpp"

namespace lookout::setup {

struct Heard {
  std::vector<lidar::Speaker> lidars = {};  // those whose packets are read
  std::vector<std::string> unread = {};     // names of lidars that are not
  std::vector<NmeaHeard> nmea = {};
  std::vector<std::string> faults = {};  // what could not be listened to, for people
  bool is_recording = false;
};

/// @param devices  serial ports; each is tried at the usual baud rates, which may last longer than `duration`
Heard Listen(std::chrono::milliseconds duration, const std::vector<std::filesystem::path>& devices);

/// Captures (pcap, pcapng) read to their end. @throws std::runtime_error when one cannot be read
Heard ReadRecordings(const std::vector<std::filesystem::path>& files);

/// A line for each: which lidar, which sentences, how fast, and what lacks.
std::vector<std::string> InWords(const Heard& heard);

}  // namespace lookout::setup
