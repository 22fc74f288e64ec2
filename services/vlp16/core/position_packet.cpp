#include "services/vlp16/core/position_packet.hpp"

#include <algorithm>
#include <charconv>

#include "services/vlp16/core/packet_format.hpp"

namespace lookout::vlp16 {

namespace {

using namespace format;

constexpr std::uint32_t kMaxStampUs = kMicrosecondsPerHour + 1'000'000;  // as in data packets

bool IsPrintable(std::uint8_t byte) { return byte >= 0x20 && byte <= 0x7E; }

bool HasRightChecksum(std::string_view sentence) {
  const auto star = sentence.find('*');
  if (star == std::string_view::npos) return true;
  std::uint8_t computed = 0;
  for (const char character : sentence.substr(1, star - 1)) computed = static_cast<std::uint8_t>(computed ^ static_cast<std::uint8_t>(character));
  const auto digits = sentence.substr(star + 1);
  unsigned said = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), said, 16);
  return fault == std::errc() && digits.size() == 2 && end == digits.data() + 2 && said == computed;
}

}  // namespace

bool IsValidRmc(std::string_view sentence) {
  // $--RMC,hhmmss.ss,A,...
  constexpr std::string_view kType = "RMC,";
  if (sentence.size() < 7 || sentence[0] != '$' || sentence.substr(3, kType.size()) != kType) return false;
  const auto comma = sentence.find(',', 3 + kType.size());
  if (comma == std::string_view::npos || sentence.substr(comma, 3) != ",A,") return false;
  return HasRightChecksum(sentence);
}

PositionPacketResult ParsePositionPacket(Bytes payload) {
  const auto refused = [](PositionFault fault) { return PositionPacketResult{fault, {}}; };
  if (payload.size() != kPositionPacketSizeBytes) return refused(PositionFault::kSize);
  PositionPacket packet;
  packet.stamp_us = ReadU32LittleEndian(payload, kPositionStampOffset);
  if (packet.stamp_us >= kMaxStampUs) return refused(PositionFault::kStamp);
  packet.pps = payload[kPpsOffset];
  if (packet.pps > kPpsError) return refused(PositionFault::kPps);

  const auto text = payload.subspan(kSentenceOffset);
  const auto end = std::ranges::find_if_not(text, IsPrintable);
  if (end == text.end() || (*end != '\r' && *end != '\n' && *end != '\0')) return refused(PositionFault::kSentence);
  packet.sentence.assign(text.begin(), end);
  if (!packet.sentence.empty() && packet.sentence.front() != '$') return refused(PositionFault::kSentence);
  packet.has_valid_rmc = IsValidRmc(packet.sentence);
  return {PositionFault::kNone, packet};
}

}  // namespace lookout::vlp16
