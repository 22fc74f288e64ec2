// One item of navigator's input: what NAV_RAW holds, and all that POSE is computed from.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/core/utime.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

/// The numbers of nav_raw_t.
enum class ItemKind { kStart = 0, kSentence = 1, kImu = 2, kTick = 3, kEnd = 4 };

struct Item {
  Utime time;  // arrival; never before that of the previous item, except at a start mark
  std::int64_t seq = 0;
  ItemKind kind = ItemKind::kTick;
  std::string source;                    // of a sentence: kUdpSource, kLidarSource, or the name of an input in config
  std::string sentence;                  // of a sentence: IsLine
  std::optional<StrapdownSample> imu{};  // of a sample
};

inline constexpr char kUdpSource[] = "udp";
inline constexpr char kLidarSource[] = "lidar";
/// LIDAR_ODOMETRY, each as a line (core/odometry.hpp).
inline constexpr char kOdometerSource[] = "odometer";

}  // namespace lookout::navigator
