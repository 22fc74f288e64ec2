// Folders of scans: PCD, KITTI, SeePerSea.
#include <bit>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "services/navigator/core/nmea.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/import/made_folders.hpp"
#include "tools/import/box_labels.hpp"
#include "tools/import/cloud_points.hpp"
#include "tools/import/folder_recording.hpp"
#include "tools/import/oxts.hpp"
#include "tools/import/pcd_file.hpp"
#include "tools/import/ros_import.hpp"
#include "tools/import/ros_message.hpp"
#include "tools/import/topic_map.hpp"

namespace lookout::importer {
namespace {

using namespace test;
namespace fs = std::filesystem;

constexpr std::int64_t kFolderNs = 1'000'000'000;

RingCloud CloudOf(Bytes message) {
  const auto cloud = ParsePointCloud(Encoding::kRos1, message);
  EXPECT_TRUE(cloud);
  std::string why;
  const auto points = cloud ? ToRingCloud(*cloud, why) : std::nullopt;
  EXPECT_TRUE(points) << why;
  return points.value_or(RingCloud());
}

TEST(Lzf, UnpacksAndRefusesWhatIsDamaged) {
  const std::string plain = "abc" + std::string(300, 'x') + "def" + std::string(20, '\0');
  const auto packed = PackLzf(plain);
  EXPECT_LT(packed.size(), 60U);
  std::string unpacked;
  ASSERT_TRUE(UnpackLzf(packed, plain.size(), unpacked));
  EXPECT_EQ(unpacked, plain);
  for (std::size_t size = 0; size < packed.size(); ++size) EXPECT_FALSE(UnpackLzf(packed.substr(0, size), plain.size(), unpacked)) << size;
  EXPECT_FALSE(UnpackLzf(packed, plain.size() - 1, unpacked));
  EXPECT_FALSE(UnpackLzf(packed, plain.size() + 1, unpacked));
  EXPECT_FALSE(UnpackLzf(packed, std::size_t{1} << 40, unpacked));     // memory is not taken
  EXPECT_FALSE(UnpackLzf(std::string("\x20\x05", 2), 3, unpacked));    // from before the beginning
  EXPECT_FALSE(UnpackLzf(std::string("\0\x61\xE0", 3), 9, unpacked));  // without its length
}

TEST(PointMessage, OfEachFormOfPcdIsTheSameCloud) {
  const auto turn = MadeTurn();
  const auto binary = MessageOfPcd(PcdBytes(turn, PcdKind::kBinary), "a.pcd", 5 * kFolderNs, {});
  EXPECT_EQ(binary.fault, "");
  const auto cloud = CloudOf(binary.bytes);
  ASSERT_EQ(cloud.points.size(), turn.size());
  EXPECT_TRUE(cloud.has_rings);
  EXPECT_TRUE(cloud.has_times);
  EXPECT_EQ(cloud.points[17].ring, 1);
  EXPECT_EQ(cloud.points[17].reflectivity, 25);
  EXPECT_EQ(cloud.points[17].time_ns, std::llround(turn[17].time_s * 1e9));
  EXPECT_EQ(MessageOfPcd(PcdBytes(turn, PcdKind::kCompressed), "a.pcd", 5 * kFolderNs, {}).bytes, binary.bytes);
  const auto text = CloudOf(MessageOfPcd(PcdBytes(turn, PcdKind::kText), "a.pcd", 5 * kFolderNs, {}).bytes);
  ASSERT_EQ(text.points.size(), turn.size());
  EXPECT_NEAR(text.points[17].level_m, cloud.points[17].level_m, 1e-5);
}

TEST(PointMessage, OfAPcdCutAnywhereHasThePointsBeforeTheCut) {
  const auto turn = MadeTurn();
  for (const auto kind : {PcdKind::kText, PcdKind::kBinary, PcdKind::kCompressed}) {
    const auto whole = PcdBytes(turn, kind);
    for (std::size_t part = 0; part < 40; ++part) {
      const auto message = MessageOfPcd(std::string_view(whole).substr(0, whole.size() * part / 40), "a.pcd", 0, {});
      EXPECT_NE(message.fault, "");
      EXPECT_TRUE(message.bytes.empty() || CloudOf(message.bytes).points.size() < turn.size());
    }
  }
  // Rows stay what they are: they may be rings.
  const auto whole = PcdBytes(turn, PcdKind::kBinary, 16);
  const auto cut = MessageOfPcd(std::string_view(whole).substr(0, whole.size() / 2), "a.pcd", 0, {});
  const auto cloud = ParsePointCloud(Encoding::kRos1, cut.bytes);
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->width, 360U);
  EXPECT_EQ(cloud->height, 8U);
}

TEST(PointMessage, OfFalseCountsTakesNoMemory) {
  const std::string head = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  for (const std::string form : {"ascii", "binary", "binary_compressed"}) {
    for (const std::string size : {"WIDTH 2097152\nHEIGHT 1\n", "WIDTH 1048576\nHEIGHT 2\n", "WIDTH 4294967295\nHEIGHT 4294967295\n"}) {
      const auto message = MessageOfPcd(head + size + "DATA " + form + "\n1 2 3\n", "a.pcd", 0, {});
      EXPECT_NE(message.fault, "") << form << size;
    }
  }
  EXPECT_NE(MessageOfPcd("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nVIEWPOINT 1 0 0 1 0 0 0\nDATA ascii\n1 2 3\n",
                         "a.pcd", 0, {})
                .fault,
            "");
}

TEST(PointMessage, ReadsWholeNumbersOfNanoseconds) {
  std::string bytes =
      "VERSION 0.7\nFIELDS x y z ring t\nSIZE 4 4 4 1 8\nTYPE F F F U U\nWIDTH 2\nHEIGHT 1\nDATA ascii\n1 2 3 0 1000\n1 2 4 1 99000000\n";
  const auto cloud = CloudOf(MessageOfPcd(bytes, "a.pcd", kFolderNs, {}).bytes);
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[0].time_ns, 1000);
  EXPECT_EQ(cloud.points[1].time_ns, 99'000'000);
  // Times since 1970 tell when the scan was, where nothing else does.
  bytes = "VERSION 0.7\nFIELDS x y z timestamp\nSIZE 4 4 4 8\nTYPE F F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n1 2 3 1621234567.75\n1 2 4 1621234567.5\n";
  EXPECT_EQ(MessageOfPcd(bytes, "a.pcd", std::nullopt, {}).stamp_ns, 1'621'234'567 * kFolderNs + 500'000'000);
  EXPECT_NE(MessageOfPcd(PcdBytes(MadeTurn(), PcdKind::kBinary), "a.pcd", std::nullopt, {}).fault, "");
}

TEST(PointMessage, OfKittiLeavesOutWhatIsNoPoint) {
  auto turn = MadeTurn();
  turn[3].x_m = NAN;
  const auto bytes = KittiBytes(turn);
  const auto message = MessageOfKitti(bytes + "abc", "a.bin", 7 * kFolderNs, {});
  EXPECT_EQ(message.fault, "a.bin: the file ends inside a point of 16 bytes");
  const auto cloud = CloudOf(message.bytes);
  EXPECT_EQ(cloud.points.size(), turn.size() - 1);
  EXPECT_EQ(cloud.num_empty, 1);
  EXPECT_FALSE(cloud.has_rings);
  EXPECT_FALSE(cloud.has_times);
  EXPECT_EQ(cloud.points[0].reflectivity, 25);
  EXPECT_TRUE(CloudOf(MessageOfKitti("", "a.bin", 0, {}).bytes).points.empty());
}

TEST(Oxts, BecomesSentencesAndASample) {
  const auto time = Utime(std::chrono::sys_days(std::chrono::year(2026) / 6 / 15) + std::chrono::seconds(3'723));
  const auto items = ParseOxts(OxtsText(), time);
  ASSERT_TRUE(items);
  ASSERT_EQ(items->sentences.size(), 4U);
  EXPECT_EQ(items->sentences[0].substr(0, 6), "$GPGST");
  EXPECT_EQ(items->sentences[1].substr(0, 61), "$GPGGA,010203.000000,4530.00000000,N,00915.00000000,E,1,,,210");
  EXPECT_EQ(items->sentences[2].substr(0, 17), "$GPVTG,90.0000,T,");
  const auto attitude = navigator::ParseSentence(items->sentences[3], true);
  ASSERT_EQ(attitude.fault, SentenceFault::kNone) << items->sentences[3];
  EXPECT_NEAR(attitude.sentence.heading_rad, M_PI / 2.0, 1e-6);  // yaw 0 is east
  EXPECT_NEAR(attitude.sentence.roll_rad, 0.05, 2e-6);           // left side up: starboard down
  EXPECT_NEAR(attitude.sentence.pitch_rad, 0.02, 2e-6);          // front up
  ASSERT_TRUE(items->imu);
  EXPECT_EQ(items->imu->specific_force_mps2, Eigen::Vector3d(0.1, -0.2, -9.8));
  EXPECT_EQ(items->imu->angular_velocity_radps, Eigen::Vector3d(0.01, -0.02, -0.03));
  EXPECT_FALSE(ParseOxts("1 2 3", time));
  EXPECT_FALSE(ParseOxts("word " + OxtsText(), time));
  std::string none;
  for (int i = 0; i < 30; ++i) none += "nan ";
  const auto empty = ParseOxts(none, time);
  ASSERT_TRUE(empty);
  EXPECT_EQ(empty->sentences.size(), 1U);  // that there is no fix
  EXPECT_FALSE(empty->imu);
}

TEST(Boxes, HoldPointsAsTheyAreTurned) {
  const auto boxes = ParseBoxes(
      R"({"labels":[{"id":4,"category":"ship","box3d":{"dimension":{"width":2,"length":6,"height":2},"location":{"x":10,"y":0,"z":0},
          "orientation":{"rotationYaw":1.5707963267948966}}},
          {"category":"buoy","box3d":{"dimension":{"width":1,"length":1,"height":1},"location":{"x":12,"y":0,"z":0},"orientation":{"rotationYaw":0}}}]})");
  ASSERT_TRUE(boxes);
  const std::uint32_t ship = kBoxShip | 5U << 16;
  const std::uint32_t buoy = kBoxBuoy | 2U << 16;
  EXPECT_EQ(LabelAt(*boxes, 7.1, 0.0, 0.0), ship);  // its length lies along x, turned from y
  EXPECT_EQ(LabelAt(*boxes, 10.0, 1.1, 0.0), 0U);
  EXPECT_EQ(LabelAt(*boxes, 10.0, 0.0, 1.1), 0U);
  EXPECT_EQ(LabelAt(*boxes, 12.2, 0.1, 0.0), buoy);  // the smaller one
  for (const std::string text : {"", "{}", "[]", R"({"labels":1})", R"({"labels":[{}]})",
                                 R"({"labels":[{"category":"ship","box3d":{"dimension":{"width":-1,"length":1,"height":1},
        "location":{"x":0,"y":0,"z":0},"orientation":{"rotationYaw":0}}}]})"}) {
    EXPECT_FALSE(ParseBoxes(text)) << text;
  }
  EXPECT_TRUE(ParseBoxes(R"({"labels":[]})")->empty());
}

class Folders : public ::testing::Test {
 protected:
  struct Read {
    std::string topic;
    std::int64_t time_ns;
    std::size_t num_bytes;
  };
  // All messages of a folder; its losses are kept.
  std::vector<Read> ReadAll(const fs::path& folder) {
    FolderRecording recording(folder);
    std::vector<Read> messages;
    while (const auto message = recording.Next()) messages.push_back({message->topic->name, message->time_ns, message->bytes.size()});
    losses_ = recording.losses();
    remarks_ = recording.remarks();
    topics_ = recording.IndexedTopics();
    EXPECT_EQ(recording.share(), 1.0);
    return messages;
  }

  support::TempDir folder_;
  Losses losses_;
  std::vector<std::string> remarks_;
  Topics topics_;
};

TEST_F(Folders, OfKittiRawDataGiveScansAndNavigationByTime) {
  const auto drive = folder_ / "2011_09_26_drive_0001_sync";
  WriteIn(drive / "velodyne_points" / "data", "0000000000.bin", KittiBytes(MadeTurn()));
  WriteIn(drive / "velodyne_points" / "data", "0000000002.bin", KittiBytes(MadeTurn()));  // one is missing
  WriteIn(drive / "velodyne_points", "timestamps.txt", "2011-09-26 13:02:25.1\n2011-09-26 13:02:25.2\n2011-09-26 13:02:25.3\n");
  WriteIn(drive / "oxts" / "data", "0000000000.txt", OxtsText());
  WriteIn(drive / "oxts", "timestamps.txt", "2011-09-26 13:02:25.25\n");
  const auto messages = ReadAll(drive / "");
  ASSERT_EQ(messages.size(), 3U);
  EXPECT_EQ(messages[0].topic, "/points");
  EXPECT_EQ(messages[1].topic, "oxts");
  EXPECT_EQ(messages[2].time_ns, 1'317'042'145 * kFolderNs + 300'000'000);
  EXPECT_FALSE(losses_.IsAny());
  EXPECT_EQ(remarks_, std::vector<std::string>{"the times name no zone: they are taken for UTC"});
  EXPECT_EQ(GuessTopics(topics_), (TopicMap{{"/points", {Use::kLidarScan}}, {"oxts", {Use::kOxts}}}));
  EXPECT_EQ(FilesOfRecording(drive), std::vector<fs::path>{drive});
  EXPECT_EQ(OpenRecording(drive)->kind(), "folder of scans");
}

TEST_F(Folders, OfASequenceCountFromItsBegin) {
  const auto sequence = folder_ / "sequences" / "04";
  for (const std::string name : {"000000", "000001"}) {
    const auto turn = MadeTurn(10.0, 20.0, 10U | 3U << 16);
    WriteIn(sequence / "velodyne", name + ".bin", KittiBytes(turn));
    WriteIn(sequence / "labels", name + ".label", LabelBytes(turn));
  }
  WriteIn(sequence, "times.txt", "0.000000e+00\n1.037360e-01\n");
  const auto messages = ReadAll(sequence);
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0].time_ns, 0);
  EXPECT_EQ(messages[1].time_ns, 103'736'000);
  EXPECT_EQ(remarks_, std::vector<std::string>{"the times have no date: they count from 1970-01-01, where the log begins"});
  EXPECT_FALSE(losses_.IsAny());
  EXPECT_NE(FolderRecording(sequence).default_labels(), "");
  // A time of 0 is a time.
  LogMaker log({}, false, [](Utime, const bus::Channel&, Bytes) {});
  RosImport import({{"/points", {Use::kLidarScan}}}, log);
  FolderRecording learned(sequence);
  import.Learn(learned);
  FolderRecording recording(sequence);
  while (const auto message = recording.Next()) import.Take(*message);
  EXPECT_EQ(import.tallies().at("/points").num_used, 2);
  EXPECT_EQ(import.tallies().at("/points").num_other_time, 0);
}

TEST_F(Folders, OfPcdFilesTellWhatIsDamagedForeignAndWithoutATime) {
  const auto bytes = PcdBytes(MadeTurn(), PcdKind::kCompressed);
  WriteIn(folder_, "1621234567.5.pcd", bytes);
  WriteIn(folder_, "1621234567.4.pcd", PcdBytes(MadeTurn(), PcdKind::kBinary).substr(0, 20'000));
  WriteIn(folder_, "1621234567.6.pcd", "no cloud");
  WriteIn(folder_, "frame.pcd", bytes);
  WriteIn(folder_, "notes.md", "a note");
  WriteIn(folder_ / "images", "1.png", "");
  const auto messages = ReadAll(folder_);
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0].time_ns, 1'621'234'567 * kFolderNs + 400'000'000);
  EXPECT_EQ(losses_.num_damaged, 3);
  EXPECT_EQ(losses_.num_foreign, 1);
  EXPECT_EQ(losses_.first_fault, "notes.md: is no file of this recording");
  EXPECT_TRUE(losses_.IsAny());
  ASSERT_EQ(remarks_.size(), 1U);
}

TEST_F(Folders, WithATimeOfItsOwnForEachFrameAreReadWithTheirBoxes) {
  const auto sequence = folder_ / "mascoma";
  WriteIn(sequence / "point_clouds", "000000.pcd", PcdBytes(MadeTurn(), PcdKind::kText));
  WriteIn(sequence / "timestamp", "000000.txt", "1665158400.25\n");
  WriteIn(sequence / "annotations", "000000.json",
          R"({"labels":[{"id":0,"category":"ship","box3d":{"dimension":{"width":8,"length":8,"height":40},"location":{"x":20,"y":0,"z":0},
              "orientation":{"rotationYaw":0}}}]})");
  FolderRecording recording(sequence);
  const auto message = recording.Next();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->time_ns, 1'665'158'400 * kFolderNs + 250'000'000);
  std::int64_t num_labelled = 0;
  for (const auto& point : CloudOf(message->bytes).points) num_labelled += point.label == (kBoxShip | 1U << 16) ? 1 : 0;
  EXPECT_GT(num_labelled, 200);
  EXPECT_FALSE(recording.losses().IsAny());
}

TEST_F(Folders, OfAnotherKindAreRefused) {
  WriteIn(folder_ / "images", "1.png", "");
  EXPECT_FALSE(FolderRecording::IsLayout(folder_));
  EXPECT_THROW(FolderRecording{folder_}, std::runtime_error);
  EXPECT_THROW(FilesOfRecording(folder_), std::runtime_error);
}

TEST_F(Folders, WithoutAnyTimeGiveNothingAndSaySo) {
  WriteIn(folder_, "000000.bin", KittiBytes(MadeTurn()));
  EXPECT_TRUE(ReadAll(folder_).empty());
  EXPECT_EQ(losses_.num_bad_messages, 1);
  ASSERT_EQ(remarks_.size(), 1U);
  EXPECT_NE(remarks_[0].find("timestamps.txt"), std::string::npos);
}

}  // namespace
}  // namespace lookout::importer
