// Serial ports of this computer on which NMEA 0183 may come.
#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/utime.hpp"
#include "services/navigator/io/serial_port.hpp"
#include "tools/setup/nmea_survey.hpp"

namespace lookout::setup {

/// Ports of USB adapters: by the name that stays the same (/dev/serial/by-id), where they have one, else /dev/ttyUSB* and /dev/ttyACM*. By name.
std::vector<std::filesystem::path> SerialDevices();

/// Tries one port at one rate after the other, until a sentence with a right checksum comes.
class SerialSearch {
 public:
  /// Highest first of those that GNSS receivers and AHRS have as delivered: at a lower rate than its own a stream is noise, too.
  static constexpr std::array kBauds{38400, 4800, 115200, 9600, 19200, 57600};
  /// At each rate: receivers send at least once a second.
  static constexpr std::chrono::milliseconds kWait{1300};

  explicit SerialSearch(std::filesystem::path device) : device_(std::move(device)) {}

  void Poll(Utime now, NmeaSurvey& survey);

  /// Found, or no rate is left.
  bool IsDone() const { return is_found_ || next_baud_ > kBauds.size(); }

  bool is_found() const { return is_found_; }
  const std::filesystem::path& device() const { return device_; }
  const std::string& fault() const { return fault_; }  // fault of opening the port; empty: none

 private:
  std::filesystem::path device_;
  std::unique_ptr<navigator::SerialPort> port_;
  std::size_t next_baud_ = 0;
  std::optional<Utime> began_;
  bool is_found_ = false;
  std::string fault_;
};

}  // namespace lookout::setup
