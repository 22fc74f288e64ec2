#include "tools/log/run_marks.hpp"

#include <cstddef>

#include "common/bus/channels.hpp"
#include "common/bus/header.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/nav_raw_t.hpp"

namespace lookout::log {

namespace {

constexpr std::array<std::string_view, 2> kChannels{bus::kLidarPackets.name, bus::kNavRaw.name};

// Behind fingerprint, utime_us and seq: `marks` of lidar_packets_t, `kind` of nav_raw_t; 32 bits.
constexpr std::size_t kMarkOffset = 24;

std::optional<std::size_t> IndexOf(std::string_view channel) {
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    if (kChannels[i] == channel) return i;
  }
  return std::nullopt;
}

std::optional<std::int32_t> MarkOf(std::size_t stream, Bytes bytes) {
  if (bytes.size() < kMarkOffset + 4) return std::nullopt;
  const auto fingerprint = static_cast<std::uint64_t>(stream == 0 ? lidar_packets_t::getHash() : nav_raw_t::getHash());
  if (bus::ReadU64BigEndian(bytes, 0) != fingerprint) return std::nullopt;
  std::uint32_t mark = 0;
  for (std::size_t i = 0; i < 4; ++i) mark = mark << 8 | bytes[kMarkOffset + i];
  return static_cast<std::int32_t>(mark);
}

bool IsStart(std::size_t stream, std::int32_t mark) {
  return stream == 0 ? (mark & lidar_packets_t::MARK_START) != 0 : mark == nav_raw_t::KIND_START;
}

bool IsEnd(std::size_t stream, std::int32_t mark) { return stream == 0 ? (mark & lidar_packets_t::MARK_END) != 0 : mark == nav_raw_t::KIND_END; }

}  // namespace

bool RunMarks::IsMarked(std::string_view channel) { return IndexOf(channel).has_value(); }

void RunMarks::Add(Utime time, std::string_view channel, Bytes bytes) {
  const auto index = IndexOf(channel);
  const auto mark = index ? MarkOf(*index, bytes) : std::nullopt;
  if (!mark) return;  // what is no such message nobody consumed
  auto& stream = streams_.at(*index);
  const bool is_start = IsStart(*index, *mark);
  if (!stream.has_messages) stream.begins_with_start = is_start;
  if (stream.has_messages && is_start && !stream.ends_with_end) stream.is_cut_inside = true;
  stream.has_messages = true;
  stream.ends_with_end = IsEnd(*index, *mark);
  stream.last = time;
}

std::vector<std::string> RunMarks::Channels() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    if (streams_.at(i).has_messages) names.emplace_back(kChannels.at(i));
  }
  return names;
}

std::vector<std::string> RunMarks::WithoutStart() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    if (streams_.at(i).has_messages && !streams_.at(i).begins_with_start) names.emplace_back(kChannels.at(i));
  }
  return names;
}

std::vector<std::string> RunMarks::WithoutEnd() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    if (streams_.at(i).has_messages && !streams_.at(i).ends_with_end) names.emplace_back(kChannels.at(i));
  }
  return names;
}

std::vector<std::string> RunMarks::CutInside() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    if (streams_.at(i).is_cut_inside) names.emplace_back(kChannels.at(i));
  }
  return names;
}

bool RunMarks::HasEnd(std::string_view channel) const {
  const auto index = IndexOf(channel);
  return index && streams_.at(*index).ends_with_end;
}

std::optional<Utime> RunMarks::LastTime(std::string_view channel) const {
  const auto index = IndexOf(channel);
  if (!index || !streams_.at(*index).has_messages) return std::nullopt;
  return streams_.at(*index).last;
}

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace lookout::log
