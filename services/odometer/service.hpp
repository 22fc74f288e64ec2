// The odometer process without its shell: LIDAR_SCAN in, LIDAR_ODOMETRY out.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "common/core/input_watch.hpp"
#include "common/core/utime.hpp"
#include "common/messages/part_assembler.hpp"
#include "services/odometer/params.hpp"

namespace lookout::odometer {

class Service {
 public:
  Service(bus::Bus& bus, const Params& params);

  /// Live only: host time has come so far. To be called once a second.
  void AdvanceTo(Utime host_time) { scans_watch_.AdvanceTo(host_time); }

  /// @return degraded while no LIDAR_SCAN comes. Open water is no fault: `motions_unknown` counts it
  HealthReport Report() const;

 private:
  void OnScan(const lidar_scan_t& message);
  void Count(Reason reason);

  bus::Bus& bus_;
  Odometer odometer_;
  std::optional<std::int64_t> last_seq_;
  messages::PartAssembler<lidar_scan_t> assembler_;
  Counts<messages::kScanFaults> refusals_;
  InputWatch scans_watch_{bus::kLidarScan.name};
  static constexpr auto kCountNames = std::to_array<std::string_view>(
      {"motions_known", "motions_unknown", "unknown_first_scan", "unknown_gap", "unknown_few_returns", "unknown_one_thing", "unknown_no_fit",
       "unknown_undetermined", "scans_incomplete", "scans_inconsistent", "parts_duplicate", "parts_inconsistent"});
  Counts<kCountNames> counts_;
};

}  // namespace lookout::odometer
