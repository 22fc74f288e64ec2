// Between the messages of the AIS process and its own types.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <variant>

#include "lookout/ais_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/ais/core/watcher.hpp"

namespace lookout::ais {

/// Why a message is refused: the name of a counter.
using Fault = std::string_view;

inline constexpr Fault kTracksTime = "tracks_refused_time";      // does not exist, or the end before the begin
inline constexpr Fault kTracksParts = "tracks_refused_parts";    // part_index, num_parts (above 1000), or counts that do not agree
inline constexpr Fault kTracksNumber = "tracks_refused_number";  // not finite, or beyond what can be
inline constexpr Fault kTracksId = "tracks_refused_id";          // ids that do not increase
inline constexpr std::array kTracksFaults{kTracksTime, kTracksParts, kTracksNumber, kTracksId};

/// @return the fault of one part of TRACKS; empty where there is none
Fault FaultOf(const tracks_t& message);

/// The scan out of its parts: confirmed and coasting tracks, whose ids increase.
///
/// @param parts  all of one scan, at least one, by part_index, each without a fault
/// @return kTracksId where ids of two parts do not increase
std::variant<TracksOfScan, Fault> ToScan(std::span<const tracks_t> parts);

/// @param message  holds a sentence or a start mark, and a time that exists
Item ToItem(const nav_raw_t& message, Utime time);

ais_t ToMessage(const TracksOfScan& scan, const Picture& picture, std::int64_t seq);

}  // namespace lookout::ais
