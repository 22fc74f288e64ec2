// The segmenter process without its shell: LIDAR_SCAN in, SEGMENTS out. It keeps nothing between scans.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "common/core/input_watch.hpp"
#include "common/core/recently.hpp"
#include "common/core/utime.hpp"
#include "common/messages/part_assembler.hpp"
#include "services/segmenter/params.hpp"

namespace lookout::segmenter {

class Service {
 public:
  Service(bus::Bus& bus, const Params& params);

  /// Live only: host time has come so far. To be called once a second.
  void AdvanceTo(Utime host_time) {
    time_.Advance(host_time);
    scans_watch_.AdvanceTo(host_time);
  }

  /// @return degraded while no LIDAR_SCAN comes, or the latest was refused, for a minute at most
  HealthReport Report() const;

 private:
  void OnScan(const lidar_scan_t& message);

  bus::Bus& bus_;
  Segmenter segmenter_;
  messages::PartAssembler<lidar_scan_t> assembler_;
  Counts<messages::kScanFaults> refusals_;
  std::optional<messages::Fault> last_fault_;  // of the latest message, if it was refused
  std::chrono::microseconds refused_at_{0};
  PassedTime time_{std::chrono::seconds(2)};
  InputWatch scans_watch_{bus::kLidarScan.name};
  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"scans", "segments", "segments_too_small", "segments_over_limit", "returns_repeated", "scans_without_pieces",
                                       "scans_incomplete", "scans_inconsistent", "parts_duplicate", "parts_inconsistent"});
  Counts<kCountNames> counts_;
};

}  // namespace lookout::segmenter
