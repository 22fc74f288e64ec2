// Between the messages of navigator and its own types.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/pose_t.hpp"
#include "services/navigator/core/item.hpp"
#include "services/navigator/core/measurement.hpp"
#include "services/navigator/core/pose.hpp"

namespace lookout::navigator {

/// Why a NAV_RAW message is not an item.
enum class ItemFault {
  kNone,
  kBadTime,  // outside of the bounds of Utime
  kBadKind,
  kBadText,  // a sentence that is not IsLine, a source that is not a word, or either where there is none
  kBadImu,   // not as many samples as the kind has, or a number that cannot be
};
inline constexpr std::size_t kNumItemFaults = static_cast<std::size_t>(ItemFault::kBadImu) + 1;

struct ItemResult {
  ItemFault fault = ItemFault::kNone;
  Item item;  // only when there is no fault
};

nav_raw_t ToMessage(const Item& item);
ItemResult ToItem(const nav_raw_t& message);

gnss_fix_t ToMessage(const GnssFix& fix, std::int64_t seq, std::int64_t raw_seq);
attitude_t ToMessage(const Attitude& attitude, std::int64_t seq, std::int64_t raw_seq);
pose_t ToMessage(const Pose& pose, std::int64_t seq, std::int64_t raw_seq);

}  // namespace lookout::navigator
