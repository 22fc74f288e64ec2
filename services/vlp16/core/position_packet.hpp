// The position packet: the sensor's clock, its PPS, and the NMEA sentence that it last took from a GNSS receiver.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/core/bytes.hpp"

namespace lookout::vlp16 {

/// Why a payload is not a position packet.
enum class PositionFault {
  kNone,
  kSize,
  kStamp,     // beyond the hour
  kPps,       // not one of the four states
  kSentence,  // bytes that are not printable ASCII, no $ at the start, or no end
};
inline constexpr std::array<std::string_view, 5> kPositionFaultNames{"position_packets_whole", "position_bad_size", "position_bad_stamp",
                                                                     "position_bad_pps", "position_bad_sentence"};

struct PositionPacket {
  std::uint32_t stamp_us = 0;  // past the hour
  int pps = 0;                 // format::kPpsAbsent to kPpsError
  std::string sentence;        // from $, without CR LF; empty when the sensor has none
  bool has_valid_rmc = false;  // the sentence is an RMC of status A, and its checksum, where it has one, is right
};

struct PositionPacketResult {
  PositionFault fault = PositionFault::kNone;
  PositionPacket packet;  // only when there is no fault
};

PositionPacketResult ParsePositionPacket(Bytes payload);

/// @return whether `sentence` is an RMC ($--RMC) of status A whose checksum, where it has one, is right
bool IsValidRmc(std::string_view sentence);

}  // namespace lookout::vlp16
