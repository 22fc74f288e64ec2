// A service with an output of MAVLink, and what it reads: walls and boats around a boat that moves and turns, seen by a lidar that is not at its
// reference point.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "common/core/frames.hpp"
#include "services/plotter/mavlink_output.hpp"
#include "tests/support/mavlink_frames.hpp"
#include "tests/unit/plotter/fixture.hpp"

namespace lookout::plotter::test {
using Eigen::Vector2d;
using support::MavlinkFrame;

using Polygon = std::vector<Vector2d>;  // map frame
inline constexpr double kNothing = std::numeric_limits<double>::infinity();
inline constexpr double kReachM = 40.0;
inline constexpr std::int64_t kScanUs = 100'000;

// Of a ray from a place to the nearest edge.
inline double RangeTo(const std::vector<Polygon>& things, const Vector2d& from_m, const Vector2d& direction) {
  double nearest_m = kNothing;
  for (const auto& thing : things) {
    for (std::size_t i = 0; i < thing.size(); ++i) {
      const Vector2d a_m = thing[i] - from_m;
      const Vector2d edge_m = thing[(i + 1) % thing.size()] - thing[i];
      const double turn = direction.x() * edge_m.y() - direction.y() * edge_m.x();
      if (std::abs(turn) < 1e-12) continue;
      const double range_m = (a_m.x() * edge_m.y() - a_m.y() * edge_m.x()) / turn;
      const double share = (a_m.x() * direction.y() - a_m.y() * direction.x()) / turn;
      if (range_m > 0.0 && share >= 0.0 && share <= 1.0) nearest_m = std::min(nearest_m, range_m);
    }
  }
  return nearest_m;
}

class MavlinkService : public ::testing::Test {
 protected:
  std::unique_ptr<bus::MemoryBus> bus_ = std::make_unique<bus::MemoryBus>();
  Params params_{.boat = "gannet"};
  OutputParams output_{.name = "pilot", .format = Format::kMavlink, .mavlink = {.system_id = 3, .component_id = 196, .max_distance_m = kReachM}};
  KeepingLink* link_ = nullptr;
  std::unique_ptr<Service> service_;
  std::int64_t host_us_ = kStartUs;
  std::int64_t seq_ = 0;

  // The boat, linear in time.
  Vector2d place_m_{200.0, -100.0};  // map, at kStartUs
  Vector2d velocity_mps_{1.5, 2.0};
  double heading_rad_ = 0.7;
  double turn_radps_ = DegToRad(20.0);
  std::int32_t pose_status_ = pose_t::STATUS_OK;
  bool is_relative_ = false;
  // What there is, and what the lidar sees of it.
  std::vector<Polygon> things_;
  std::vector<track_t> tracks_;
  std::vector<alert_t> alerts_;
  bool is_sure_ = true;
  std::vector<std::int32_t> land_ids_;
  std::vector<Vector2d> waterline_m_;
  bool sends_scan_ = true;
  bool sends_labels_ = true;
  bool is_in_parts_ = false;
  std::function<bool(double azimuth_deg)> fires_ = [](double) { return true; };

  MavlinkService() {
    LidarSightParams lidar{.above_water_m = 1.4, .min_range_m = 0.5, .reach_m = kReachM};
    lidar.T_vessel_lidar = TransformVesselSensor({.p_vessel_m = {1.2, -0.3, 1.0}, .yaw_rad = DegToRad(30.0)});
    lidar.own_vessel_box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-1.5, -0.8, -1.0), Eigen::Vector3d(1.5, 0.8, 2.0));
    params_.surroundings = SurroundingsParams{.lidars = {lidar}, .own_vessel_box_m = lidar.own_vessel_box_m, .reach_m = kReachM};
  }

  void SetUp() override { Start(); }

  // POSE is there before the first shot, once things are set.
  void BeginPose() {
    if (host_us_ == kStartUs) SendPose(kStartUs);
  }

  void Start() {
    service_.reset();
    bus_ = std::make_unique<bus::MemoryBus>();
    auto link = std::make_unique<KeepingLink>();
    link_ = link.get();
    std::vector<std::unique_ptr<Output>> outputs;
    outputs.push_back(std::make_unique<MavlinkOutput>(output_, std::move(link)));
    service_ = std::make_unique<Service>(*bus_, params_, std::move(outputs));
    service_->AdvanceTo(Now());
  }

  Utime Now() const { return Utime(std::chrono::microseconds(host_us_)); }
  static double SinceStart(std::int64_t utime_us) { return static_cast<double>(utime_us - kStartUs) * 1e-6; }
  Vector2d PlaceAt(std::int64_t utime_us) const { return place_m_ + SinceStart(utime_us) * velocity_mps_; }
  double HeadingAt(std::int64_t utime_us) const { return WrapTo2Pi(heading_rad_ + SinceStart(utime_us) * turn_radps_); }

  void SetDatum(auto& message) const {
    support::SetDatum(message, kPlace);
    if (!is_relative_) return;
    message.datum_latitude_deg = message.datum_longitude_deg = kNan;
    message.datum_ellipsoid_height_m = 1'782'901'200'000.0;
  }

  void SendPose(std::int64_t utime_us) {
    pose_t pose{};
    pose.utime_us = utime_us;
    pose.seq = utime_us / 20'000 - kStartUs / 20'000;
    pose.status = pose_status_;
    pose.heading_source = pose_t::HEADING_HDT;
    SetDatum(pose);
    const auto place_m = PlaceAt(utime_us);
    const auto place = LocalFrame(kPlace).Reverse({place_m.x(), place_m.y(), 0.0});
    pose.latitude_deg = is_relative_ ? kNan : place.latitude_deg;
    pose.longitude_deg = is_relative_ ? kNan : place.longitude_deg;
    pose.position_map_m[0] = place_m.x();
    pose.position_map_m[1] = place_m.y();
    pose.heading_rad = HeadingAt(utime_us);
    for (int i = 0; i < 9; ++i) pose.covariance[i][i] = 0.01;
    if (pose_status_ == pose_t::STATUS_UNKNOWN) {
      pose.latitude_deg = pose.longitude_deg = pose.heading_rad = kNan;
      SetDatum(pose);
    }
    support::Send(*bus_, bus::kPose, pose);
  }

  // Two halves of a scan or of its labels, by columns; segments stand in the first.
  template <typename Message>
  static std::vector<Message> Halves(const Message& whole) {
    const auto half = whole.num_columns / 2;
    const auto cells = static_cast<std::ptrdiff_t>(whole.num_cells / whole.num_columns) * half;
    std::vector<Message> parts(2, whole);
    for (std::int32_t i = 0; i < 2; ++i) {
      auto& part = parts[static_cast<std::size_t>(i)];
      part.part_index = i;
      part.num_parts = 2;
      part.first_column = i * half;
      part.num_columns = i == 0 ? half : whole.num_columns - half;
      const auto cut = [i](auto& values, std::ptrdiff_t at) {
        if (i == 0) values.erase(values.begin() + at, values.end());
        if (i == 1) values.erase(values.begin(), values.begin() + at);
      };
      if constexpr (requires { part.label; }) {
        cut(part.label, cells);
        part.num_cells = static_cast<std::int32_t>(part.label.size());
        part.num_labelled = static_cast<std::int32_t>(std::ranges::count(part.label, 1));
        part.piece.resize(static_cast<std::size_t>(part.num_labelled));
        if (i == 1) part.segments.clear();
        part.num_segments = static_cast<std::int32_t>(part.segments.size());
      } else {
        cut(part.azimuth_rad, half);
        cut(part.time_ns, half);
        cut(part.range, cells);
        cut(part.reflectivity, cells);
        part.num_cells = static_cast<std::int32_t>(part.range.size());
      }
    }
    return parts;
  }
  template <typename Message>
  void SendAll(const bus::Channel& channel, const Message& message) {
    if (!is_in_parts_) return support::Send(*bus_, channel, message);
    for (const auto& part : Halves(message)) support::Send(*bus_, channel, part);
  }

  // A scan of 0.2 deg columns that ends so long before now: each column sees from where the boat was then.
  void SendScan(std::size_t lidar_index = 0, std::int64_t before_us = 0) {
    const auto begin_us = host_us_ - kScanUs - before_us;
    auto scan = support::OfScan<lidar_scan_t>(begin_us, seq_, kScanUs);
    const auto& lidar = params_.surroundings->lidars.at(lidar_index);
    constexpr int kColumns = 1800;
    std::vector<float> azimuth_rad;
    std::vector<std::int32_t> time_ns;
    for (int i = 0; i < kColumns; ++i) {
      if (!fires_(i * 360.0 / kColumns)) continue;
      azimuth_rad.push_back(static_cast<float>(i * kTwoPi / kColumns));
      time_ns.push_back(static_cast<std::int32_t>(i * kScanUs * 1000 / kColumns));
    }
    support::FillColumns(scan, azimuth_rad, time_ns, 0);
    scan.elevation_rad = {-0.01F, 0.01F};
    scan.time_offset_ns = {0, 0};
    auto labels = support::LabelsOf(scan, 0);
    for (std::size_t i = 0; i < azimuth_rad.size(); ++i) {
      const auto utime_us = begin_us + time_ns[i] / 1000;
      const Eigen::Matrix3d turn = RotationMapVessel(HeadingAt(utime_us), 0.0, 0.0);
      const Eigen::Vector3d direction = turn * lidar.T_vessel_lidar.linear() * BeamDirection(static_cast<double>(azimuth_rad[i]), 0.0);
      const Vector2d from_m = PlaceAt(utime_us) + (turn * lidar.T_vessel_lidar.translation()).head<2>();
      const double range_m = RangeTo(things_, from_m, direction.head<2>());
      if (range_m > 100.0) continue;
      // Slant range of the upper beam.
      const auto cell = 2 * i + 1;
      scan.range[cell] = static_cast<std::int16_t>(static_cast<std::uint16_t>(std::lround(range_m / std::cos(0.01) / 0.002)));
      labels.label[cell] = 1;
    }
    labels.num_labelled = static_cast<std::int32_t>(std::ranges::count(labels.label, 1));
    labels.piece.assign(static_cast<std::size_t>(labels.num_labelled), 1);
    segment_t segment{};
    segment.utime_us = segment.nearest_utime_us = begin_us;
    segment.id = 1;
    segment.confidence = is_sure_ ? std::int32_t{segment_t::CONFIDENCE_SURE} : std::int32_t{segment_t::CONFIDENCE_TENTATIVE};
    segment.num_points = std::max(1, labels.num_labelled);
    segment.num_hull = 1;
    segment.hull_x_m = segment.hull_y_m = {1.0F};
    segment.hull_time_us = {0};
    support::Fill(labels, {segment});
    if (sends_scan_) SendAll(lidar_index == 0 ? bus::kLidarScan : bus::kLidarScan2, scan);
    if (sends_labels_) SendAll(lidar_index == 0 ? bus::kSegments : bus::kSegments2, labels);
  }

  void SendTracks() {
    auto message = support::OfScan<tracks_t>(host_us_ - kScanUs, seq_, kScanUs);
    message.begin_utime_us = kStartUs;
    SetDatum(message);
    message.land_segment_ids = land_ids_;
    message.num_land_segments = static_cast<std::int32_t>(land_ids_.size());
    for (const auto& cell_m : waterline_m_) {
      message.waterline_east_m.push_back(static_cast<float>(cell_m.x()));
      message.waterline_north_m.push_back(static_cast<float>(cell_m.y()));
    }
    message.num_waterline = static_cast<std::int32_t>(waterline_m_.size());
    support::Fill(message, tracks_);
    support::Send(*bus_, bus::kTracks, message);
  }

  void SendAlerts() {
    auto message = support::OfScan<alerts_t>(host_us_ - kScanUs, seq_, kScanUs);
    support::Fill(message, alerts_);
    support::Send(*bus_, bus::kAlerts, message);
  }

  void Wait(std::int64_t duration_us, bool has_pose = true) {
    for (const auto end_us = host_us_ + duration_us; host_us_ < end_us;) {
      host_us_ += 20'000;
      link_->Pass(0.02);
      service_->AdvanceTo(Now());
      if (has_pose) SendPose(host_us_);
      support::HandleAll(*bus_);
    }
  }

  // A scan, and all that is made of it.
  void NextScan() {
    BeginPose();
    Wait(kScanUs);
    SendScan();
    SendTracks();
    SendAlerts();
    support::HandleAll(*bus_);
    ++seq_;
  }
  void Run(int num_scans) {
    for (int i = 0; i < num_scans; ++i) NextScan();
  }

  std::vector<MavlinkFrame> Frames() const {
    std::string bytes;
    for (const auto& message : link_->sent) bytes += message;
    return support::ReadMavlink(bytes);
  }
  std::vector<MavlinkFrame> Frames(std::uint32_t message_id) const { return support::Only(message_id, Frames()); }
  std::vector<std::string> Texts() const {
    std::vector<std::string> texts;
    for (const auto& frame : Frames(support::kStatusTextId)) texts.push_back(frame.text());
    return texts;
  }
  // Of the next scan; empty where nothing was sent.
  std::optional<MavlinkFrame> Last() {
    link_->sent.clear();
    NextScan();
    const auto frames = Frames(support::kObstacleDistanceId);
    EXPECT_LE(frames.size(), 1U);
    return frames.empty() ? std::nullopt : std::optional(frames.back());
  }

  // Nearest edge of anything in a sector around the boat of now, by steps of 0.05 deg; the sector made wider or narrower by so much at each side.
  double TrueDistance(std::size_t sector, double wider_deg) const {
    double least_m = kNothing;
    const double half_deg = kSectorDeg / 2.0 + wider_deg;
    for (double within_deg = -half_deg; within_deg <= half_deg; within_deg += 0.05) {
      const double from_north_rad = HeadingAt(host_us_) + DegToRad(static_cast<double>(sector) * kSectorDeg + within_deg);
      least_m = std::min(least_m, RangeTo(things_, PlaceAt(host_us_), {std::sin(from_north_rad), std::cos(from_north_rad)}));
    }
    return least_m;
  }

  // Each sector holds the truth within 0.1 m, of a sector that is half a degree wider at each side at most.
  void ExpectTruth(const MavlinkFrame& frame) const {
    for (std::size_t i = 0; i < kNumSectors; ++i) {
      const double narrow_m = TrueDistance(i, -0.5);
      const double wide_m = TrueDistance(i, 0.5);
      const auto sent_cm = frame.distance_cm(i);
      ASSERT_NE(sent_cm, MavSectors::kUnknown) << i;
      if (sent_cm == 4001) {
        EXPECT_GT(narrow_m, kReachM - 0.1) << i;
        continue;
      }
      EXPECT_LE(sent_cm * 0.01, narrow_m + 0.1) << i;
      EXPECT_GE(sent_cm * 0.01, wide_m - 0.1) << i;
    }
  }

  static Polygon Box(const Vector2d& center_m, double length_m, double width_m, double angle_rad) {
    const Vector2d along(std::cos(angle_rad) * length_m / 2.0, std::sin(angle_rad) * length_m / 2.0);
    const Vector2d across(-std::sin(angle_rad) * width_m / 2.0, std::cos(angle_rad) * width_m / 2.0);
    return {center_m + along + across, center_m - along + across, center_m - along - across, center_m + along - across};
  }
  static track_t TrackOf(std::int64_t id, const Polygon& outline_m, std::int32_t status = track_t::STATUS_CONFIRMED) {
    track_t track{};
    track.id = id;
    track.status = status;
    track.kind = track_t::KIND_BOAT;
    track.first_utime_us = track.seen_utime_us = kStartUs;
    track.latitude_deg = kPlace.latitude_deg;
    track.longitude_deg = kPlace.longitude_deg;
    track.num_outline = static_cast<std::int32_t>(outline_m.size());
    for (const auto& corner_m : outline_m) {
      track.outline_east_m.push_back(static_cast<float>(corner_m.x()));
      track.outline_north_m.push_back(static_cast<float>(corner_m.y()));
    }
    return track;
  }
  static alert_t AlertOf(std::int64_t id, std::int32_t cause) {
    alert_t alert{};
    alert.id = id;
    alert.cause = cause;
    alert.level = alert_t::LEVEL_WARNING;
    alert.state = alert_t::STATE_ACTIVE;
    alert.raised_utime_us = alert.changed_utime_us = kStartUs;
    alert.text = "boat 17: closest approach 3 m in 21 s";
    return alert;
  }
  // Before the boat at the end of that scan.
  Vector2d Ahead(int num_scans, double ahead_m, double starboard_m) const {
    const auto utime_us = host_us_ + num_scans * kScanUs;
    const double heading_rad = HeadingAt(utime_us);
    return PlaceAt(utime_us) + ahead_m * Vector2d(std::sin(heading_rad), std::cos(heading_rad)) +
           starboard_m * Vector2d(std::cos(heading_rad), -std::sin(heading_rad));
  }
};

}  // namespace lookout::plotter::test
