#include "services/navigator/core/mavlink_lines.hpp"

#include <algorithm>

#include "common/core/sentence.hpp"

namespace lookout::navigator {

namespace {

constexpr std::string_view kDigits = "0123456789ABCDEF";

}  // namespace

std::string ToMavlinkLine(std::string_view frame) {
  std::string body(kMavlinkAddress);
  body += ',';
  for (const char character : frame) {
    const auto byte = static_cast<std::uint8_t>(character);
    body += kDigits[byte >> 4U];
    body += kDigits[byte & 15U];
  }
  return WithChecksum(body);
}

std::optional<std::string> MavlinkBytesOf(std::string_view line) {
  const auto [fault, sentence] = Frame(line);
  if (fault != SentenceFault::kNone || line.front() != '$' || sentence.address != kMavlinkAddress || sentence.fields.size() != 1) return std::nullopt;
  const auto text = sentence.fields.front();
  if (text.size() % 2 != 0) return std::nullopt;
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const auto high = kDigits.find(text[i]);
    const auto low = kDigits.find(text[i + 1]);
    if (high == std::string_view::npos || low == std::string_view::npos) return std::nullopt;
    bytes += static_cast<char>(16 * high + low);
  }
  return bytes;
}

MavlinkLines MavlinkCutter::Add(Utime arrival, Bytes bytes, const std::string& sender) {
  MavlinkLines result;
  std::string text;
  if (const auto found = held_.find(sender); found != held_.end()) {
    const auto& held = found->second;
    if (arrival >= held.arrival && arrival - held.arrival <= kMaxWait) {
      text = held.bytes;
    } else {
      result.num_skipped_bytes += static_cast<std::int64_t>(held.bytes.size());
    }
    held_.erase(found);
  }
  text.append(bytes.begin(), bytes.end());
  const auto found = FindMavlink(text, kMavlinkKinds);
  result.num_bad_checksum += found.num_bad_checksum;
  result.num_skipped_bytes += found.num_skipped_bytes;
  for (const auto& frame : found.frames) {
    if (frame.system_id == system_id_ && frame.component_id == kAutopilotComponent) {
      result.lines.push_back(ToMavlinkLine(frame.bytes));
    } else {
      ++result.num_other_sender;
    }
  }
  if (found.num_used == text.size()) return result;
  if (held_.size() >= kMaxSenders) {
    // The sender that was heard longest ago goes.
    const auto oldest = std::ranges::min_element(held_, {}, [](const auto& entry) { return entry.second.arrival; });
    result.num_skipped_bytes += static_cast<std::int64_t>(oldest->second.bytes.size());
    held_.erase(oldest);
  }
  held_.emplace(sender, Held{text.substr(found.num_used), arrival});
  return result;
}

}  // namespace lookout::navigator
