#include "common/core/mavlink.hpp"

#include <algorithm>

namespace lookout {

namespace {

constexpr std::uint8_t kMagic1 = 0xFE;
constexpr std::uint8_t kMagic2 = 0xFD;
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kSignatureBytes = 13;
constexpr std::uint8_t kSigned = 1;  // the only flag that a receiver knows: frames with others must not be read

std::uint8_t ByteAt(std::string_view bytes, std::size_t index) { return static_cast<std::uint8_t>(bytes[index]); }

// Where the head of a frame has what.
struct Head {
  std::size_t num_bytes;
  std::size_t system_at;  // behind it the component, and then the number of the message
  std::size_t num_id_bytes;
};
constexpr Head kHead1{6, 3, 1};
constexpr Head kHead2{10, 5, 3};

std::uint32_t IdOf(std::string_view frame, const Head& head) {
  std::uint32_t id = 0;
  for (std::size_t i = head.num_id_bytes; i > 0; --i) id = id << 8U | ByteAt(frame, head.num_bytes - head.num_id_bytes + i - 1);
  return id;
}

}  // namespace

std::uint16_t MavlinkCrc(std::string_view bytes, std::uint8_t crc_extra) {
  std::uint16_t crc = 0xFFFF;
  const auto add = [&crc](std::uint8_t byte) {
    auto mixed = static_cast<std::uint8_t>(byte ^ (crc & 0xFF));
    mixed = static_cast<std::uint8_t>(mixed ^ (mixed << 4));
    crc = static_cast<std::uint16_t>((crc >> 8) ^ (mixed << 8) ^ (mixed << 3) ^ (mixed >> 4));
  };
  for (const char byte : bytes) add(static_cast<std::uint8_t>(byte));
  add(crc_extra);
  return crc;
}

MavlinkLook LookForMavlink(std::string_view bytes, std::span<const MavlinkKind> kinds) {
  using enum MavlinkLook::Verdict;
  if (bytes.empty()) return {kUnfinished};
  const bool is_second = ByteAt(bytes, 0) == kMagic2;
  if (!is_second && ByteAt(bytes, 0) != kMagic1) return {kNone};
  const Head& head = is_second ? kHead2 : kHead1;
  if (bytes.size() < head.num_bytes) return {kUnfinished};
  const std::uint32_t id = IdOf(bytes, head);
  const auto kind = std::ranges::find(kinds, id, &MavlinkKind::id);
  if (kind == kinds.end()) return {kNone};
  const std::size_t num_payload = ByteAt(bytes, 1);
  const std::uint8_t flags = is_second ? ByteAt(bytes, 2) : 0;
  const bool has_size = is_second ? num_payload > 0 && num_payload <= kind->max_payload_bytes : num_payload == kind->num_bytes;
  if (!has_size || (flags & ~kSigned) != 0) return {kNone};
  const std::size_t crc_at = head.num_bytes + num_payload;
  const std::size_t end = crc_at + kCrcBytes + ((flags & kSigned) != 0 ? kSignatureBytes : 0);
  if (bytes.size() < end) return {kUnfinished};
  const int stated = ByteAt(bytes, crc_at) | ByteAt(bytes, crc_at + 1) << 8;
  if (MavlinkCrc(bytes.substr(1, crc_at - 1), kind->crc_extra) != stated) return {kBadChecksum};
  return {kFrame,
          {.system_id = ByteAt(bytes, head.system_at),
           .component_id = ByteAt(bytes, head.system_at + 1),
           .id = id,
           .payload = bytes.substr(head.num_bytes, num_payload),
           .bytes = bytes.substr(0, end)}};
}

MavlinkFound FindMavlink(std::string_view bytes, std::span<const MavlinkKind> kinds) {
  MavlinkFound found;
  while (found.num_used < bytes.size()) {
    const auto [verdict, frame] = LookForMavlink(bytes.substr(found.num_used), kinds);
    if (verdict == MavlinkLook::Verdict::kUnfinished) break;
    if (verdict == MavlinkLook::Verdict::kFrame) {
      found.frames.push_back(frame);
      found.num_used += frame.bytes.size();
      continue;
    }
    found.num_bad_checksum += verdict == MavlinkLook::Verdict::kBadChecksum ? 1 : 0;
    ++found.num_skipped_bytes;
    ++found.num_used;
  }
  return found;
}

}  // namespace lookout
