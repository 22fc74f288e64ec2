#include "tools/replay/plan.hpp"

#include <gtest/gtest.h>

namespace lookout::replay {
namespace {

// A recorded day: everything.
const ChannelSet kDay{"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_CLOCK", "LIDAR_NMEA", "SEGMENTS", "NAV_RAW", "GNSS_FIX", "ATTITUDE", "POSE", "OBSTACLES"};

std::string PlanOf(const Request& request, const ChannelSet& present = kDay) { return InWords(MakeLogPlan(request, present)); }

TEST(ReplayPlan, OfALogBeginsAtTheRawChannels) {
  EXPECT_EQ(PlanOf({}), "ran: lidar, segmenter, odometer, navigator, georeferencer, tracker, ais\nread: LIDAR_PACKETS, NAV_RAW, ALERT_ACK, ORDERS\n");
  const auto plan = MakeLogPlan({}, kDay);
  EXPECT_TRUE(plan.Reads("LIDAR_PACKETS"));
  EXPECT_TRUE(plan.Reads("NAV_RAW"));
  EXPECT_FALSE(plan.Reads("POSE"));
}

TEST(ReplayPlan, WithoutNavRawTakesTheSentencesOfTheLidar) {
  const auto plan = MakeLogPlan({}, {"LIDAR_PACKETS"});
  EXPECT_EQ(InWords(plan), "ran: lidar, segmenter, odometer, navigator, georeferencer, tracker, ais\nread: LIDAR_PACKETS, ALERT_ACK, ORDERS\n");
  EXPECT_FALSE(plan.Reads("NAV_RAW"));
}

TEST(ReplayPlan, FromAChannelStopsWhatGivesItAndWhatIsBefore) {
  EXPECT_EQ(PlanOf({.from = {"LIDAR_SCAN"}}),
            "ran: segmenter, odometer, navigator, georeferencer, tracker, ais\nread: LIDAR_SCAN, NAV_RAW, ALERT_ACK, ORDERS\n");
  EXPECT_EQ(PlanOf({.from = {"SEGMENTS"}}),
            "ran: odometer, navigator, georeferencer, tracker, ais\nread: LIDAR_SCAN, SEGMENTS, NAV_RAW, ALERT_ACK, ORDERS\n");
  EXPECT_EQ(PlanOf({.from = {"POSE"}}),
            "ran: lidar, segmenter, georeferencer, tracker, ais\nread: LIDAR_PACKETS, NAV_RAW, POSE, ALERT_ACK, ORDERS\n");
  EXPECT_EQ(PlanOf({.from = {"SEGMENTS", "POSE"}}),
            "ran: georeferencer, tracker, ais\nread: LIDAR_SCAN, SEGMENTS, NAV_RAW, POSE, ALERT_ACK, ORDERS\n");
  EXPECT_EQ(PlanOf({.from = {"OBSTACLES"}}), "ran: tracker, ais\nread: LIDAR_SCAN, SEGMENTS, NAV_RAW, POSE, OBSTACLES, ALERT_ACK, ORDERS\n");
  EXPECT_EQ(PlanOf({.from = {"LIDAR_PACKETS", "NAV_RAW"}}), PlanOf({}));
}

TEST(ReplayPlan, FromLidarNmeaLeavesNavRawAside) {
  const auto plan = MakeLogPlan({.from = {"LIDAR_NMEA"}}, kDay);
  EXPECT_EQ(InWords(plan), "ran: segmenter, odometer, navigator, georeferencer, tracker, ais\nread: LIDAR_SCAN, LIDAR_NMEA, ALERT_ACK, ORDERS\n");
  EXPECT_FALSE(plan.Reads("NAV_RAW"));
}

TEST(ReplayPlan, OnlySomeServicesReadWhatTheOthersGave) {
  EXPECT_EQ(PlanOf({.only = {"segmenter"}}), "ran: segmenter\nread: LIDAR_SCAN\n");
  EXPECT_EQ(PlanOf({.only = {"lidar"}}), "ran: lidar\nread: LIDAR_PACKETS\n");
  EXPECT_EQ(PlanOf({.only = {"navigator"}}), "ran: navigator\nread: NAV_RAW\n");
  EXPECT_EQ(PlanOf({.only = {"georeferencer"}}), "ran: georeferencer\nread: SEGMENTS, POSE\n");
  EXPECT_EQ(PlanOf({.only = {"ais"}}, {"NAV_RAW", "POSE", "TRACKS"}), "ran: ais\nread: NAV_RAW, POSE, TRACKS\n");
  EXPECT_EQ(PlanOf({.from = {"TRACKS"}}, {"NAV_RAW", "POSE", "TRACKS"}), "ran: ais\nread: NAV_RAW, POSE, TRACKS\n");
  EXPECT_EQ(PlanOf({.only = {"georeferencer", "segmenter"}}), "ran: segmenter, georeferencer\nread: LIDAR_SCAN, POSE\n");
  EXPECT_EQ(PlanOf({.only = {"lidar", "georeferencer"}}), "ran: lidar, georeferencer\nread: LIDAR_PACKETS, SEGMENTS, POSE\n");
  EXPECT_EQ(PlanOf({.from = {"LIDAR_SCAN"}, .only = {"segmenter"}}), "ran: segmenter\nread: LIDAR_SCAN\n");
}

TEST(ReplayPlan, RefusesWhatContradictsItself) {
  EXPECT_THROW(MakeLogPlan({.from = {"LIDAR_SCAN"}, .only = {"lidar"}}, kDay), RequestError);
  EXPECT_THROW(MakeLogPlan({.from = {"POSE"}, .only = {"segmenter"}}, kDay), RequestError);
  EXPECT_THROW(MakeLogPlan({.from = {"LIDAR_PACKETS", "LIDAR_SCAN"}}, kDay), RequestError);
  EXPECT_THROW(MakeLogPlan({.from = {"NAV_RAW", "LIDAR_NMEA"}}, kDay), RequestError);
  EXPECT_THROW(MakeLogPlan({.from = {"ALERTS"}}, kDay), RequestError);
  EXPECT_THROW(MakeLogPlan({.from = {"ALERT_ACK"}}, kDay), RequestError);
  EXPECT_THROW(MakeLogPlan({.only = {"recorder"}}, kDay), RequestError);
  EXPECT_THROW(Candidates({.from = {"POSE"}, .only = {"segmenter"}}), RequestError);
}

TEST(ReplayPlan, RefusesALogThatLacksWhatIsAskedFor) {
  EXPECT_THROW(MakeLogPlan({}, {"POSE", "SEGMENTS"}), std::runtime_error);
  EXPECT_THROW(MakeLogPlan({.from = {"LIDAR_SCAN"}}, {"LIDAR_PACKETS", "NAV_RAW"}), std::runtime_error);
  EXPECT_THROW(MakeLogPlan({.only = {"segmenter"}}, {"LIDAR_PACKETS", "NAV_RAW"}), std::runtime_error);
  EXPECT_THROW(MakeLogPlan({.only = {"navigator", "segmenter"}}, {"NAV_RAW"}), std::runtime_error);
  EXPECT_NO_THROW(MakeLogPlan({.only = {"georeferencer"}}, {"SEGMENTS"}));  // obstacles in the vessel frame
}

// Of obstacles that another program made, nobody knows what could have been seen.
TEST(ReplayPlan, FromObstaclesKnowsWhatTheLogLacks) {
  const auto plan = MakeLogPlan({.from = {"OBSTACLES"}}, {"OBSTACLES", "POSE"});
  EXPECT_EQ(plan.absent, (std::vector<std::string>{"LIDAR_SCAN", "SEGMENTS", "NAV_RAW"}));
  EXPECT_TRUE(plan.Gives(bus::kPose));
  EXPECT_FALSE(plan.Gives(bus::kLidarScan));
  EXPECT_TRUE(MakeLogPlan({.from = {"OBSTACLES"}}, kDay).absent.empty());
  EXPECT_TRUE(MakeLogPlan({}, kDay).Gives(bus::kLidarScan));
}

TEST(ReplayPlan, NeedsNoMoreThanItsCandidates) {
  EXPECT_EQ(Candidates({}), (ChannelSet{"LIDAR_PACKETS", "NAV_RAW"}));
  EXPECT_EQ(Candidates({.only = {"segmenter"}}), (ChannelSet{"LIDAR_SCAN"}));
  EXPECT_EQ(Candidates({.from = {"LIDAR_NMEA"}}), (ChannelSet{"LIDAR_NMEA", "LIDAR_SCAN"}));
}

TEST(ReplayPlan, OfACaptureHasNoMessagesToRead) {
  EXPECT_EQ(InWords(MakeCapturePlan({})), "ran: lidar, segmenter, odometer, navigator, georeferencer, tracker, ais\nread: datagrams\n");
  EXPECT_EQ(InWords(MakeCapturePlan({.only = {"navigator"}})), "ran: navigator\nread: datagrams\n");
  EXPECT_THROW(MakeCapturePlan({.from = {"LIDAR_PACKETS"}}), RequestError);
  EXPECT_THROW(MakeCapturePlan({.only = {"segmenter"}}), RequestError);
  EXPECT_THROW(MakeCapturePlan({.only = {"georeferencer"}}), RequestError);
}

}  // namespace
}  // namespace lookout::replay
