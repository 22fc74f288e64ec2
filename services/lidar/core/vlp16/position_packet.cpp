#include "services/lidar/core/vlp16/position_packet.hpp"

#include <algorithm>
#include <iterator>

#include "common/core/sentence.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::vlp16 {

namespace {

using namespace format;

bool IsPrintable(std::uint8_t byte) { return byte >= 0x20 && byte <= 0x7E; }

std::optional<Telemetry> ToTelemetry(Bytes payload) {
  const Telemetry telemetry{payload[kTopBoardTemperatureOffset], payload[kBottomBoardTemperatureOffset],
                            payload[kThermalStateOffset] == kThermalShutdown, payload[kShutdownTemperatureOffset],
                            payload[kPowerUpTemperatureOffset]};
  if (telemetry == Telemetry{}) return std::nullopt;
  return telemetry;
}

}  // namespace

std::optional<SentenceTime> TimeOfSentence(std::string_view sentence) {
  constexpr std::size_t kTalkerCharacters = 2;
  if (!sentence.starts_with('$')) return std::nullopt;
  const auto framed = Frame(sentence, false);  // older receivers send no checksum
  if (framed.fault != SentenceFault::kNone || framed.sentence.address.size() < kTalkerCharacters) return std::nullopt;
  const auto type = framed.sentence.address.substr(kTalkerCharacters);
  FieldReader fields(framed.sentence.fields);
  SentenceTime time;
  if (type == "RMC" && fields.size() > 1 && fields.Text(1) == "A") {
    constexpr std::size_t kDateField = 8;
    if (fields.size() > kDateField) time.date = fields.Date(kDateField);
  } else if (type != "GGA" || fields.size() <= 5 || fields.IsEmpty(5) || fields.Text(5) == "0") {
    return std::nullopt;
  }
  const auto time_of_day = fields.TimeOfDay(0);
  if (!time_of_day) return std::nullopt;
  time.time_of_day = *time_of_day;
  return time;
}

PositionPacketResult ParsePositionPacket(Bytes payload) {
  const auto refused = [](PositionFault fault) { return PositionPacketResult{fault, {}}; };
  if (payload.size() != kPositionPacketSizeBytes) return refused(PositionFault::kSize);
  PositionPacketResult result;
  result.packet.stamp_us = ReadU32LittleEndian(payload, kPositionStampOffset);
  result.packet.pps = payload[kPpsOffset];
  if (result.packet.pps > kPpsError) return refused(PositionFault::kPps);
  result.packet.telemetry = ToTelemetry(payload);

  const auto text = payload.subspan(kSentenceOffset);
  auto end = std::ranges::find_if_not(text, IsPrintable);
  // Some receivers send blanks behind the checksum.
  const auto is_blank = [](std::uint8_t byte) { return byte == ' ' || byte == '\t'; };
  const auto stop = std::find_if_not(end, text.end(), is_blank);
  const bool has_end = stop != text.end() && (*stop == '\r' || *stop == '\n' || *stop == '\0');
  while (end != text.begin() && is_blank(*std::prev(end))) --end;
  if (!has_end || (end != text.begin() && text.front() != '$')) {
    result.fault = PositionFault::kSentence;
    return result;
  }
  result.packet.sentence.assign(text.begin(), end);
  result.packet.time = TimeOfSentence(result.packet.sentence);
  return result;
}

}  // namespace lookout::vlp16
