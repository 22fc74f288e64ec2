// Asks a sensor over TCP for its beams: an Ouster for its metadata (HTTP), a Hesai for its angle correction (command 5 of its control port).
#pragma once

#include <chrono>
#include <cstddef>
#include <stop_token>
#include <string>

namespace lookout::lidar {

struct SensorAddress {
  std::string host;  // numeric
  int port = 0;
};

/// As a beam file may have.
inline constexpr std::size_t kMaxBeamBytes = 64 << 10;

/// The whole exchange, from the connection to the last byte, has ended by `time_limit`, or at once where a stop is asked for.
///
/// @return the answer to GET /api/v1/sensor/metadata, not looked at
/// @throws std::runtime_error with address and reason
std::string RequestOusterMetadata(const SensorAddress& sensor, std::chrono::milliseconds time_limit, const std::stop_token& stop = {});

/// @return the table of angles (CSV), not looked at
/// @throws std::runtime_error with address and reason
std::string RequestHesaiAngles(const SensorAddress& sensor, std::chrono::milliseconds time_limit, const std::stop_token& stop = {});

}  // namespace lookout::lidar
