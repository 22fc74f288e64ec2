#include "services/tracker/map_telling.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "common/bus/channels.hpp"

namespace lookout::tracker {

void MapTelling::Tell(const ScanLabel& label, std::int32_t source, const OwnMap& map, std::optional<Utime> land_begin, int least_parts) {
  auto parts = ToMessages({label, next_seq_++, source, land_begin}, map, bus::kMaxMessageBytes, least_parts);
  parts_.assign(std::make_move_iterator(parts.begin()), std::make_move_iterator(parts.end()));
}

std::optional<map_t> MapTelling::Next(const ScanLabel& label, bool is_placed, Tracker& tracker) {
  const auto minute = std::chrono::floor<std::chrono::minutes>(label.end_time.time_since_epoch()).count();
  if (minute_ && *minute_ != minute) is_due_ = true;
  minute_ = minute;

  if (given_) {
    const GivenMap given = std::move(*given_);
    given_.reset();
    ScanLabel without_datum = label;
    without_datum.datum = {};
    without_datum.own_up_m = 0.0;
    Tell(without_datum, map_t::SOURCE_GIVEN, given.map, std::nullopt, given.num_parts);
    is_cut_ = std::cmp_not_equal(parts_.front().num_parts, parts_.size());
    // What the wire rounds is used as it is rounded.
    for (const auto& part : parts_) {
      auto map = ToOwnMap(part);
      if (!map) continue;
      std::ranges::move(map->things, std::back_inserter(used_.things));
    }
  } else if (is_due_ && is_placed && is_given_ && parts_.empty()) {
    is_due_ = false;
    Tell(label, map_t::SOURCE_KEPT, tracker.TakeMap(), tracker.land_begin());
  }
  if (parts_.empty()) return std::nullopt;
  std::optional<map_t> part = std::move(parts_.front());
  parts_.pop_front();
  if (parts_.empty() && !is_given_ && !is_cut_) {
    tracker.GiveMap(std::exchange(used_, {}));
    is_given_ = true;
  }
  return part;
}

}  // namespace lookout::tracker
