// Between the messages of navigator and its own types.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/lidar_odometry_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/pose_t.hpp"
#include "services/navigator/core/item.hpp"
#include "services/navigator/core/measurement.hpp"
#include "services/navigator/core/odometry.hpp"
#include "services/navigator/core/pose.hpp"

namespace lookout::navigator {

/// Why a NAV_RAW message is not an item: the name of a counter.
using Refusal = std::string_view;

inline constexpr Refusal kRawTime = "nav_raw_bad_time";  // outside of the bounds of Utime
inline constexpr Refusal kRawKind = "nav_raw_bad_kind";
inline constexpr Refusal kRawText = "nav_raw_bad_text";  // a sentence that is not IsLine, a source that is not a word, or either where there is none
inline constexpr Refusal kRawImu = "nav_raw_bad_imu";    // not as many samples as the kind has, or a number that cannot be

nav_raw_t ToMessage(const Item& item);
std::variant<Item, Refusal> ToItem(const nav_raw_t& message);

/// @return nullopt where a time or a number cannot be
std::optional<OdometryMotion> ToMotion(const lidar_odometry_t& message);

gnss_fix_t ToMessage(const GnssFix& fix, std::int64_t seq, std::int64_t raw_seq);
attitude_t ToMessage(const Attitude& attitude, std::int64_t seq, std::int64_t raw_seq);
pose_t ToMessage(const Pose& pose, std::int64_t seq, std::int64_t raw_seq);

}  // namespace lookout::navigator
