// Bounds of what a sentence may say, whatever its kind.
#pragma once

namespace lookout::navigator {

inline constexpr double kMaxSpeedMps = 100.0;   // of receivers on boats: 194 knots
inline constexpr double kMinHeightM = -1000.0;  // the Dead Sea lies at -430 m
inline constexpr double kMaxHeightM = 20'000.0;
inline constexpr double kMaxSdM = 1e6;  // receivers without a fix send great deviations

}  // namespace lookout::navigator
