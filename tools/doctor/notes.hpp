// Notes down what goes over a bus: the live one, or the one inside the doctor on which its own copies of the services speak.
#pragma once

#include <functional>
#include <string_view>

#include "common/bus/bus.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

class Notes {
 public:
  /// @param seen   is filled; outlives this
  /// @param clock  host time
  Notes(Observations& seen, std::function<Utime()> clock);

  /// Subscribes what the lidar and the navigation say.
  void TakeFrom(bus::Bus& bus, Via via);

  /// Subscribes what only a live bus has: HEALTH, OBSTACLES, and the size of all.
  void TakeRest(bus::Bus& bus);

  /// As a recorder would have written it.
  std::int64_t num_log_bytes() const { return num_log_bytes_; }

 private:
  void OnPackets(const lidar_packets_t& message, Via via);
  void OnFix(const gnss_fix_t& message);
  void OnHealth(const health_t& message);

  Observations& seen_;
  std::function<Utime()> clock_;
  std::int64_t num_log_bytes_ = 0;
};

}  // namespace lookout::doctor
