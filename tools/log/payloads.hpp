// Whether the messages of a log are sound: LCM's log has no checksum, so that a flipped bit inside of a message shows in its values alone.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>

#include "common/bus/log_file.hpp"
#include "common/core/utime.hpp"

namespace lookout::log {

/// The fault of a message of a known channel, as its readers check it: another type than the channel's, bytes that do not decode, impossible counts
/// or numbers, damaged packets of the lidar or sentences. A flipped bit that leaves a possible value is not found.
///
/// @return empty where there is none, or the channel is not known
std::string_view PayloadFault(std::string_view channel, Bytes bytes);

/// Counts them over a log.
class Payloads {
 public:
  /// @param event  its number in the order of the logs, from 0
  void Add(std::int64_t event, const bus::LogEvent& message);

  /// A line, and one more for each channel and fault.
  void Print(std::ostream& out) const;

 private:
  struct Found {
    std::int64_t count = 0;
    std::int64_t first_event = 0;
    Utime first_time;
  };

  std::int64_t num_checked_ = 0;
  std::int64_t num_of_others_ = 0;  // events of channels that are not known
  std::int64_t num_faulty_ = 0;
  std::map<std::pair<std::string, std::string_view>, Found> found_;
};

}  // namespace lookout::log
