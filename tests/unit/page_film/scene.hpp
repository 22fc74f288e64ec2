// Logs of scans as a boat's pipeline would write them, small.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/run_info_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/page/core/recordings.hpp"
#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"
#include "tests/support/messages.hpp"

namespace lookout::page {

inline constexpr std::int64_t kBeginUs = 1'790'000'000'000'000;
inline constexpr std::int64_t kScanUs = 100'000;
inline constexpr std::int64_t kDelayUs = 110'000;  // from the first firing of a scan to its LIDAR_SCAN in the log
inline constexpr std::int64_t kPartUs = 1'000;     // from part to part, and on to TRACKS

inline Utime At_us(std::int64_t utime_us) { return Utime(std::chrono::microseconds(utime_us)); }

inline ChannelIndex IndexOfChannel(const bus::Channel& channel) {
  return static_cast<ChannelIndex>(bus::FindChannel(channel.name) - bus::kChannels.data());
}

inline const auto kScanChannel = IndexOfChannel(bus::kLidarScan);
inline const auto kTracksChannel = IndexOfChannel(bus::kTracks);
inline const auto kAlertsChannel = IndexOfChannel(bus::kAlerts);
inline const auto kPoseChannel = IndexOfChannel(bus::kPose);
inline const auto kHealthChannel = IndexOfChannel(bus::kHealth);
inline const auto kRunInfoChannel = IndexOfChannel(bus::kRunInfo);

/// Writes messages into a log, or whatever takes them.
template <typename Sink>
class SceneWriter {
 public:
  explicit SceneWriter(Sink& sink) : sink_(sink) {}

  template <typename Message>
  void Put(std::int64_t time_us, const bus::Channel& channel, const Message& message) {
    sink_(At_us(time_us + shift_us), channel.name, bus::Encode(message));
  }

  /// Scan number `seq` in two parts, its TRACKS and ALERTS, and the POSE of its end.
  void Scan(std::int64_t seq, int num_tracks = 3, std::optional<std::int32_t> alert_level = {}, int num_parts = 2) {
    const auto utime_us = kBeginUs + seq * kScanUs;
    auto time_us = utime_us + kDelayUs;
    pose_t pose{};
    pose.utime_us = utime_us + kScanUs;
    pose.seq = seq;
    Put(time_us - kPartUs, bus::kPose, pose);
    for (int part = 0; part < num_parts; ++part, time_us += kPartUs) {
      auto scan = support::OfScan<lidar_scan_t>(utime_us, seq, kScanUs - 1);
      scan.part_index = part;
      scan.num_parts = num_parts;
      scan.model = std::string(20'000, 'x');  // large: what follows it is passed over
      Put(time_us, bus::kLidarScan, scan);
    }
    auto tracks = support::OfScan<tracks_t>(utime_us, seq, kScanUs - 1);
    tracks.num_scan_tracks = num_tracks;
    Put(time_us, bus::kTracks, tracks);
    auto alerts = support::OfScan<alerts_t>(utime_us, seq, kScanUs - 1);
    if (alert_level) {
      alert_t alert{};
      alert.id = 7;
      alert.level = *alert_level;
      alert.state = alert_t::STATE_ACTIVE;
      alert.raised_utime_us = kBeginUs;
      alert.text = "boat 17: closest approach 3 m";
      support::Fill(alerts, {alert});
    }
    Put(time_us + kPartUs, bus::kAlerts, alerts);
  }

  void Health(std::int64_t time_us, const std::string& process, std::int32_t state = health_t::STATE_OK, const std::string& reason = "") {
    health_t health{};
    health.utime_us = time_us;
    health.seq = health_seq_++;
    health.process = process;
    health.state = state;
    health.reason = reason;
    Put(time_us, bus::kHealth, health);
  }

  std::int64_t shift_us = 0;  // of the host's clock

 private:
  Sink& sink_;
  std::int64_t health_seq_ = 0;
};

/// A log as a file.
class SceneLog {
 public:
  explicit SceneLog(const std::filesystem::path& file) : log_(file) {}
  SceneWriter<SceneLog>* operator->() { return &writer_; }
  void operator()(Utime time, std::string_view channel, Bytes bytes) { log_.Write(time, channel, bytes); }
  void Flush() { log_.Flush(); }

 private:
  support::FileLog log_;
  SceneWriter<SceneLog> writer_{*this};
};

inline void WriteScans(const std::filesystem::path& file, std::int64_t first, std::int64_t end) {
  SceneLog log(file);
  for (auto seq = first; seq < end; ++seq) log->Scan(seq);
}

inline At AtTime(std::int64_t time_us, std::vector<ChannelIndex> channels, int num_scans_on = 0) {
  At at;
  at.id = 1;
  at.time = At_us(time_us);
  at.num_scans_on = num_scans_on;
  at.channels = std::move(channels);
  return at;
}

inline At AtScan(std::int64_t utime_us, std::vector<ChannelIndex> channels) {
  At at;
  at.id = 1;
  at.scan_time = At_us(utime_us);
  at.channels = std::move(channels);
  return at;
}

/// utime_us of the messages of a channel in an answer.
inline std::vector<std::int64_t> UtimesOf(const Answer& answer, const bus::Channel& channel) {
  std::vector<std::int64_t> utimes;
  for (const auto& message : answer.messages) {
    if (message.channel == IndexOfChannel(channel)) utimes.push_back(bus::ReadHeader(message.bytes)->utime_us);
  }
  return utimes;
}

}  // namespace lookout::page
