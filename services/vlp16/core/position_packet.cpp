#include "services/vlp16/core/position_packet.hpp"

#include <algorithm>
#include <charconv>
#include <vector>

#include "services/vlp16/core/packet_format.hpp"

namespace lookout::vlp16 {

namespace {

using namespace format;

bool IsPrintable(std::uint8_t byte) { return byte >= 0x20 && byte <= 0x7E; }

// A sentence without a checksum passes: older receivers send none.
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

std::vector<std::string_view> Fields(std::string_view sentence) {
  std::vector<std::string_view> fields;
  sentence = sentence.substr(0, sentence.find('*'));
  for (;;) {
    const auto comma = sentence.find(',');
    fields.push_back(sentence.substr(0, comma));
    if (comma == std::string_view::npos) return fields;
    sentence.remove_prefix(comma + 1);
  }
}

// Two decimal digits at `place`, -1 when they are not there.
int TwoDigits(std::string_view text, std::size_t place) {
  if (text.size() < place + 2) return -1;
  const auto digit = [&](std::size_t i) { return text[i] >= '0' && text[i] <= '9' ? text[i] - '0' : -100; };
  return std::max(-1, digit(place) * 10 + digit(place + 1));
}

// hhmmss or hhmmss.s...; digits beyond microseconds do not count.
std::optional<std::chrono::microseconds> TimeOfDay(std::string_view text) {
  const int hour = TwoDigits(text, 0);
  const int minute = TwoDigits(text, 2);
  const int second = TwoDigits(text, 4);
  constexpr int kLeapSecond = 60;
  if (hour < 0 || hour > 23 || minute < 0 || minute > 59 || second < 0 || second > kLeapSecond) return std::nullopt;
  std::chrono::microseconds time = std::chrono::hours(hour) + std::chrono::minutes(minute) + std::chrono::seconds(second);
  if (text.size() == 6) return time;
  if (text[6] != '.') return std::nullopt;
  std::int64_t unit_us = 100'000;
  for (const char character : text.substr(7)) {
    if (character < '0' || character > '9') return std::nullopt;
    time += std::chrono::microseconds(unit_us * (character - '0'));
    unit_us /= 10;
  }
  return time;
}

// ddmmyy
std::optional<std::chrono::sys_days> Date(std::string_view text) {
  const int day = TwoDigits(text, 0);
  const int month = TwoDigits(text, 2);
  const int year = TwoDigits(text, 4);
  if (text.size() != 6 || day < 0 || month < 0 || year < 0) return std::nullopt;
  constexpr int kFirstYear = 80;  // of GPS
  const std::chrono::year_month_day date(std::chrono::year(year < kFirstYear ? 2000 + year : 1900 + year),
                                         std::chrono::month(static_cast<unsigned>(month)), std::chrono::day(static_cast<unsigned>(day)));
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days(date);
}

std::optional<Telemetry> ToTelemetry(Bytes payload) {
  const Telemetry telemetry{payload[kTopBoardTemperatureOffset], payload[kBottomBoardTemperatureOffset],
                            payload[kThermalStateOffset] == kThermalShutdown, payload[kShutdownTemperatureOffset],
                            payload[kPowerUpTemperatureOffset]};
  if (telemetry == Telemetry{}) return std::nullopt;
  return telemetry;
}

}  // namespace

std::optional<SentenceTime> TimeOfSentence(std::string_view sentence) {
  constexpr std::size_t kTypeOffset = 3;  // behind $ and a talker of two characters
  if (sentence.size() < kTypeOffset || sentence[0] != '$' || !HasRightChecksum(sentence)) return std::nullopt;
  const auto fields = Fields(sentence);
  const auto type = fields[0].size() > kTypeOffset ? fields[0].substr(kTypeOffset) : std::string_view();
  SentenceTime time;
  if (type == "RMC" && fields.size() > 2 && fields[2] == "A") {
    constexpr std::size_t kDateField = 9;
    if (fields.size() > kDateField) time.date = Date(fields[kDateField]);
  } else if (type != "GGA" || fields.size() <= 6 || fields[6].empty() || fields[6] == "0") {
    return std::nullopt;
  }
  const auto time_of_day = TimeOfDay(fields[1]);
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
  const auto end = std::ranges::find_if_not(text, IsPrintable);
  const bool has_end = end != text.end() && (*end == '\r' || *end == '\n' || *end == '\0');
  if (!has_end || (end != text.begin() && text.front() != '$')) {
    result.fault = PositionFault::kSentence;
    return result;
  }
  result.packet.sentence.assign(text.begin(), end);
  result.packet.time = TimeOfSentence(result.packet.sentence);
  return result;
}

}  // namespace lookout::vlp16
