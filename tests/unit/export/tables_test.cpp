#include <gtest/gtest.h>
#include <limits>

#include "common/core/angles.hpp"
#include "lookout/ais_t.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/unit/export/export_logs.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {
namespace {

using TablesTest = ExportTest;

TEST(TableHeader, IsTheContractWithScriptsOutside) {
  EXPECT_EQ(TableHeader("returns"),
            "scan_utime_us,utime_us,ring,return_index,azimuth_deg,range_m,x_m,y_m,z_m,reflectivity,label,reason,track_id,piece");
  EXPECT_EQ(TableHeader("segments"),
            "scan_utime_us,segment_id,utime_us,num_points,x_m,y_m,z_m,nearest_m,length_m,width_m,height_m,confidence,grounds,kind,seen_share,"
            "thing_probability,land_probability");
  EXPECT_EQ(TableHeader("obstacles"),
            "scan_utime_us,utime_us,obstacle_id,latitude_deg,longitude_deg,top_above_water_m,east_m,north_m,cov_ee_m2,cov_en_m2,cov_nn_m2,length_m,"
            "width_m,num_points,status,confidence,kind,thing_probability,range_m,bearing_deg,height_m,outline_wkt");
  EXPECT_TRUE(TableHeader("tracks").starts_with("utime_us,track_id,latitude_deg,longitude_deg,speed_mps,course_deg,cpa_m,tcpa_s,status,kind,"));
  EXPECT_EQ(TableHeader("alerts"),
            "utime_us,alert_id,cause,level,state,track_id,raised_utime_us,changed_utime_us,distance_m,bearing_deg,cpa_m,tcpa_s,cpa_probability,text,"
            "name,in_zone,comes_near,time_left_s,latitude_deg,longitude_deg,sight,seen_utime_us,end,sounds");
  EXPECT_EQ(TableHeader("pose"),
            "utime_us,latitude_deg,longitude_deg,ellipsoid_height_m,heading_deg,roll_deg,pitch_deg,speed_mps,course_deg,status,velocity_east_mps,"
            "velocity_north_mps,velocity_up_mps,cov_ee_m2,cov_en_m2,cov_nn_m2,cov_uu_m2,velocity_cov_ee_m2ps2,velocity_cov_en_m2ps2,"
            "velocity_cov_nn_m2ps2,velocity_cov_uu_m2ps2,roll_var_rad2,pitch_var_rad2,heading_var_rad2,heading_source");
}

TEST_F(TablesTest, ReturnsComeByColumnThenRingWithTheTimeOfTheirLaser) {
  const auto scan = MakeScan(0);
  auto segments = MakeSegments(scan, 3);
  segments.label = {3, -segments_t::REASON_OWN_VESSEL, -segments_t::REASON_TOO_SMALL, 1};
  Add(bus::kLidarScan, scan);
  Add(bus::kSegments, segments);
  ASSERT_EQ(Export("returns"), kExitFine) << errors_;
  EXPECT_EQ(text_,
            "scan_utime_us,utime_us,ring,return_index,azimuth_deg,range_m,x_m,y_m,z_m,reflectivity,label,reason,track_id,piece\n"
            "1700000000000000,1700000000000000,0,0,0.0000,10.000,9.6593,0.0000,-2.5882,7,3,,,3\n"
            "1700000000000000,1700000000000002,1,0,0.0000,10.000,10.0000,0.0000,0.0000,7,0,own_vessel,,0\n"
            "1700000000000000,1700000000000055,0,0,90.0000,10.000,0.0000,-9.6593,-2.5882,7,0,too_small,,0\n"
            "1700000000000000,1700000000000058,1,0,90.0000,10.000,0.0000,-10.0000,0.0000,7,1,,,1\n");
  EXPECT_EQ(errors_, "");
}

// Land has the id 0, by what is remembered.
TEST_F(TablesTest, ReturnsNameTheTrackOfTheirSegment) {
  for (int seq = 0; seq < 2; ++seq) {
    const auto scan = MakeScan(seq);
    auto segments = MakeSegments(scan);
    segments.label = {1, 2, 3, 0};
    Add(bus::kLidarScan, scan);
    Add(bus::kSegments, segments);
    tracks_t tracks{};
    tracks.utime_us = scan.utime_us;
    tracks.seq = seq;
    tracks.num_parts = 1;
    tracks.num_tracks = 1;
    tracks.tracks.resize(1);
    tracks.tracks[0].id = 17;
    tracks.tracks[0].num_segments = 1;
    tracks.tracks[0].segment_ids = {2};
    tracks.num_land_segments = 1;
    tracks.land_segment_ids = {3};
    Add(bus::kTracks, tracks);
  }
  ASSERT_EQ(Export("returns"), kExitFine) << errors_;
  ASSERT_EQ(Rows().size(), 8U);
  for (const std::size_t first : {0U, 4U}) {
    EXPECT_TRUE(Rows()[first].ends_with(",7,1,,,1")) << Rows()[first];
    EXPECT_TRUE(Rows()[first + 1].ends_with(",7,2,,17,2")) << Rows()[first + 1];
    EXPECT_TRUE(Rows()[first + 2].ends_with(",7,3,,0,3")) << Rows()[first + 2];
    EXPECT_TRUE(Rows()[first + 3].ends_with(",7,0,,,0")) << Rows()[first + 3];
  }
}

// Segment 1 is of three pieces: land, track 17 and one that nothing follows; segment 2 is of one, which has a number that TRACKS do not have.
TEST_F(TablesTest, ReturnsNameTheTrackOfTheirPiece) {
  const auto scan = MakeScan(0);
  auto segments = MakeSegments(scan);
  segments.label = {1, 1, 1, 2};
  segments.piece = {3, 1, 6, 2};
  segments.num_labelled = 4;
  Add(bus::kLidarScan, scan);
  Add(bus::kSegments, segments);
  tracks_t tracks{};
  tracks.utime_us = scan.utime_us;
  tracks.num_parts = 2;
  tracks.num_tracks = 1;
  tracks.tracks.resize(1);
  tracks.tracks[0].id = 17;
  tracks.tracks[0].num_segments = 2;
  tracks.tracks[0].segment_ids = {1, 2};
  tracks.first_piece = 1;
  tracks.track_of_piece = {17, -40};
  tracks.num_pieces = 2;
  Add(bus::kTracks, tracks);
  tracks.part_index = 1;
  tracks.num_tracks = 0;
  tracks.tracks.clear();
  tracks.first_piece = 3;
  tracks.track_of_piece = {0, 5, tracks_t::PIECE_NO_TRACK};
  tracks.num_pieces = 3;
  Add(bus::kTracks, tracks);
  ASSERT_EQ(Export("returns"), kExitFine) << errors_;
  ASSERT_EQ(Rows().size(), 4U);
  EXPECT_TRUE(Rows()[0].ends_with(",7,1,,0,3")) << Rows()[0];
  EXPECT_TRUE(Rows()[1].ends_with(",7,1,,17,1")) << Rows()[1];
  EXPECT_TRUE(Rows()[2].ends_with(",7,1,,,6")) << "beyond the last slice: " << Rows()[2];
  EXPECT_TRUE(Rows()[3].ends_with(",7,2,,-40,2")) << Rows()[3];
}

// Nothing is followed: that is said of pieces too, and the ids of segments do not count.
TEST_F(TablesTest, ReturnsOfPiecesThatNothingFollowsHaveNoTrack) {
  const auto scan = MakeScan(0);
  Add(bus::kLidarScan, scan);
  Add(bus::kSegments, MakeSegments(scan));
  tracks_t tracks{};
  tracks.utime_us = scan.utime_us;
  tracks.num_parts = 1;
  tracks.num_land_segments = 1;
  tracks.land_segment_ids = {1};
  tracks.first_piece = tracks.num_pieces = 1;
  tracks.track_of_piece = {tracks_t::PIECE_NO_TRACK};
  Add(bus::kTracks, tracks);
  ASSERT_EQ(Export("returns"), kExitFine) << errors_;
  for (const auto& row : Rows()) EXPECT_TRUE(row.ends_with(",7,1,,,1")) << row;
}

TEST_F(TablesTest, TracksHaveARowForEachTrackAndScan) {
  tracks_t message{};
  message.utime_us = kStartUs;
  message.end_utime_us = kStartUs + 99'999;
  message.num_parts = 1;
  message.num_tracks = 2;
  message.tracks.resize(2);
  auto& track = message.tracks[0];
  track.id = 17;
  track.status = track_t::STATUS_CONFIRMED;
  track.kind = track_t::KIND_BOAT;
  track.latitude_deg = 43.7;
  track.longitude_deg = -72.3;
  track.speed_mps = 2.0F;
  track.course_rad = static_cast<float>(kPi / 2.0);
  track.cpa_m = 3.5F;
  track.tcpa_s = 21.0F;
  track.encounter = track_t::ENCOUNTER_HEAD_ON;
  message.tracks[1].id = 18;
  message.tracks[1].status = track_t::STATUS_LOST;
  message.tracks[1].course_rad = std::numeric_limits<float>::quiet_NaN();
  Add(bus::kTracks, message);
  ASSERT_EQ(Export("tracks"), kExitFine) << errors_;
  ASSERT_EQ(Rows().size(), 2U);
  EXPECT_TRUE(Rows()[0].starts_with("1700000000099999,17,43.700000000,-72.300000000,2.0000,90.0000,3.5000,21.00,confirmed,boat,1700000000000000,"))
      << Rows()[0];
  EXPECT_NE(Rows()[0].find(",head_on,"), std::string::npos);
  EXPECT_TRUE(Rows()[1].starts_with("1700000000099999,18,0.000000000,0.000000000,0.0000,,0.0000,0.00,lost,obstacle,")) << Rows()[1];
}

TEST_F(TablesTest, AisHasARowForEachShip) {
  ais_t message{};
  message.utime_us = message.end_utime_us = kStartUs;
  message.scan_seq = 5;
  message.num_ships = 1;
  auto& ship = message.ships.emplace_back();
  ship = {};
  ship.mmsi = 211000001;
  ship.name = "=EVE, REST";
  ship.state = ais_ship_t::STATE_TRACKED;
  ship.sender = ais_ship_t::SENDER_CLASS_B;
  ship.track_id = 17;
  ship.track_probability = 0.995F;
  ship.latitude_deg = 43.7;
  ship.longitude_deg = -72.3;
  ship.heading_rad = std::numeric_limits<float>::quiet_NaN();
  ship.navigational_status = -1;
  Add(bus::kAis, message);
  ASSERT_EQ(Export("ais"), kExitFine) << errors_;
  ASSERT_EQ(Rows().size(), 1U);
  EXPECT_EQ(Rows()[0],
            "1700000000000000,211000001,\"'=EVE, REST\",,tracked,17,0.9950,class_b,0,43.700000000,-72.300000000,0.0000,0.0000,0,0,0,0.0000,0.0000,"
            "0.0000,0.0000,,,0.0000,0.0000,0.0000,0.0000,0,0,0,0,0,0,5");
}

TEST_F(TablesTest, AlertsHaveTheirWordsAndTheirText) {
  alerts_t message{};
  message.end_utime_us = kStartUs;
  message.num_alerts = 1;
  message.alerts.resize(1);
  alert_t& alert = message.alerts[0];
  alert.id = 3;
  alert.cause = alert_t::CAUSE_CLOSEST_APPROACH;
  alert.comes_near = 1;
  alert.level = alert_t::LEVEL_WARNING;
  alert.state = alert_t::STATE_ACTIVE;
  alert.track_id = 17;
  alert.name = "boat 17";
  alert.raised_utime_us = kStartUs - 5;
  alert.changed_utime_us = kStartUs - 4;
  alert.distance_m = 20.0F;
  alert.cpa_m = 3.0F;
  alert.tcpa_s = 21.0F;
  alert.cpa_probability = 0.75F;
  alert.time_left_s = 17.5F;
  alert.latitude_deg = 43.7;
  alert.longitude_deg = -72.3;
  alert.sight = alert_t::SIGHT_JUST_SEEN;
  alert.seen_utime_us = kStartUs - 1;
  alert.text = "boat 17: closest approach 3 m in 21 s, 0 deg to starboard";
  message.sounding_alert_id = 3;
  Add(bus::kAlerts, message);
  ASSERT_EQ(Export("alerts"), kExitFine) << errors_;
  ASSERT_EQ(Rows().size(), 1U);
  EXPECT_EQ(
      Rows()[0],
      "1700000000000000,3,closest_approach,warning,active,17,1699999999999995,1699999999999996,20.0000,0.0000,3.0000,21.00,0.7500,"
      "\"boat 17: closest approach 3 m in 21 s, 0 deg to starboard\",boat 17,0,1,17.50,43.700000000,-72.300000000,just_seen,1699999999999999,,1");
}

TEST_F(TablesTest, ReturnsOfALogWithoutSegmentsHaveNeitherLabelNorReason) {
  Add(bus::kLidarScan, MakeScan(0, 1));
  ASSERT_EQ(Export("returns"), kExitFine);
  ASSERT_EQ(Rows().size(), 2U);
  EXPECT_EQ(Rows()[0], "1700000000000000,1700000000000000,0,0,0.0000,10.000,9.6593,0.0000,-2.5882,7,,,,");
}

TEST_F(TablesTest, CellsWithoutReturnHaveNoRow) {
  auto scan = MakeScan(0);
  scan.range = {0, 1, 0, 0};
  scan.reflectivity = {0, 0, 0, 0};
  Add(bus::kLidarScan, scan);
  ASSERT_EQ(Export("returns"), kExitFine);
  ASSERT_EQ(Rows().size(), 1U);
  EXPECT_EQ(Rows()[0], "1700000000000000,1700000000000002,1,0,0.0000,0.002,0.0020,0.0000,0.0000,0,,,,");
}

TEST_F(TablesTest, RangeIsAnUnsignedCountPrintedToTheLastMillimetre) {
  // The wire holds it as int16: 65535 x 2 mm is -1 there.
  for (const int count : {1, 499, 32'767, 32'768, 65'535}) {
    auto scan = MakeScan(count, 1);
    scan.range = {static_cast<std::int16_t>(count), 0};
    Add(bus::kLidarScan, scan);
  }
  ASSERT_EQ(Export("returns"), kExitFine);
  std::string ranges;
  for (const auto& row : Rows()) {
    std::size_t cell = 0;
    for (int i = 0; i < 5; ++i) cell = row.find(',', cell) + 1;
    ranges += row.substr(cell, row.find(',', cell) - cell) + " ";
  }
  EXPECT_EQ(ranges, "0.002 0.998 65.534 65.536 131.070 ");
}

TEST_F(TablesTest, ReturnsKnowBothReturnsOfAFiringAzimuthOffsetsAndOrigins) {
  auto scan = MakeScan(0, 1);
  scan.num_returns = 2;
  scan.return_kind = {lidar_scan_t::RETURN_LAST, lidar_scan_t::RETURN_STRONGEST};
  scan.num_cells = 4;
  scan.range = {0, 0, 1000, 500};
  scan.reflectivity = {0, 0, 1, 255};
  scan.azimuth_offset_rad[1] = static_cast<float>(-kPi / 2.0);  // wraps below north
  scan.origin_height_m[1] = 0.5F;
  scan.time_ns[0] = -3000;  // before the first firing: rounding goes to the nearest there too
  scan.time_offset_ns[1] = 499;
  Add(bus::kLidarScan, scan);
  ASSERT_EQ(Export("returns"), kExitFine);
  ASSERT_EQ(Rows().size(), 2U);
  EXPECT_EQ(Rows()[0], "1700000000000000,1699999999999997,1,0,270.0000,2.000,0.0000,2.0000,0.5000,1,,,,");
  EXPECT_EQ(Rows()[1], "1700000000000000,1699999999999997,1,1,270.0000,1.000,0.0000,1.0000,0.5000,255,,,,");
}

TEST_F(TablesTest, ReturnsOfAPartAreLabelledByThatPart) {
  auto first = MakeScan(0, 1, 0);
  auto second = MakeScan(0, 1, 1);
  first.num_parts = second.num_parts = 2;
  second.part_index = 1;
  Add(bus::kLidarScan, first);
  Add(bus::kLidarScan, second);
  Add(bus::kSegments, MakeSegments(first, 1));
  Add(bus::kSegments, MakeSegments(second, 2));
  ASSERT_EQ(Export("returns"), kExitFine);
  ASSERT_EQ(Rows().size(), 4U);
  EXPECT_TRUE(Rows()[1].ends_with(",7,1,,,1"));
  EXPECT_TRUE(Rows()[2].ends_with(",7,2,,,2"));
}

TEST_F(TablesTest, SegmentsHaveTheirNearestDistanceAndHeight) {
  auto segments = MakeSegments(MakeScan(0));
  segments.segments = {MakeSegment(1, 4.0F), MakeSegment(2, 6.0F)};
  segments.num_segments = 2;
  segments.segments[1].nearest_m[1] = 8.0F;
  segments.segments[1].thing_probability = segments.segments[1].land_probability = std::numeric_limits<float>::quiet_NaN();
  Add(bus::kSegments, segments);
  ASSERT_EQ(Export("segments"), kExitFine);
  ASSERT_EQ(Rows().size(), 2U);
  EXPECT_EQ(Rows()[0],
            "1700000000000000,1,1700000000000005,12,4.5000,-1.2500,0.1250,4.0000,2.5000,1.0000,1.5000,sure,,obstacle,0.7500,0.9375,0.0625");
  EXPECT_EQ(Rows()[1], "1700000000000000,2,1700000000000005,12,6.5000,-1.2500,0.1250,10.0000,2.5000,1.0000,1.5000,sure,,obstacle,0.7500,,");
}

TEST_F(TablesTest, SegmentsSayTheirConfidenceGroundsAndKindInWords) {
  auto segments = MakeSegments(MakeScan(0));
  const auto add = [&segments](int confidence, int grounds, int kind, float seen_share) {
    auto segment = MakeSegment(static_cast<int>(segments.segments.size()) + 1, 4.0F);
    segment.confidence = confidence;
    segment.grounds = grounds;
    segment.kind = kind;
    segment.seen_share = seen_share;
    segments.segments.push_back(segment);
  };
  add(segment_t::CONFIDENCE_TENTATIVE, segment_t::GROUND_FEW_RETURNS, segment_t::KIND_OBSTACLE, 1.0F);
  add(segment_t::CONFIDENCE_TENTATIVE, 1 + 2 + 4, segment_t::KIND_OBSTACLE, 0.0F);
  add(segment_t::CONFIDENCE_SURE, 0, segment_t::KIND_LAND, 0.33333F);
  add(9, 4 + 8, 9, std::numeric_limits<float>::quiet_NaN());  // of a later version
  segments.num_segments = 4;
  Add(bus::kSegments, segments);
  ASSERT_EQ(Export("segments"), kExitFine);
  ASSERT_EQ(Rows().size(), 4U);
  EXPECT_TRUE(Rows()[0].ends_with(",1.5000,tentative,few_returns,obstacle,1.0000,0.9375,0.0625")) << Rows()[0];
  EXPECT_TRUE(Rows()[1].ends_with(",1.5000,tentative,few_returns+scattered+at_surface,obstacle,0.0000,0.9375,0.0625")) << Rows()[1];
  EXPECT_TRUE(Rows()[2].ends_with(",1.5000,sure,,land,0.3333,0.9375,0.0625")) << Rows()[2];
  EXPECT_TRUE(Rows()[3].ends_with(",1.5000,undefined,at_surface+undefined,undefined,,0.9375,0.0625")) << Rows()[3];
}

TEST_F(TablesTest, ATurnWithoutSegmentsIsAHeaderWithoutRows) {
  Add(bus::kSegments, MakeSegments(MakeScan(0)));
  EXPECT_EQ(Export("segments"), kExitFine);
  EXPECT_EQ(Rows().size(), 0U);
  EXPECT_EQ(text_, std::string(TableHeader("segments")) + "\n");
}

TEST_F(TablesTest, ObstaclesLeaveEmptyWhatIsNotKnown) {
  obstacles_t message{};
  message.utime_us = kStartUs;
  message.num_obstacles = 2;
  obstacle_t placed{};
  placed.utime_us = kStartUs + 40;
  placed.id = 7;
  placed.latitude_deg = 43.7022;
  placed.longitude_deg = -72.2895;
  placed.position_map_m[0] = -12.5;
  placed.position_map_m[1] = 30.25;
  placed.covariance_m2[0] = 0.04;
  placed.covariance_m2[1] = -0.001;
  placed.covariance_m2[2] = 1e-7;
  placed.top_above_water_m = 2.125;
  placed.length_m = 3.5F;
  placed.width_m = 1.5F;
  placed.num_points = 42;
  placed.confidence = obstacle_t::CONFIDENCE_SURE;
  placed.kind = obstacle_t::KIND_LAND;
  placed.thing_probability = 0.375F;
  placed.range_m = 31.5F;
  placed.bearing_rad = static_cast<float>(kPi / 4.0);
  placed.height_m = 1.25F;
  obstacle_t unplaced = placed;
  unplaced.status = obstacle_t::STATUS_VESSEL_FRAME_ONLY;
  unplaced.confidence = obstacle_t::CONFIDENCE_TENTATIVE;
  unplaced.kind = obstacle_t::KIND_OBSTACLE;
  unplaced.thing_probability = std::numeric_limits<float>::quiet_NaN();
  for (double* value : {&unplaced.latitude_deg, &unplaced.longitude_deg, &unplaced.top_above_water_m, &unplaced.position_map_m[0],
                        &unplaced.position_map_m[1], &unplaced.covariance_m2[0], &unplaced.covariance_m2[1], &unplaced.covariance_m2[2]}) {
    *value = kNaN;
  }
  message.obstacles = {placed, unplaced};
  Add(bus::kObstacles, message);
  ASSERT_EQ(Export("obstacles"), kExitFine);
  ASSERT_EQ(Rows().size(), 2U);
  EXPECT_EQ(Rows()[0],
            "1700000000000000,1700000000000040,7,43.702200000,-72.289500000,2.1250,-12.5000,30.2500,0.04,-0.001,0.0000001,3.5000,1.5000,42,ok,sure,"
            "land,0.3750,31.5000,45.0000,1.2500,");
  EXPECT_EQ(Rows()[1], "1700000000000000,1700000000000040,7,,,,,,,,,3.5000,1.5000,42,vessel_frame_only,tentative,obstacle,,31.5000,45.0000,1.2500,");
}

}  // namespace
}  // namespace lookout::exporter
