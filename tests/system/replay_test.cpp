// lookout-replay and lookout-export as a user runs them, on the simulator's capture.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/run_info_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"
#include "tests/system/replay_fixture.hpp"

namespace lookout::system_test {
namespace {

using namespace support;

TEST_F(Replay, OfTheSimulatorsCaptureGivesTheSameBytesEachTime) {
  const auto sim =
      RunProgram({Bin("sim"), "--config", config_, "--scene", "lake", "--seed", "2", "--seconds", "3", "--pcap", Path("sim.pcap")}, Path("sim.out"));
  ASSERT_EQ(sim.exit_code, 0) << sim.output;
  ExpectSameBytes(Path("sim.pcap"));
  EXPECT_EQ(RawRanges("first"), ExportedRanges("first"));
  int num_placed = 0;
  for (const auto& message : Messages<obstacles_t>("first", "OBSTACLES")) {
    for (const auto& obstacle : message.obstacles) num_placed += obstacle.status == obstacle_t::STATUS_OK ? 1 : 0;
  }
  EXPECT_GT(num_placed, 100);
}

TEST_F(Replay, FromAnyLevelGivesTheSameBytes) {
  MakeDay();
  const auto day = PayloadsByChannel("day");
  const std::vector<std::pair<std::vector<std::string>, std::set<std::string>>> parts{
      {{"--from", "LIDAR_SCAN"},
       {"LIDAR_SCAN", "LIDAR_ODOMETRY", "NAV_RAW", "SEGMENTS", "GNSS_FIX", "ATTITUDE", "POSE", "OBSTACLES", "TRACKS", "ALERTS"}},
      // NAV_RAW is read for the ships of AIS in it.
      {{"--from", "SEGMENTS", "--from", "POSE"}, {"LIDAR_SCAN", "NAV_RAW", "SEGMENTS", "POSE", "OBSTACLES", "TRACKS", "ALERTS"}},
      {{"--from", "OBSTACLES"}, {"LIDAR_SCAN", "NAV_RAW", "SEGMENTS", "POSE", "OBSTACLES", "TRACKS", "ALERTS"}},
      {{"--from", "POSE"},
       {"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_CLOCK", "LIDAR_NMEA", "NAV_RAW", "SEGMENTS", "POSE", "OBSTACLES", "TRACKS", "ALERTS"}},
      {{"--only", "lidar"}, {"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_CLOCK", "LIDAR_NMEA"}},
      {{"--only", "segmenter"}, {"LIDAR_SCAN", "SEGMENTS"}},
      {{"--only", "navigator"}, {"NAV_RAW", "GNSS_FIX", "ATTITUDE", "POSE"}},
      {{"--only", "segmenter", "--only", "georeferencer"}, {"LIDAR_SCAN", "SEGMENTS", "POSE", "OBSTACLES"}}};
  for (const auto& [options, channels] : parts) {
    SCOPED_TRACE(::testing::PrintToString(options));
    const auto result = ReplayTo(Path("day"), "part", options);
    ASSERT_EQ(result.exit_code, 0) << result.output;
    auto part = PayloadsByChannel("part");
    part.erase("RUN_INFO");
    std::set<std::string> names;
    for (const auto& [channel, payloads] : part) {
      names.insert(channel);
      EXPECT_TRUE(day.contains(channel) && payloads == day.at(channel)) << channel << " differs";
    }
    EXPECT_EQ(names, channels);
    EXPECT_NE(result.output.find("not read: "), std::string::npos) << result.output;
    const auto infos = Messages<run_info_t>("part", "RUN_INFO");
    ASSERT_EQ(infos.size(), 1U);
    EXPECT_EQ(infos[0].file_name.back(), "lookout-replay");
    EXPECT_EQ(infos[0].file_text.back().substr(0, 5), "ran: ");
    // A part is a log as well.
    EXPECT_EQ(ReplayTo(Path("part"), "again", options).exit_code, 0);
    EXPECT_EQ(ReadFile(folder_ / "part"), ReadFile(folder_ / "again"));
  }
}

TEST_F(Replay, RefusesAPartThatTheLogDoesNotAllow) {
  MakeDay();
  ASSERT_EQ(ReplayTo(Path("day"), "part", {"--only", "navigator"}).exit_code, 0);
  const auto lacking = ReplayTo(Path("part"), "none", {"--from", "LIDAR_SCAN"});
  EXPECT_EQ(lacking.exit_code, 1);
  EXPECT_NE(lacking.output.find("part: --from LIDAR_SCAN: the input does not hold it"), std::string::npos) << lacking.output;
  EXPECT_EQ(ReplayTo(Path("day"), "none", {"--from", "LIDAR_SCAN", "--only", "lidar"}).exit_code, 2);
  EXPECT_EQ(ReplayTo(Path("day"), "none", {"--from", "HEALTH"}).exit_code, 2);
  EXPECT_EQ(ReplayTo(Path("sim.pcap"), "none", {"--from", "LIDAR_SCAN"}).exit_code, 2);
}

TEST_F(Replay, WithAnotherConfigSaysSoInRunInfo) {
  MakeDay();
  fs::copy(config_, folder_ / "config");
  std::ofstream(folder_ / "config/segmenter.txtpb") << "method: PAPER\n";
  const auto result = ReplayWith(Path("config"), Path("day"), "other");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("differs in segmenter.txtpb"), std::string::npos) << result.output;
  const auto infos = Messages<run_info_t>("other", "RUN_INFO");
  ASSERT_EQ(infos.size(), 1U);
  std::map<std::string, std::string> text_of_file;
  for (std::size_t i = 0; i < infos[0].file_name.size(); ++i) text_of_file[infos[0].file_name[i]] = infos[0].file_text[i];
  EXPECT_NE(text_of_file["segmenter.txtpb"].find("method: PAPER"), std::string::npos) << text_of_file["segmenter.txtpb"];
  EXPECT_EQ(text_of_file["lookout-replay"], "config differs from that of the input: segmenter.txtpb\n");
  EXPECT_TRUE(PayloadsByChannel("day")["LIDAR_SCAN"] == PayloadsByChannel("other")["LIDAR_SCAN"]);
  EXPECT_FALSE(PayloadsByChannel("day")["SEGMENTS"] == PayloadsByChannel("other")["SEGMENTS"]);
}

TEST_F(Replay, OfRotatedFilesEqualsThatOfTheWhole) {
  MakeDay();
  Rotate("day", "one", "other");
  const auto right = ReplayTo(Path("one"), "joined", {"--in", Path("other")});
  ASSERT_EQ(right.exit_code, 0) << right.output;
  EXPECT_EQ(right.output.find("in their order"), std::string::npos) << right.output;
  EXPECT_EQ(right.output.find("missing in the input"), std::string::npos) << right.output;
  auto joined = PayloadsByChannel("joined");
  auto day = PayloadsByChannel("day");
  joined.erase("RUN_INFO");
  day.erase("RUN_INFO");
  EXPECT_TRUE(joined == day);
  const auto wrong = ReplayTo(Path("other"), "wrong", {"--in", Path("one")});
  EXPECT_NE(wrong.output.find("in their order"), std::string::npos) << wrong.output;
}

// In the log of a replay each event is followed by what came of it: cut in front of a raw one, it is what live gave until then. End of input used to
// flush a scan and poses that live never had.
TEST_F(Replay, OfALogThatWasCutAddsNothingToIt) {
  MakeDay();
  std::vector<std::size_t> raw;
  {
    bus::LogReader reader(Path("day"));
    for (std::size_t i = 0; const auto event = reader.Next(); ++i) {
      if (event->channel == "LIDAR_PACKETS" || (event->channel == "NAV_RAW" && i > 0)) raw.push_back(i);
    }
  }
  ASSERT_GT(raw.size(), 500U);
  for (const std::size_t place : {raw[20], raw[raw.size() / 3], raw[raw.size() / 2], raw[raw.size() * 3 / 4]}) {
    Cut("day", "cut", place);
    const auto result = ReplayTo(Path("cut"), "again");
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_NE(result.output.find("ends without an end mark"), std::string::npos) << result.output;
    EXPECT_EQ(result.output.find("without a start mark"), std::string::npos) << result.output;
    auto cut = PayloadsByChannel("cut");
    auto again = PayloadsByChannel("again");
    cut.erase("RUN_INFO");
    again.erase("RUN_INFO");
    EXPECT_TRUE(cut == again) << "cut after " << place << " events";
  }
  const auto whole = ReplayTo(Path("day"), "again");
  EXPECT_EQ(whole.output.find("mark"), std::string::npos) << whole.output;
}

TEST_F(Replay, OfTheRestOfARunSaysThatItBeginsInTheMiddle) {
  MakeDay();
  Rotate("day", "one", "two");
  const auto result = ReplayTo(Path("two"), "again");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("LIDAR_PACKETS, NAV_RAW: the input begins without a start mark"), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find("end mark"), std::string::npos) << result.output;
}

// A boat without a navigator: its scans wait for no POSE that could come.
TEST_F(Replay, OfALogThatWasCutAndHoldsNoNavigationGivesItsObstaclesAllTheSame) {
  MakeDay();
  {
    bus::LogReader reader(Path("day"));
    support::FileLog writer(Path("lidar"));
    int num_bundles = 0;
    while (const auto event = reader.Next()) {
      num_bundles += event->channel == "LIDAR_PACKETS" ? 1 : 0;
      if (event->channel == "LIDAR_PACKETS" && num_bundles < 60) writer.Write(event->time, event->channel, event->bytes);
    }
  }
  const auto result = ReplayTo(Path("lidar"), "again", {"--only", "lidar", "--only", "segmenter", "--only", "georeferencer"});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  auto again = PayloadsByChannel("again");
  EXPECT_GT(again["OBSTACLES"].size(), 5U) << result.output;
  EXPECT_EQ(again["OBSTACLES"].size(), again["SEGMENTS"].size()) << result.output;
}

// A replay of packets of another port once ended with counters alone.
TEST_F(Replay, SaysWhatItsResultLacksAndWhy) {
  MakeDay();
  EXPECT_EQ(ReplayTo(Path("sim.pcap"), "whole").output.find("no lidar packet"), std::string::npos);
  fs::copy(config_, Path("other"));
  std::ofstream(Path("other/lidar.txtpb"), std::ios::app) << "\ndata_port: 2399\n";
  const auto result = ReplayWith(Path("other"), Path("sim.pcap"), "part");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("no lidar packet came to port 2399 (data_port of lidar.txtpb): no scans, segments, obstacles, tracks and alerts are "
                               "computed; datagrams came to other ports: 2368 ("),
            std::string::npos)
      << result.output;
  EXPECT_NE(result.output.find("as a lidar sends them); set data_port to 2368"), std::string::npos) << result.output;
}

// A log of a version whose SEGMENTS had another type: they are computed anew, and who asks for those of the log is told.
TEST_F(Replay, MakesMessagesOfAnotherVersionAnew) {
  MakeDay();
  std::size_t num_segments = 0;
  {
    bus::LogReader reader(Path("day"));
    support::FileLog writer(Path("older"));
    while (auto event = reader.Next()) {
      if (event->channel == "SEGMENTS") {
        event->bytes[7] ^= 1;  // its fingerprint
        ++num_segments;
      }
      writer.Write(event->time, event->channel, event->bytes);
    }
  }
  const std::string said = " messages of SEGMENTS are of another type than this version's SEGMENTS";
  const auto anew = ReplayTo(Path("older"), "anew");
  EXPECT_EQ(anew.exit_code, 0) << anew.output;
  EXPECT_EQ(anew.output.find(said), std::string::npos) << anew.output;
  EXPECT_TRUE(PayloadsByChannel("anew") == PayloadsByChannel("day"));
  const auto as_it_is = ReplayTo(Path("older"), "as_it_is", {"--from", "SEGMENTS"});
  EXPECT_EQ(as_it_is.exit_code, 0) << as_it_is.output;
  EXPECT_NE(as_it_is.output.find(std::to_string(num_segments) + said + ": lookout-replay makes SEGMENTS anew of the log, without --from and --only"),
            std::string::npos)
      << as_it_is.output;
}

TEST_F(Replay, RefusesAnOutputThatExistsUnlessItIsForced) {
  MakeDay();
  std::ofstream(Path("old")) << "another recording";
  const auto result = RunProgram({Bin("replay"), "--config", config_, "--in", Path("sim.pcap"), "--out", Path("old")}, Path("replay.out"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("exists already; --force replaces it"), std::string::npos) << result.output;
  EXPECT_EQ(ReadFile(folder_ / "old"), "another recording");
  EXPECT_EQ(ReplayTo(Path("sim.pcap"), "old").exit_code, 0);
  EXPECT_EQ(ReadFile(folder_ / "old"), ReadFile(folder_ / "day"));
}

TEST_F(Replay, LeavesNothingOfWhatItCouldNotCompute) {
  std::ofstream(Path("in")) << "neither a log nor a capture";
  EXPECT_EQ(ReplayTo(Path("in"), "out").exit_code, 1);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_FALSE(fs::exists(folder_ / "out.partial"));
}

TEST_F(Replay, TellsOfGapsAndOfProgressWhenAskedFor) {
  MakeDay();
  {
    bus::LogReader reader(Path("day"));
    support::FileLog writer(Path("holes"));
    int num_bundles = 0;
    while (const auto event = reader.Next()) {
      num_bundles += event->channel == "LIDAR_PACKETS" ? 1 : 0;
      if (event->channel != "LIDAR_PACKETS" || num_bundles % 40 != 20) writer.Write(event->time, event->channel, event->bytes);
    }
  }
  const auto result = ReplayTo(Path("holes"), "log", {"--progress"});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("LIDAR_PACKETS: 3 messages are missing in the input"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find(" s left"), std::string::npos) << result.output;
  EXPECT_EQ(ReplayTo(Path("holes"), "log").output.find(" s left"), std::string::npos);
}

}  // namespace
}  // namespace lookout::system_test
