// The segmenter process without its shell: LIDAR_SCAN in, SEGMENTS out. It keeps nothing between scans.
#pragma once

#include <chrono>
#include <cstdint>
#include <list>
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
  Service(bus::Bus& bus, const Lanes& params);
  Service(bus::Bus& bus, const Params& params) : Service(bus, Lanes{params, std::nullopt}) {}

  /// Live only: host time has come so far. To be called once a second.
  void AdvanceTo(Utime host_time) {
    time_.Advance(host_time);
    for (auto& lane : lanes_) lane.watch.AdvanceTo(host_time);
  }

  /// @return degraded while no LIDAR_SCAN comes, or the latest was refused, for a minute at most
  HealthReport Report() const;

 private:
  struct Lane {
    Lane(const bus::Channel& scans, const bus::Channel& out, const Params& params) : segments(out), segmenter(params), watch(scans.name) {}

    const bus::Channel& segments;
    Segmenter segmenter;
    messages::PartAssembler<lidar_scan_t> assembler = {};
    InputWatch watch;
    std::optional<messages::Fault> last_fault = {};  // of the latest message, if it was refused
    std::chrono::microseconds refused_at{0};
  };

  void Add(const bus::Channel& scans, const bus::Channel& segments, const Params& params);
  void OnScan(const lidar_scan_t& message, Lane& lane);

  bus::Bus& bus_;
  std::list<Lane> lanes_;
  Counts<messages::kScanFaults> refusals_;
  PassedTime time_{std::chrono::seconds(2)};
  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"scans", "segments", "segments_too_small", "segments_over_limit", "returns_repeated", "scans_without_pieces",
                                       "scans_incomplete", "scans_inconsistent", "parts_duplicate", "parts_inconsistent"});
  Counts<kCountNames> counts_;
};

}  // namespace lookout::segmenter
