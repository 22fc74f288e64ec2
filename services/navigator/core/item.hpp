// One item of navigator's input: what NAV_RAW holds, and all that POSE is computed from.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/core/utime.hpp"

namespace lookout::navigator {

/// The numbers of nav_raw_t.
enum class ItemKind { kStart = 0, kSentence = 1, kImu = 2, kTick = 3, kEnd = 4 };

/// A sample along the axes of a sensor that is lined up with the boat: x forward, y to starboard, z down.
struct RawImu {
  std::array<double, 3> angular_velocity_radps{};
  std::array<double, 3> specific_force_mps2{};  // at rest and level z is -9.81
};

struct Item {
  Utime time;  // arrival; never less than that of the item before, except at a start mark
  std::int64_t seq = 0;
  ItemKind kind = ItemKind::kTick;
  std::string source;           // of a sentence: kUdpSource, kLidarSource, or the name of an input in config
  std::string sentence;         // of a sentence: IsLine
  std::optional<RawImu> imu{};  // of a sample
};

inline constexpr char kUdpSource[] = "udp";
inline constexpr char kLidarSource[] = "lidar";

}  // namespace lookout::navigator
