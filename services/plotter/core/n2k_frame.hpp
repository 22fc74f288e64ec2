// Messages of NMEA 2000 as frames of CAN, and frames as the RAW text of Yacht Devices' gateways. Layout: ISO 11783-3 (identifier of 29 bits),
// canboat's description of the fast packet, and appendix E of the gateways' manuals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::plotter {

inline constexpr std::uint8_t kN2kEverybody = 0xFF;
/// The source of a device that has no address.
inline constexpr std::uint8_t kN2kNoAddress = 0xFE;

struct N2kMessage {
  std::uint32_t pgn = 0;
  std::uint8_t priority = 0;  // 0 (highest) to 7
  bool is_fast_packet = false;
  std::vector<std::uint8_t> payload;         // up to 8 bytes; in a fast packet up to 223
  std::uint8_t destination = kN2kEverybody;  // counts for PGNs with a destination (PDU1)
};

inline constexpr std::size_t kMostFastPacketBytes = 223;

/// One frame of CAN 2.0B.
struct N2kFrame {
  std::uint32_t id = 0;             // 29 bits
  std::vector<std::uint8_t> bytes;  // 0 to 8

  bool operator==(const N2kFrame&) const = default;
};

/// The parts of a frame's identifier.
struct N2kHeader {
  std::uint32_t pgn = 0;
  std::uint8_t priority = 0;
  std::uint8_t source = 0;
  std::uint8_t destination = kN2kEverybody;

  bool operator==(const N2kHeader&) const = default;
};

std::uint32_t CanIdOf(const N2kHeader& header);
N2kHeader HeaderOf(std::uint32_t can_id);

/// @param sequence  0 to 7, of this fast packet: one more for each
/// Precondition: the payload has at most 8 bytes, of a fast packet at most kMostFastPacketBytes.
std::vector<N2kFrame> FramesOf(const N2kMessage& message, std::uint8_t source, int sequence);

/// A line that a gateway sends onto the network: "<id> <bytes>" CR LF, in hexadecimal digits.
std::string RawLine(const N2kFrame& frame);

/// nullopt: the text is no such line (its end is cut off), or the identifier has more than 29 bits.
std::optional<N2kFrame> ReadRawLine(std::string_view line);

/// A frame that a gateway tells of.
struct HeardFrame {
  N2kFrame frame;
  bool is_echo = false;  // direction T: a program sent the frame through this gateway

  bool operator==(const HeardFrame&) const = default;
};

/// "hh:mm:ss.ddd <R or T> <id> <bytes>" without its end. nullopt: the text is no such line. Only the form of the time is checked.
std::optional<HeardFrame> ReadHeardLine(std::string_view line);

}  // namespace lookout::plotter
