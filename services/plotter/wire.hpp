// From the messages that the plotter reads to its own types, checked.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/messages/checks.hpp"
#include "lookout/ais_t.hpp"
#include "lookout/alert_ack_t.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/order_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

using messages::Fault;

inline constexpr Fault kTracksTime = "tracks_refused_time";      // does not exist
inline constexpr Fault kTracksParts = "tracks_refused_parts";    // part_index or num_parts (above 1000)
inline constexpr Fault kTracksNumber = "tracks_refused_number";  // no place on the earth, not finite, or no speed, length or probability that can be
inline constexpr Fault kTracksCode = "tracks_refused_code";      // a status that does not exist
inline constexpr Fault kTracksId = "tracks_refused_id";          // ids that do not increase, 0 or -1
inline constexpr std::array kTracksFaults{kTracksTime, kTracksParts, kTracksNumber, kTracksCode, kTracksId};

inline constexpr Fault kAlertsTime = "alerts_refused_time";  // the time of the message or of an alert does not exist
inline constexpr Fault kAlertsCode = "alerts_refused_code";  // a cause, level or state that does not exist
inline constexpr Fault kAlertsText = "alerts_refused_text";  // more than 1000 bytes
inline constexpr Fault kAlertsId = "alerts_refused_id";      // 0, out of bounds, or twice
inline constexpr std::array kAlertsFaults{kAlertsTime, kAlertsCode, kAlertsText, kAlertsId};

/// By track.
using GivenNames = std::map<std::int64_t, std::string>;

/// One part of TRACKS.
struct TracksPart {
  Utime time;                   // to which the states are propagated
  Utime begin;                  // of the tracker's process: ids of another begin are of other tracks
  std::vector<Target> targets;  // by id; tentative targets are kAcquiring
};

/// The whole message is valid, or it is refused.
std::variant<TracksPart, Fault> ToTracksPart(const tracks_t& message);
std::variant<std::vector<Notice>, Fault> ToNotices(const alerts_t& message);
/// nullopt: one of them is no name, or ids of tracks do not increase.
std::optional<GivenNames> ToGivenNames(const alerts_t& message);

/// Ships of AIS that are tracks, for sure.
struct ShipNames {
  Utime time;                // as TracksPart::time
  Utime tracks_begin;        // as TracksPart::begin
  GivenNames name_of_track;  // her name, else "MMSI 211000001"
  // Whose report is so new that every receiver of AIS still has her.
  std::set<std::int64_t> on_air = {};
};
/// nullopt: a time does not exist.
std::optional<ShipNames> ToShipNames(const ais_t& message);

/// @param message  one that messages::ToPose accepts
OwnShip ToOwnShip(const pose_t& message);

alert_ack_t ToMessage(const Notice& notice, Utime host_time, std::int64_t seq);
/// The order that nothing sounds for a while.
order_t ToSilence(Utime host_time, std::int64_t seq);

}  // namespace lookout::plotter
