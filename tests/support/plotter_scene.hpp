// What lookout-plotter reads, made up: an own ship that moves, tracks around it, alerts. Sent on a live bus, a scan at a time.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/core/geodesy.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/support/messages.hpp"

namespace lookout::support {

class PlotterScene {
 public:
  static constexpr GeodeticPlace kPlace{53.3, -6.1, 0.0};
  static constexpr std::int64_t kScanUs = 100'000;

  explicit PlotterScene(bus::LcmBus& bus) : bus_(bus) {}

  int num_tracks = 1;
  std::vector<alert_t> alerts;
  bool has_alerts = true;  // else ALERTS are not sent
  bool has_pose = true;
  bool has_tracks = true;
  bool has_scan = false;  // LIDAR_SCAN and SEGMENTS of open water without a return

  /// POSE, TRACKS and ALERTS of a scan that has just ended.
  void SendScan() {
    auto now_us = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
    if (has_scan) now_us = now_us / 20'000 * 20'000;  // TRACKS of a scan come when POSE has reached its end
    if (has_pose) {
      // The boat's way within the scan is known.
      const auto newest_us = now_us / 20'000 * 20'000;
      const auto first_us = std::max(last_pose_us_ + 20'000, newest_us - 2 * kScanUs);
      for (auto pose_us = has_scan ? first_us : newest_us; pose_us <= newest_us; pose_us += 20'000) SendPose(pose_us);
      last_pose_us_ = newest_us;
    }
    if (has_scan) SendScanOfWater(now_us);
    if (has_tracks) SendTracks(now_us);
    if (has_alerts) SendAlerts(now_us);
    ++seq_;
  }

  static alert_t MakeAlert(std::int64_t id, std::int64_t track_id) {
    alert_t alert{};
    alert.id = id;
    alert.cause = alert_t::CAUSE_CLOSEST_APPROACH;
    alert.level = alert_t::LEVEL_WARNING;
    alert.state = alert_t::STATE_ACTIVE;
    alert.track_id = track_id;
    alert.raised_utime_us = alert.changed_utime_us = 1'782'901'200'000'000;
    alert.text = "boat " + std::to_string(track_id) + ": closest approach 3 m in 21 s";
    return alert;
  }

 private:
  void SendPose(std::int64_t utime_us) {
    pose_t pose{};
    pose.utime_us = utime_us;
    pose.seq = pose_seq_++;
    pose.status = pose_t::STATUS_OK;
    SetDatum(pose, kPlace);
    pose.latitude_deg = kPlace.latitude_deg;
    pose.longitude_deg = kPlace.longitude_deg;
    pose.velocity_map_mps[0] = 2.0;
    pose.heading_rad = 1.5;
    bus::Publish(bus_, bus::kPose, pose);
  }

  void SendScanOfWater(std::int64_t end_utime_us) {
    auto scan = OfScan<lidar_scan_t>(end_utime_us - kScanUs, seq_, kScanUs);
    constexpr int kColumns = 900;
    std::vector<float> azimuth_rad;
    std::vector<std::int32_t> time_ns;
    for (int i = 0; i < kColumns; ++i) {
      azimuth_rad.push_back(static_cast<float>(i * 2.0 * 3.14159265358979 / kColumns));
      time_ns.push_back(static_cast<std::int32_t>(i * kScanUs * 1000 / kColumns));
    }
    FillColumns(scan, azimuth_rad, time_ns, 0);
    scan.elevation_rad = {-0.02F, 0.0F};
    auto labels = LabelsOf(scan, 0);
    bus::Publish(bus_, bus::kLidarScan, scan);
    bus::Publish(bus_, bus::kSegments, labels);
  }

  // On rings around the boat, half of them moving; in parts, as the tracker sends them.
  void SendTracks(std::int64_t end_utime_us) {
    const LocalFrame map(kPlace);
    auto message = OfScan<tracks_t>(end_utime_us - kScanUs, seq_, kScanUs);
    message.begin_utime_us = 1'782'901'200'000'000;
    SetDatum(message, kPlace);
    std::vector<track_t> tracks(static_cast<std::size_t>(num_tracks));
    for (int i = 0; i < num_tracks; ++i) {
      const double range_m = 20.0 + i % 60;
      const auto place = map.Reverse({range_m * std::sin(i), range_m * std::cos(i), 0.0});
      auto& track = tracks[static_cast<std::size_t>(i)];
      track.id = i + 1;
      track.status = track_t::STATUS_CONFIRMED;
      track.kind = track_t::KIND_BOAT;
      track.first_utime_us = track.seen_utime_us = end_utime_us;
      track.latitude_deg = place.latitude_deg;
      track.longitude_deg = place.longitude_deg;
      track.velocity_map_mps[0] = i % 2 == 0 ? 1.0 : 0.0;
      track.length_m = 4.0F;
      track.width_m = 2.0F;
      track.distance_m = static_cast<float>(range_m) - 2.0F;
      track.cpa_m = 15.0F;
      track.num_outline = 12;
      track.outline_east_m.assign(12, 1.0F);
      track.outline_north_m.assign(12, 1.0F);
    }
    Fill(message, std::move(tracks));
    for (const auto& part : InParts(message, 150)) bus::Publish(bus_, bus::kTracks, part);
  }

  void SendAlerts(std::int64_t end_utime_us) {
    auto message = OfScan<alerts_t>(end_utime_us - kScanUs, seq_, kScanUs);
    Fill(message, alerts);
    bus::Publish(bus_, bus::kAlerts, message);
  }

  bus::LcmBus& bus_;
  std::int64_t seq_ = 0;
  std::int64_t pose_seq_ = 0;
  std::int64_t last_pose_us_ = 0;
};

}  // namespace lookout::support
