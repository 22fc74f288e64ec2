// lookout-replay and lookout-export as a user runs them, on the simulator's capture and on real recordings where they are at hand.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/run_info_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;

class Replay : public ::testing::Test {
 protected:
  TempDir folder_;
  const fs::path data_ = kRecordings;
  const std::string config_ = kCatabotConfig.string();

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  RunResult ReplayTo(const std::string& in, const std::string& out, const std::vector<std::string>& options = {}) {
    return ReplayWith(config_, in, out, options);
  }
  RunResult ReplayWith(const std::string& config, const std::string& in, const std::string& out, const std::vector<std::string>& options = {}) {
    std::vector<std::string> command{Bin("replay"), "--config", config, "--in", in, "--out", Path(out), "--force"};
    command.insert(command.end(), options.begin(), options.end());
    return RunProgram(command, Path("replay.out"));
  }

  // Three seconds of the simulated lake, replayed once, as the log "day".
  void MakeDay() {
    const auto sim = RunProgram({Bin("sim"), "--config", config_, "--scene", "lake", "--seed", "2", "--seconds", "3", "--pcap", Path("sim.pcap")},
                                Path("sim.out"));
    ASSERT_EQ(sim.exit_code, 0) << sim.output;
    ASSERT_EQ(ReplayTo(Path("sim.pcap"), "day").exit_code, 0);
  }

  // The first events of a log, as a recorder leaves them that is killed there.
  void Cut(const std::string& log, const std::string& cut, std::size_t num_events) {
    bus::LogReader reader(Path(log));
    support::FileLog writer(Path(cut));
    for (std::size_t i = 0; i < num_events; ++i) {
      const auto event = reader.Next();
      ASSERT_TRUE(event);
      writer.Write(event->time, event->channel, event->bytes);
    }
  }

  // The files of a recorder that began a new one after half of the events, RUN_INFO first in each.
  void Rotate(const std::string& log, const std::string& first, const std::string& second) {
    std::vector<bus::LogEvent> events;
    bus::LogReader reader(Path(log));
    while (const auto event = reader.Next()) events.push_back(*event);
    ASSERT_EQ(events.front().channel, "RUN_INFO");
    support::FileLog one(Path(first));
    support::FileLog other(Path(second));
    other.Write(events[events.size() / 2].time, "RUN_INFO", events.front().bytes);
    for (std::size_t i = 0; i < events.size(); ++i) (i < events.size() / 2 ? one : other).Write(events[i].time, events[i].channel, events[i].bytes);
  }

  template <typename T>
  std::vector<T> Messages(const std::string& log, const std::string& channel) {
    std::vector<T> messages;
    bus::LogReader reader(Path(log));
    while (const auto event = reader.Next()) {
      if (event->channel != channel) continue;
      const auto message = bus::Decode<T>(event->bytes);
      EXPECT_TRUE(message);
      if (message) messages.push_back(*message);
    }
    return messages;
  }

  // Replays twice and wants the same file; replays the replay and wants the same payloads on every channel.
  void ExpectSameBytes(const std::string& capture) {
    const auto first = ReplayTo(capture, "first");
    ASSERT_EQ(first.exit_code, 0) << first.output;
    ASSERT_EQ(ReplayTo(capture, "second").exit_code, 0);
    EXPECT_EQ(ReadFile(folder_ / "first"), ReadFile(folder_ / "second"));
    const auto again = ReplayTo(Path("first"), "again");
    ASSERT_EQ(again.exit_code, 0) << again.output;
    EXPECT_TRUE(PayloadsByChannel("first") == PayloadsByChannel("again"));
  }

  // Payloads of each channel in their order. How channels lie between each other in the file is not promised.
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> PayloadsByChannel(const std::string& log) {
    std::map<std::string, std::vector<std::vector<std::uint8_t>>> payloads;
    bus::LogReader reader(Path(log));
    while (auto event = reader.Next()) payloads[event->channel].push_back(std::move(event->bytes));
    return payloads;
  }

  // Turns of a log: whole and partial.
  std::pair<int, int> CountTurns(const std::string& log) {
    std::map<std::int64_t, int> flags;
    for (const auto& scan : Messages<lidar_scan_t>(log, "LIDAR_SCAN")) flags[scan.seq] = scan.flags;
    int num_whole = 0;
    for (const auto& [seq, flag] : flags) {
      const bool is_partial = (flag & lidar_scan_t::FLAG_PARTIAL_START) != 0 || (flag & lidar_scan_t::FLAG_PARTIAL_END) != 0;
      num_whole += is_partial ? 0 : 1;
    }
    return {num_whole, static_cast<int>(flags.size()) - num_whole};
  }

  // Ranges above 0 in the raw packets, and how often each count occurs.
  std::map<int, int> RawRanges(const std::string& log) {
    std::map<int, int> histogram;
    for (const auto& bundle : Messages<lidar_packets_t>(log, "LIDAR_PACKETS")) {
      std::size_t offset = 0;
      for (const int size : bundle.size_bytes) {
        if (size == 1206) {
          for (int block = 0; block < 12; ++block) {
            for (int channel = 0; channel < 32; ++channel) {
              const std::size_t place = offset + static_cast<std::size_t>(100 * block + 4 + 3 * channel);
              const int range = bundle.payload[place] | bundle.payload[place + 1] << 8;
              if (range > 0) ++histogram[range];
            }
          }
        }
        offset += static_cast<std::size_t>(size);
      }
    }
    return histogram;
  }

  std::map<int, int> ExportedRanges(const std::string& log) {
    const auto result = RunProgram({Bin("export"), "--in", Path(log), "--table", "returns", "--out", Path("returns.csv")}, Path("export.out"));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    std::ifstream in(Path("returns.csv"));
    std::map<int, int> histogram;
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line, "scan_utime_us,utime_us,ring,return_index,azimuth_deg,range_m,x_m,y_m,z_m,reflectivity,label,reason,track_id,piece");
    while (std::getline(in, line)) {
      std::istringstream row(line);
      std::string field;
      for (int i = 0; i < 6; ++i) std::getline(row, field, ',');
      const double count = std::stod(field) / 0.002;
      EXPECT_NEAR(count, std::round(count), 1e-6);
      ++histogram[static_cast<int>(std::lround(count))];
    }
    return histogram;
  }
};

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
      {{"--from", "LIDAR_SCAN"}, {"LIDAR_SCAN", "NAV_RAW", "SEGMENTS", "GNSS_FIX", "ATTITUDE", "POSE", "OBSTACLES", "TRACKS", "ALERTS"}},
      {{"--from", "SEGMENTS", "--from", "POSE"}, {"LIDAR_SCAN", "SEGMENTS", "POSE", "OBSTACLES", "TRACKS", "ALERTS"}},
      {{"--from", "OBSTACLES"}, {"LIDAR_SCAN", "SEGMENTS", "POSE", "OBSTACLES", "TRACKS", "ALERTS"}},
      {{"--from", "POSE"}, {"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_CLOCK", "LIDAR_NMEA", "SEGMENTS", "POSE", "OBSTACLES", "TRACKS", "ALERTS"}},
      {{"--only", "vlp16"}, {"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_CLOCK", "LIDAR_NMEA"}},
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
  EXPECT_EQ(ReplayTo(Path("day"), "none", {"--from", "LIDAR_SCAN", "--only", "vlp16"}).exit_code, 2);
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
  const auto result = ReplayTo(Path("lidar"), "again", {"--only", "vlp16", "--only", "segmenter", "--only", "georeferencer"});
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
  std::ofstream(Path("other/vlp16.txtpb"), std::ios::app) << "\ndata_port: 2399\n";
  const auto result = ReplayWith(Path("other"), Path("sim.pcap"), "part");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("no lidar packet came to port 2399 (data_port of vlp16.txtpb): no scans, segments, obstacles, tracks and alerts are "
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

struct RealCapture {
  const char* file;
  int num_whole;
  int num_partial;
};

class ReplayOfRealCaptures : public Replay, public ::testing::WithParamInterface<RealCapture> {};

TEST_P(ReplayOfRealCaptures, CutsTurnsAndGivesTheSameBytesEachTime) {
  const auto capture = data_ / "vlp16" / GetParam().file;
  if (!fs::exists(capture)) GTEST_SKIP() << "no recording at " << capture;
  ExpectSameBytes(capture.string());
  EXPECT_EQ(CountTurns("first"), std::pair(GetParam().num_whole, GetParam().num_partial));
  EXPECT_EQ(RawRanges("first"), ExportedRanges("first"));
}

INSTANTIATE_TEST_SUITE_P(Vlp16, ReplayOfRealCaptures,
                         ::testing::Values(RealCapture{"mrpt_sample_velodyne_vlp16_gps.pcap", 3, 2}, RealCapture{"einride_vlp16_1000pkt.pcap", 12, 2},
                                           RealCapture{"rlu_vlp16_example.pcap", 0, 2}),
                         [](const auto& capture) {
                           const std::string file = capture.param.file;
                           return file.substr(0, file.find('_'));
                         });

TEST_F(Replay, OfACaptureWithAFixAndNoHeadingPlacesTheBoatAndNotTheObstacles) {
  const auto capture = data_ / "vlp16/mrpt_sample_velodyne_vlp16_gps.pcap";
  if (!fs::exists(capture)) GTEST_SKIP() << "no recording at " << capture;
  ASSERT_EQ(ReplayTo(capture.string(), "log").exit_code, 0);
  std::map<int, int> packets;
  for (const auto& bundle : Messages<lidar_packets_t>("log", "LIDAR_PACKETS")) {
    for (const int size : bundle.size_bytes) ++packets[size];
  }
  EXPECT_EQ(packets, (std::map<int, int>{{512, 57}, {1206, 293}}));
  int num_known = 0;
  for (const auto& pose : Messages<pose_t>("log", "POSE")) {
    if (pose.status != pose_t::STATUS_NO_HEADING) continue;
    ++num_known;
    EXPECT_NEAR(pose.latitude_deg, 36.829131, 1.0 / 111000.0);
    EXPECT_NEAR(pose.longitude_deg, -2.407572, 1.0 / 89000.0);
  }
  EXPECT_GT(num_known, 5);
  std::set<std::int64_t> turns;
  int num_obstacles = 0;
  for (const auto& message : Messages<obstacles_t>("log", "OBSTACLES")) {
    turns.insert(message.seq);
    for (const auto& obstacle : message.obstacles) {
      ++num_obstacles;
      EXPECT_EQ(obstacle.status, obstacle_t::STATUS_VESSEL_FRAME_ONLY);
      EXPECT_TRUE(std::isnan(obstacle.latitude_deg));
    }
  }
  EXPECT_EQ(turns.size(), 5U);  // the end of input flushes what waits
  EXPECT_GT(num_obstacles, 0);
}

TEST_F(Replay, RefusesTheWrongLidar) {
  const auto capture = data_ / "other_lidar/vv_hdl32_monterey.pcap";
  if (!fs::exists(capture)) GTEST_SKIP() << "no recording at " << capture;
  const auto result = ReplayTo(capture.string(), "log");
  EXPECT_EQ(result.exit_code, 1) << result.output;
  EXPECT_NE(result.output.find("HDL-32E"), std::string::npos) << result.output;
  EXPECT_FALSE(fs::exists(Path("log"))) << "an output of a run that failed";
}

TEST_F(Replay, OfBrokenCapturesEndsWithAClearErrorOrACountedRefusal) {
  if (!fs::exists(data_ / "bad_pcap")) GTEST_SKIP() << "no recordings at " << data_;
  int num_files = 0;
  for (const auto& folder : {"bad_pcap", "other_lidar"}) {
    for (const auto& entry : fs::directory_iterator(data_ / folder)) {
      const auto result = ReplayTo(entry.path().string(), "log");
      EXPECT_EQ(result.exit_code, 1) << entry.path() << ": " << result.output;
      EXPECT_NE(result.output.find("critical"), std::string::npos) << entry.path() << ": " << result.output;
      ++num_files;
    }
  }
  EXPECT_GE(num_files, 14);
}

TEST_F(Replay, DoesNotOverwriteItsInput) {
  std::ofstream(Path("in")) << "x";
  const auto result = ReplayTo(Path("in"), "in");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(ReadFile(folder_ / "in"), "x");
}

TEST_F(Replay, SaysWhichLineOfAConfigIsWrong) {
  fs::copy(config_, folder_ / "config");
  const auto text = ReadFile(folder_ / "config/vlp16.txtpb");
  const auto line = std::to_string(std::ranges::count(text, '\n') + 1);
  std::ofstream(folder_ / "config/vlp16.txtpb", std::ios::app) << "no_such_field: 1\n";
  const auto result = RunProgram({Bin("replay"), "--config", Path("config"), "--check"}, Path("check.out"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.output.find("vlp16.txtpb:" + line + ": "), std::string::npos) << result.output;
}

TEST_F(Replay, ChecksTheConfigAndPrintsWhatIsInForce) {
  const auto result = RunProgram({Bin("replay"), "--config", config_, "--check"}, Path("check.out"));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("e1_cosine: 0.95  # default"), std::string::npos) << result.output;
}

// A boat in Amsterdam, 20 minutes (Signal K project).
TEST_F(Replay, ATextLogOfSentencesGivesATrack) {
  const auto log = data_ / "nmea/signalk_gps.log";
  if (!fs::exists(log)) GTEST_SKIP() << log << " is not there";
  const auto result = ReplayTo(log.string(), "track");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto poses = Messages<pose_t>("track", "POSE");
  // 08:54:11 to 09:14, every 20 ms.
  EXPECT_GT(poses.size(), 50'000U);
  const auto is_placed = [](const pose_t& pose) { return std::isfinite(pose.latitude_deg); };
  const auto num_placed = std::count_if(poses.begin(), poses.end(), is_placed);
  EXPECT_GT(num_placed, static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(poses.size())));
  for (const auto& pose : poses) {
    if (!is_placed(pose)) continue;
    ASSERT_NEAR(pose.latitude_deg, 52.37, 0.1);
    ASSERT_NEAR(pose.longitude_deg, 4.91, 0.2);
  }
  const auto track =
      RunProgram({Bin("export"), "--in", Path("track"), "--table", "pose", "--format", "svg", "--out", Path("track.svg")}, Path("export.out"));
  EXPECT_EQ(track.exit_code, 0) << track.output;
  EXPECT_NE(ReadFile(Path("track.svg")).find("polyline"), std::string::npos);
}

TEST_F(Replay, ATextLogGivesTheSameBytesEachTime) {
  std::ofstream log(Path("day.nmea"));
  for (int second = 0; second < 10; ++second) {
    const std::string body =
        "GPRMC,08541" + std::to_string(second) + ".00,A,5222.32" + std::to_string(second) + "0,N,00454.5778,E,3.60,0.0,030414,,,A";
    int sum = 0;
    for (const char letter : body) sum ^= letter;
    log << '$' << body << '*' << "0123456789ABCDEF"[sum / 16] << "0123456789ABCDEF"[sum % 16] << "\r\n";
  }
  log.close();
  ExpectSameBytes(Path("day.nmea"));
  EXPECT_GT(Messages<pose_t>("first", "POSE").size(), 400U);
  EXPECT_EQ(Messages<gnss_fix_t>("first", "GNSS_FIX").size(), 10U);
}

}  // namespace
}  // namespace lookout::system_test
