// Makes the HEALTH message of this process, and tells systemd how the process fares.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "lookout/health_t.hpp"

namespace lookout::runtime {

class HealthReporter {
 public:
  explicit HealthReporter(std::string process);

  /// @param now  host time
  /// @return the state of the process since the call before; removes the handling times from `bus`
  health_t Make(Utime now, const HealthReport& report, bus::Bus& bus);

  /// @return the same with state, reason and counters of now; rates and other values of an interval are those of the call of Make before
  health_t MakeBetween(Utime now, const HealthReport& report);

 private:
  // State, reason and counters; sets what tells of this process and this moment.
  void Fill(Utime now, const HealthReport& report, health_t& message);

  std::string process_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
  double last_cpu_s_ = 0.0;
  std::int64_t seq_ = 0;
  bool is_started_ = false;  // was OK once, or had its time
  std::int64_t last_num_unsent_ = 0;
  std::int64_t last_num_refused_ = 0;             // of second publishers
  std::optional<std::int64_t> last_num_dropped_;  // datagrams, by the filter of the bus
  // Scans of each input that came whole and that did not, as of the last calls of Make.
  struct Inputs {
    std::chrono::steady_clock::time_point time;
    std::map<std::string, std::pair<std::int64_t, std::int64_t>> whole_and_lost;
  };
  std::string LossText(std::chrono::steady_clock::time_point now, bus::Bus& bus);
  std::deque<Inputs> inputs_;
  std::string
      bus_text_;  // of the last call of Make: messages that could not be sent or were lost, channels with two publishers, a bus without its filter
  health_t last_message_{};
  std::map<std::string, std::int64_t> last_counts_;  // by channel, inputs and outputs apart
};

/// READY=1 to systemd: the bus is open, inputs are set up, the main loop begins. Where no supervisor listens (NOTIFY_SOCKET is not set) nothing
/// happens. There is no STOPPING=1: a process that starts itself anew (SIGHUP) would be ended by it.
void NotifyReady();

/// STATUS with state and reason of this HEALTH message, and WATCHDOG=1. Only the main loop may call it: a watchdog fed elsewhere is still fed when
/// the loop hangs.
void NotifyAlive(const health_t& health);

}  // namespace lookout::runtime
