// Distances for an autopilot, against exact geometry: walls and boats around a boat that moves and turns, seen by a lidar that is not at its
// reference point; and when nothing is sent.
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
namespace {

using Eigen::Vector2d;
using support::MavlinkFrame;

using Polygon = std::vector<Vector2d>;  // map frame
constexpr double kNothing = std::numeric_limits<double>::infinity();
constexpr double kReachM = 40.0;
constexpr std::int64_t kScanUs = 100'000;

// Of a ray from a place to the nearest edge.
double RangeTo(const std::vector<Polygon>& things, const Vector2d& from_m, const Vector2d& direction) {
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

  // A scan of 0.2 deg columns that ends now: each column sees from where the boat was then.
  void SendScan() {
    const auto begin_us = host_us_ - kScanUs;
    auto scan = support::OfScan<lidar_scan_t>(begin_us, seq_, kScanUs);
    const auto& lidar = params_.surroundings->lidars.front();
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
    if (sends_scan_) support::Send(*bus_, bus::kLidarScan, scan);
    if (sends_labels_) support::Send(*bus_, bus::kSegments, labels);
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

  // Nearest edge of anything in a sector around the boat of now, by steps of 0.02 deg; the sector made wider or narrower by so much at each side.
  double TrueDistance(std::size_t sector, double wider_deg) const {
    double least_m = kNothing;
    const double half_deg = kSectorDeg / 2.0 + wider_deg;
    for (double within_deg = -half_deg; within_deg <= half_deg; within_deg += 0.02) {
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

TEST_F(MavlinkService, SendsTheTrueDistanceOfEachSectorWhileTheBoatMovesAndTurns) {
  things_ = {Box(Ahead(1, 12.0, 0.0), 4.0, 2.0, 0.3), Box(Ahead(1, -20.0, 9.0), 6.0, 2.5, 1.2), Box(Ahead(1, 2.0, 6.0), 1.0, 1.0, 0.0),
             Box(Ahead(1, 0.0, -25.0), 60.0, 3.0, 0.5)};
  for (int i = 0; i < 5; ++i) {
    const auto frame = Last();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->system_id, 3);
    EXPECT_EQ(frame->component_id, 196);
    EXPECT_EQ(frame->At<std::uint64_t>(0), static_cast<std::uint64_t>(host_us_));
    EXPECT_EQ(frame->At<std::uint16_t>(152), 1);
    EXPECT_EQ(frame->At<std::uint16_t>(154), 4000);
    EXPECT_EQ(frame->At<float>(158), 5.0F);
    EXPECT_EQ(frame->At<float>(162), 0.0F);
    EXPECT_EQ(frame->At<std::uint8_t>(166), 12);
    ExpectTruth(*frame);
  }
}

// It is not on the earth, and has no position.
TEST_F(MavlinkService, SendsTheSameInAFrameOfItsOwn) {
  is_relative_ = true;
  pose_status_ = pose_t::STATUS_RELATIVE;
  things_ = {Box(Ahead(1, 15.0, 3.0), 4.0, 2.0, 0.3), Box(Ahead(1, 0.0, -25.0), 60.0, 3.0, 0.5)};
  for (int i = 0; i < 3; ++i) {
    const auto frame = Last();
    ASSERT_TRUE(frame);
    ExpectTruth(*frame);
  }
}

TEST_F(MavlinkService, SendsWhatTheLidarSawWherePoseKnowsNothing) {
  pose_status_ = pose_t::STATUS_UNKNOWN;
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = 0.0;
  things_ = {Box(Ahead(1, 15.0, 3.0), 4.0, 2.0, 0.3)};
  Run(2);
  const auto frame = Last();
  ASSERT_TRUE(frame);
  ExpectTruth(*frame);
}

// The boat has turned right round under a wall that stands.
TEST_F(MavlinkService, FollowsATurnOfTheBoat) {
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = DegToRad(60.0);
  things_ = {Box(place_m_ + Vector2d(0.0, 10.0), 8.0, 1.0, 0.0)};
  for (int i = 0; i < 60; ++i) {
    const auto frame = Last();
    ASSERT_TRUE(frame);
    ExpectTruth(*frame);
  }
}

TEST_F(MavlinkService, SendsCoastingTracksThatAreNotSeenWhereTheyHaveGone) {
  turn_radps_ = 0.0;
  const auto outline_m = Box(Ahead(1, 10.0, 0.0), 2.0, 2.0, -heading_rad_);
  auto track = TrackOf(7, outline_m, track_t::STATUS_COASTING);
  tracks_ = {track};
  auto frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_NEAR(frame->distance_cm(0), 900, 2);
  EXPECT_EQ(frame->distance_cm(20), 4001);
  // POSE is 60 ms farther than TRACKS: the track has gone on, and so has the boat.
  Wait(kScanUs);
  SendScan();
  auto ahead_m = Box(Ahead(0, 10.0, 0.0), 2.0, 2.0, -heading_rad_);
  track = TrackOf(7, ahead_m, track_t::STATUS_COASTING);
  const Vector2d bow(std::sin(heading_rad_), std::cos(heading_rad_));
  track.velocity_map_mps[0] = 5.0 * bow.x();
  track.velocity_map_mps[1] = 5.0 * bow.y();
  tracks_ = {track};
  const auto end_us = host_us_;
  Wait(60'000);
  host_us_ = end_us;
  link_->sent.clear();
  SendTracks();
  support::HandleAll(*bus_);
  const auto frames = Frames(support::kObstacleDistanceId);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_NEAR(frames.front().distance_cm(0), 100.0 * (9.0 + 0.06 * (5.0 - velocity_mps_.dot(bow))), 3.0);
}

TEST_F(MavlinkService, LeavesOutWhatMayBeSprayAndTentativeAndLostTracks) {
  things_ = {Box(Ahead(1, 10.0, 0.0), 1.0, 1.0, 0.0)};
  is_sure_ = false;
  tracks_ = {TrackOf(-2, Box(Ahead(1, 0.0, 10.0), 2.0, 2.0, 0.0), track_t::STATUS_TENTATIVE),
             TrackOf(5, Box(Ahead(1, 0.0, -10.0), 2.0, 2.0, 0.0), track_t::STATUS_LOST)};
  auto frame = Last();
  ASSERT_TRUE(frame);
  for (std::size_t i = 0; i < kNumSectors; ++i) EXPECT_EQ(frame->distance_cm(i), 4001) << i;
  // Land it is by what is remembered.
  land_ids_ = {1};
  frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_LT(frame->distance_cm(0), 1000);
  land_ids_.clear();
  // Or a confirmed track explains it, as one of a buoy with a return a scan.
  tracks_ = {TrackOf(5, Box(Ahead(1, 0.0, -10.0), 2.0, 2.0, 0.0))};
  tracks_.front().segment_ids = {1};
  tracks_.front().num_segments = 1;
  frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_LT(frame->distance_cm(0), 1000);
}

// The outline of a dock around the berth bridges its mouth; its returns do not.
TEST_F(MavlinkService, SendsTheReturnsOfAStructureThatIsSeenAndNotItsOutline) {
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = 0.0;
  things_ = {Box(Ahead(1, -6.0, 0.0), 12.0, 1.0, -heading_rad_), Box(Ahead(1, 0.0, 6.0), 1.0, 12.0, -heading_rad_),
             Box(Ahead(1, 0.0, -6.0), 1.0, 12.0, -heading_rad_)};
  tracks_ = {TrackOf(9, Box(Ahead(1, 0.0, 0.0), 13.0, 13.0, -heading_rad_))};
  for (const bool is_structure : {true, false}) {
    tracks_.front().kind = is_structure ? std::int32_t{track_t::KIND_STRUCTURE} : std::int32_t{track_t::KIND_UNKNOWN};
    tracks_.front().segment_ids = {1};
    tracks_.front().num_segments = 1;
    const auto frame = Last();
    ASSERT_TRUE(frame);
    ExpectTruth(*frame);
    EXPECT_EQ(frame->distance_cm(0), 4001);
  }
}

// On a beach what was seen before, when a beam met it lower, is nearer than what is seen now. TRACKS tell it every tenth scan.
TEST_F(MavlinkService, SendsRememberedLandUntilItIsToldNoMore) {
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = 0.0;
  waterline_m_ = {Ahead(0, 15.0, 0.0), Ahead(0, 0.0, 60.0)};
  auto frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_NEAR(frame->distance_cm(0), 1500, 1);
  EXPECT_EQ(frame->distance_cm(18), 4001);
  waterline_m_.clear();
  for (int i = 0; i < 10; ++i) frame = Last();
  EXPECT_NEAR(frame->distance_cm(0), 1500, 1);
  Run(25);
  EXPECT_EQ(Last()->distance_cm(0), 4001);
}

TEST_F(MavlinkService, SaysUnknownWhereNobodyLooks) {
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = 0.0;
  // The lidar is turned by 30 deg to port: it does not fire from 120 to 240 deg of its own, 90 to 210 deg of the boat.
  fires_ = [](double azimuth_deg) { return azimuth_deg < 120.0 || azimuth_deg > 240.0; };
  tracks_ = {TrackOf(4, Box(Ahead(1, -10.0, 0.0), 2.0, 2.0, -heading_rad_), track_t::STATUS_COASTING)};
  const auto frame = Last();
  ASSERT_TRUE(frame);
  for (std::size_t i = 20; i < 41; ++i) {
    const bool is_thing = i >= 35 && i <= 37;
    EXPECT_EQ(frame->distance_cm(i) == MavSectors::kUnknown, !is_thing) << i;
  }
  EXPECT_NEAR(frame->distance_cm(36), 900, 2);  // what was there before is told
  EXPECT_EQ(frame->distance_cm(0), 4001);
  EXPECT_EQ(frame->distance_cm(50), 4001);
}

// At the start, or where the map becomes another one: the boat's way within the scan is not known.
TEST_F(MavlinkService, SaysNothingIsClearWhereAPoseWithinTheScanIsMissing) {
  host_us_ += 20'000;
  NextScan();
  for (const auto& frame : Frames(support::kObstacleDistanceId)) {
    for (std::size_t i = 0; i < kNumSectors; ++i) EXPECT_EQ(frame.distance_cm(i), MavSectors::kUnknown) << i;
  }
  const auto frame = Last();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->distance_cm(0), 4001);
}

// Without the scan nobody knows what else is there; without a track either there is nothing to say.
TEST_F(MavlinkService, SaysNothingIsClearWithoutTheScan) {
  tracks_ = {TrackOf(4, Box(Ahead(1, 10.0, 0.0), 2.0, 2.0, -heading_rad_))};
  for (bool* sends : {&sends_scan_, &sends_labels_}) {
    *sends = false;
    const auto frame = Last();
    ASSERT_TRUE(frame);
    EXPECT_LT(frame->distance_cm(0), 1200);
    for (std::size_t i = 0; i < kNumSectors; ++i) EXPECT_NE(frame->distance_cm(i), 4001) << i;
    *sends = true;
  }
  sends_scan_ = false;
  tracks_.clear();
  EXPECT_FALSE(Last());
}

TEST_F(MavlinkService, IsSilentWhenTheLookOutIsLostAndSaysSoOnce) {
  Run(10);
  EXPECT_EQ(Frames(support::kObstacleDistanceId).size(), 10U);
  ASSERT_EQ(Texts(), std::vector<std::string>{"Lookout: the look-out begins"});
  link_->sent.clear();
  // TRACKS come no more, all else does.
  for (int i = 0; i < 30; ++i) {
    Wait(kScanUs);
    SendScan();
    SendAlerts();
  }
  EXPECT_TRUE(Frames(support::kObstacleDistanceId).empty());
  ASSERT_EQ(Texts(), std::vector<std::string>{"Lookout: no look-out, no distances are sent"});
  EXPECT_EQ(Frames(support::kHeartbeatId).size(), 3U);
  EXPECT_EQ(Frames(support::kHeartbeatId).back().At<std::uint8_t>(7), 5);  // MAV_STATE_CRITICAL
  link_->sent.clear();
  Run(3);
  EXPECT_EQ(Texts(), std::vector<std::string>{"Lookout: the look-out is back"});
  EXPECT_EQ(Frames(support::kObstacleDistanceId).size(), 3U);
}

TEST_F(MavlinkService, IsSilentWithoutAlertsOrPose) {
  Run(10);
  for (int i = 0; i < 20; ++i) {
    Wait(kScanUs);
    SendScan();
    SendTracks();
    ++seq_;
  }
  link_->sent.clear();
  for (int i = 0; i < 10; ++i) {
    Wait(kScanUs);
    SendScan();
    SendTracks();
    ++seq_;
  }
  EXPECT_TRUE(Frames(support::kObstacleDistanceId).empty());
  Run(5);
  EXPECT_FALSE(Frames(support::kObstacleDistanceId).empty());
  Wait(1'200'000, false);
  link_->sent.clear();
  SendScan();
  SendTracks();
  SendAlerts();
  support::HandleAll(*bus_);
  EXPECT_TRUE(Frames(support::kObstacleDistanceId).empty());
}

TEST_F(MavlinkService, IsSilentWhileAnAlertSaysThatNobodyLooks) {
  Run(10);
  alerts_ = {AlertOf(-1, alert_t::CAUSE_WATCH)};
  NextScan();
  EXPECT_FALSE(Last());
  // A part of the guard zone alone: its sectors are unknown by themselves.
  alerts_ = {AlertOf(4, alert_t::CAUSE_WATCH)};
  NextScan();
  EXPECT_TRUE(Last());
}

TEST_F(MavlinkService, TellsARaisedAlertOnce) {
  Run(5);
  link_->sent.clear();
  alerts_ = {AlertOf(3, alert_t::CAUSE_CLOSEST_APPROACH)};
  Run(130);
  alerts_.front().state = alert_t::STATE_ACKNOWLEDGED;
  Run(5);
  ASSERT_EQ(Texts(), std::vector<std::string>{"Lookout: boat 17: closest approach 3 m in 21 s"});
  EXPECT_EQ(Frames(support::kStatusTextId).front().At<std::uint8_t>(0), 4);  // MAV_SEVERITY_WARNING
}

TEST_F(MavlinkService, SendsAHeartbeatASecondFromTheStartOn) {
  Wait(10'000'000, false);
  const auto frames = Frames(support::kHeartbeatId);
  EXPECT_EQ(frames.size(), 11U);
  EXPECT_EQ(frames.front().At<std::uint8_t>(4), 18);
  EXPECT_EQ(frames.front().At<std::uint8_t>(5), 8);
  EXPECT_EQ(Texts(), std::vector<std::string>{"Lookout: no look-out, no distances are sent"});
}

TEST_F(MavlinkService, SendsPointsInPlaceOfSectors) {
  output_.mavlink.form = MavlinkForm::kPoints;
  Start();
  NextScan();
  auto points = Frames(support::kObstacleDistance3dId);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points.front().At<float>(4), 41.0F);
  things_ = {Box(Ahead(1, 12.0, 0.0), 2.0, 2.0, -heading_rad_)};
  turn_radps_ = 0.0;
  link_->sent.clear();
  NextScan();
  points = Frames(support::kObstacleDistance3dId);
  EXPECT_TRUE(Frames(support::kObstacleDistanceId).empty());
  ASSERT_GE(points.size(), 3U);
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_EQ(points[i].At<std::uint32_t>(0), points[0].At<std::uint32_t>(0));
    EXPECT_EQ(points[i].At<std::uint8_t>(27), 12);
    EXPECT_GE(std::hypot(points[i].At<float>(4), points[i].At<float>(8)), std::hypot(points[i - 1].At<float>(4), points[i - 1].At<float>(8)));
  }
}

}  // namespace
}  // namespace lookout::plotter::test
