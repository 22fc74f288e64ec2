// Maps out of little logs: what stands in them, in each format.
#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "common/core/angles.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/export/export_logs.hpp"
#include "tools/export/waterline.hpp"

namespace lookout::exporter {
namespace {

std::size_t Count(std::string_view text, std::string_view word) {
  std::size_t number = 0;
  for (auto at = text.find(word); at != std::string_view::npos; at = text.find(word, at + word.size())) ++number;
  return number;
}

// A square of two metres, `east_m` from a datum at 0 N 180 E.
obstacle_t MakeObstacle(int id, float east_m) {
  obstacle_t obstacle{};
  obstacle.utime_us = kStartUs + 40'000;
  obstacle.id = id;
  obstacle.confidence = obstacle_t::CONFIDENCE_SURE;
  obstacle.thing_probability = 0.75F;
  obstacle.longitude_deg = WrapToPi(DegToRad(180.0 + east_m / 111'319.49)) * 180.0 / kPi;
  obstacle.position_map_m[0] = east_m;
  obstacle.covariance_m2[0] = obstacle.covariance_m2[2] = 0.04;
  obstacle.range_m = 12.5F;
  obstacle.num_points = 9;
  obstacle.num_footprint = obstacle.num_map = 4;
  obstacle.footprint_vessel_x_m = obstacle.footprint_vessel_y_m = {0.0F, 0.0F, 0.0F, 0.0F};
  obstacle.footprint_east_m = {east_m - 1.0F, east_m + 1.0F, east_m + 1.0F, east_m - 1.0F};
  obstacle.footprint_north_m = {-1.0F, -1.0F, 1.0F, 1.0F};
  return obstacle;
}

obstacles_t MakeObstacles(std::int64_t seq, const std::vector<obstacle_t>& obstacles) {
  auto message = support::OfScan<obstacles_t>(kStartUs + 100'000 * seq, seq, 99'999);
  message.datum_longitude_deg = 180.0;
  support::Fill(message, obstacles);
  return message;
}

class ObstacleMapTest : public ExportTest {
 protected:
  Request MakeRequest(const std::string& format) {
    return {.inputs = {log_}, .table = "obstacles", .format = format, .output = folder_ / "out", .force = true};
  }
};

TEST_F(ObstacleMapTest, HasAPointAnOutlineAndAnEllipseOfEach) {
  Add(bus::kObstacles, MakeObstacles(0, {MakeObstacle(1, -50.0F)}));
  ASSERT_EQ(Export(MakeRequest("geojson")), kExitFine) << errors_;
  EXPECT_TRUE(text_.starts_with(
      "{\"type\":\"FeatureCollection\",\"features\":[\n"
      "{\"type\":\"Feature\",\"properties\":{\"what\":\"obstacle\",\"name\":\"obstacle 1\",\"time\":\"2023-11-14T22:13:20.000000Z\","
      "\"end_time\":\"2023-11-14T22:13:20.099999Z\",\"scan_seq\":0,\"scan_utime_us\":1700000000000000,\"utime_us\":1700000000040000,"
      "\"obstacle_id\":1,\"confidence\":\"sure\",\"kind\":\"obstacle\",\"thing_probability\":0.7500,\"range_m\":12.50,"))
      << text_;
  EXPECT_NE(text_.find("\"geometry\":{\"type\":\"Point\",\"coordinates\":[179.999550842,0.000000000]}}"), std::string::npos) << text_;
  EXPECT_EQ(Count(text_, "\"what\":\"outline\""), 1U);
  EXPECT_NE(text_.find("{\"type\":\"Polygon\",\"coordinates\":[[[179.999541859,-0.000009044],[179.999559826,-0.000009044],"
                       "[179.999559826,0.000009044],[179.999541859,0.000009044],[179.999541859,-0.000009044]]]}"),
            std::string::npos)
      << text_;
  EXPECT_EQ(Count(text_, "\"what\":\"ellipse\""), 1U);
  EXPECT_TRUE(text_.ends_with("}\n]}\n"));
}

TEST_F(ObstacleMapTest, CutsWhatLiesOnTheHundredAndEightiethMeridian) {
  Add(bus::kObstacles, MakeObstacles(0, {MakeObstacle(1, 0.0F)}));
  ASSERT_EQ(Export(MakeRequest("geojson")), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"MultiPolygon\""), 2U) << text_;
  EXPECT_NE(text_.find("[180.000000000,0.000009044]"), std::string::npos) << text_;
  EXPECT_NE(text_.find("[-180.000000000,0.000009044]"), std::string::npos) << text_;
  ASSERT_EQ(Export(MakeRequest("kml")), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "<MultiGeometry><Polygon>"), 2U);
  ASSERT_EQ(Export("obstacles"), kExitFine) << errors_;
  EXPECT_NE(text_.find(",\"MULTIPOLYGON((("), std::string::npos) << text_;
}

TEST_F(ObstacleMapTest, OfLandHasItsWaterline) {
  auto land = MakeObstacle(2, 50.0F);
  land.kind = obstacle_t::KIND_LAND;
  land.num_waterline = land.num_waterline_map = 3;
  land.waterline_vessel_x_m = land.waterline_vessel_y_m = {0.0F, 0.0F, 0.0F};
  land.waterline_east_m = {49.0F, 50.0F, 51.0F};
  land.waterline_north_m = {0.0F, 1.0F, 0.0F};
  Add(bus::kObstacles, MakeObstacles(0, {land}));
  ASSERT_EQ(Export(MakeRequest("geojson")), kExitFine) << errors_;
  EXPECT_NE(text_.find("\"what\":\"waterline\",\"name\":\"land 2\""), std::string::npos) << text_;
  EXPECT_EQ(Count(text_, "\"LineString\""), 1U);
  EXPECT_EQ(Count(text_, "\"what\":\"outline\""), 0U);
  ASSERT_EQ(Export("obstacles"), kExitFine) << errors_;
  EXPECT_NE(text_.find(",\"LINESTRING(-179.999559826 0.000000000,"), std::string::npos) << text_;
}

TEST_F(ObstacleMapTest, IsOfTheWholeLogUnlessAScanIsNamed) {
  for (int seq = 0; seq < 4; ++seq) Add(bus::kObstacles, MakeObstacles(seq, {MakeObstacle(10 + seq, 0.0F), MakeObstacle(20 + seq, 5.0F)}));
  auto request = MakeRequest("geojson");
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"obstacle\""), 8U);
  const auto all = text_;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(text_, all);  // the same log, the same bytes
  request.scan = 2;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"obstacle\""), 2U);
  EXPECT_NE(text_.find("\"obstacle_id\":12,"), std::string::npos);
  request.scan = std::nullopt;
  request.is_last_scan = true;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"obstacle\""), 2U);
  EXPECT_NE(text_.find("\"obstacle_id\":13,"), std::string::npos);
  request.scan = 9;
  EXPECT_EQ(Export(request), kExitFailed);
  EXPECT_NE(errors_.find("holds no scan 9"), std::string::npos) << errors_;
  request = MakeRequest("geojson");
  request.span = {kStartUs + 100'000, kStartUs + 300'000};
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"obstacle\""), 4U);
}

TEST_F(ObstacleMapTest, LeavesOutWhatLiesOutsideTheCircle) {
  Add(bus::kObstacles, MakeObstacles(0, {MakeObstacle(1, 0.0F), MakeObstacle(2, 100.0F)}));
  auto request = MakeRequest("geojson");
  request.near = Circle{{0.0, -180.0, 0.0}, 20.0};
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"obstacle\""), 1U);
  request.near->place.latitude_deg = 1.0;
  EXPECT_EQ(Export(request), kExitFailed);
  EXPECT_NE(errors_.find("no obstacle lies within 20 m of 1, -180"), std::string::npos) << errors_;
}

TEST_F(ObstacleMapTest, SaysHowManyHaveNoPlace) {
  auto lost = MakeObstacle(1, 0.0F);
  lost.status = obstacle_t::STATUS_VESSEL_FRAME_ONLY;
  lost.latitude_deg = lost.longitude_deg = kNaN;
  auto far = MakeObstacle(2, 0.0F);
  far.footprint_east_m[1] = std::numeric_limits<float>::infinity();
  far.covariance_m2[0] = kNaN;
  Add(bus::kObstacles, MakeObstacles(0, {lost, far}));
  ASSERT_EQ(Export(MakeRequest("geojson")), kExitFine) << errors_;
  EXPECT_NE(errors_.find("1 obstacles have no place on the earth"), std::string::npos) << errors_;
  EXPECT_EQ(Count(text_, "\"Feature\""), 1U) << text_;  // a place, but neither outline nor ellipse
}

TEST_F(ObstacleMapTest, RefusesTimesOutOfBounds) {
  auto message = MakeObstacles(0, {MakeObstacle(1, 0.0F)});
  message.end_utime_us = std::numeric_limits<std::int64_t>::max();
  Add(bus::kObstacles, message);
  EXPECT_EQ(Export(MakeRequest("kml")), kExitFailed);
  EXPECT_NE(errors_.find("1 messages of OBSTACLES contradict themselves"), std::string::npos) << errors_;
}

TEST_F(ObstacleMapTest, AsKmlHasTheTimeOfItsScanForTheSlider) {
  Add(bus::kObstacles, MakeObstacles(0, {MakeObstacle(1, -50.0F)}));
  ASSERT_EQ(Export(MakeRequest("kml")), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "<Placemark>"), 3U);
  EXPECT_NE(text_.find("<Placemark><name>obstacle 1</name><TimeSpan><begin>2023-11-14T22:13:20.000000Z</begin><end>2023-11-14T22:13:20.099999Z</end>"
                       "</TimeSpan><styleUrl>#obstacle</styleUrl>"),
            std::string::npos)
      << text_;
  EXPECT_NE(text_.find("<Point><coordinates>179.999550842,0.000000000</coordinates></Point></Placemark>"), std::string::npos) << text_;
  EXPECT_EQ(text_.find("nan"), std::string::npos);
}

TEST_F(ObstacleMapTest, AsGpxHasAWaypointOfEach) {
  Add(bus::kObstacles, MakeObstacles(0, {MakeObstacle(1, -50.0F), MakeObstacle(2, 50.0F)}));
  ASSERT_EQ(Export(MakeRequest("gpx")), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "<wpt "), 2U);
  EXPECT_NE(text_.find("<wpt lat=\"0.000000000\" lon=\"179.999550842\"><time>2023-11-14T22:13:20.099999Z</time><name>obstacle 1</name><desc>"),
            std::string::npos)
      << text_;
  EXPECT_TRUE(text_.ends_with("</wpt>\n</gpx>\n"));
}

class TrackMapTest : public ExportTest {
 protected:
  // The boat goes east at 3 m/s from 60 N 10 E, a second a scan.
  void AddScan(std::int64_t seq, const std::vector<track_t>& tracks, int pose_status = pose_t::STATUS_OK) {
    pose_t pose{};
    pose.utime_us = kStartUs + 1'000'000 * seq;
    pose.status = pose_status;
    pose.latitude_deg = 60.0;
    pose.longitude_deg = 10.0 + 3.0 * static_cast<double>(seq) / 55'800.0;
    Add(bus::kPose, pose);
    tracks_t message{};
    message.utime_us = pose.utime_us;
    message.end_utime_us = pose.utime_us + 99'999;
    message.seq = seq;
    message.num_parts = 1;
    message.datum_latitude_deg = 60.0;
    message.datum_longitude_deg = 10.0;
    message.num_tracks = static_cast<std::int32_t>(tracks.size());
    message.tracks = tracks;
    message.waterline_east_m = waterline_east_m_;
    message.waterline_north_m = waterline_north_m_;
    message.num_waterline = static_cast<std::int32_t>(waterline_east_m_.size());
    Add(bus::kTracks, message);
    alerts_t alerts{};
    alerts.utime_us = message.utime_us;
    alerts.end_utime_us = message.end_utime_us;
    alerts.seq = seq;
    alerts.alerts = alerts_;
    alerts.num_alerts = static_cast<std::int32_t>(alerts_.size());
    Add(bus::kAlerts, alerts);
  }

  static track_t MakeTrack(std::int64_t id, double north_deg, float speed_mps = 0.0F) {
    track_t track{};
    track.id = id;
    track.status = track_t::STATUS_CONFIRMED;
    track.kind = track_t::KIND_BUOY;
    if (speed_mps > 0.0F) track.kind = track_t::KIND_BOAT;
    track.first_utime_us = track.seen_utime_us = kStartUs;
    track.latitude_deg = 60.0 + north_deg;
    track.longitude_deg = 10.0;
    track.position_map_m[1] = 111'412.0 * north_deg;
    track.covariance[0][0] = track.covariance[1][1] = 0.25;
    track.speed_mps = speed_mps;
    track.num_outline = 3;
    track.outline_east_m = {-1.0F, 1.0F, 0.0F};
    const auto north_m = static_cast<float>(track.position_map_m[1]);
    track.outline_north_m = {north_m, north_m, north_m + 2.0F};
    return track;
  }

  std::vector<float> waterline_east_m_;
  std::vector<float> waterline_north_m_;
  std::vector<alert_t> alerts_;
};

TEST_F(TrackMapTest, HoldsTheBoatTheTracksAndTheWayOfWhatMoves) {
  for (int seq = 0; seq < 3; ++seq) AddScan(seq, {MakeTrack(7, 0.001), MakeTrack(8, 0.002 + 1e-5 * seq, 1.1F)});
  ASSERT_EQ(Export("tracks", "geojson"), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"own_track\""), 1U);
  EXPECT_EQ(Count(text_, "\"what\":\"track\""), 2U);
  EXPECT_EQ(Count(text_, "\"what\":\"outline\""), 2U);
  EXPECT_EQ(Count(text_, "\"what\":\"ellipse\""), 2U);
  EXPECT_EQ(Count(text_, "\"what\":\"way\""), 1U);
  EXPECT_NE(text_.find("\"what\":\"way\",\"name\":\"boat 8\",\"time\":\"2023-11-14T22:13:20.099999Z\",\"end_time\":\"2023-11-14T22:13:22.099999Z\","
                       "\"track_id\":8,\"status\":\"confirmed\",\"kind\":\"boat\",\"coordTimes\":[\"2023-11-14T22:13:20.099999Z\","
                       "\"2023-11-14T22:13:21.099999Z\",\"2023-11-14T22:13:22.099999Z\"]},\"geometry\":{\"type\":\"LineString\",\"coordinates\":"
                       "[[10.000000000,60.002000000],[10.000000000,60.002010000],[10.000000000,60.002020000]]}}"),
            std::string::npos)
      << text_;
  EXPECT_NE(text_.find("\"what\":\"track\",\"name\":\"buoy 7\",\"time\":\"2023-11-14T22:13:20.099999Z\""), std::string::npos) << text_;
}

TEST_F(TrackMapTest, GpxHasTheBoatsTrackAndTheWayAsTracksBehindTheWaypoints) {
  for (int seq = 0; seq < 3; ++seq) AddScan(seq, {MakeTrack(7, 0.001), MakeTrack(8, 0.002 + 1e-5 * seq, 1.1F)});
  ASSERT_EQ(Export("tracks", "gpx"), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "<wpt "), 2U);
  EXPECT_EQ(Count(text_, "<trk>"), 2U);
  EXPECT_EQ(Count(text_, "</trk>"), 2U);
  EXPECT_EQ(Count(text_, "<trkpt "), 6U);
  EXPECT_LT(text_.rfind("<wpt "), text_.find("<trk>"));
  EXPECT_NE(text_.find("<trk><name>own track</name><type>own_track</type>\n<trkseg>\n"
                       "<trkpt lat=\"60.000000000\" lon=\"10.000000000\"><time>2023-11-14T22:13:20.000000Z</time></trkpt>\n"),
            std::string::npos)
      << text_;
}

// The fields that a Schema declares, and those that its features have.
void ExpectDeclaredFields(const std::string& kml) {
  std::map<std::string, std::set<std::string>> declared;
  const std::regex schema(R"re(<Schema name="\w+" id="(\w+)">(.*?)</Schema>)re");
  const std::regex field(R"re(<SimpleField type="(int|double|string)" name="(\w+)"/>)re");
  for (std::sregex_iterator one(kml.begin(), kml.end(), schema), end; one != end; ++one) {
    const std::string fields = (*one)[2];
    for (std::sregex_iterator name(fields.begin(), fields.end(), field); name != end; ++name) declared[(*one)[1]].insert((*name)[2]);
  }
  const std::regex data(R"re(<SchemaData schemaUrl="#(\w+)">(.*?)</SchemaData>)re");
  const std::regex value(R"re(<SimpleData name="(\w+)">)re");
  int num_values = 0;
  for (std::sregex_iterator one(kml.begin(), kml.end(), data), end; one != end; ++one) {
    const std::string values = (*one)[2];
    for (std::sregex_iterator name(values.begin(), values.end(), value); name != end; ++name, ++num_values) {
      EXPECT_TRUE(declared[(*one)[1]].contains((*name)[1])) << (*one)[1] << " has no field " << (*name)[1];
    }
  }
  EXPECT_GT(num_values, 0);
  EXPECT_EQ(kml.find("<Data "), std::string::npos);
}

// GIS once read every number of a KML file as text.
TEST_F(ObstacleMapTest, KmlHasTypedFields) {
  auto land = MakeObstacle(2, 50.0F);
  land.kind = obstacle_t::KIND_LAND;
  land.num_waterline = land.num_waterline_map = 2;
  land.waterline_vessel_x_m = land.waterline_vessel_y_m = {0.0F, 0.0F};
  land.waterline_east_m = {49.0F, 50.0F};
  land.waterline_north_m = {0.0F, 1.0F};
  Add(bus::kObstacles, MakeObstacles(0, {MakeObstacle(1, -50.0F), land}));
  ASSERT_EQ(Export(MakeRequest("kml")), kExitFine) << errors_;
  ExpectDeclaredFields(text_);
  EXPECT_NE(text_.find("<SimpleField type=\"double\" name=\"range_m\"/>"), std::string::npos) << text_;
  EXPECT_NE(text_.find("<SimpleField type=\"int\" name=\"obstacle_id\"/>"), std::string::npos) << text_;
}

TEST_F(TrackMapTest, KmlHasTypedFields) {
  for (int seq = 0; seq < 3; ++seq) AddScan(seq, {MakeTrack(8, 0.002 + 1e-5 * seq, 1.1F)});
  ASSERT_EQ(Export("tracks", "kml"), kExitFine) << errors_;
  ExpectDeclaredFields(text_);
}

// Three decimals would make 0.000 of the covariance of a good receiver.
TEST_F(ObstacleMapTest, CovariancesHaveTheDigitsThatTheyHave) {
  auto obstacle = MakeObstacle(1, -50.0F);
  obstacle.covariance_m2[0] = 0.000123456789;
  obstacle.covariance_m2[1] = -2.5e-7;
  obstacle.covariance_m2[2] = 0.25;
  Add(bus::kObstacles, MakeObstacles(0, {obstacle}));
  ASSERT_EQ(Export(MakeRequest("geojson")), kExitFine) << errors_;
  EXPECT_NE(text_.find("\"cov_ee_m2\":0.000123456789,\"cov_en_m2\":-0.00000025,\"cov_nn_m2\":0.25}"), std::string::npos) << text_;
  ASSERT_EQ(Export(MakeRequest("kml")), kExitFine) << errors_;
  EXPECT_NE(text_.find("<SimpleData name=\"cov_ee_m2\">0.000123456789</SimpleData>"), std::string::npos) << text_;
  ASSERT_EQ(Export(MakeRequest("gpx")), kExitFine) << errors_;
  EXPECT_NE(text_.find("cov_ee_m2 0.000123456789, cov_en_m2 -0.00000025, cov_nn_m2 0.25"), std::string::npos) << text_;
}

TEST_F(TrackMapTest, KmlHasAPlaceForEachTime) {
  for (int seq = 0; seq < 3; ++seq) AddScan(seq, {MakeTrack(8, 0.002 + 1e-5 * seq, 1.1F)});
  ASSERT_EQ(Export("tracks", "kml"), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "<gx:Track>"), 2U);
  EXPECT_EQ(Count(text_, "<when>"), 6U);
  EXPECT_EQ(Count(text_, "<gx:coord>"), 6U);
}

TEST_F(TrackMapTest, OwnTrackBreaksWhereThePlaceIsNotKnownAndIsThinnedOut) {
  for (int seq = 0; seq < 3; ++seq) AddScan(seq, {});
  AddScan(3, {}, pose_t::STATUS_NO_POSITION);
  for (int seq = 4; seq < 7; ++seq) AddScan(seq, {}, pose_t::STATUS_COASTING);
  for (int i = 0; i < 20; ++i) {  // stands for 20 s
    pose_t pose{};
    pose.utime_us = kStartUs + 6'000'000 + 1'000'000 * (i + 1);
    pose.status = pose_t::STATUS_COASTING;
    pose.latitude_deg = 60.0;
    pose.longitude_deg = 10.0 + 3.0 * 6.0 / 55'800.0;
    Add(bus::kPose, pose);
  }
  ASSERT_EQ(Export("pose", "gpx"), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "<trk>"), 1U);
  EXPECT_EQ(Count(text_, "<trkseg>"), 2U);
  EXPECT_EQ(Count(text_, "<trkpt "), 3U + 3U + 2U);
  ASSERT_EQ(Export("pose", "geojson"), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"own_track\""), 2U);
  EXPECT_EQ(Count(text_, "\"status\":\"coasting\""), 1U);
}

TEST_F(TrackMapTest, AlertsStandWhereTheBoatWasAndAreEscaped) {
  AddScan(0, {});
  alerts_.resize(1);
  alerts_[0].id = 1;
  alerts_[0].state = alert_t::STATE_ACTIVE;
  alerts_[0].level = alert_t::LEVEL_WARNING;
  alerts_[0].cause = alert_t::CAUSE_GUARD_ZONE;
  alerts_[0].text = "a \"boat\" <17> & \x1b[2J more";
  AddScan(1, {});
  AddScan(2, {});
  ASSERT_EQ(Export("tracks", "geojson"), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"alert\""), 1U);
  EXPECT_NE(text_.find(R"("name":"a \"boat\" <17> & ?[2J more","time":"2023-11-14T22:13:21.099999Z")"), std::string::npos) << text_;
  EXPECT_NE(text_.find("{\"type\":\"Point\",\"coordinates\":[10.000053763,60.000000000]}"), std::string::npos) << text_;
  for (const auto* format : {"kml", "gpx"}) {
    ASSERT_EQ(Export("tracks", format), kExitFine) << errors_;
    EXPECT_NE(text_.find("<name>a &quot;boat&quot; &lt;17&gt; &amp; ?[2J more</name>"), std::string::npos) << text_;
  }
}

TEST_F(TrackMapTest, OfOneScanShowsWhatWasKnownThen) {
  for (int seq = 0; seq < 4; ++seq) {
    std::vector<track_t> tracks{MakeTrack(8, 0.002 + 1e-5 * seq, 1.1F)};
    if (seq < 2) tracks.push_back(MakeTrack(9, 0.003));
    AddScan(seq, tracks);
  }
  Request request{.inputs = {log_}, .table = "tracks", .format = "geojson", .output = folder_ / "out", .force = true, .scan = 1};
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"track\""), 2U);
  EXPECT_EQ(Count(text_, "\"what\":\"way\""), 0U);
  EXPECT_NE(text_.find("[10.000000000,60.002010000]"), std::string::npos) << text_;
  EXPECT_NE(text_.find("\"what\":\"own_place\",\"name\":\"own place\",\"time\":\"2023-11-14T22:13:21.000000Z\""), std::string::npos) << text_;
  request.scan = std::nullopt;
  request.is_last_scan = true;
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"track\""), 1U);
  request.scan = 17;
  EXPECT_EQ(Export(request), kExitFailed);
  EXPECT_NE(errors_.find("holds no scan 17"), std::string::npos) << errors_;
}

TEST_F(TrackMapTest, CircleCutsWaysAndLeavesOutTheRest) {
  for (int seq = 0; seq < 5; ++seq) AddScan(seq, {MakeTrack(8, 0.002 + 1e-4 * seq, 11.0F), MakeTrack(9, 0.01)});
  Request request{.inputs = {log_}, .table = "tracks", .format = "geojson", .output = folder_ / "out", .force = true};
  request.near = Circle{{60.0021, 10.0, 0.0}, 12.0};
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"own_track\""), 0U);
  EXPECT_EQ(Count(text_, "\"what\":\"track\""), 1U);
  EXPECT_NE(text_.find("\"coordinates\":[[10.000000000,60.002000000],[10.000000000,60.002100000],[10.000000000,60.002200000]]}"), std::string::npos)
      << text_;
  request.near->place.longitude_deg = 11.0;
  EXPECT_EQ(Export(request), kExitFailed);
  EXPECT_NE(errors_.find("nothing lies within 12 m"), std::string::npos) << errors_;
}

// A tracker that starts again counts from 1.
TEST_F(TrackMapTest, TwoRunsOfTheTrackerDoNotShareTheirNumbers) {
  for (int run = 0; run < 2; ++run) {
    tracks_t message{};
    message.utime_us = message.end_utime_us = message.begin_utime_us = kStartUs + 1'000'000 * run;
    message.num_tracks = 1;
    message.tracks = {MakeTrack(1, 0.001 * (run + 1))};
    message.datum_latitude_deg = 60.0;
    message.datum_longitude_deg = 10.0;
    Add(bus::kTracks, message);
  }
  ASSERT_EQ(Export("tracks", "geojson"), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"track\""), 2U);
}

TEST_F(TrackMapTest, WaterlineIsALineAlongItsCells) {
  waterline_east_m_ = {1.75F, 0.75F, 1.25F, 20.25F};
  waterline_north_m_ = {0.25F, 0.25F, 0.25F, 5.25F};
  AddScan(0, {});
  ASSERT_EQ(Export("tracks", "geojson"), kExitFine) << errors_;
  EXPECT_EQ(Count(text_, "\"what\":\"waterline\""), 1U);
  EXPECT_NE(text_.find("{\"type\":\"MultiLineString\",\"coordinates\":[[[10.000013"), std::string::npos) << text_;
}

TEST(Waterline, JoinsCellsAlongTheirNeighbours) {
  const GeodeticPlace datum{60.0, 10.0, 0.0};
  const MapOfDatum map(datum);
  Waterline waterline;
  // A staircase, told in disorder and twice.
  const std::vector<Eigen::Vector2d> stairs{{-0.25, -0.25}, {0.75, 0.75}, {0.25, -0.25}, {0.25, 0.25}, {0.75, 0.25}};
  waterline.Add(datum, stairs);
  waterline.Add(datum, stairs);
  auto lines = waterline.Lines(nullptr);
  ASSERT_EQ(lines.size(), 1U);
  const std::vector<MapPlace> expected{map.PlaceAt({-0.25, -0.25}), map.PlaceAt({0.25, -0.25}), map.PlaceAt({0.25, 0.25}), map.PlaceAt({0.75, 0.25}),
                                       map.PlaceAt({0.75, 0.75})};
  EXPECT_EQ(lines[0], expected);
  // A ring closes.
  waterline.Clear();
  std::vector<Eigen::Vector2d> ring;
  for (int i = 0; i < 4; ++i) {
    ring.emplace_back(0.25 + 0.5 * i, 0.25);
    ring.emplace_back(1.75 - 0.5 * i, 1.75);
    ring.emplace_back(1.75, 0.25 + 0.5 * i);
    ring.emplace_back(0.25, 1.75 - 0.5 * i);
  }
  waterline.Add(datum, ring);
  lines = waterline.Lines(nullptr);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].front(), lines[0].back());
  EXPECT_EQ(lines[0].size(), 5U);
  // One that is alone is as long as a cell.
  waterline.Clear();
  waterline.Add(datum, std::vector<Eigen::Vector2d>{{10.25, 0.25}});
  EXPECT_EQ(waterline.Lines(nullptr)[0], (std::vector{map.PlaceAt({10.0, 0.25}), map.PlaceAt({10.5, 0.25})}));
}

}  // namespace
}  // namespace lookout::exporter
