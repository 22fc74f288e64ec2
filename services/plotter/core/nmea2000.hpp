// Messages of NMEA 2000 for the own ship and for targets, as the text of two makers' gateways. Layout of the payloads: canboat's description of
// PGN 128520, 129025 and 129026. The first is marked there as incomplete; a frame of a Raymarine display has the same layout, byte by byte (the
// tests).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/plotter/core/n2k_frame.hpp"
#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

/// 129025 Position, Rapid Update. Precondition: own.is_placed().
N2kMessage PositionMessage(const OwnShip& own);
/// 129026 COG & SOG, Rapid Update.
N2kMessage CourseMessage(const OwnShip& own);
/// 128520 Tracked Target Data: true bearing and range from the own ship's reference point to the target's centre; closest approach hull to hull.
///
/// @param number  0 to 99
/// Precondition: own.is_placed(); `target` is propagated to own.time.
N2kMessage TargetMessage(const OwnShip& own, const Target& target, int number);

/// Actisense N2K ASCII: one line, "Ahhmmss.ddd <SS><DD><P> <PPPPP> payload" CR LF.
std::string ActisenseLine(const N2kMessage& message, Utime time);

/// Frames of one message as Yacht Devices' RAW text: "hh:mm:ss.ddd R <id> <bytes>" CR LF each.
///
/// @param sequence  0 to 7, of this fast packet: one more for each
std::string YdenLines(const N2kMessage& message, Utime time, int sequence);

}  // namespace lookout::plotter
