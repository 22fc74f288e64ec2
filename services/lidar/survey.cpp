#include "services/lidar/survey.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "services/lidar/core/models/hesai.hpp"
#include "services/lidar/core/models/velodyne.hpp"
#include "services/lidar/core/vlp16/foreign_sensor.hpp"
#include "services/lidar/core/vlp16/judge.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"
#include "services/lidar/params.hpp"

namespace lookout::lidar {

namespace {

using std::chrono::microseconds;

constexpr std::size_t kMaxHeard = 64;
constexpr std::size_t kSecondPacketBytes = 512;  // position of a Velodyne, GPS of a Hesai

constexpr std::array kHesaiOfTable{OtherModel::kXt16,  OtherModel::kXt32,      OtherModel::kXt32m,   OtherModel::kQt64,
                                   OtherModel::kQt128, OtherModel::kPandar40p, OtherModel::kPandar64};
static_assert(kHesaiOfTable.size() == kNumHesaiModels);

OtherModel TableModelOf(VelodyneModel model) {
  switch (model) {
    case VelodyneModel::kHdl32e:
      return OtherModel::kHdl32e;
    case VelodyneModel::kVlp32c:
      return OtherModel::kVlp32c;
    default:
      return OtherModel::kVls128;
  }
}

std::string SecondsText(double seconds) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), seconds < 100.0 ? "%.3f" : "%.0f", seconds);
  return text.data();
}

}  // namespace

void Survey::Identify(Bytes payload, Heard& heard) const {
  auto& speaker = heard.speaker;
  speaker.is_of_vlp16_family = false;
  speaker.other.reset();
  if (const auto hesai = HesaiModelOf(payload)) {
    speaker.other = kHesaiOfTable.at(static_cast<std::size_t>(*hesai));
    speaker.name = NameOf(*hesai);
    return;
  }
  if (auto layouts = OusterLayoutsOf(payload); !layouts.empty()) {
    speaker.other = OtherModel::kOuster;
    speaker.name = "Ouster";
    speaker.layouts = std::move(layouts);
    return;
  }
  // An early VLP-16 has the product byte of the HDL-32E: intervals tell, so the first packets decide nothing.
  if (!heard.family_judge) heard.family_judge = vlp16::MakeJudgeOf(vlp16::ModelChoice::kAuto)();
  const auto verdict = heard.family_judge->Judge(Stream::kData, payload);
  const auto velodyne = VelodyneModelOf(payload);
  if (verdict == Verdict::kValid || verdict == Verdict::kUndecided) {
    speaker.is_of_vlp16_family = verdict == Verdict::kValid;
    speaker.name =
        verdict == Verdict::kUndecided ? "Velodyne VLP-16 or HDL-32E" : std::string(vlp16::NameOfProduct(payload[vlp16::format::kProductOffset]));
    if (speaker.name.empty() || payload[vlp16::format::kProductOffset] == vlp16::format::kProductHdl32e) {
      if (verdict == Verdict::kValid) speaker.name = "Velodyne VLP-16";
    }
  } else if (velodyne) {
    speaker.other = TableModelOf(*velodyne);
    speaker.name = NameOf(*velodyne);
  } else {
    speaker.name = vlp16::NameOfForeignPayload(payload);
  }
}

std::optional<std::chrono::nanoseconds> Survey::StampOf(Bytes payload, Heard& heard) {
  const auto& other = heard.speaker.other;
  if (!other || RowOf(*other).has_position_packets) return std::nullopt;
  if (*other == OtherModel::kOuster) return OusterStampOf(payload, heard.speaker.layouts.front());
  if (!heard.reader) heard.reader = MakeReader(*other, "");
  if (heard.reader->Read(payload, heard.packet) != PacketFault::kNone) return std::nullopt;
  return heard.packet.stamp;
}

void Survey::Add(Utime host_time, const std::string& source_address, const std::string& destination_address, int port, Bytes payload) {
  const Key key(source_address, port);
  auto found = heard_.find(key);
  if (found == heard_.end()) {
    if (payload.size() == kSecondPacketBytes || ParseOusterImu(payload)) {
      if (second_port_.size() < kMaxHeard) second_port_.emplace(source_address, port);
      return;
    }
    Heard heard;
    Identify(payload, heard);
    if (heard.speaker.name.empty() || heard_.size() >= kMaxHeard) return;
    heard.speaker.source_address = source_address;
    heard.speaker.data_port = port;
    heard.speaker.first = host_time;
    found = heard_.emplace(key, std::move(heard)).first;
  } else {
    // An Ouster may send both kinds to one port.
    if (payload.size() == kSecondPacketBytes || ParseOusterImu(payload)) {
      if (second_port_.size() < kMaxHeard) second_port_.emplace(source_address, port);
      return;
    }
    const auto before = found->second.speaker;
    Identify(payload, found->second);
    if (found->second.speaker.name.empty()) {
      // A datagram that tells nothing takes nothing back.
      found->second.speaker = before;
      return;
    }
  }
  auto& [speaker, judge, reader, packet] = found->second;
  speaker.destination_address = destination_address;
  speaker.size_bytes = payload.size();
  speaker.last = host_time;
  ++speaker.num_packets;
  const auto stamp = StampOf(payload, found->second);
  if (!stamp) return;
  speaker.stamp = Utime(std::chrono::floor<microseconds>(*stamp));
  const auto apart = host_time - *speaker.stamp;
  speaker.host_minus_stamp = std::min(speaker.host_minus_stamp.value_or(apart), apart);
}

std::vector<Speaker> Survey::Speakers() const {
  std::vector<Speaker> speakers;
  speakers.reserve(heard_.size());
  for (const auto& [key, heard] : heard_) {
    speakers.push_back(heard.speaker);
    const auto second = second_port_.find(key.first);
    if (second != second_port_.end()) speakers.back().second_port = second->second;
  }
  return speakers;
}

std::string ClockDifferenceText(microseconds host_minus_stamp, Utime stamp, const std::string& whose) {
  using namespace std::chrono_literals;
  constexpr microseconds kAgreeing = 250ms;
  constexpr microseconds kSame = 2s;  // of seconds of a time scale, where the host keeps time roughly
  constexpr Utime kYear2000{946'684'800s};
  constexpr Utime kYear2021{1'609'459'200s};
  if (std::chrono::abs(host_minus_stamp) <= kAgreeing) return {};
  const double ahead_s = -ToSeconds(host_minus_stamp);
  const std::string seconds = SecondsText(std::abs(ahead_s)) + " s " + (ahead_s > 0.0 ? "ahead of " : "behind ") + whose;
  if (stamp < kYear2000) return "it counts from its own start: it was never set";
  if (std::chrono::abs(host_minus_stamp + 37s) < kSame) return "it is " + seconds + ", as TAI is ahead of UTC by 37 s: its PTP master sends TAI";
  if (std::chrono::abs(host_minus_stamp + 18s) < kSame) return "it is " + seconds + ", as GPS time is ahead of UTC by 18 s";
  if (stamp < kYear2021) return "it is " + seconds + " and says a year before 2021: it was never set";
  return "it is " + seconds;
}

std::string ConfigLines(const Speaker& speaker) {
  if (!speaker.is_of_vlp16_family && !speaker.other) return {};
  std::string lines = "model: " + ModelWord(speaker.other) + "\n";
  lines += "data_port: " + std::to_string(speaker.data_port) + "\n";
  const int usual_second = speaker.other ? RowOf(*speaker.other).usual_position_port : vlp16::format::kPositionPort;
  // Where the sensor sends both kinds of packets to one port, position_port must still differ from data_port.
  const int second = speaker.second_port && *speaker.second_port != speaker.data_port ? *speaker.second_port : usual_second;
  lines += "position_port: " + std::to_string(second) + "\n";
  if (speaker.other && RowOf(*speaker.other).needs_beam_file) lines += "beam_file: \"metadata.json\"\n";
  return lines;
}

}  // namespace lookout::lidar
