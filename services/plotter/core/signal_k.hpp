// Signal K deltas (specification 1.7 and its targets): one JSON text each, on one line that ends with LF. Units are those of Signal K: rad, m, m/s,
// s.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

/// Part of a target's context: letters, digits, - and _; what else the name of a boat has becomes _.
std::string BoatWord(std::string_view boat);

/// navigation.* of vessels.self. What is not known is null, so that nothing old stays.
std::string OwnShipDelta(const OwnShip& own);

/// targets.lidar:<boat>-<id>: position, course, speed, size, closest approach (hull to hull).
/// @param boat  BoatWord
std::string TargetDelta(std::string_view boat, const Target& target, Utime time);
/// Its end: position, course, speed and closest approach are null.
std::string TargetEndDelta(std::string_view boat, std::int64_t target_id, Utime time);

/// notifications.lookout.<word>: warn for a caution, alarm for a warning; visual alone once it is acknowledged; alert for what is over and was not
/// acknowledged; normal when it is over. The word is of this alert alone: a server remembers by path that one was acknowledged.
std::string NoticeDelta(const Notice& notice, Utime time);
std::string NoticeWord(const Notice& notice);

/// What asks a server to send notifications back.
std::string NoticeSubscription();

struct AcknowledgedWords {
  bool is_wrong = false;           // no JSON, or no delta
  std::vector<std::string> words;  // NoticeWord
};

/// Notices that a delta from a server says to be acknowledged: by its notifications API (value.status.acknowledged), or in older ones by taking all
/// methods away. The server's own greeting and answers say none.
AcknowledgedWords ReadDelta(std::string_view text);

}  // namespace lookout::plotter
