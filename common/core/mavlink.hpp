// Frames of MAVLink 1 and 2 in bytes: which messages they hold, and their checksum. Source: MAVLink guide, "Serialization".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace lookout {

/// A message that is looked for.
struct MavlinkKind {
  std::uint32_t id;
  std::uint8_t crc_extra;         // of the layout of its fields
  std::size_t num_bytes;          // of its payload without extensions: MAVLink 1 has exactly so many
  std::size_t max_payload_bytes;  // MAVLink 2, with extensions; trailing zeros are not sent, so there may be fewer
};

struct MavlinkFrame {
  int system_id = 0;
  int component_id = 0;
  std::uint32_t id = 0;
  std::string_view payload;  // as it was sent
  std::string_view bytes;    // the whole frame, with its signature if it has one
};

/// A message, or the lack of one, at the begin of some bytes.
struct MavlinkLook {
  enum class Verdict {
    kNone,         // no message of the kinds that are looked for begins here
    kUnfinished,   // a message may begin here, and goes on behind the last byte
    kBadChecksum,  // a message would begin here, but for its checksum
    kFrame,
  };
  Verdict verdict = Verdict::kNone;
  MavlinkFrame frame = {};  // of kFrame; views into the bytes
};

/// CRC-16/MCRF4XX of a frame behind its first byte, and of its message's CRC_EXTRA.
std::uint16_t MavlinkCrc(std::string_view bytes, std::uint8_t crc_extra);

/// Looks at the first byte and what follows it. A signature (MAVLink 2) is passed over, not checked.
MavlinkLook LookForMavlink(std::string_view bytes, std::span<const MavlinkKind> kinds);

struct MavlinkFound {
  std::vector<MavlinkFrame> frames;    // views into the bytes
  std::int64_t num_bad_checksum = 0;   // frames
  std::int64_t num_skipped_bytes = 0;  // of no frame that is looked for
  std::size_t num_used = 0;            // bytes: the rest may be the begin of a frame
};

/// All frames, wherever they stand.
MavlinkFound FindMavlink(std::string_view bytes, std::span<const MavlinkKind> kinds);

/// @return most bytes of a frame whose payload has at most `max_payload_bytes`: head, checksum and signature of MAVLink 2 with it
constexpr std::size_t MaxMavlinkFrameBytes(std::size_t max_payload_bytes) { return 10 + max_payload_bytes + 2 + 13; }

}  // namespace lookout
