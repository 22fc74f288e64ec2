// The segmenter process without its shell: LIDAR_SCAN in, SEGMENTS out. It keeps nothing between turns.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "common/core/recently.hpp"
#include "common/core/utime.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/segmenter/core/turn_gatherer.hpp"
#include "services/segmenter/params.hpp"
#include "services/segmenter/wire.hpp"

namespace lookout::segmenter {

class Service {
 public:
  Service(bus::Bus& bus, const Params& params);

  /// Live only: host time has come so far. To be called once a second.
  void AdvanceTo(Utime host_time) { time_.Advance(host_time); }

  /// @return degraded while the latest LIDAR_SCAN was refused, for a minute at most
  HealthReport Report() const;

 private:
  void OnScan(const lidar_scan_t& message);

  bus::Bus& bus_;
  Segmenter segmenter_;
  TurnGatherer gatherer_;
  std::array<std::int64_t, kRefusalNames.size()> num_refused_{};
  std::optional<Refusal> last_refusal_;  // of the latest message, if it was refused
  std::chrono::microseconds refused_at_{0};
  PassedTime time_{std::chrono::seconds(2)};
  std::int64_t num_turns_ = 0;
  std::int64_t num_segments_ = 0;
  std::int64_t num_too_small_ = 0;
  std::int64_t num_over_limit_ = 0;
  std::int64_t num_repeats_ = 0;
};

}  // namespace lookout::segmenter
