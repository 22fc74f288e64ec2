// What becomes of messages of ROS.
#include "tools/import/ros_import.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/config/text_config.hpp"
#include "common/messages/checks.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "services/navigator/wire.hpp"
#include "tests/unit/import/made_recordings.hpp"
#include "tools/import/log_maker.hpp"
#include "tools/import/ros_message.hpp"
#include "tools/import/ros_sentences.hpp"
#include "tools/import/topic_map.hpp"

namespace lookout::importer {
namespace {

using namespace test;

constexpr Utime kTime{std::chrono::microseconds(kMadeStampNs / 1000)};

TEST(RosMessage, IsTheSameOutOfBothEncodings) {
  for (const auto encoding : {Encoding::kRos1, Encoding::kCdr}) {
    const auto imu = ParseImu(encoding, MakeImu(encoding));
    ASSERT_TRUE(imu);
    EXPECT_EQ(imu->header.stamp_ns, kMadeStampNs);
    EXPECT_EQ(imu->header.frame, "lidar");
    EXPECT_EQ(imu->angular_velocity_radps, (std::array{0.01, 0.02, 0.03}));
    EXPECT_EQ(imu->linear_acceleration_mps2, (std::array{0.1, 0.2, 9.8}));
    const auto fix = ParseNavSatFix(encoding, MakeFix(encoding, -43.7, 170.1, -1));
    ASSERT_TRUE(fix);
    EXPECT_EQ(fix->status, -1);
    EXPECT_EQ(fix->longitude_deg, 170.1);
    EXPECT_EQ(fix->variance_m2, (std::array{0.04, 0.09, 0.25}));
    const auto scan = MakeVelodyneScan(encoding, 3);
    const auto packets = ParsePackets(encoding, kTypeVelodyneScan, scan);
    ASSERT_TRUE(packets);
    ASSERT_EQ(packets->size(), 3U);
    EXPECT_EQ(packets->at(2).stamp_ns, kMadeStampNs + 2 * 1'327'000);
    EXPECT_EQ(packets->at(2).payload[1205], 2);
    const auto sentence = ParseSentenceMessage(encoding, MakeSentence(encoding, "$A"), true);
    ASSERT_TRUE(sentence);
    EXPECT_EQ(sentence->text, "$A");
  }
}

TEST(RosMessage, HoldsPacketsOfHesaiAndOuster) {
  for (const auto encoding : {Encoding::kRos1, Encoding::kCdr}) {
    for (const bool has_room : {true, false}) {
      const auto scan = MakeHesaiPackets(encoding, 4, has_room);
      const auto packets = ParsePackets(encoding, has_room ? kTypePandarScan : kTypeNebulaPackets, scan);
      ASSERT_TRUE(packets);
      ASSERT_EQ(packets->size(), 4U);
      EXPECT_EQ(packets->at(3).stamp_ns, kMadeStampNs + 3'000'000);
      EXPECT_EQ(packets->at(3).payload.size(), 1003U);
      EXPECT_EQ(packets->at(3).payload[1002], 3);
    }
    for (const auto type : kTypesOusterPacket) {
      const auto bytes = MakeOusterPacket(encoding, 7);
      const auto packet = ParsePackets(encoding, type, bytes);
      ASSERT_TRUE(packet && packet->size() == 1);
      EXPECT_EQ(packet->at(0).stamp_ns, 0);
      EXPECT_EQ(packet->at(0).payload.size(), 300U);
    }
  }
  auto longer = MakeHesaiPackets(Encoding::kRos1, 1, true);
  longer[longer.size() - 2] = 0xFF;  // its size is more than its room
  EXPECT_FALSE(ParsePackets(Encoding::kRos1, kTypePandarScan, longer));
}

TEST(RosMessage, CutAnywhereOrLongerIsNone) {
  for (const auto encoding : {Encoding::kRos1, Encoding::kCdr}) {
    const auto whole = MakeFix(encoding, 1.0, 2.0);
    for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_FALSE(ParseNavSatFix(encoding, Bytes(whole).first(size)));
    auto longer = whole;
    longer.resize(whole.size() + 9);
    EXPECT_FALSE(ParseNavSatFix(encoding, longer));
  }
  auto other = MakeImu(Encoding::kCdr);
  other[1] = 7;  // an encapsulation that is not known
  EXPECT_FALSE(ParseImu(Encoding::kCdr, other));
}

TEST(RosMessage, OfCountsThatItCannotHoldIsNone) {
  for (const std::uint32_t count : {0xFFFFFFFFU, 0x10000U}) {
    for (const auto type : {kTypeVelodyneScan, kTypePandarScan, kTypeNebulaPackets}) {
      EXPECT_FALSE(ParsePackets(Encoding::kRos1, type, RosWriter(Encoding::kRos1).Header().Number(count).Bytes()));
    }
    EXPECT_FALSE(ParsePackets(Encoding::kRos1, kTypesOusterPacket[0], RosWriter(Encoding::kRos1).Number(count).Bytes()));
    EXPECT_FALSE(ParsePointCloud(Encoding::kRos1, RosWriter(Encoding::kRos1).Header().Number(count).Number(count).Number(count).Bytes()));
    EXPECT_FALSE(ParsePointCloud(Encoding::kRos1, MakeCloud(Encoding::kRos1, count, count, 16, {}, Payload(64))));
    EXPECT_FALSE(ParsePointCloud(Encoding::kRos1, MakeCloud(Encoding::kRos1, 1, 4, count, {}, Payload(64))));
  }
}

TEST(RosMessage, OfNoPointsHasNoEndlessRows) {
  EXPECT_FALSE(ParsePointCloud(Encoding::kRos1, MakeCloud(Encoding::kRos1, 0x7FFFFFFFU, 0, 16, {}, {})));
  EXPECT_FALSE(ParsePointCloud(Encoding::kRos1, MakeCloud(Encoding::kRos1, 0, 0x7FFFFFFFU, 0, {}, {})));
  EXPECT_TRUE(ParsePointCloud(Encoding::kRos1, MakeCloud(Encoding::kRos1, 1, 0, 16, {}, {})));
  EXPECT_TRUE(ParsePointCloud(Encoding::kRos1, MakeCloud(Encoding::kRos1, 0, 0, 16, {}, {})));
}

TEST(RosSentences, SayAPositionToAHundredthOfAMillimetre) {
  const auto fix = *ParseNavSatFix(Encoding::kRos1, MakeFix(Encoding::kRos1, -43.70001234567, 9.5));
  const auto time = Utime(std::chrono::sys_days(std::chrono::year(2026) / 6 / 15) + std::chrono::microseconds(3'723'000'004));
  EXPECT_EQ(GgaOf(fix, time), "$GPGGA,010203.000004,4342.00074074,S,00930.00000000,E,1,,,710.1250,M,0.0,M,,*50");
  EXPECT_EQ(GstOf(fix, time), "$GPGST,010203.000004,,,,,0.3000,0.2000,0.5000*67");
  auto none = fix;
  none.status = RosNavSatFix::kNoFix;
  EXPECT_EQ(GgaOf(none, time), "$GPGGA,010203.000004,,,,,0,,,,M,,M,,*4C");
  none.status = RosNavSatFix::kGbasFix;
  none.latitude_deg = NAN;
  EXPECT_EQ(GgaOf(none, time), "$GPGGA,010203.000004,,,,,0,,,,M,,M,,*4C");
  none.has_variance = false;
  EXPECT_EQ(GstOf(none, time), "");
}

TEST(RosSentences, SayAVelocityAsCourseAndSpeed) {
  const auto vtg = [](double east_mps, double north_mps) {
    return VtgOf(*ParseTwist(Encoding::kRos1, MakeTwist(Encoding::kRos1, east_mps, north_mps), false));
  };
  EXPECT_EQ(vtg(0.0, 0.0).substr(0, 10), "$GPVTG,,T,");
  EXPECT_EQ(vtg(-1.852, 0.0).substr(0, 31), "$GPVTG,270.0000,T,,M,3.60000,N,");
  EXPECT_EQ(vtg(-1e-9, 1.0).substr(0, 17), "$GPVTG,359.9999,T");
  EXPECT_EQ(vtg(NAN, 1.0), "");
  EXPECT_EQ(vtg(200.0, 1.0), "");
}

Topics MakeTopics(const std::vector<std::pair<std::string, std::string>>& topics) {
  Topics made;
  for (const auto& [name, type] : topics) made.emplace(static_cast<std::uint32_t>(made.size()), Topic{name, type, Encoding::kRos1, 5});
  return made;
}

TEST(TopicMap, IsGuessedByTypeAndName) {
  const auto packets = MakeTopics({{"/velodyne_points", "sensor_msgs/PointCloud2"}, {"/velodyne_packets", "velodyne_msgs/VelodyneScan"}});
  EXPECT_EQ(GuessTopics(packets), (TopicMap{{"/velodyne_packets", {Use::kLidarPackets}}}));
  EXPECT_EQ(GuessTopics(MakeTopics({{"/pandar_packets", "pandar_msgs/PandarScan"}})), (TopicMap{{"/pandar_packets", {Use::kLidarPackets}}}));
  const auto ouster = MakeTopics({{"/ouster/imu_packets", "ouster_sensor_msgs/PacketMsg"},
                                  {"/ouster/lidar_packets", "ouster_sensor_msgs/PacketMsg"},
                                  {"/ouster/points", "sensor_msgs/PointCloud2"}});
  EXPECT_EQ(GuessTopics(ouster), (TopicMap{{"/ouster/imu_packets", {Use::kPositionPackets}}, {"/ouster/lidar_packets", {Use::kLidarPackets}}}));
  const auto boat = MakeTopics({{"/os1_node/imu", "sensor_msgs/Imu"},
                                {"/imu/data", "sensor_msgs/Imu"},
                                {"/obstacles/points", "sensor_msgs/PointCloud2"},
                                {"/ouster/points", "sensor_msgs/PointCloud2"},
                                {"/camera/depth/points", "sensor_msgs/PointCloud2"},
                                {"/gps/fix", "sensor_msgs/NavSatFix"},
                                {"/gps/filtered", "sensor_msgs/NavSatFix"},
                                {"/gps/vel", "geometry_msgs/TwistStamped"},
                                {"/cmd_vel", "geometry_msgs/TwistStamped"},
                                {"/odom", "nav_msgs/Odometry"}});
  const auto map = GuessTopics(boat);
  EXPECT_EQ(
      map,
      (TopicMap{{"/imu/data", {Use::kImuFlu}}, {"/ouster/points", {Use::kLidarScan}}, {"/gps/fix", {Use::kFix}}, {"/gps/vel", {Use::kVelocity}}}));
  EXPECT_NE(TopicMapText(boat, map).find("/odom none  # nav_msgs/Odometry, 5 messages; odometry is not used\n"), std::string::npos);
  // Sentences are what a receiver sent; a fix beside them would count twice.
  const auto sentences =
      MakeTopics({{"/fix", "sensor_msgs/NavSatFix"}, {"/nmea_sentence", "nmea_msgs/Sentence"}, {"/camera", "sensor_msgs/PointCloud2"}});
  EXPECT_EQ(GuessTopics(sentences), (TopicMap{{"/nmea_sentence", {Use::kSentences}}}));
}

TEST(TopicMap, IsReadAsItIsPrinted) {
  const auto topics = MakeTopics({{"/imu", "sensor_msgs/Imu"}, {"/a", "sensor_msgs/PointCloud2"}, {"/fix", "sensor_msgs/NavSatFix"}});
  const TopicMap map{{"/imu", {Use::kImu, TimeBasis::kRecorded}}, {"/a", {Use::kLidarScan, TimeBasis::kStamp}}, {"/fix", {Use::kNone}}};
  EXPECT_EQ(ParseTopicMap(TopicMapText(topics, map), "topics.txt", topics), map);
}

TEST(TopicMap, OfFaultsTellsEachWithItsLine) {
  const auto topics = MakeTopics({{"/imu", "sensor_msgs/Imu"}, {"/a", "sensor_msgs/PointCloud2"}, {"/b", "sensor_msgs/PointCloud2"}});
  try {
    ParseTopicMap("/imu fix\n/none imu\n# note\n/imu imu time=soon\n/a scan\n/a lidar_scan\n/b lidar_scan\n", "topics.txt", topics);
    FAIL();
  } catch (const config::ConfigError& error) {
    ASSERT_EQ(error.faults().size(), 6U) << error.what();
    EXPECT_EQ(error.faults()[0], "topics.txt:1: /imu is of type sensor_msgs/Imu, which cannot be fix");
    EXPECT_EQ(error.faults()[1], "topics.txt:2: the recording has no topic /none");
    EXPECT_EQ(error.faults()[2], "topics.txt:4: 'time=soon' is not time=auto, time=stamp or time=recorded");
    EXPECT_EQ(error.faults()[3], "topics.txt:4: /imu stands in a line before");
    EXPECT_EQ(error.faults()[5], "topics.txt:7: a log holds one lidar, and /a is it");
  }
}

// Messages of a log by channel.
class Import : public ::testing::Test {
 protected:
  void Run(const std::vector<Made>& messages, const TopicMap& map) {
    lidar::Params params;
    LogMaker log(params, true, [this](Utime time, const bus::Channel& channel, Bytes bytes) {
      num_set_back_ += time < last_ ? 1 : 0;
      last_ = time;
      by_channel_[std::string(channel.name)].emplace_back(bytes.begin(), bytes.end());
    });
    RosImport import(map, log);
    for (const auto& message : messages) {
      const Topic topic{message.topic, message.type, Encoding::kRos1};
      import.Take({message.time_ns, &topic, message.bytes});
    }
    log.Finish();
    num_late_ = log.num_late();
    EXPECT_EQ(num_set_back_, expected_set_back_);
    tallies_ = import.tallies();
  }

  std::vector<nav_raw_t> Navigation() const {
    std::vector<nav_raw_t> items;
    for (const auto& bytes : by_channel_.at("NAV_RAW")) {
      items.push_back(bus::Decode<nav_raw_t>(bytes).value());
      EXPECT_TRUE(std::holds_alternative<navigator::Item>(navigator::ToItem(items.back())));
    }
    return items;
  }

  Utime last_{};
  int num_set_back_ = 0;
  int expected_set_back_ = 0;
  std::int64_t num_late_ = 0;
  std::map<std::string, std::vector<Payload>> by_channel_;
  std::map<std::string, TopicTally> tallies_;
};

TEST_F(Import, PutsWhatWasRecordedLateInItsPlace) {
  // A scan is recorded when its last packet is there, after the sentences that came meanwhile.
  std::vector<Made> messages;
  for (int i = 0; i < 10; ++i) {
    const auto time_ns = kMadeStampNs + i * 10'000'000LL;
    messages.push_back({"/nmea", "nmea_msgs/Sentence", time_ns, MakeSentence(Encoding::kRos1, "$GPHDT,9" + std::to_string(i) + ".0,T", time_ns)});
  }
  messages.push_back({"/packets", "velodyne_msgs/VelodyneScan", kMadeStampNs + 95'000'000, MakeVelodyneScan(Encoding::kRos1, 60)});
  Run(messages, {{"/nmea", {Use::kSentences}}, {"/packets", {Use::kLidarPackets}}});
  const auto items = Navigation();
  EXPECT_EQ(items.front().kind, nav_raw_t::KIND_START);
  EXPECT_EQ(items.back().kind, nav_raw_t::KIND_END);
  EXPECT_EQ(items[1].source, "imported:/nmea");
  std::int64_t num_packets = 0;
  std::int64_t last_us = 0;
  for (const auto& bytes : by_channel_["LIDAR_PACKETS"]) {
    const auto bundle = bus::Decode<lidar_packets_t>(bytes).value();
    num_packets += bundle.num_packets;
    for (const auto time_us : bundle.host_utime_us) {
      EXPECT_GE(time_us, last_us);
      last_us = time_us;
    }
  }
  EXPECT_EQ(num_packets, 60);
  EXPECT_EQ(tallies_.at("/nmea").num_used, 10);
}

TEST_F(Import, UsesTheTimeOfRecordingWhereAStampIsOfAnotherClock) {
  std::vector<Made> messages;
  for (int i = 0; i < 5; ++i) {
    const auto time_ns = kMadeStampNs + i * 100'000'000LL;
    messages.push_back({"/nmea", "nmea_msgs/Sentence", time_ns, MakeSentence(Encoding::kRos1, "$GPHDT,90.0,T", i * 100'000'000LL)});
  }
  messages.push_back({"/packets", "velodyne_msgs/VelodyneScan", kMadeStampNs + 500'000'000, MakeVelodyneScan(Encoding::kRos1, 3, 1'000'000'000)});
  Run(messages, {{"/nmea", {Use::kSentences}}, {"/packets", {Use::kLidarPackets}}});
  EXPECT_EQ(tallies_.at("/nmea").num_other_time, 5);
  const auto bundle = bus::Decode<lidar_packets_t>(by_channel_["LIDAR_PACKETS"].at(0)).value();
  EXPECT_EQ(bundle.host_utime_us,
            (std::vector<std::int64_t>{kMadeStampNs / 1000 + 500'000 - 2654, kMadeStampNs / 1000 + 500'000 - 1327, kMadeStampNs / 1000 + 500'000}));
}

TEST_F(Import, CountsWhatIsNotOfItsType) {
  auto spoiled = MakeImu(Encoding::kRos1);
  spoiled.resize(100);
  auto infinite = MakeImu(Encoding::kRos1);
  std::fill_n(infinite.begin() + 21 + 8 * 13, 8, std::uint8_t{0x7F});
  Run({{"/imu", "sensor_msgs/Imu", kMadeStampNs, MakeImu(Encoding::kRos1)},
       {"/imu", "sensor_msgs/Imu", kMadeStampNs, spoiled},
       {"/imu", "sensor_msgs/Imu", kMadeStampNs, infinite},
       {"/nmea", "nmea_msgs/Sentence", kMadeStampNs, MakeSentence(Encoding::kRos1, "\x01 no sentence")}},
      {{"/imu", {Use::kImuFlu}}, {"/nmea", {Use::kSentences}}});
  EXPECT_EQ(tallies_.at("/imu").num_used, 1);
  EXPECT_EQ(tallies_.at("/imu").num_refused, 1);
  EXPECT_EQ(tallies_.at("/imu").num_empty, 1);
  EXPECT_EQ(tallies_.at("/nmea").num_empty, 1);
  const auto items = Navigation();
  ASSERT_EQ(items[1].kind, nav_raw_t::KIND_IMU);
  // From x forward, y left, z up to y right, z down.
  EXPECT_EQ(items[1].imu[0].specific_force_mps2[2], -9.8);
  EXPECT_EQ(items[1].imu[0].angular_velocity_radps[0], 0.01);
  EXPECT_EQ(items[1].imu[0].angular_velocity_radps[1], -0.02);
}

// By 100 s: what came before is out, marks stand between, and nothing is late.
TEST_F(Import, BeginsAnewWhereTheClockWasSetBack) {
  expected_set_back_ = 1;
  constexpr std::int64_t kSetBackNs = 100'000'000'000;
  std::vector<Made> messages;
  for (const std::int64_t era_ns : {std::int64_t{0}, -kSetBackNs}) {
    for (int i = 0; i < 5; ++i) {
      const auto time_ns = kMadeStampNs + era_ns + i * 10'000'000LL;
      messages.push_back({"/packets", "velodyne_msgs/VelodyneScan", time_ns, MakeVelodyneScan(Encoding::kRos1, 1, time_ns)});
      messages.push_back({"/imu", "sensor_msgs/Imu", time_ns, MakeImu(Encoding::kRos1, time_ns)});
    }
  }
  Run(messages, {{"/imu", {Use::kImu}}, {"/packets", {Use::kLidarPackets}}});
  EXPECT_EQ(num_late_, 0);
  std::vector<std::vector<std::int64_t>> times_us;
  std::vector<std::int32_t> marks;
  for (const auto& bytes : by_channel_["LIDAR_PACKETS"]) {
    const auto bundle = bus::Decode<lidar_packets_t>(bytes).value();
    times_us.push_back(bundle.host_utime_us);
    marks.push_back(bundle.marks);
  }
  ASSERT_EQ(times_us.size(), 2U);
  constexpr std::int32_t kBoth = std::int32_t{lidar_packets_t::MARK_START} | std::int32_t{lidar_packets_t::MARK_END};
  EXPECT_EQ(marks, (std::vector<std::int32_t>{kBoth, kBoth}));
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(times_us[0].at(i), kMadeStampNs / 1000 + static_cast<std::int64_t>(i) * 10'000);
    EXPECT_EQ(times_us[1].at(i), times_us[0].at(i) - kSetBackNs / 1000);
  }
  std::int64_t num_starts = 0;
  std::int64_t num_samples = 0;
  for (const auto& item : Navigation()) {
    num_starts += item.kind == nav_raw_t::KIND_START ? 1 : 0;
    num_samples += item.kind == nav_raw_t::KIND_IMU ? 1 : 0;
  }
  EXPECT_EQ(num_starts, 2);
  EXPECT_EQ(num_samples, 10);
}

TEST_F(Import, CountsLinesThatAreLostAndRefusesTextWithoutEnd) {
  const auto make = [](const std::string& text) { return Made{"/nmea", "nmea_msgs/Sentence", kMadeStampNs, MakeSentence(Encoding::kRos1, text)}; };
  Run({make("$GPHDT,1.0,T\r\nnothing\r\n$" + std::string(400, 'x') + "\r\n$\x01\r\n$GPHDT,2.0,T\r\n"),
       make("$GPHDT,1.0,T\n" + std::string(64 << 10, '$'))},
      {{"/nmea", {Use::kSentences}}});
  EXPECT_EQ(tallies_.at("/nmea").num_used, 1);
  EXPECT_EQ(tallies_.at("/nmea").num_lines_lost, 3);
  EXPECT_EQ(tallies_.at("/nmea").num_refused, 1);
  EXPECT_EQ(Navigation().size(), 4U);
}

TEST_F(Import, RefusesTimesThatNoClockHas) {
  for (const auto time_ns : {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    Run({{"/imu", "sensor_msgs/Imu", time_ns, MakeImu(Encoding::kRos1)}}, {{"/imu", {Use::kImu, TimeBasis::kRecorded}}});
    EXPECT_EQ(tallies_.at("/imu").num_refused, 1);
  }
}

TEST(ImportSource, OfATopicIsAWordOfLimitedLength) {
  EXPECT_EQ(RosImport::SourceOf("/fix"), "imported:/fix");
  EXPECT_EQ(RosImport::SourceOf("/a b\x01"), "imported:/a_b_");
  EXPECT_EQ(RosImport::SourceOf(std::string(200, 'x') + "y").size(), 64U);
}

}  // namespace
}  // namespace lookout::importer
