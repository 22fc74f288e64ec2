// Frames of an autopilot's MAVLink as lines that may stand in NAV_RAW: "$PLKMAV," and the bytes of a frame in hexadecimal digits.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/mavlink.hpp"
#include "common/core/utime.hpp"
#include "services/navigator/core/lines.hpp"

namespace lookout::navigator {

inline constexpr std::string_view kMavlinkAddress = "PLKMAV";

/// Payloads of at most so many bytes are read. GPS_RAW_INT, the longest, has 52 with its extensions; more may be added to it.
inline constexpr std::size_t kMaxMavlinkPayloadBytes = 80;
/// $ address , digits * checksum.
static_assert(kMavlinkAddress.size() + 2 * MaxMavlinkFrameBytes(kMaxMavlinkPayloadBytes) + 5 <= kMaxLineCharacters);

/// Numbers of messages of common.xml.
inline constexpr std::uint32_t kMavlinkGpsRawInt = 24;
inline constexpr std::uint32_t kMavlinkAttitude = 30;
inline constexpr std::uint32_t kMavlinkGlobalPositionInt = 33;

/// The messages that are read.
inline constexpr std::array kMavlinkKinds{MavlinkKind{kMavlinkGpsRawInt, 24, 30, kMaxMavlinkPayloadBytes},
                                          MavlinkKind{kMavlinkAttitude, 39, 28, kMaxMavlinkPayloadBytes},
                                          MavlinkKind{kMavlinkGlobalPositionInt, 104, 28, kMaxMavlinkPayloadBytes}};

/// @return a line of NAV_RAW
std::string ToMavlinkLine(std::string_view frame);

/// @param line  from $ to the checksum
/// @return the bytes of its one frame, which may be a frame or not; nullopt: it is no line of that form
std::optional<std::string> MavlinkBytesOf(std::string_view line);

/// The lines of some bytes, and what was not used.
struct MavlinkLines {
  std::vector<std::string> lines;      // of the autopilot, checksum right
  std::int64_t num_bad_checksum = 0;   // frames
  std::int64_t num_other_sender = 0;   // frames of another system or component: right otherwise
  std::int64_t num_skipped_bytes = 0;  // bytes outside of frames that are read: other messages, text, noise
};

/// Finds the frames of one autopilot (MAVLink 1 and 2) in the bytes that one input receives. Frames may begin anywhere, and may be cut anywhere over
/// datagrams of one sender or pieces of a stream. Holds at most the begin of one frame for each of kMaxSenders.
class MavlinkCutter {
 public:
  static constexpr int kAutopilotComponent = 1;  // MAV_COMP_ID_AUTOPILOT1
  static constexpr std::size_t kMaxSenders = 64;
  /// The rest of a frame comes within this: on a serial line of 4800 baud the longest takes 0.22 s. Then its begin is skipped.
  static constexpr std::chrono::milliseconds kMaxWait{300};

  explicit MavlinkCutter(int system_id) : system_id_(system_id) {}

  /// @param sender  address and port of a datagram; empty: a stream
  MavlinkLines Add(Utime arrival, Bytes bytes, const std::string& sender = {});

  /// The stream broke off: its incomplete frame is void.
  void Clear() { held_.clear(); }

 private:
  struct Held {
    std::string bytes;
    Utime arrival;  // of the last bytes
  };

  int system_id_;
  std::map<std::string, Held> held_;  // by sender
};

}  // namespace lookout::navigator
