#include "tools/top/screen.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <sstream>

#include "common/core/angles.hpp"
#include "common/core/geodesy.hpp"
#include "common/core/printable.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/unit/top/bus_talk.hpp"
#include "tools/top/format.hpp"

namespace lookout::top {
namespace {

// All channels of a boat without a tracker, five processes and twelve obstacles, after two seconds.
Board BusyBoard() {
  Board board(kStart);
  for (const auto& channel : bus::kChannels) {
    const bool is_of_tracker =
        channel.publisher == "tracker" || channel.publisher == "ais" || channel.publisher == "several" || bus::IsOfSecondLidar(channel);
    if (channel.name != "SIM_TRUTH" && channel.name != "HEALTH" && !is_of_tracker) board.Take(channel.name, {}, At(1.9));
  }
  pose_t pose = PoseAt(1'000'000, DegToRad(90.0));
  pose.heading_source = pose_t::HEADING_HDT;
  pose.latitude_deg = 43.629590;
  pose.longitude_deg = -72.149989;
  pose.datum_latitude_deg = 43.6;
  pose.datum_longitude_deg = -72.1;
  pose.velocity_map_mps[0] = 1.2;
  Say(board, bus::kPose, pose, 1.9);
  gnss_fix_t fix{};
  fix.quality = gnss_fix_t::QUALITY_RTK_FIXED;
  fix.num_satellites = 14;
  Say(board, bus::kGnssFix, fix, 1.9);
  std::vector<obstacle_t> obstacles;
  for (int i = 0; i < 12; ++i) obstacles.push_back(ObstacleAt(i + 1, 4.5F + static_cast<float>(i), static_cast<float>(DegToRad(30.0 * i))));
  obstacles[1].confidence = obstacle_t::CONFIDENCE_TENTATIVE;
  obstacles[2].kind = obstacle_t::KIND_LAND;
  Say(board, bus::kObstacles, TurnOf(1, obstacles), 1.9);
  for (const std::string process : {"lidar", "segmenter", "navigator", "georeferencer", "recorder"}) {
    Say(board, bus::kHealth,
        HealthOf(process, 0, process == "navigator" ? 1 : 0,
                 process == "navigator" ? "no heading: neither HDT nor PASHR for 12 s, course is too slow to tell" : ""),
        1.9);
  }
  return board;
}

Board AlarmedBoard() {
  Board board = BusyBoard();
  alerts_t alerts{};
  for (const auto* text :
       {"boat 17 in the guard zone: 4.5 m, 12 deg to port", "boat 18: closest approach 3 m in 21 s, from where it is hard to see, 120 deg to port"}) {
    alert_t alert{};
    alert.id = 1 + std::ssize(alerts.alerts);
    alert.cause = alert_t::CAUSE_GUARD_ZONE;
    alert.level = alert_t::LEVEL_WARNING;
    if (!alerts.alerts.empty()) alert.level = alert_t::LEVEL_CAUTION;
    alert.state = alert_t::STATE_ACTIVE;
    alert.text = text;
    alerts.alerts.push_back(alert);
  }
  alerts.num_alerts = 2;
  Say(board, bus::kAlerts, alerts, 1.95);
  return board;
}

track_t TrackAt(std::int64_t id, float range_m, std::int32_t status = track_t::STATUS_CONFIRMED) {
  track_t track{};
  track.id = id;
  track.status = status;
  track.kind = track_t::KIND_BOAT;
  track.range_m = range_m;
  track.bearing_rad = static_cast<float>(DegToRad(40.0));
  track.course_rad = static_cast<float>(DegToRad(270.0));
  track.speed_mps = 2.5F;
  track.cpa_m = 3.0F;
  track.tcpa_s = 21.0F;
  track.num_seen = 14;
  track.num_looks = 15;
  return track;
}

// The same boat with a tracker.
Board TrackedBoard(const std::vector<track_t>& tracks, double second = 1.95) {
  Board board = BusyBoard();
  tracks_t message{};
  message.num_parts = 1;
  message.tracks = tracks;
  message.num_tracks = static_cast<std::int32_t>(tracks.size());
  Say(board, bus::kTracks, message, second);
  alerts_t alerts{};
  for (const bool is_active : {true, false}) {
    alert_t alert{};
    alert.id = 1 + std::ssize(alerts.alerts);
    alert.track_id = 17;
    alert.level = alert_t::LEVEL_WARNING;
    alert.state = alert_t::STATE_ACTIVE;
    if (!is_active) {
      alert.track_id = 9;
      alert.level = alert_t::LEVEL_CAUTION;
      alert.state = alert_t::STATE_ACKNOWLEDGED;
    }
    alert.text = "boat " + std::to_string(alert.track_id) + ": closest approach 3 m in 21 s";
    alerts.alerts.push_back(alert);
  }
  alerts.num_alerts = 2;
  Say(board, bus::kAlerts, alerts, second);
  return board;
}

std::vector<std::string> Lines(const std::vector<Row>& rows) {
  std::vector<std::string> lines;
  std::istringstream text(PlainText(rows));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

bool Has(const std::vector<std::string>& lines, const std::string& piece) {
  return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(piece) != std::string::npos; });
}

TEST(Screen, ShowsEightObstaclesWithAllNumbersOnEightyByTwentyFour) {
  const auto rows = DrawScreen(BusyBoard(), "title", At(2.0), {80, 24});
  const auto lines = Lines(rows);
  ASSERT_EQ(lines.size(), 24U);
  EXPECT_EQ(lines[0], "own 43.629590 -72.149989  heading 090 hdt  1.2 m/s  pose ok  fix rtk_fixed");
  EXPECT_EQ(lines[1], "channel           Hz   kB/s lost bad  age process       state    cpu%   MB p99ms");
  EXPECT_EQ(lines[15], "of 12  id range m  rel true    latitude    longitude  size m        confidence");
  EXPECT_EQ(lines[16], "  1     1     4.5  000  090   43.500000   -72.250000  6.0x2.5x1.5   sure");
  EXPECT_EQ(lines[17], "  2     2     5.5  030  120   43.500000   -72.250000  6.0x2.5x1.5   tentative");
  EXPECT_EQ(lines[18], "  3     3     6.5  060  150   43.500000   -72.250000  6.0x2.5x1.5   land");
  EXPECT_EQ(lines[23], "  8     8    11.5  210  300   43.500000   -72.250000  6.0x2.5x1.5   sure");
  EXPECT_TRUE(Has(lines, "q quit  t tracks  s sure  c count anew"));
  EXPECT_TRUE(Has(lines, "navigator     degraded 12.5   14     -"));
  EXPECT_TRUE(Has(lines, " no heading: neither HDT nor PASHR for"));
  EXPECT_TRUE(Has(lines, "POSE             1.0"));
}

TEST(Screen, AWiderOneHasProbabilitiesTooAndADashForThoseThatAreNotStated) {
  Board board = BusyBoard();
  auto obstacles = std::vector{ObstacleAt(1, 4.5F, 0.0F), ObstacleAt(2, 5.5F, 0.0F), ObstacleAt(3, 6.5F, 0.0F), ObstacleAt(4, 7.5F, 0.0F)};
  obstacles[1].thing_probability = std::numeric_limits<float>::quiet_NaN();
  obstacles[2].thing_probability = 1.0F;
  obstacles[3].thing_probability = 0.9999F;
  Say(board, bus::kObstacles, TurnOf(2, obstacles), 1.95);
  const auto lines = Lines(DrawScreen(board, "title", At(2.0), {85, 24}));
  const auto head = std::ranges::find_if(lines, [](const std::string& line) { return line.starts_with("of 4 "); });
  ASSERT_GE(lines.end() - head, 5);
  EXPECT_TRUE(head->ends_with("confidence thing%")) << *head;
  const std::vector<std::string> ends{"   97", "    -", "  100", "   99"};
  for (std::size_t i = 0; i < ends.size(); ++i) EXPECT_TRUE((head + 1)[static_cast<std::ptrdiff_t>(i)].ends_with(ends[i])) << i;
}

TEST(Screen, MayLeaveOutWhatIsNotSure) {
  const auto lines = Lines(DrawScreen(BusyBoard(), "title", At(2.0), {80, 24, true}));
  EXPECT_EQ(lines[15], "of 11  id range m  rel true    latitude    longitude  size m        sure only");
  EXPECT_FALSE(Has(lines, "tentative"));
  EXPECT_TRUE(Has(lines, "  8     9    12.5"));
}

TEST(Screen, AlarmStandsOnTopInReverse) {
  for (const int height : {0, 24, 8, 1}) {
    const auto rows = DrawScreen(AlarmedBoard(), "title", At(2.0), {80, height});
    ASSERT_FALSE(rows.empty());
    EXPECT_EQ(rows[0][0].style, Style::kAlarm);
    EXPECT_EQ(Lines(rows)[0], "WARNING: boat 17 in the guard zone: 4.5 m, 12 deg to port") << height;
  }
  const auto calm = DrawScreen(BusyBoard(), "title", At(2.0), {80, 24});
  EXPECT_FALSE(Has(Lines(calm), "WARNING"));
}

TEST(Screen, AnAlertStaysWhereTheTrackerFellSilentAndSaysSo) {
  const auto lines = Lines(DrawScreen(AlarmedBoard(), "title", At(10.0), {80, 24}));
  EXPECT_EQ(lines[0], "NO LOOK-OUT: no ALERTS for 8 s");
  EXPECT_EQ(lines[1], "before that: boat 17 in the guard zone: 4.5 m, 12 deg to port");
}

TEST(Screen, TellsOfEachAlertInARowOfItsOwn) {
  const auto lines = Lines(DrawScreen(AlarmedBoard(), "title", At(2.0), {80, 24}));
  ASSERT_EQ(lines.size(), 24U);
  EXPECT_EQ(lines[0], "WARNING: boat 17 in the guard zone: 4.5 m, 12 deg to port");
  EXPECT_EQ(lines[1], "CAUTION: boat 18: closest approach 3 m in 21 s, from where it is hard to see,..");
  EXPECT_EQ(lines[2].substr(0, 4), "own ");
}

TEST(Screen, FitsAnySize) {
  for (int width = 1; width <= 200; width += 3) {
    for (int height = 1; height <= 60; ++height) {
      const auto rows = DrawScreen(AlarmedBoard(), "lookout-top", At(2.0), {width, height});
      EXPECT_LE(rows.size(), static_cast<std::size_t>(height));
      for (const auto& line : Lines(rows)) EXPECT_LE(line.size(), static_cast<std::size_t>(width));
    }
  }
}

// By their ids, so that a row stays where it is while boats pass each other.
TEST(Screen, ShowsTracksInPlaceOfObstaclesWhereThereIsATracker) {
  auto still = TrackAt(23, 8.0F, track_t::STATUS_COASTING);
  still.course_rad = std::numeric_limits<float>::quiet_NaN();
  still.speed_mps = 0.0F;
  const auto board = TrackedBoard({TrackAt(9, 50.0F), TrackAt(17, 20.0F), TrackAt(20, 10.0F, track_t::STATUS_TENTATIVE), still});
  const auto rows = DrawScreen(board, "title", At(2.0), {90, 40});
  const auto lines = Lines(rows);
  EXPECT_EQ(lines[0], "WARNING: boat 17: closest approach 3 m in 21 s") << "the other is acknowledged";
  EXPECT_EQ(rows[0][0].style, Style::kAlarm);
  const auto head = std::ranges::find_if(lines, [](const std::string& line) { return line.starts_with("of 3 "); });
  ASSERT_GE(lines.end() - head, 4);
  EXPECT_EQ(head[0], "of 3   track  kind      range m  rel course   m/s  CPA m TCPA s  alert     status     seen");
  EXPECT_EQ(head[1], "  1        9  boat         50.0  040    270   2.5    3.0     21  (caution) confirmed 14/15");
  EXPECT_EQ(head[2], "  2       17  boat         20.0  040    270   2.5    3.0     21  warning   confirmed 14/15");
  EXPECT_EQ(head[3], "  3       23  boat          8.0  040      -   0.0    3.0     21  -         coasting  14/15");
  EXPECT_TRUE(Has(Lines(DrawScreen(board, "title", At(2.0), {80, 40})), "  2       17  boat         20.0  040    270   2.5    3.0     21  warning"));
  const auto obstacles = Lines(DrawScreen(board, "title", At(2.0), {.width = 80, .height = 40, .has_tracks = false}));
  EXPECT_TRUE(Has(obstacles, "  1     1     4.5  000  090"));
}

TEST(Screen, ShowsWhichShipATrackIsWhereThereIsRoom) {
  auto board = TrackedBoard({TrackAt(9, 50.0F), TrackAt(17, 20.0F)});
  ais_t message{};
  message.num_ships = 3;
  for (const auto& [mmsi, name, state] :
       {std::tuple(211000001, "EVEREST", +ais_ship_t::STATE_TRACKED), std::tuple(211000002, "", +ais_ship_t::STATE_TRACKED),
        std::tuple(211000003, "MAYBE", +ais_ship_t::STATE_UNSURE)}) {
    auto& ship = message.ships.emplace_back();
    ship = {};
    ship.mmsi = mmsi;
    ship.name = name;
    ship.state = state;
    ship.track_id = mmsi == 211000002 ? 17 : 9;
  }
  Say(board, bus::kAis, message, 1.97);
  const auto lines = Lines(DrawScreen(board, "title", At(2.0), {130, 40}));
  EXPECT_TRUE(Has(lines, "confirmed 14/15  EVEREST"));
  EXPECT_TRUE(Has(lines, "confirmed 14/15  211000002"));
  EXPECT_FALSE(Has(lines, "MAYBE"));
}

// The lidar should see her and does not: people should know before they look at tracks.
TEST(Screen, NamesShipsThatAisAloneTellsOf) {
  for (const bool has_track : {true, false}) {
    auto board = TrackedBoard(has_track ? std::vector{TrackAt(9, 50.0F)} : std::vector<track_t>{});
    ais_t message{};
    for (int i = 0; i < 5; ++i) {
      auto& ship = message.ships.emplace_back();
      ship = {};
      ship.mmsi = 211000001 + i;
      ship.name = i == 1 ? "EVER\x1B"
                           "BEST"
                         : "";
      ship.state = i == 4 ? +ais_ship_t::STATE_NOT_IN_SIGHT : +ais_ship_t::STATE_AIS_ONLY;
      ship.range_m = 40.0F - 5.0F * static_cast<float>(i);
      ship.bearing_rad = 0.5F;
    }
    message.num_ships = 5;
    Say(board, bus::kAis, message, 1.97);
    const auto lines = Lines(DrawScreen(board, "title", At(2.0), {130, 40}));
    EXPECT_TRUE(Has(lines, "AIS only, no track: 211000004 at 25.0 m, 029 deg from the bow"));
    EXPECT_TRUE(Has(lines, "AIS only, no track: EVER"));
    EXPECT_FALSE(Has(lines, "211000001")) << "the nearest three";
    EXPECT_FALSE(Has(lines, "211000005"));
    EXPECT_EQ(std::ranges::any_of(lines, [](const auto& line) { return line.starts_with("no track"); }), !has_track);
    message.num_ships = 0;
    message.ships.clear();
    Say(board, bus::kAis, message, 1.98);
    EXPECT_FALSE(Has(Lines(DrawScreen(board, "title", At(2.0), {130, 40})), "AIS only"));
  }
}

TEST(Screen, SaysNoLookOutWhenAlertsAreOlderThanASecond) {
  const auto board = TrackedBoard({TrackAt(9, 50.0F)}, 1.0);
  EXPECT_FALSE(Has(Lines(DrawScreen(board, "title", At(1.9), {80, 40})), "NO LOOK-OUT"));
  const auto lines = Lines(DrawScreen(board, "title", At(4.2), {80, 40}));
  EXPECT_EQ(lines[0], "NO LOOK-OUT: no ALERTS for 3 s");
  EXPECT_FALSE(Has(lines, "WARNING"));
}

TEST(Screen, TellsTheOwnShip) {
  const auto wide = Lines(DrawScreen(BusyBoard(), "title", At(2.0), {120, 40}));
  EXPECT_EQ(wide[1], "own 43.629590 -72.149989  heading 090 hdt  1.2 m/s  pose ok  fix rtk_fixed  course 090  14 satellites");
  EXPECT_EQ(Lines(DrawScreen(BusyBoard(), "title", At(2.0), {40, 40}))[1], "own 43.629590 -72.149989  heading 090");
  const auto rows = DrawScreen(BusyBoard(), "title", At(9.0), {80, 40});
  EXPECT_EQ(Lines(rows)[0], "NO LOOK-OUT: no ALERTS yet");  // no tracker, and the others were heard 3 s ago
  EXPECT_EQ(Lines(rows)[2].substr(0, 40), "own (no POSE for 7 s) 43.629590 -72.1499");
  EXPECT_EQ(rows[2][0].style, Style::kFault);
  Board board(kStart);
  EXPECT_TRUE(Has(Lines(DrawScreen(board, "title", At(1.0), {80, 0})), "own ship: no POSE"));
  auto lost = PoseAt(1'000'000, std::numeric_limits<double>::quiet_NaN());
  lost.status = pose_t::STATUS_UNKNOWN;
  lost.latitude_deg = lost.longitude_deg = lost.velocity_map_mps[0] = std::numeric_limits<double>::quiet_NaN();
  Say(board, bus::kPose, lost, 1.0);
  EXPECT_TRUE(Has(Lines(DrawScreen(board, "title", At(1.1), {80, 0})), "own without position  heading -  - m/s  pose unknown  fix -  course -"));
  EXPECT_EQ(DrawScreen(board, "title", At(1.1), {80, 0})[1][0].style, Style::kWarning);
}

// A heading that is only the course over ground looked like that of a compass, and the line was not yellow.
TEST(Screen, TellsACourseFromAHeading) {
  Board board = BusyBoard();
  pose_t pose = PoseAt(1'000'000, DegToRad(90.0));
  pose.heading_source = pose_t::HEADING_COURSE;
  pose.latitude_deg = 43.629590;
  pose.longitude_deg = -72.149989;
  pose.datum_latitude_deg = 43.6;
  pose.datum_longitude_deg = -72.1;
  pose.velocity_map_mps[0] = 1.2;
  Say(board, bus::kPose, pose, 1.95);
  const auto rows = DrawScreen(board, "title", At(2.0), {80, 24});
  EXPECT_EQ(Lines(rows)[0], "own 43.629590 -72.149989  course 090 no compass  1.2 m/s  pose ok  fix rtk_fixed");
  EXPECT_EQ(rows[0][0].style, Style::kWarning);
}

// At a datum with swapped latitude and longitude it said 4.8 m/s and 333 deg of a boat that goes 5 m/s due east.
TEST(Screen, SpeedAndCourseAreThoseWhereTheBoatIs) {
  Board board(kStart);
  pose_t pose = PoseAt(1'000'000, DegToRad(90.0));
  pose.latitude_deg = 43.62959;
  pose.longitude_deg = -72.149989;
  pose.datum_latitude_deg = -72.149989;
  pose.datum_longitude_deg = 43.62959;
  const LocalFrame map({pose.datum_latitude_deg, pose.datum_longitude_deg, 0.0});
  const LocalFrame here({pose.latitude_deg, pose.longitude_deg, 0.0});
  const Eigen::Vector3d velocity_map_mps = map.TransformFrom(here).linear() * Eigen::Vector3d(5.0, 0.0, 0.0);
  for (int i = 0; i < 3; ++i) pose.velocity_map_mps[i] = velocity_map_mps[i];
  Say(board, bus::kPose, pose, 1.0);
  const auto lines = Lines(DrawScreen(board, "title", At(1.1), {120, 0}));
  EXPECT_TRUE(Has(lines, "  5.0 m/s")) << lines[1];
  EXPECT_TRUE(Has(lines, "  course 090")) << lines[1];
}

TEST(Screen, ShowsMoreObstaclesWhereThereIsRoom) {
  EXPECT_TRUE(Has(Lines(DrawScreen(BusyBoard(), "title", At(2.0), {80, 29})), " 12    12    15.5"));
  EXPECT_FALSE(Has(Lines(DrawScreen(BusyBoard(), "title", At(2.0), {80, 0})), " 12    12    15.5")) << "ten in text";
}

TEST(Screen, ShowsTheKeysAtAnyWidthWhereThereIsRoom) {
  for (const int width : {40, 79, 80, 120, 200}) {
    EXPECT_TRUE(Has(Lines(DrawScreen(BusyBoard(), "title", At(2.0), {width, 40})), "q quit  t tracks  s sure  c count anew")) << width;
  }
  EXPECT_FALSE(Has(Lines(DrawScreen(BusyBoard(), "title", At(2.0), {80, 0})), "q quit")) << "nobody presses keys at --once";
}

TEST(Screen, CountsTheHealthOfInventedNames) {
  Board board = BusyBoard();
  for (int i = 0; i < 64; ++i) Say(board, bus::kHealth, HealthOf("a" + std::to_string(i), 0), 1.95);
  const auto lines = Lines(DrawScreen(board, "title", At(2.0), {80, 40}));
  for (const std::string process : {" lidar", " segmenter", " navigator", " georeferencer", " recorder"}) EXPECT_TRUE(Has(lines, process));
  EXPECT_TRUE(Has(lines, "and 56 HEALTH of others"));
}

// Every column as wide as it gets: a number next to another without a space between is one that nobody sent.
Board WideBoard() {
  Board board(kStart);
  std::vector<std::uint8_t> rubbish(100'000);
  for (int i = 0; i < 12345; ++i) board.Take("A_CHANNEL_OF_A_LONG_NAME", {rubbish.data(), i < 200 ? rubbish.size() : 0}, At(1.5));
  for (int i = 0; i < 123'456; ++i) board.Take("LIDAR_SCAN", {}, At(1.5));
  auto health = HealthOf("georeferencer_of_a_long_name", 0, health_t::STATE_DEGRADED);
  health.cpu_fraction = 12.345;
  health.resident_bytes = 123'456'000'000;
  health_channel_t channel{};
  channel.channel = "OBSTACLES";
  channel.latency_p99_us = 123'456'700;
  health.channels = {channel};
  health.num_channels = 1;
  Say(board, bus::kHealth, health, 1.5);
  pose_t pose = PoseAt(1'000'000, 6.28);
  pose.latitude_deg = -83.123456;
  pose.longitude_deg = -179.123456;
  Say(board, bus::kPose, pose, 1.5);
  auto obstacle = ObstacleAt(123'456, 123'456.7F, 6.28F);
  obstacle.latitude_deg = -83.123456;
  obstacle.longitude_deg = -179.123456;
  obstacle.length_m = 123.4F;
  obstacle.width_m = 123.4F;
  obstacle.height_m = 12.3F;
  Say(board, bus::kObstacles, TurnOf(1, {obstacle}), 1.5);
  return board;
}

TEST(Screen, NoColumnsRunTogetherAtAnyWidth) {
  const auto board = WideBoard();
  for (int width = 1; width <= 200; ++width) {
    const auto lines = Lines(DrawScreen(board, "title", At(2.0), {width, 40}));
    for (const auto& line : lines) {
      const bool is_number_cut = line.find("-83.") != std::string::npos && line.find("-83.123456") == std::string::npos;
      EXPECT_FALSE(is_number_cut) << width << ": " << line;
      for (const std::string touching : {"123k", "12k", "6173", "###"}) {
        for (auto at = line.find(touching); at != std::string::npos; at = line.find(touching, at + touching.size())) {
          EXPECT_TRUE(at == 0 || line[at - 1] == ' ' || line[at - 1] == '#') << width << ": " << line;
          const auto end = at + touching.size();
          EXPECT_TRUE(end == line.size() || line[end] == ' ' || line[end] == '#') << width << ": " << line;
        }
      }
      EXPECT_EQ(line.find("-83.123456-179"), std::string::npos) << width << ": " << line;
    }
  }
  EXPECT_TRUE(Has(Lines(DrawScreen(board, "title", At(2.0), {80, 40})), "123x123x12"));
}

TEST(Screen, AnEmptyBusIsSaid) {
  const auto lines = Lines(DrawScreen(Board(kStart), "title", At(2.0), {80, 24}));
  EXPECT_TRUE(Has(lines, "nothing on the bus"));
  EXPECT_TRUE(Has(lines, "no process sends HEALTH"));
  EXPECT_TRUE(Has(lines, "no OBSTACLES"));
}

TEST(Screen, SilenceIsSaid) {
  const auto lines = Lines(DrawScreen(BusyBoard(), "title", At(14.0), {80, 40}));
  EXPECT_TRUE(Has(lines, "lidar         silent"));
  EXPECT_TRUE(Has(lines, " no HEALTH for 12 s"));
  EXPECT_TRUE(Has(lines, "no OBSTACLES"));
}

TEST(Screen, TextFromOutsideSendsNoControlSequence) {
  Board board(kStart);
  Say(board, bus::kHealth, HealthOf("evil\x1b[2J", 0, health_t::STATE_FAILED, "\x1b]0;title\x07 and \xff"), 0.1);
  board.Take("BAD\x1b[31mNAME\n", {}, At(0.1));
  const auto rows = DrawScreen(board, "title", At(0.2), {80, 24});
  for (const auto& row : rows) {
    for (const auto& span : row) EXPECT_EQ(span.text, Printable(span.text));
  }
  EXPECT_TRUE(Has(Lines(rows), "evil?[2J"));
}

TEST(Format, NumbersKeepTheirWidth) {
  EXPECT_EQ(Number(3.14159, 6, 2), "  3.14");
  EXPECT_EQ(Number(-0.001, 6, 1), "   0.0");
  EXPECT_EQ(Number(1234.567, 6, 2), "1234.6");
  EXPECT_EQ(Number(123456.7, 6, 2), "123457");
  EXPECT_EQ(Number(1e9, 6, 2), "######");
  EXPECT_EQ(Number(1e300, 6, 2), "######");
  EXPECT_EQ(Number(std::numeric_limits<double>::quiet_NaN(), 6, 2), "     -");
  EXPECT_EQ(Number(std::numeric_limits<double>::infinity(), 6, 2), "     -");
  EXPECT_EQ(Count(12345, 5), "12345");
  EXPECT_EQ(Count(123456, 5), " 123k");
  EXPECT_EQ(Count(std::numeric_limits<std::int64_t>::max(), 4), "####");
  EXPECT_EQ(Count(-5, 4), "  -5");
}

TEST(Format, DegreesWrapToThreeDigits) {
  EXPECT_EQ(Degrees(0.0), "000");
  EXPECT_EQ(Degrees(DegToRad(359.7)), "000");
  EXPECT_EQ(Degrees(DegToRad(-1.0)), "359");
  EXPECT_EQ(Degrees(std::numeric_limits<double>::quiet_NaN()), "-");
}

TEST(Format, WrapsAtWordsAndBreaksLongOnes) {
  EXPECT_EQ(Wrapped("one two three", 7, 9), (std::vector<std::string>{"one two", "three"}));
  EXPECT_EQ(Wrapped("abcdefghij", 4, 9), (std::vector<std::string>{"abcd", "efgh", "ij"}));
  EXPECT_EQ(Wrapped("one two three four", 5, 2), (std::vector<std::string>{"one", "two.."}));
  EXPECT_TRUE(Wrapped("", 5, 2).empty());
}

}  // namespace
}  // namespace lookout::top
