#include "tools/setup/nmea_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/lidar/core/vlp16/position_packet.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::setup {

namespace {

constexpr std::size_t kMostPorts = 32;
constexpr double kLeastSecondsOfARate = 2.0;

}  // namespace

std::string SentencesInWords(const NmeaHeard& heard) {
  std::string text;
  for (const auto& [type, count] : heard.num_by_type) {
    text += (text.empty() ? "" : ", ") + type;
    // Between n sentences lie n - 1 periods; a source that is mixed has its others in between.
    if (heard.seconds >= kLeastSecondsOfARate) text += fmt::format(" {:.1f}/s", static_cast<double>(count) / heard.seconds);
  }
  return text;
}

bool NmeaSurvey::Take(Utime time, const std::string& line, Count& count) {
  const auto result = navigator::ParseSentence(line);
  if (result.fault != SentenceFault::kNone) return false;
  const auto& sentence = result.sentence;
  auto& heard = count.heard;
  if (heard.num_by_type.empty()) count.first = time;
  count.last = time;
  heard.seconds = ToSeconds(count.last - count.first);
  if (sentence.type == navigator::SentenceType::kOther) {
    ++heard.num_by_type["others"];
    return true;
  }
  ++heard.num_by_type[std::string(sentence.name)];
  heard.has_position |= sentence.position.has_value();
  heard.has_heading |= !std::isnan(sentence.heading_rad);
  heard.has_tilt |= sentence.has_tilt();
  return true;
}

void NmeaSurvey::AddDatagram(Utime time, int port, Bytes payload, bool is_frame) {
  // Most datagrams are a lidar's, and no text.
  if (payload.empty() || std::ranges::find(payload, static_cast<std::uint8_t>('*')) == payload.end()) return;
  Count count;
  auto& counts = is_frame ? by_frame_ : by_socket_;
  const auto found = counts.find(port);
  if (found == counts.end() && counts.size() >= kMostPorts) return;
  auto& target = found == counts.end() ? count : found->second;
  bool is_any = false;
  for (const auto& line : navigator::SplitDatagram(payload).lines) is_any |= Take(time, line, target);
  if (found != counts.end() || !is_any) return;
  count.heard.kind = NmeaHeard::Kind::kUdp;
  count.heard.port = port;
  counts.emplace(port, std::move(count));
}

void NmeaSurvey::AddPositionPacket(Utime time, Bytes payload) {
  const auto result = vlp16::ParsePositionPacket(payload);
  if (result.fault != vlp16::PositionFault::kNone || result.packet.sentence.empty()) return;
  lidar_.heard.kind = NmeaHeard::Kind::kLidar;
  Take(time, result.packet.sentence, lidar_);
}

bool NmeaSurvey::AddSerial(Utime time, const std::string& device, int baud, Bytes bytes) {
  bool is_any = false;
  for (const auto& line : lines_[device].Add(bytes).lines) {
    auto& count = by_device_[device];
    if (count.heard.baud != baud) count = {};
    count.heard.kind = NmeaHeard::Kind::kSerial;
    count.heard.device = device;
    count.heard.baud = baud;
    is_any |= Take(time, line, count);
  }
  return is_any;
}

std::vector<NmeaHeard> NmeaSurvey::Sources() const {
  std::vector<NmeaHeard> sources;
  if (!lidar_.heard.num_by_type.empty()) sources.push_back(lidar_.heard);
  auto by_port = by_socket_;
  by_port.insert(by_frame_.begin(), by_frame_.end());  // for a port that both heard the socket's counts are used
  sources.reserve(1 + by_port.size() + by_device_.size());
  for (const auto& [port, count] : by_port) sources.push_back(count.heard);
  for (const auto& [device, count] : by_device_) {
    if (!count.heard.num_by_type.empty()) sources.push_back(count.heard);
  }
  return sources;
}

}  // namespace lookout::setup
