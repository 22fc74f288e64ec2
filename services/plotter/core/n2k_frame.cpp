#include "services/plotter/core/n2k_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace lookout::plotter {

namespace {

constexpr std::size_t kFrameBytes = 8;
constexpr std::uint32_t kMostCanId = 0x1FFF'FFFF;
// PDU formats from here on (PDU2) go to everybody, and the low byte is a part of the PGN; below (PDU1) it is the destination.
constexpr std::uint32_t kFirstPdu2Format = 0xF0;

bool IsPdu1(std::uint32_t pgn) { return (pgn >> 8U & 0xFFU) < kFirstPdu2Format; }

bool IsHexDigit(char letter) { return (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'f') || (letter >= 'A' && letter <= 'F'); }

// Takes a number of exactly so many digits off the front. nullopt: there is none.
std::optional<std::uint32_t> TakeHex(std::string_view& text, std::size_t num_digits) {
  if (text.size() < num_digits || !std::ranges::all_of(text.substr(0, num_digits), IsHexDigit)) return std::nullopt;
  std::uint32_t value = 0;
  std::from_chars(text.data(), text.data() + num_digits, value, 16);
  text.remove_prefix(num_digits);
  return value;
}

bool IsTime(std::string_view text) {
  constexpr std::string_view kForm = "00:00:00.000";
  return std::ranges::equal(text, kForm, [](char letter, char form) { return form == '0' ? letter >= '0' && letter <= '9' : letter == form; });
}

}  // namespace

std::uint32_t CanIdOf(const N2kHeader& header) {
  const std::uint32_t pgn = IsPdu1(header.pgn) ? (header.pgn & 0x3FF00U) | header.destination : header.pgn;
  return static_cast<std::uint32_t>(header.priority) << 26U | pgn << 8U | header.source;
}

N2kHeader HeaderOf(std::uint32_t can_id) {
  N2kHeader header;
  header.priority = static_cast<std::uint8_t>(can_id >> 26U & 7U);
  header.pgn = can_id >> 8U & 0x3FFFFU;
  header.source = static_cast<std::uint8_t>(can_id & 0xFFU);
  if (!IsPdu1(header.pgn)) return header;
  header.destination = static_cast<std::uint8_t>(header.pgn & 0xFFU);
  header.pgn &= 0x3FF00U;
  return header;
}

std::vector<N2kFrame> FramesOf(const N2kMessage& message, std::uint8_t source, int sequence) {
  constexpr std::size_t kFirst = 6;  // bytes of payload in the first frame of a fast packet
  constexpr std::size_t kNext = 7;   // and in the others
  const auto id = CanIdOf({.pgn = message.pgn, .priority = message.priority, .source = source, .destination = message.destination});
  if (!message.is_fast_packet) return {{id, message.payload}};
  std::vector<N2kFrame> frames;
  frames.reserve(1 + message.payload.size() / kNext + 1);
  std::size_t done = 0;
  for (unsigned index = 0; done < message.payload.size() || index == 0; ++index) {
    std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(static_cast<unsigned>(sequence) << 5U | index)};
    if (index == 0) bytes.push_back(static_cast<std::uint8_t>(message.payload.size()));
    const auto end = std::min(done + (index == 0 ? kFirst : kNext), message.payload.size());
    bytes.insert(bytes.end(), message.payload.begin() + static_cast<std::ptrdiff_t>(done),
                 message.payload.begin() + static_cast<std::ptrdiff_t>(end));
    bytes.resize(kFrameBytes, 0xFF);
    done = end;
    frames.push_back({id, std::move(bytes)});
  }
  return frames;
}

std::string RawLine(const N2kFrame& frame) {
  auto line = fmt::format("{:08X}", frame.id);
  for (const auto byte : frame.bytes) line += fmt::format(" {:02X}", byte);
  return line + "\r\n";
}

std::optional<N2kFrame> ReadRawLine(std::string_view line) {
  constexpr std::size_t kIdDigits = 8;
  const auto id = TakeHex(line, kIdDigits);
  if (!id || *id > kMostCanId) return std::nullopt;
  N2kFrame frame{*id, {}};
  frame.bytes.reserve(kFrameBytes);
  while (line.ends_with(' ')) line.remove_suffix(1);
  while (!line.empty()) {
    if (frame.bytes.size() == kFrameBytes || line.front() != ' ') return std::nullopt;
    line.remove_prefix(1);
    const auto byte = TakeHex(line, 2);
    if (!byte) return std::nullopt;
    frame.bytes.push_back(static_cast<std::uint8_t>(*byte));
  }
  return frame;
}

std::optional<HeardFrame> ReadHeardLine(std::string_view line) {
  constexpr std::size_t kTime = 12;  // characters
  constexpr std::size_t kHead = 15;  // with the direction and blanks
  if (line.size() < kHead || !IsTime(line.substr(0, kTime)) || line[kTime] != ' ' || line[kHead - 1] != ' ') return std::nullopt;
  const char direction = line[kTime + 1];
  if (direction != 'R' && direction != 'T') return std::nullopt;
  auto frame = ReadRawLine(line.substr(kHead));
  if (!frame) return std::nullopt;
  return HeardFrame{*std::move(frame), direction == 'T'};
}

}  // namespace lookout::plotter
