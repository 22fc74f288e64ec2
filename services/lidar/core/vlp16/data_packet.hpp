// The data packet of the VLP-16 family: checked once as a whole, then read in place.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

#include "common/core/bytes.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::vlp16 {

enum class ReturnMode { kStrongest, kLast, kDual };

/// Why a payload is not a data packet.
enum class DataFault {
  kNone,
  kSize,
  kFlag,          // a block does not begin with the flag
  kAzimuth,       // beyond 360 deg by more than rounding: a block with an impossible angle cannot be trusted
  kReturnMode,    // not one of the three known modes
  kAzimuthOrder,  // the blocks go round more than once, which no motor does in a millisecond
  kDualPair,      // dual return, but the two blocks of a pair differ in azimuth
};
inline constexpr std::array<std::string_view, 7> kDataFaultNames{"data_packets_whole", "data_bad_size",        "data_bad_flag",
                                                                 "data_bad_azimuth",   "data_bad_return_mode", "data_bad_azimuth_order",
                                                                 "data_bad_dual_pair"};

/// A step is a block, or in dual return a pair of blocks: two firing sequences in format::kBlockPeriod.
struct DataPacket {
  Bytes payload;               // format::kDataPacketSizeBytes, checked; belongs to the caller
  std::uint32_t stamp_us = 0;  // of the first shot, past the hour; in a leap second, and of a clock that never was set, it may be an hour or more
  ReturnMode mode = ReturnMode::kStrongest;
  std::uint8_t product = 0;
  int num_steps = 0;
  bool has_wrapped_azimuth = false;                    // a block said 36000 or a little more, and was taken as 0 or a little more
  std::array<int, format::kNumBlocks> azimuth_cdeg{};  // [num_steps] of the first shot of each, 0 to 35999

  int num_returns() const { return mode == ReturnMode::kDual ? 2 : 1; }
  std::chrono::nanoseconds period() const { return num_steps * format::kBlockPeriod; }
};

struct DataPacketResult {
  DataFault fault = DataFault::kNone;
  DataPacket packet;  // only when there is no fault
};

/// Checks a payload as a whole. The product byte is not checked here: see ModelDetector.
DataPacketResult ParseDataPacket(Bytes payload);

/// A rotation of the head by more than this in one step is a jump (limited field of view), not a rate: 1200 rpm and a quarter more.
inline constexpr int kMaxGapCdeg = 99;
static_assert(kMaxGapCdeg <=
              1.25 * format::kMaxRpm / 60.0 * format::kAzimuthsPerRevolution * std::chrono::duration<double>(format::kBlockPeriod).count());

/// @return azimuth in [0, 36000) after going from `from_cdeg` to `to_cdeg` clockwise
constexpr int ClockwiseCdeg(int from_cdeg, int to_cdeg) {
  const int difference = to_cdeg - from_cdeg;
  return difference < 0 ? difference + format::kAzimuthsPerRevolution : difference;
}

/// A part of the circle that the head went through without firing, or without being heard.
struct Gap {
  int from_cdeg = 0;  // where the next shot was due
  int to_cdeg = 0;    // where the next shot came

  int width_cdeg() const { return ClockwiseCdeg(from_cdeg, to_cdeg); }
};

/// How far the head rotates in each step and when, and how long the packet took.
struct Steps {
  std::array<int, format::kNumBlocks> gap_cdeg{};                   // [num_steps] per format::kBlockPeriod
  std::array<std::chrono::nanoseconds, format::kNumBlocks> time{};  // [num_steps] since the first shot of the packet
  std::chrono::nanoseconds duration{0};                             // from the first shot of the packet to the first shot of the next
  std::optional<Gap> jump;                                          // the widest, where the head did not fire for a while

  /// Azimuth at which the next packet begins when the head fires on.
  int end_cdeg = 0;
};

/// The manual, 9.5: the gap of a step is the azimuth of the next step minus its own, across 0. The last step has the last gap before it that is
/// a rate. Where a gap is a jump, or goes back, the median of the others stands in.
///
/// @param known_cdeg  per format::kBlockPeriod, from packets before; 0 = not known. A jump takes as long as the head needs at this rate; where it is
///                    0, at the rate of this packet, which is known to some percent only. `known_cdeg` also stands in for the gaps of a packet that
///                    has no rate.
Steps MeasureSteps(const DataPacket& packet, double known_cdeg);

}  // namespace lookout::vlp16
