// What becomes of messages of ROS.
#include "tools/import/ros_import.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/messages/checks.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "services/navigator/wire.hpp"
#include "tests/unit/import/made_recordings.hpp"
#include "tools/import/cloud_scan.hpp"
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
    const auto scan = ParseVelodyneScan(encoding, MakeVelodyneScan(encoding, 3));
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->packets.size(), 3U);
    EXPECT_EQ(scan->packets[2].stamp_ns, kMadeStampNs + 2 * 1'327'000);
    EXPECT_EQ(scan->packets[2].payload[1205], 2);
    const auto sentence = ParseSentenceMessage(encoding, MakeSentence(encoding, "$A"), true);
    ASSERT_TRUE(sentence);
    EXPECT_EQ(sentence->text, "$A");
  }
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
    EXPECT_FALSE(ParseVelodyneScan(Encoding::kRos1, RosWriter(Encoding::kRos1).Header().Number(count).Bytes()));
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

// A lidar of 3 rings, 400 columns at 1 ms, 10 us from ring to ring; walls at 10 and 30 m. Ring 0 is the topmost.
struct MadeTurn {
  static constexpr int kNumRings = 3;
  static constexpr int kNumColumns = 400;
  static constexpr std::array<double, 3> kElevationsDeg{10.0, 1.0, -6.0};
  static constexpr double kHeightM = 0.04;
  static double RangeM(int column) { return column % 2 == 0 ? 10.0 : 30.0; }
  static std::array<double, 3> PlaceM(int ring, int column, double azimuth_rad) {
    const double level_m = RangeM(column) * std::cos(DegToRad(kElevationsDeg.at(static_cast<std::size_t>(ring))));
    return {level_m * std::cos(azimuth_rad), -level_m * std::sin(azimuth_rad),
            kHeightM + RangeM(column) * std::sin(DegToRad(kElevationsDeg.at(static_cast<std::size_t>(ring))))};
  }
};

enum class Layout { kVelodyne, kPacketTimes, kRings, kHesai, kOrganised, kBare };

Payload MakeTurnCloud(Layout layout) {
  Writer data;
  const auto write = [&](int ring, int column) {
    const double azimuth_rad = kTwoPi * (column + 0.01 * ring) / MadeTurn::kNumColumns;
    for (const double place_m : MadeTurn::PlaceM(ring, column, azimuth_rad)) data.Number(static_cast<float>(place_m));
    const auto time_ns = column * 1'000'000LL + ring * 10'000LL;
    // Some drivers count from the begin of each packet.
    const auto since_ns = layout == Layout::kPacketTimes ? time_ns % 4'000'000 : time_ns;
    if (layout == Layout::kVelodyne || layout == Layout::kPacketTimes) {
      data.Number(42.0F).Number(static_cast<std::uint16_t>(ring)).Number(static_cast<float>(1e-9 * static_cast<double>(since_ns)));
    }
    if (layout == Layout::kRings) data.Number(static_cast<std::uint16_t>(ring));
    if (layout == Layout::kHesai)
      data.Number(42.0F)
          .Number(static_cast<double>(kMadeStampNs / 1'000'000'000) + 1e-9 * static_cast<double>(time_ns))
          .Number(static_cast<std::uint16_t>(ring));
    if (layout == Layout::kOrganised) data.Number(static_cast<std::uint32_t>(time_ns)).Number(std::uint16_t{42});
  };
  if (layout == Layout::kOrganised) {
    for (int ring = 0; ring < MadeTurn::kNumRings; ++ring) {
      for (int column = 0; column < MadeTurn::kNumColumns; ++column) write(ring, column);
    }
    return MakeCloud(Encoding::kRos1, MadeTurn::kNumRings, MadeTurn::kNumColumns, 18,
                     {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"t", 12, 6}, {"reflectivity", 16, 4}}, data.bytes);
  }
  for (int column = 0; column < MadeTurn::kNumColumns; ++column) {
    for (int ring = 0; ring < MadeTurn::kNumRings; ++ring) write(ring, column);
  }
  const auto num_points = static_cast<std::uint32_t>(MadeTurn::kNumRings * MadeTurn::kNumColumns);
  if (layout == Layout::kRings) {
    return MakeCloud(Encoding::kRos1, 1, num_points, 14, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 4}}, data.bytes);
  }
  if (layout == Layout::kVelodyne || layout == Layout::kPacketTimes) {
    return MakeCloud(Encoding::kRos1, 1, num_points, 22,
                     {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"intensity", 12, 7}, {"ring", 16, 4}, {"time", 18, 7}}, data.bytes);
  }
  if (layout == Layout::kHesai) {
    return MakeCloud(Encoding::kRos1, 1, num_points, 26,
                     {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"intensity", 12, 7}, {"timestamp", 16, 8}, {"ring", 24, 4}}, data.bytes);
  }
  return MakeCloud(Encoding::kRos1, 1, num_points, 12, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}}, data.bytes);
}

TEST(CloudScans, OfEachDriverGiveTheSameScan) {
  for (const auto layout : {Layout::kVelodyne, Layout::kHesai, Layout::kOrganised}) {
    SCOPED_TRACE(static_cast<int>(layout));
    const auto bytes = MakeTurnCloud(layout);
    const auto cloud = ParsePointCloud(Encoding::kRos1, bytes);
    ASSERT_TRUE(cloud);
    CloudScans scans;
    const auto parts = scans.Convert(*cloud, kMadeStampNs, "model");
    ASSERT_EQ(parts.size(), 1U);
    const auto& scan = parts[0];
    ASSERT_EQ(scan.num_rings, MadeTurn::kNumRings);
    ASSERT_EQ(scan.num_turn_columns, MadeTurn::kNumColumns);
    EXPECT_EQ(scan.utime_us, kMadeStampNs / 1000);
    EXPECT_NEAR(static_cast<double>(scan.end_utime_us - scan.utime_us), 399'021.0, 2.0);
    EXPECT_DOUBLE_EQ(scan.range_unit_m, 0.002);
    for (int ring = 0; ring < MadeTurn::kNumRings; ++ring) {
      const auto up = static_cast<std::size_t>(MadeTurn::kNumRings - 1 - ring);  // from the lowest
      EXPECT_NEAR(scan.elevation_rad[up], DegToRad(MadeTurn::kElevationsDeg.at(static_cast<std::size_t>(ring))), 1e-6);
      EXPECT_NEAR(scan.origin_height_m[up], MadeTurn::kHeightM, 1e-5);
      EXPECT_NEAR(scan.time_offset_ns[up], ring * 10'000, 100);
      for (int column = 0; column < MadeTurn::kNumColumns; ++column) {
        const auto place = static_cast<std::size_t>(column);
        const double azimuth_rad = kTwoPi * (column + 0.01 * ring) / MadeTurn::kNumColumns;
        EXPECT_NEAR(WrapToPi(scan.azimuth_rad[place] + scan.azimuth_offset_rad[up] - azimuth_rad), 0.0, 1e-6);
        EXPECT_NEAR(scan.time_ns[place] + scan.time_offset_ns[up], column * 1'000'000 + ring * 10'000, 300);
        const auto cell = place * MadeTurn::kNumRings + up;
        EXPECT_EQ(scan.range[cell], static_cast<std::int16_t>(MadeTurn::RangeM(column) / 0.002));
        EXPECT_EQ(scan.reflectivity[cell], 42);
      }
    }
    EXPECT_EQ(scans.counts().num_hidden + scans.counts().num_no_ring, 0);
    EXPECT_TRUE(scans.Remarks().empty());
  }
}

// Times that say nothing of the firing, or none: the azimuths tell which points are of one firing, also where rings look to different sides.
TEST(CloudScans, WithoutUsableTimesGoByTheAzimuthsOfTheShots) {
  for (const auto layout : {Layout::kPacketTimes, Layout::kRings}) {
    SCOPED_TRACE(static_cast<int>(layout));
    const auto bytes = MakeTurnCloud(layout);
    CloudScans scans;
    const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_EQ(scans.counts().num_hidden, 0);
    ASSERT_EQ(parts[0].num_turn_columns, MadeTurn::kNumColumns);
    std::vector<std::int16_t> ranges;
    for (std::size_t column = 0; column < static_cast<std::size_t>(MadeTurn::kNumColumns); ++column) {
      const double turned = WrapTo2Pi(parts[0].azimuth_rad[column] + parts[0].azimuth_offset_rad[2] + 1e-6) / kTwoPi * MadeTurn::kNumColumns;
      EXPECT_NEAR(turned - std::floor(turned), 0.0, 1e-3);
      EXPECT_EQ(parts[0].range[column * 3 + 2], static_cast<std::int16_t>(MadeTurn::RangeM(static_cast<int>(turned)) / 0.002));
    }
  }
}

TEST(CloudScans, WithoutRingsAndTimesSayWhatTheyLack) {
  const auto bytes = MakeTurnCloud(Layout::kBare);
  const auto cloud = ParsePointCloud(Encoding::kRos1, bytes);
  CloudScans scans;
  const auto parts = scans.Convert(*cloud, kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].end_utime_us, parts[0].utime_us);
  EXPECT_EQ(scans.Remarks().size(), 3U);
  EXPECT_GE(parts[0].num_rings, MadeTurn::kNumRings);
  EXPECT_LE(scans.counts().num_hidden, 12);
}

// A turn of 4 rings and 360 columns with times, and a second return of every tenth shot, 5 m behind the first.
Payload MakeDualTurn(bool has_times, bool is_same_direction) {
  Writer data;
  std::uint32_t num_points = 0;
  const auto put = [&](int column, int ring, double range_m, double off_rad) {
    const double elevation_rad = DegToRad(2.0 * ring - 3.0);
    const double azimuth_rad = kTwoPi * column / 360 + off_rad;
    data.Number(static_cast<float>(range_m * std::cos(elevation_rad) * std::cos(azimuth_rad)));
    data.Number(static_cast<float>(-range_m * std::cos(elevation_rad) * std::sin(azimuth_rad)));
    data.Number(static_cast<float>(range_m * std::sin(elevation_rad))).Number(static_cast<std::uint16_t>(ring));
    data.Number(static_cast<float>(has_times ? 0.1 * column / 360 : 0.0)).Number(static_cast<std::uint32_t>(range_m));
    ++num_points;
  };
  for (int column = 0; column < 360; ++column) {
    for (int ring = 0; ring < 4; ++ring) {
      const bool has_second = (column + ring) % 10 == 0;
      if (has_second) put(column, ring, 25.0, is_same_direction ? 0.0 : 0.003);
      put(column, ring, 20.0, 0.0);
    }
  }
  return MakeCloud(Encoding::kRos1, 1, num_points, 22, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 4}, {"time", 14, 7}, {"label", 18, 6}},
                   data.bytes);
}

TEST(CloudScans, KeepBothReturnsOfAShot) {
  for (const bool has_times : {true, false}) {
    CloudScans scans;
    const auto bytes = MakeDualTurn(has_times, true);
    const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
    ASSERT_EQ(parts.size(), 1U);
    const auto& scan = parts[0];
    EXPECT_FALSE(messages::FaultOf(scan, bus::kMaxMessageBytes));
    ASSERT_EQ(scan.num_returns, 2);
    EXPECT_EQ(scan.return_kind, (std::vector<std::int32_t>{lidar_scan_t::RETURN_STRONGEST, lidar_scan_t::RETURN_LAST}));
    ASSERT_EQ(scan.num_columns, 360);
    EXPECT_EQ(scans.counts().num_hidden, 0);
    for (std::size_t shot = 0; shot < 360 * 4; ++shot) {
      const bool has_second = (shot / 4 + shot % 4) % 10 == 0;
      EXPECT_EQ(scan.range[2 * shot], 10'000);
      EXPECT_EQ(scan.range[2 * shot + 1], has_second ? 12'500 : 0);
      EXPECT_EQ(scans.cell_labels()[2 * shot + 1], has_second ? 25U : 0U);
    }
    EXPECT_TRUE(std::ranges::any_of(scans.Remarks(), [](const auto& remark) { return remark.find("two returns") != std::string::npos; }));
  }
}

// Points that share a cell by the rounding of a grid are no second returns.
TEST(CloudScans, TakeNoOtherShotForASecondReturn) {
  CloudScans scans;
  const auto bytes = MakeDualTurn(false, false);
  const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].num_returns, 1);
  EXPECT_EQ(scans.counts().num_hidden, 144);
}

// Of a cloud without rings 100 rings share 64 bands, and stand above each other.
TEST(CloudScans, TakeNoOtherRingOfABandForASecondReturn) {
  Writer data;
  for (int column = 0; column < 360; ++column) {
    for (int ring = 0; ring < 100; ++ring) {
      const double level_m = 20.0 + ring % 2;
      data.Number(static_cast<float>(level_m * std::cos(DegToRad(column)))).Number(static_cast<float>(-level_m * std::sin(DegToRad(column))));
      data.Number(static_cast<float>(level_m * std::tan(DegToRad(0.2 * ring))));
    }
  }
  const auto bytes = MakeCloud(Encoding::kRos1, 1, 36'000, 12, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}}, data.bytes);
  CloudScans scans;
  const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
  ASSERT_FALSE(parts.empty());
  EXPECT_EQ(parts[0].num_returns, 1);
  EXPECT_GT(scans.counts().num_hidden, 10'000);
}

// Points at 20 m, at each of these elevations once in a degree.
Payload MakeBareTurn(const std::vector<double>& elevations_deg) {
  Writer data;
  for (int column = 0; column < 360; ++column) {
    for (const double elevation_deg : elevations_deg) {
      const double level_m = 20.0 * std::cos(DegToRad(elevation_deg));
      data.Number(static_cast<float>(level_m * std::cos(DegToRad(column)))).Number(static_cast<float>(-level_m * std::sin(DegToRad(column))));
      data.Number(static_cast<float>(20.0 * std::sin(DegToRad(elevation_deg))));
    }
  }
  return MakeCloud(Encoding::kRos1, 1, static_cast<std::uint32_t>(360 * elevations_deg.size()), 12, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}},
                   data.bytes);
}

TEST(CloudScans, WithoutRingsHaveBandsOfAllThatWasLearned) {
  const auto flat = MakeBareTurn({0.0, 1.0, 2.0});
  const auto tall = MakeBareTurn({-15.0, -5.0, 5.0, 15.0});
  const auto taller = MakeBareTurn({-15.0, -5.0, 5.0, 15.0, 25.0});
  CloudScans scans;
  EXPECT_TRUE(scans.Learn(*ParsePointCloud(Encoding::kRos1, flat)));
  EXPECT_TRUE(scans.Learn(*ParsePointCloud(Encoding::kRos1, tall)));
  auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, tall), kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_NEAR(parts[0].elevation_rad.front(), DegToRad(-15.0), 1e-4);
  EXPECT_NEAR(parts[0].elevation_rad.back(), DegToRad(15.0), 1e-4);
  EXPECT_EQ(scans.counts().num_out_of_range + scans.counts().num_hidden, 0);
  // What comes later outside of the bands is none of theirs.
  parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, taller), kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_NEAR(parts[0].elevation_rad.back(), DegToRad(15.0), 1e-4);
  EXPECT_EQ(scans.counts().num_out_of_range, 360);
}

// Lines that are no rings: the first cloud alone does not show how far they go.
TEST(CloudScans, OfScatteredRingsHaveBandsOfAllThatWasLearned) {
  const auto make = [](double highest_deg) {
    Writer data;
    for (int i = 0; i < 2000; ++i) {
      const double elevation_rad = DegToRad(highest_deg * std::sin(0.7 * i));
      const double azimuth_rad = DegToRad(0.02 * i);
      data.Number(static_cast<float>(20.0 * std::cos(elevation_rad) * std::cos(azimuth_rad)));
      data.Number(static_cast<float>(-20.0 * std::cos(elevation_rad) * std::sin(azimuth_rad)));
      data.Number(static_cast<float>(20.0 * std::sin(elevation_rad))).Number(static_cast<std::uint16_t>(i % 4));
    }
    return MakeCloud(Encoding::kRos1, 1, 2000, 14, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"line", 12, 4}}, data.bytes);
  };
  const auto low = make(5.0);
  const auto high = make(20.0);
  CloudScans scans;
  scans.Learn(*ParsePointCloud(Encoding::kRos1, low));
  scans.Learn(*ParsePointCloud(Encoding::kRos1, high));
  const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, high), kMadeStampNs, "model");
  ASSERT_FALSE(parts.empty());
  EXPECT_LT(parts[0].elevation_rad.front(), DegToRad(-19.0));
  EXPECT_GT(parts[0].elevation_rad.back(), DegToRad(19.0));
  EXPECT_EQ(scans.counts().num_out_of_range + scans.counts().num_no_ring, 0);
}

// A turn of 16 rings and 100 columns at 1 ms, with these times.
template <typename T, typename TimeOf>
Payload MakeTimedTurn(const std::string& field, std::uint8_t type, const TimeOf& time_of) {
  Writer data;
  for (int column = 0; column < 100; ++column) {
    for (int ring = 0; ring < 16; ++ring) {
      const double elevation_rad = DegToRad(2.0 * ring - 15.0);
      const double azimuth_rad = kTwoPi * column / 100;
      data.Number(static_cast<float>(20.0 * std::cos(elevation_rad) * std::cos(azimuth_rad)));
      data.Number(static_cast<float>(-20.0 * std::cos(elevation_rad) * std::sin(azimuth_rad)));
      data.Number(static_cast<float>(20.0 * std::sin(elevation_rad))).Number(static_cast<std::uint16_t>(ring));
      data.Number(static_cast<T>(time_of(column, ring)));
    }
  }
  return MakeCloud(Encoding::kRos1, 1, 1600, static_cast<std::uint32_t>(14 + sizeof(T)),
                   {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 4}, {field, 14, type}}, data.bytes);
}

TEST(CloudScans, AreNotMovedByAPointWithoutATime) {
  const double stamp_s = static_cast<double>(kMadeStampNs / 1'000'000'000);
  for (const double begin_s : {stamp_s, 5000.0}) {
    for (const double bad_s : {0.0, static_cast<double>(NAN), 1e300, stamp_s + 3.0}) {
      const auto bytes =
          MakeTimedTurn<double>("timestamp", 8, [&](int column, int ring) { return column == 50 && ring == 3 ? bad_s : begin_s + 1e-3 * column; });
      CloudScans scans;
      const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
      ASSERT_EQ(parts.size(), 1U);
      EXPECT_NEAR(static_cast<double>(parts[0].utime_us - kMadeStampNs / 1000), 0.0, 2.0) << begin_s << " " << bad_s;
      EXPECT_NEAR(static_cast<double>(parts[0].end_utime_us - parts[0].utime_us), 99'000.0, 2.0) << begin_s << " " << bad_s;
      EXPECT_EQ(parts[0].num_turn_columns, 100);
      EXPECT_EQ(scans.counts().num_no_time, 1);
      EXPECT_EQ(scans.counts().num_hidden, 0);
      EXPECT_EQ(scans.Remarks().size(), begin_s == 5000.0 ? 2U : 1U);  // another clock, and no reflectivity
    }
  }
}

TEST(CloudScans, OfTimesInAnotherUnitHaveNone) {
  const auto microseconds = MakeTimedTurn<float>("time", 7, [](int column, int ring) { return 1000.0 * column + ring; });
  const auto none = MakeTimedTurn<float>("time", 7, [](int, int) { return NAN; });
  for (const auto& bytes : {microseconds, none}) {
    CloudScans scans;
    const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_EQ(parts[0].utime_us, kMadeStampNs / 1000);
    EXPECT_EQ(parts[0].end_utime_us, parts[0].utime_us);
    EXPECT_EQ(scans.counts().num_times_refused, 1);
    EXPECT_EQ(scans.counts().num_hidden, 0);
    EXPECT_NE(scans.Remarks().at(0).find("1 clouds have times of points"), std::string::npos);
  }
}

TEST(CloudScans, TakeAWiderUnitWhereAPointIsFartherThan131Metres) {
  Writer data;
  for (int i = 0; i < 40; ++i) data.Number(i == 7 ? 300.0F : 10.0F).Number(static_cast<float>(i) * 0.1F).Number(0.0F).Number(std::uint16_t{0});
  const auto bytes = MakeCloud(Encoding::kRos1, 1, 40, 14, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 4}}, data.bytes);
  CloudScans scans;
  const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_DOUBLE_EQ(parts[0].range_unit_m, 0.006);
}

TEST(CloudScans, RefuseCloudsThatAreNone) {
  CloudScans scans;
  const auto refuse = [&](const Payload& bytes) {
    const auto cloud = ParsePointCloud(Encoding::kRos1, bytes);
    ASSERT_TRUE(cloud);
    EXPECT_TRUE(scans.Convert(*cloud, kMadeStampNs, "model").empty());
  };
  refuse(MakeCloud(Encoding::kRos1, 1, 4, 8, {{"x", 0, 7}, {"y", 4, 7}}, Payload(32)));
  refuse(MakeCloud(Encoding::kRos1, 1, 4, 8, {{"x", 0, 7}, {"y", 4, 7}, {"z", 6, 7}}, Payload(32)));  // beyond the point
  refuse(MakeCloud(Encoding::kRos1, 0, 0, 12, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}}, {}));
  EXPECT_EQ(scans.counts().num_refused, 3);
}

}  // namespace
}  // namespace lookout::importer
