// Losses and times of HEALTH and LIDAR_CLOCK of a log.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "lab/eval/metrics.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_clock_t.hpp"

namespace lookout::eval {

/// Traffic of one process on one channel.
struct Traffic {
  std::int64_t num_messages = 0;  // out of the last HEALTH
  std::int64_t num_undecodable = 0;
  std::int64_t num_lost = 0;
  Summary p50_us;  // of the reports in which a message came
  Summary p99_us;
};

/// The last report of a process.
struct ProcessState {
  int state = 0;
  std::string reason;
  Summary cpu_fraction;
  std::int64_t resident_bytes = 0;
};

/// Data packets over all runs in the log: counts begin anew at a start mark.
struct PacketTotals {
  std::int64_t num_packets = 0;
  std::int64_t num_lost = 0;
  std::int64_t num_duplicate = 0;
  std::int64_t num_reordered = 0;
};

class Machine {
 public:
  void Add(const health_t& message);
  void Add(const lidar_clock_t& message);

  std::map<std::string, ProcessState> processes;
  std::map<std::pair<std::string, std::pair<bool, std::string>>, Traffic> traffic;  // process, is output, channel
  std::int64_t num_scans_by_sensor = 0;                                             // stamped by the sensor's clock
  std::int64_t num_scans_by_host = 0;
  PacketTotals packets;

 private:
  std::optional<lidar_clock_t> last_clock_;
};

}  // namespace lookout::eval
