// Sentences of NMEA 0183 for the own ship and targets; sentences of alerts are in alert_sentences. Each sentence ends with CR LF and has at most 82
// characters, as the standard says, whatever texts it holds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

enum class Unit { kKilometres, kNauticalMiles };  // K: km and km/h; N: nautical miles and knots

inline constexpr std::size_t kMaxSentenceBytes = 82;

/// "$" body "*" checksum CR LF.
///
/// @param body  "RATTM,05,..." without characters that a sentence cannot hold: FieldText
std::string Sentence(std::string_view body);

/// A text as a field: a character reserved in a sentence ($ * , ! \ ^ ~), a control character or one that is no ASCII becomes a space.
std::string FieldText(std::string_view text, std::size_t max_bytes);

/// Bytes of text that fit between `before` and `after` in one sentence.
std::size_t RoomFor(std::string_view before, std::string_view after);

/// hhmmss.ss, cut, not rounded: 59.999 s is no 60.00.
std::string TimeOfDay(Utime time);

/// Position, speed and course. Without a position it is void (V), with empty fields; where that is estimated it is void, too, with mode E.
std::string Rmc(std::string_view talker, const OwnShip& own);
/// True heading. nullopt while it is not known, or estimated.
std::optional<std::string> Hdt(std::string_view talker, const OwnShip& own);
/// Own ship data that belong to TTM: heading, course and speed over ground (reference P: a positioning system).
std::string Osd(std::string_view talker, const OwnShip& own, Unit unit);

/// Tracked target: range in `unit` with 4 decimals and true bearing from the own ship's reference point to the target's centre, speed, true course,
/// closest approach hull to hull, minutes to it.
///
/// @param number  0 to 99
/// Precondition: own.is_placed(); `target` is propagated to own.time.
std::string Ttm(std::string_view talker, const OwnShip& own, const Target& target, int number, Unit unit);
/// Target latitude and longitude.
std::string Tll(std::string_view talker, const Target& target, int number, Utime time);

}  // namespace lookout::plotter
