#include "tools/replay/input.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <spdlog/spdlog.h>
#include <stdexcept>

#include "common/bus/log_file.hpp"
#include "services/vlp16/io/capture_reader.hpp"

namespace lookout::replay {

namespace {

using Magic = std::array<unsigned char, 4>;

constexpr Magic kLogSyncWord{0xED, 0xA1, 0xDA, 0x01};
// pcap with microseconds and with nanoseconds, in both byte orders, and pcapng.
constexpr std::array<Magic, 5> kCaptureMagics{
    {{0xA1, 0xB2, 0xC3, 0xD4}, {0xD4, 0xC3, 0xB2, 0xA1}, {0xA1, 0xB2, 0x3C, 0x4D}, {0x4D, 0x3C, 0xB2, 0xA1}, {0x0A, 0x0D, 0x0D, 0x0A}}};

void Count(std::vector<std::pair<std::string, std::int64_t>>& refused, const std::string& reason, std::int64_t count) {
  if (count == 0) return;
  for (auto& [known_reason, known_count] : refused) {
    if (known_reason == reason) {
      known_count += count;
      return;
    }
  }
  refused.emplace_back(reason, count);
}

void FeedCapture(const std::filesystem::path& file, Chain& chain, InputSummary& summary) {
  vlp16::CaptureReader reader(file);
  while (const auto datagram = reader.Next()) {
    ++summary.num_events;
    chain.OnDatagram(datagram->host_time, datagram->destination_port, datagram->payload);
  }
  if (reader.num_damaged() > 0) spdlog::warn("{}: {}", file.string(), reader.damage());
  for (const auto& counter : reader.counters()) {
    if (counter.name == "frames_read" || counter.name == "frames_datagram") continue;  // work done, no refusal
    Count(summary.refused, "capture." + std::string(counter.name), counter.count);
  }
}

void FeedLog(const std::filesystem::path& file, Chain& chain, InputSummary& summary) {
  bus::LogReader reader(file);
  std::int64_t num_oversize = 0;
  while (const auto event = reader.Next()) {
    const auto* channel = bus::FindChannel(event->channel);
    if (channel == nullptr || !channel->is_raw) continue;
    if (event->bytes.size() > bus::kMaxMessageBytes) {
      ++num_oversize;
      continue;
    }
    ++summary.num_events;
    chain.OnRaw(event->time, *channel, event->bytes);
  }
  Count(summary.refused, "log.damaged", reader.num_damaged());
  Count(summary.refused, "log.oversize_message", num_oversize);
}

}  // namespace

InputKind KindOf(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) throw std::runtime_error(file.string() + ": is not a file that can be read twice");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  Magic start{};
  in.read(reinterpret_cast<char*>(start.data()), start.size());
  if (std::ranges::find(kCaptureMagics, start) != kCaptureMagics.end()) return InputKind::kCapture;
  // A log may be damaged at its start.
  return start == kLogSyncWord || bus::LogReader(file).Next() ? InputKind::kLog : InputKind::kCapture;
}

RawInput Inspect(const std::vector<std::filesystem::path>& files) {
  int num_logs = 0;
  bool has_packets = false;
  bool has_nav_raw = false;
  for (const auto& file : files) {
    if (KindOf(file) == InputKind::kCapture) continue;
    ++num_logs;
    bus::LogReader reader(file);
    while (const auto event = reader.Next()) {
      has_packets = has_packets || event->channel == bus::kLidarPackets.name;
      has_nav_raw = has_nav_raw || event->channel == bus::kNavRaw.name;
    }
  }
  if (num_logs == 0) return {};
  if (num_logs != static_cast<int>(files.size())) throw std::runtime_error("captures and lcm-logs cannot be replayed together");
  if (!has_packets && !has_nav_raw)
    throw std::runtime_error(files.front().string() + ": holds neither LIDAR_PACKETS nor NAV_RAW, nothing can be computed again");
  // Without NAV_RAW the sentences of the lidar's position packets are all the navigation there is.
  return {vlp16::Input::kLog, has_nav_raw ? navigator::Input::kLog : navigator::Input::kOutside};
}

InputSummary Feed(const std::vector<std::filesystem::path>& files, Chain& chain) {
  InputSummary summary;
  for (const auto& file : files) {
    if (KindOf(file) == InputKind::kLog) {
      FeedLog(file, chain, summary);
    } else {
      FeedCapture(file, chain, summary);
    }
  }
  return summary;
}

}  // namespace lookout::replay
