#include "tools/replay/lacks.hpp"

#include <gtest/gtest.h>

namespace lookout::replay {
namespace {

pose_t PoseOf(std::int32_t status, std::int32_t heading_source = pose_t::HEADING_HDT) {
  pose_t pose{};
  pose.status = status;
  pose.heading_source = heading_source;
  return pose;
}

// A capture of which all was computed, with a compass.
Seen Whole() {
  Seen seen;
  seen.wants_scans = seen.wants_poses = seen.wants_tracks = true;
  seen.data_port = 2368;
  seen.sentence_ports = {10110};
  seen.num_lidar_packets = 7500;
  seen.num_sentences = 300;
  seen.num_scans = 100;
  seen.num_obstacles_placed = 1000;
  for (int i = 0; i < 100; ++i) seen.poses.Add(PoseOf(pose_t::STATUS_OK));
  return seen;
}

std::string Said(const Seen& seen) {
  std::string said;
  for (const auto& line : Lacks(seen)) said += line + "\n";
  return said;
}

TEST(Lacks, NothingOfAWholeRun) { EXPECT_EQ(Said(Whole()), ""); }

// A replay without a position once ended with counters alone: nothing said that there are no tracks.
TEST(Lacks, NamesWhatIsMissingWithoutAPositionAndWhatWorksAllTheSame) {
  auto seen = Whole();
  seen.poses = {};
  for (int i = 0; i < 50; ++i) seen.poses.Add(PoseOf(pose_t::STATUS_NO_POSITION));
  EXPECT_EQ(Said(seen),
            "nothing has a place on the earth, as POSE knows no position (50 of 50 messages): obstacles are known in the vessel frame alone (range "
            "and bearing), "
            "there are no tracks and no closest approach; the guard zone works\n");
  seen.poses = {};
  for (int i = 0; i < 50; ++i) seen.poses.Add(PoseOf(pose_t::STATUS_NO_HEADING));
  EXPECT_NE(Said(seen).find("POSE knows no heading (50 of 50 messages)"), std::string::npos) << Said(seen);
  seen.poses.Add(PoseOf(pose_t::STATUS_UNKNOWN));
  EXPECT_NE(Said(seen).find("POSE knows no heading (51 of 51 messages)"), std::string::npos) << Said(seen);
  seen.poses = {};
  EXPECT_NE(Said(seen).find("there is no POSE: obstacles are known in the vessel frame"), std::string::npos) << Said(seen);
}

// What follows, for how long, and what to do.
TEST(Lacks, SaysThatTracksAreRelative) {
  auto seen = Whole();
  seen.poses = {};
  for (int i = 0; i < 25; ++i) seen.poses.Add(PoseOf(pose_t::STATUS_UNKNOWN));
  for (int i = 0; i < 100; ++i) seen.poses.Add(PoseOf(pose_t::STATUS_RELATIVE));
  for (int i = 0; i < 50; ++i) seen.poses.Add(PoseOf(pose_t::STATUS_RELATIVE_TO_BOAT));
  const auto said = Said(seen);
  EXPECT_NE(
      said.find(
          "obstacles, tracks, closest approach and alerts are there, but without a place on the earth: for 2.0 of 3.5 s they are in a frame that "
          "began where the boat was, its own motion by the lidar; for 1.0 s the lidar did not tell the own motion, and they are relative to "
          "the boat"),
      std::string::npos)
      << said;
  EXPECT_NE(said.find("give the boat a GNSS receiver and a compass"), std::string::npos) << said;
  // Of a part of the run.
  seen.poses.Add(PoseOf(pose_t::STATUS_OK));
  EXPECT_NE(Said(seen).find("position and heading on the earth were known for a part of the run only"), std::string::npos) << Said(seen);
}

TEST(Lacks, SaysThatNoSentenceCame) {
  auto seen = Whole();
  seen.poses = {};
  seen.num_sentences = 0;
  EXPECT_NE(Said(seen).find("no sentence of NMEA 0183 came: none from the lidar, none to port 10110 (navigator.txtpb): obstacles are known in the "
                            "vessel frame alone"),
            std::string::npos)
      << Said(seen);
  seen.other_ports[2000] = {.num_datagrams = 40, .num_lidar_packets = 0, .num_sentences = 40};
  EXPECT_NE(Said(seen).find("; datagrams came to other ports: 2000 (40 datagrams, sentences); give navigator.txtpb the port 2000"), std::string::npos)
      << Said(seen);
  seen.input = Seen::Input::kLog;
  EXPECT_NE(Said(seen).find("the log holds no sentence of NMEA 0183"), std::string::npos) << Said(seen);
}

TEST(Lacks, NamesThePortsThatThePacketsCameTo) {
  auto seen = Whole();
  seen.num_lidar_packets = seen.num_scans = seen.num_obstacles_placed = 0;
  EXPECT_EQ(Said(seen),
            "no lidar packet came to port 2368 (data_port of lidar.txtpb): no scans, segments, obstacles, tracks and alerts are computed\n");
  seen.other_ports[2369] = {.num_datagrams = 1808, .num_lidar_packets = 1808, .num_sentences = 0};
  seen.other_ports[53] = {.num_datagrams = 1};
  EXPECT_NE(Said(seen).find("; datagrams came to other ports: 2369 (1808 datagrams, as a lidar sends them), 53 (1 datagram); set data_port to 2369"),
            std::string::npos)
      << Said(seen);
  seen.input = Seen::Input::kTextLog;
  EXPECT_NE(Said(seen).find("a text log holds no lidar packets"), std::string::npos) << Said(seen);
}

TEST(Lacks, SaysThatTheHeadingIsTheCourse) {
  auto seen = Whole();
  seen.poses = {};
  for (int i = 0; i < 100; ++i) seen.poses.Add(PoseOf(pose_t::STATUS_OK, pose_t::HEADING_COURSE));
  EXPECT_NE(Said(seen).find("heading is course over ground in all 100 poses"), std::string::npos) << Said(seen);
  seen.poses.Add(PoseOf(pose_t::STATUS_COASTING));
  EXPECT_EQ(Said(seen), "");
}

TEST(Lacks, SaysThatMostObstaclesHaveNoPlace) {
  auto seen = Whole();
  seen.num_obstacles_unplaced = 50;
  EXPECT_EQ(Said(seen), "") << "before the first position";
  seen.num_obstacles_unplaced = 500;
  EXPECT_NE(Said(seen).find("500 of 1500 obstacles have no place"), std::string::npos) << Said(seen);
  seen.num_obstacles_placed = 0;
  EXPECT_NE(Said(seen).find("position and heading are known, but not at the time of a scan: obstacles are known"), std::string::npos) << Said(seen);
}

TEST(Lacks, IsSilentOfWhatWasNotAskedFor) {
  Seen seen;  // --only segmenter
  EXPECT_EQ(Said(seen), "");
  seen.wants_poses = true;  // --only navigator
  seen.poses.Add(PoseOf(pose_t::STATUS_OK));
  EXPECT_EQ(Said(seen), "");
}

TEST(Lacks, PortsAreNamedByHowMuchTheyGotAndNotWithoutEnd) {
  OtherPorts ports;
  for (int i = 1; i <= 20; ++i) ports[i].num_datagrams = i;
  EXPECT_TRUE(PortsText(ports).starts_with("20 (20 datagrams), 19 (19 datagrams), ")) << PortsText(ports);
  EXPECT_TRUE(PortsText(ports).ends_with("13 (13 datagrams) and 12 more")) << PortsText(ports);
  EXPECT_EQ(PortsText({}), "");
}

}  // namespace
}  // namespace lookout::replay
