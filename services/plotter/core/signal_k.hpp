// Signal K deltas (specification 1.7 and its targets): one JSON text each, on one line that ends with LF. Units as in Signal K: rad, m, m/s, s.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

/// Part of a target's context: letters, digits, - and _; other characters of the boat's name become _.
std::string BoatWord(std::string_view boat);

/// navigation.* of vessels.self. Unknown values are null, so that nothing old stays.
std::string OwnShipDelta(const OwnShip& own);

/// targets.lidar:<boat>-<place>.
/// @param boat   BoatWord
/// @param place  as of TargetPlaces
std::string TargetContext(std::string_view boat, int place);
/// vessels.urn:mrn:signalk:uuid:<uuid>, the same for this boat and place at each start. No MMSI: nobody has given it one.
std::string VesselContext(std::string_view boat, int place);
/// As people, or AIS, call it, else as its track is called.
std::string TargetName(const Target& target);
/// Name, position, course, speed, size, closest approach (hull to hull).
std::string TargetDelta(std::string_view context, const Target& target, Utime time);
/// The end of a target: position, course, speed and closest approach are null.
///
/// @param new_name  for displays that keep the last position, and show the name beside it; empty: the target keeps its name
std::string TargetEndDelta(std::string_view context, Utime time, std::string_view new_name = {});

/// notifications.lookout.<word>: warn for a caution, alarm for a warning; with sound where this notice is the one that sounds; alert for a notice
/// that is over and was not acknowledged; normal for other notices that are over. The delta says when the alert was raised, and that it is
/// acknowledged, wherever that was done: then the server's own status says so, too.
std::string NoticeDelta(const Notice& notice, std::string_view word, Utime time);

/// Names one raising of an alert, and one escalation of it. A server remembers acknowledgements by path: a user hears nothing of a new alert under an
/// old path.
std::string NoticeWord(const Notice& notice);

/// The subscription by which a server sends notifications back.
std::string NoticeSubscription();

/// The present state of a notification at a server.
struct NoticeEcho {
  std::string word;
  bool is_raised = false;        // the notification's state is not normal
  bool is_acknowledged = false;  // by the server's notifications API
  /// The notification is an alarm or a warning without sound, or was set to normal, and not by that API: as older displays acknowledge. A
  /// notification that was sent without sound comes back so, too.
  bool is_quiet = false;
};

struct ReadEchoes {
  bool is_wrong = false;  // no JSON, or no delta
  std::vector<NoticeEcho> echoes;
};

/// A text from a server: a delta; or its greeting or an answer, which hold none.
ReadEchoes ReadDelta(std::string_view text);

}  // namespace lookout::plotter
