// Listens for some seconds: on the bus, and where a process is not heard there, on the sources of its config themselves, with the process's own code.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <span>

#include "common/bus/bus.hpp"
#include "common/messages/part_assembler.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/tracker/core/zone_sight.hpp"
#include "tools/doctor/mounting_watch.hpp"
#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

/// Fills observations from a bus: the live one, or the one inside the doctor on which its own copies of the services publish.
class Notes {
 public:
  /// @param seen   is filled; outlives this
  /// @param clock  host time
  Notes(Observations& seen, std::function<Utime()> clock);

  /// Subscribes the channels of lidar and navigation.
  void ListenTo(bus::Bus& bus, Via via);

  /// Subscribes what only a live bus has: HEALTH, OBSTACLES, TRACKS, ALERTS, and the size of all.
  void ListenToProcesses(bus::Bus& bus);

  /// As a recorder would have written it.
  std::int64_t num_log_bytes() const { return num_log_bytes_; }

 private:
  void OnPackets(const lidar_packets_t& message, Via via);
  void OnScan(const lidar_scan_t& message);
  void LookAtZone(std::span<const lidar_scan_t> parts);
  void CountAzimuths(const lidar_scan_t& message);
  void OnFix(const gnss_fix_t& message);
  void OnHealth(const health_t& message);

  Observations& seen_;
  std::function<Utime()> clock_;
  std::int64_t num_log_bytes_ = 0;
  messages::PartAssembler<lidar_scan_t> scan_parts_;
  std::optional<tracker::ZoneSight> zone_sight_;
};

/// Fills lidar, navigation, processes, obstacles, look-out, the rate of the disk, end and watched_s of `seen`. Sends nothing on the bus.
///
/// @param seen      config and bus are read already
/// @param mounting  listens, too; may be nullptr
void Watch(Observations& seen, std::chrono::milliseconds duration, MountingWatch* mounting);

/// A port that could not be opened is no fault where the process that reads it was heard after all (on a busy computer its first HEALTH is late):
/// removes the faults of its ports from `seen`.
void ForgivePortsOfProcesses(Observations& seen);

}  // namespace lookout::doctor
