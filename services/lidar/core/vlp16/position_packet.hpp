// The position packet: the sensor's clock, its PPS, its temperatures, and the NMEA sentence that it last took from a GNSS receiver.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/bytes.hpp"
#include "services/lidar/core/driver/decoder.hpp"

namespace lookout::vlp16 {

/// Why a payload is not a position packet. kSentence is the mildest: the packet counts, its sentence does not.
enum class PositionFault {
  kNone,
  kSize,
  kPps,       // not one of the four known states
  kSentence,  // bytes that are not printable ASCII, no $ at the start, or no end (a serial line of the wrong polarity or rate)
};
inline constexpr std::array<std::string_view, 4> kPositionFaultNames{"position_packets_whole", "position_bad_size", "position_bad_pps",
                                                                     "position_bad_sentence"};

/// The UTC that a sentence with a fix tells.
struct SentenceTime {
  std::chrono::microseconds time_of_day{0};   // 86400 s and more in a leap second
  std::optional<std::chrono::sys_days> date;  // GGA has none; of two digits of the year, 80 and above are of the last century

  friend bool operator==(const SentenceTime&, const SentenceTime&) = default;
};

using lidar::Telemetry;  // of newer firmware

struct PositionPacket {
  std::uint32_t stamp_us = 0;          // past the hour; as in data packets it may be more than an hour
  int pps = 0;                         // format::kPpsAbsent to kPpsError
  std::string sentence;                // from $, without CR LF; empty when the sensor has none
  std::optional<SentenceTime> time;    // of the sentence, when it is valid: see TimeOfSentence
  std::optional<Telemetry> telemetry;  // when the firmware tells
};

struct PositionPacketResult {
  PositionFault fault = PositionFault::kNone;
  PositionPacket packet;  // when there is no fault, or kSentence: then without a sentence
};

PositionPacketResult ParsePositionPacket(Bytes payload);

/// @return the time of an RMC of status A or of a GGA with a fix, of any talker, whose checksum, where it has one, is right; nullopt for all else
std::optional<SentenceTime> TimeOfSentence(std::string_view sentence);

}  // namespace lookout::vlp16
