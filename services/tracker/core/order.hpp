// An order of a skipper to the look-out.
#pragma once

#include <cstdint>
#include <string>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"

namespace lookout::tracker {

// Numbers of both are those of the wire.
enum class OrderKind : std::int32_t { kSilence = 1, kSettings = 2, kName = 3 };
enum class Mode : std::int32_t { kOpenWater = 1, kHarbour = 2 };

/// NaN: as the config says.
struct Settings {
  Mode mode = Mode::kOpenWater;
  double guard_zone_range_m = kNan;  // 0: none
  double guard_zone_from_rad = kNan;
  double guard_zone_to_rad = kNan;
  double cpa_limit_m = kNan;
};

struct Order {
  Utime time;  // host time of the sender
  std::int64_t seq = 0;
  std::string source;
  OrderKind kind = OrderKind::kSilence;
  Settings settings = {};
  std::int64_t track_id = 0;  // of kName
  std::string name = {};
};

}  // namespace lookout::tracker
