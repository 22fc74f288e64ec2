// Between MAP and the boat's own map.
#pragma once

#include <optional>
#include <vector>

#include "lookout/map_t.hpp"
#include "services/tracker/core/own_map.hpp"
#include "services/tracker/wire.hpp"

namespace lookout::tracker {

/// What MAP says beside its content.
struct MapLabel {
  ScanLabel scan;        // after which it was made; GIVEN: without a datum
  std::int64_t seq = 0;  // of the maps of a process
  std::int32_t source = map_t::SOURCE_KEPT;
  std::optional<Utime> land_begin;
};

/// @param least_parts  as many are announced; what does not follow was lost
/// @return at least one part; a thing or a tile that is larger than a message is left out
std::vector<map_t> ToMessages(const MapLabel& label, const OwnMap& map, int max_message_bytes, int least_parts = 1);

/// One part.
/// @return nullopt where messages::IsWellFormed refuses it, or land of GIVEN lies off the earth
std::optional<OwnMap> ToOwnMap(const map_t& message);

}  // namespace lookout::tracker
