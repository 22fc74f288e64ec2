#include "services/tracker/wire.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include "common/bus/channels.hpp"
#include "common/core/angles.hpp"
#include "services/tracker/alert_text.hpp"
#include "tests/unit/tracker_shell/messages.hpp"

namespace lookout::tracker {
namespace {

TEST(ToObstacles, MergesPartsAndKeepsWhatTheTrackerNeeds) {
  auto first = test::MakeObstacles(0, 7, {test::MakeObstacle(1, test::kStartUs + 10, {3.0, 4.0})});
  auto second = test::MakeObstacles(0, 7, {test::MakeObstacle(5, test::kStartUs + 20, {-3.0, 4.0})});
  first.num_parts = second.num_parts = 2;
  second.part_index = 1;
  auto& land = second.obstacles[0];
  land.kind = obstacle_t::KIND_LAND;
  land.confidence = obstacle_t::CONFIDENCE_TENTATIVE;
  land.thing_probability = std::numeric_limits<float>::quiet_NaN();
  land.num_waterline = land.num_waterline_map = 2;
  land.waterline_east_m = land.waterline_north_m = land.waterline_vessel_x_m = land.waterline_vessel_y_m = {7.0F, 8.0F};
  LeftOut left_out;
  const auto scan = ToObstacles(std::vector{first, second}, left_out);
  ASSERT_TRUE(scan);
  EXPECT_TRUE(scan->is_whole);
  EXPECT_EQ(scan->key.seq, 7);
  EXPECT_EQ(ToUtimeUs(scan->end_time), test::kStartUs + test::kLastShotUs);
  ASSERT_EQ(scan->seen.size(), 2U);
  EXPECT_EQ(scan->seen[0].segment_id, 1);
  EXPECT_EQ(scan->seen[0].num_returns, 5);
  EXPECT_NEAR(scan->seen[0].thing_probability, 0.95, 1e-6);
  EXPECT_EQ(scan->seen[0].position_m, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(scan->seen[0].covariance_relative_m2, 0.01 * Eigen::Matrix2d::Identity());
  EXPECT_EQ(scan->seen[0].outline_m.size(), 3U);
  EXPECT_TRUE(scan->seen[1].is_land);
  EXPECT_FALSE(scan->seen[1].is_sure);
  EXPECT_EQ(scan->seen[1].thing_probability, 0.1) << "of a method that states none";
  EXPECT_EQ(scan->seen[1].waterline_m, (std::vector<Eigen::Vector2d>{{7.0, 7.0}, {8.0, 8.0}}));
  ASSERT_EQ(scan->outlines.size(), 2U);
  EXPECT_FALSE(scan->outlines[0].is_line);
  EXPECT_TRUE(scan->outlines[1].is_line);

  EXPECT_FALSE(ToObstacles(std::vector{second}, left_out)->is_whole);
  second.obstacles[0].id = 1;
  EXPECT_FALSE(ToObstacles(std::vector{first, second}, left_out)) << "one segment twice";
}

TEST(ToBeams, TakesTheNearestReturnOfEachShotAndItsTime) {
  auto scan = test::MakeScan(0, 3);
  scan.num_returns = 2;
  scan.return_kind = {lidar_scan_t::RETURN_LAST, lidar_scan_t::RETURN_STRONGEST};
  scan.num_cells = 2 * test::kNumColumns * test::kNumRings;
  scan.range.assign(static_cast<std::size_t>(scan.num_cells), 0);
  scan.reflectivity.assign(static_cast<std::size_t>(scan.num_cells), 0);
  scan.range[0] = 1000;
  scan.range[1] = 500;
  scan.range[2] = static_cast<std::int16_t>(60'000);  // an unsigned count
  scan.range[5] = 250;
  const auto beams = ToBeams(std::vector{scan});
  ASSERT_TRUE(beams);
  EXPECT_EQ(beams->sweep.azimuth_rad.size(), 10U);
  EXPECT_EQ(ToUtimeUs(beams->sweep.time[2]), test::kStartUs + 19'800);
  ASSERT_EQ(beams->sweep.range_m.size(), 20U);
  EXPECT_FLOAT_EQ(beams->sweep.range_m[0], 1.0F);
  EXPECT_FLOAT_EQ(beams->sweep.range_m[1], 120.0F);
  EXPECT_FLOAT_EQ(beams->sweep.range_m[2], 0.5F);
  EXPECT_EQ(beams->sweep.range_m[3], 0.0F);
  EXPECT_EQ(beams->nearest[0], 1);
  EXPECT_EQ(beams->nearest[1], 0);
  EXPECT_EQ(beams->nearest[2], 1);
}

TEST(ToBeams, RefusesColumnsThatDoNotFit) {
  auto scan = test::MakeScan(0, 3);
  EXPECT_TRUE(ToBeams(std::vector{scan}));
  scan.first_column = 1;
  EXPECT_FALSE(ToBeams(std::vector{scan}));
  scan = test::MakeScan(0, 3);
  scan.num_turn_columns = 11;
  EXPECT_FALSE(ToBeams(std::vector{scan}));
}

TEST(ToLabels, SkipsPartsWithoutColumns) {
  auto labels = test::MakeSegments(0, 3);
  auto further = labels;
  further.part_index = 1;
  further.first_column = further.num_columns = further.num_cells = 0;
  further.label.clear();
  ASSERT_TRUE(ToLabels(std::vector{labels, further}));
  EXPECT_EQ(ToLabels(std::vector{labels, further})->label.size(), 20U);
  labels.first_column = 2;
  EXPECT_FALSE(ToLabels(std::vector{labels}));
}

// Two returns a shot, in two parts of five columns.
std::vector<segments_t> LabelsInTwoParts() {
  auto whole = test::MakeSegments(0, 3);
  std::vector<segments_t> parts(2, whole);
  for (int i = 0; i < 2; ++i) {
    auto& part = parts[static_cast<std::size_t>(i)];
    part.num_parts = 2;
    part.part_index = i;
    part.num_columns = 5;
    part.first_column = 5 * i;
    part.num_cells = 10;
    part.label.assign(10, 0);
    part.label[2] = 4;
    part.label[3] = -1;
    part.label[9] = 5;
    part.num_labelled = 2;
    part.piece = {static_cast<std::int16_t>(3 + i), 7};
  }
  return parts;
}

TEST(ToLabels, PutsPiecesBesideTheirLabels) {
  const auto parts = LabelsInTwoParts();
  const auto labels = ToLabels(parts);
  ASSERT_TRUE(labels);
  std::vector<std::int16_t> expected(20, 0);
  expected[2] = 3;
  expected[12] = 4;
  expected[9] = expected[19] = 7;
  EXPECT_EQ(labels->piece, expected);
  EXPECT_EQ(labels->label[12], 4);
}

TEST(ToLabels, HasNoPiecesWhereTheScanHasNone) {
  auto parts = LabelsInTwoParts();
  for (auto& part : parts) {
    part.num_labelled = 0;
    part.piece.clear();
  }
  ASSERT_TRUE(ToLabels(parts));
  EXPECT_TRUE(ToLabels(parts)->piece.empty());
}

TEST(ToLabels, RefusesPiecesOfSomePartsAndOfTwoSegments) {
  auto parts = LabelsInTwoParts();
  parts[1].num_labelled = 0;
  parts[1].piece.clear();
  EXPECT_FALSE(ToLabels(parts));
  parts[1].label.assign(10, -1);
  EXPECT_TRUE(ToLabels(parts)) << "nothing in it has a piece";
  parts = LabelsInTwoParts();
  parts[1].piece[0] = 7;
  EXPECT_FALSE(ToLabels(parts)) << "piece 7 is of segment 5 in the other part";
}

TEST(WellFormedSegments, HaveAPieceForEachLabelAboveZeroOrNone) {
  const auto good = LabelsInTwoParts()[0];
  EXPECT_TRUE(messages::IsWellFormed(good));
  const auto is_good = [&good](std::vector<std::int16_t> piece) {
    auto message = good;
    message.piece = std::move(piece);
    message.num_labelled = messages::CountOf(message.piece);
    return messages::IsWellFormed(message);
  };
  EXPECT_TRUE(is_good({32'767, 1}));
  EXPECT_TRUE(is_good({}));
  EXPECT_FALSE(is_good({1}));
  EXPECT_FALSE(is_good({1, 2, 3}));
  EXPECT_FALSE(is_good({0, 2}));
  EXPECT_FALSE(is_good({1, -2}));
  auto miscounted = good;
  miscounted.num_labelled = 0;
  EXPECT_FALSE(messages::IsWellFormed(miscounted));
}

// All that 16 bits number: 262 136 bytes, in slices behind the tracks.
TEST(TracksMessage, CarriesWhatEachPieceIsOfInSlices) {
  ScanLabel label;
  label.datum = {43.7, -72.3, 100.0};
  Picture picture;
  picture.tracks.resize(2);
  for (auto& track : picture.tracks) track.outline_m = {{0.0, 0.0}};
  picture.track_of_piece.reserve(32'767);
  for (std::int64_t piece = 1; piece <= 32'767; ++piece) picture.track_of_piece.push_back(piece % 3 == 0 ? kNoTrack : piece % 3 == 1 ? 0 : -piece);
  const auto parts = ToMessages(label, picture, bus::kMaxMessageBytes);
  ASSERT_EQ(parts.size(), 3U);
  std::vector<std::int64_t> track_of_piece;
  for (const auto& part : parts) {
    EXPECT_LE(part.getEncodedSize(), bus::kMaxMessageBytes);
    EXPECT_TRUE(messages::IsWellFormed(part));
    EXPECT_EQ(part.num_parts, 3);
    EXPECT_EQ(part.first_piece, messages::CountOf(track_of_piece) + 1);
    EXPECT_EQ(part.num_pieces, messages::CountOf(part.track_of_piece));
    track_of_piece.insert(track_of_piece.end(), part.track_of_piece.begin(), part.track_of_piece.end());
  }
  EXPECT_EQ(parts[0].num_tracks, 2);
  EXPECT_EQ(track_of_piece, picture.track_of_piece);
}

TEST(TracksMessage, HasNoPiecesWithoutSegments) {
  const auto parts = ToMessages(ScanLabel{}, Picture{}, bus::kMaxMessageBytes);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].first_piece, 0);
  EXPECT_EQ(parts[0].num_pieces, 0);
}

TEST(WellFormedTracks, HaveSlicesOfPiecesThatExist) {
  tracks_t message{};
  message.num_parts = 1;
  message.num_pieces = 2;
  message.track_of_piece = {-5, 3};
  message.first_piece = 1;
  EXPECT_TRUE(messages::IsWellFormed(message));
  message.first_piece = 32'766;
  EXPECT_TRUE(messages::IsWellFormed(message));
  for (const std::int32_t first : {0, -1, 32'767, 2'147'483'647}) {
    message.first_piece = first;
    EXPECT_FALSE(messages::IsWellFormed(message)) << first;
  }
}

TEST(TracksMessage, TurnsAnglesOfTheMapIntoBearings) {
  Picture picture;
  Track& track = picture.tracks.emplace_back();
  track.id = 17;
  track.position_m = {1000.0, 0.0};
  track.velocity_mps = {-3.0, 0.0};  // to the west
  track.covariance = Eigen::Matrix4d::Identity();
  track.covariance(0, 1) = track.covariance(1, 0) = 0.25;
  track.covariance_relative_m2 << 0.5, 0.1, 0.1, 0.25;
  track.rectangle.length_angle_rad = DegToRad(170.0);  // from east, counter-clockwise: 280, or 100 deg from north
  track.bearing_rad = kTwoPi - 1e-12;                  // as a float 2 pi and more
  const ScanLabel label{.key = {}, .begin = {}, .end_time = {}, .raw_seq = 1, .flags = 0, .datum = {43.7, -72.3, 100.0}, .own_up_m = -0.08};
  const auto messages = ToMessages(label, picture, bus::kMaxMessageBytes);
  ASSERT_EQ(messages.size(), 1U);
  const auto& message = messages[0].tracks.at(0);
  EXPECT_NEAR(message.longitude_deg, -72.3 + 1000.0 / (111'320.0 * std::cos(DegToRad(43.7))), 1e-4);
  EXPECT_FLOAT_EQ(message.speed_mps, 3.0F);
  EXPECT_NEAR(message.course_rad, 1.5 * kPi, 1e-6);
  EXPECT_NEAR(RadToDeg(message.length_bearing_rad), 100.0, 1e-4);
  EXPECT_EQ(message.covariance[0][1], 0.25);
  EXPECT_EQ(message.covariance_relative_m2[2], 0.25);
  EXPECT_TRUE(std::isnan(message.turn_rate_radps));
  EXPECT_EQ(message.bearing_rad, 0.0F);
  EXPECT_TRUE(std::isnan(message.bearing_drift_radps));

  picture.tracks[0].velocity_mps.setZero();
  EXPECT_TRUE(std::isnan(ToMessages(label, picture, bus::kMaxMessageBytes)[0].tracks[0].course_rad)) << "what stands has no course";
}

TEST(AlertsMessage, GoesBackToTheAcknowledgementItCameFrom) {
  alert_ack_t message{};
  message.utime_us = 5;
  message.seq = 6;
  message.source = "plotter";
  message.alert_id = 7;
  message.alert_raised_utime_us = 8;
  const auto again = ToMessage(ToAcknowledgement(message));
  EXPECT_EQ(std::tie(again.utime_us, again.seq, again.source, again.alert_id, again.alert_raised_utime_us),
            std::tie(message.utime_us, message.seq, message.source, message.alert_id, message.alert_raised_utime_us));
}

TEST(AlertsMessage, LeavesOutTheLeastGraveWhereItIsFull) {
  std::vector<Alert> alerts(2000);
  for (std::size_t i = 0; i < alerts.size(); ++i) alerts[i].id = static_cast<std::int64_t>(i) + 1;
  const auto message = ToMessage(ScanLabel{}, AlertsTold{.alerts = alerts}, {}, bus::kMaxMessageBytes);
  EXPECT_LE(message.getEncodedSize(), bus::kMaxMessageBytes);
  ASSERT_GT(message.num_alerts, 100);
  EXPECT_LT(message.num_alerts, 2000);
  EXPECT_EQ(message.alerts[0].id, 1);
}

// A row of TRACKS, or none: who looks the track up finds it.
TEST(AlertsMessage, NamesOnlyTracksThatThereAre) {
  std::vector<Alert> alerts(3);
  for (std::size_t i = 0; i < alerts.size(); ++i) {
    alerts[i].id = static_cast<std::int64_t>(i) + 1;
    alerts[i].thing = alerts[i].nearest_track = static_cast<std::int64_t>(i) + 5;
    alerts[i].kind = TrackKind::kBoat;
  }
  Picture picture;
  picture.tracks.resize(2);
  picture.tracks[0].id = 5;
  picture.tracks[0].status = TrackStatus::kConfirmed;
  picture.tracks[1].id = 6;
  picture.tracks[1].status = TrackStatus::kLost;
  const auto message = ToMessage(ScanLabel{}, AlertsTold{.alerts = alerts}, picture, bus::kMaxMessageBytes);
  ASSERT_EQ(message.num_alerts, 3);
  EXPECT_EQ(message.alerts[0].track_id, 5);
  EXPECT_EQ(message.alerts[1].track_id, 0);
  EXPECT_EQ(message.alerts[2].track_id, 0);
  EXPECT_EQ(message.alerts[2].name, "boat 7");
}

TEST(AlertsMessage, SaysWhereOnTheEarthAThingIs) {
  ScanLabel label;
  label.datum = {43.7, -72.3, 100.0};
  Alert alert;
  alert.id = 1;
  EXPECT_TRUE(std::isnan(ToMessage(alert, label.datum.Map()).latitude_deg));
  alert.place_map_m = {0.0, 100.0};
  EXPECT_NEAR(ToMessage(alert, label.datum.Map()).latitude_deg, 43.7009, 1e-4);
  EXPECT_NEAR(ToMessage(alert, label.datum.Map()).longitude_deg, -72.3, 1e-9);
}

TEST(OrdersMessage, GoesBackToTheOrderItCameFrom) {
  order_t message{};
  message.utime_us = 5;
  message.seq = 6;
  message.source = "page";
  message.kind = order_t::KIND_SETTINGS;
  message.mode = order_t::MODE_HARBOUR;
  message.guard_zone_range_m = 12.5F;
  message.guard_zone_from_rad = message.guard_zone_to_rad = std::numeric_limits<float>::quiet_NaN();
  message.cpa_limit_m = 3.1F;
  const auto again = ToMessage(ToOrder(message));
  EXPECT_EQ(std::tie(again.utime_us, again.seq, again.source, again.kind, again.mode, again.guard_zone_range_m, again.cpa_limit_m),
            std::tie(message.utime_us, message.seq, message.source, message.kind, message.mode, message.guard_zone_range_m, message.cpa_limit_m));
  EXPECT_TRUE(std::isnan(again.guard_zone_from_rad));
}

TEST(OrdersMessage, HoldsAName) {
  order_t message{};
  message.kind = order_t::KIND_NAME;
  message.track_id = 7;
  message.name = "Kiosk pier";
  const auto again = ToMessage(ToOrder(message));
  EXPECT_EQ(std::tie(again.kind, again.track_id, again.name), std::tie(message.kind, message.track_id, message.name));
}

TEST(AlertText, SaysTheNameThatPeopleGave) {
  Alert alert;
  alert.thing = 17;
  alert.kind = TrackKind::kStructure;
  alert.name = "Kiosk pier";
  alert.is_in_zone = true;
  alert.distance_m = 7.31;
  EXPECT_EQ(TextOf(alert), "Kiosk pier in the guard zone: 7.3 m");
  EXPECT_EQ(NameOf(alert), "Kiosk pier");
}

TEST(AlertText, SaysWhoHowNearAndFromWhere) {
  Alert alert;
  alert.cause = AlertCause::kClosestApproach;
  alert.comes_near = true;
  alert.thing = 17;
  alert.kind = TrackKind::kBoat;
  alert.distance_m = 7.31;
  alert.cpa_m = 3.2;
  alert.tcpa_s = 20.6;
  alert.bearing_rad = DegToRad(40.0);
  EXPECT_EQ(TextOf(alert), "boat 17: closest approach 3 m in 21 s, 40 deg to starboard");
  alert.is_in_zone = true;
  EXPECT_EQ(TextOf(alert), "boat 17 in the guard zone: 7.3 m, 40 deg to starboard; passes at 3 m in 21 s");
  alert.tells_way = true;
  EXPECT_EQ(TextOf(alert), "boat 17: closest approach 3 m in 21 s, 40 deg to starboard");
  alert.tells_way = false;
  alert.sight = AlertSight::kJustSeen;
  alert.comes_near = false;
  EXPECT_EQ(TextOf(alert), "boat 17 in the guard zone: 7.3 m, 40 deg to starboard (just seen)");
  alert.sight = AlertSight::kLost;
  EXPECT_EQ(TextOf(alert), "boat 17 is not seen any more: last 7.3 m from here, 40 deg to starboard");
  alert.state = AlertState::kCleared;
  alert.end = AlertEnd::kPassed;
  EXPECT_EQ(TextOf(alert), "boat 17 has passed");
  alert = {};
  alert.is_in_zone = true;
  alert.distance_m = 7.31;
  alert.bearing_rad = DegToRad(348.0);
  EXPECT_EQ(TextOf(alert), "land in the guard zone: 7.3 m, 12 deg to port");
  alert.thing = kUnnamed;
  EXPECT_EQ(TextOf(alert), "obstacle in the guard zone: 7.3 m, 12 deg to port");
  EXPECT_EQ(ToMessage(alert, std::nullopt).track_id, 0);
}

TEST(AlertText, SumsUpWhatIsMoreThanThree) {
  std::vector<Alert> alerts(5);
  for (std::size_t i = 0; i < alerts.size(); ++i) {
    alerts[i].thing = static_cast<std::int64_t>(i) + 5;
    alerts[i].kind = TrackKind::kBoat;
    alerts[i].distance_m = 19.5 - 4.0 * static_cast<double>(i);
    alerts[i].bearing_rad = DegToRad(12.0);
  }
  EXPECT_EQ(SummaryOf(alerts), "5 things within 20 m, the nearest boat 9, 4 m, 12 deg to starboard");
  alerts[0].state = alerts[1].state = AlertState::kRectified;
  EXPECT_EQ(SummaryOf(alerts), "");
}

}  // namespace
}  // namespace lookout::tracker
