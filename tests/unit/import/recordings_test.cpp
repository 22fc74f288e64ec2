// Recordings of every kind, and databases of rosbag2, whole and damaged.
#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/import/read_recordings.hpp"
#include "tools/import/import_recording.hpp"
#include "tools/import/rosbag2_database.hpp"

namespace lookout::importer {
namespace {

using namespace test;

// Heads of chunks that are none: each is a fault, and the recording is read about once all the same.
TEST(Recordings, OfFalseHeadsAreNotReadAnewForEach) {
  const auto bag_head = Writer().Sized(BagHeader({{"op", {5}}, {"compression", BagBytes("none")}, {"size", BagNumber(0U)}})).Raw(Payload(12)).bytes;
  const auto mcap_head = McapRecord(6, Writer().Raw(Payload(28)).Number(0U).Number(std::uint64_t{0}).bytes);
  Writer bag;
  Writer mcap;
  bag.Raw("#ROSBAG V2.0\n");
  mcap.Raw(kMcapFileMagic);
  for (int i = 0; i < 10'000; ++i) {
    bag.Raw(bag_head);
    mcap.Raw(mcap_head).Raw(Payload(1));
  }
  const auto size = bag.bytes.size();
  std::uint64_t num_read = 0;
  RosBag false_bag(std::make_unique<CountingSource>(bag.bytes, num_read));
  EXPECT_GE(ReadAll(false_bag).losses.num_damaged, 9'000);
  EXPECT_LT(num_read, 4 * size);
  const auto mcap_size = mcap.bytes.size();
  num_read = 0;
  McapFile false_mcap(std::make_unique<CountingSource>(mcap.bytes, num_read));
  EXPECT_GE(ReadAll(false_mcap).losses.num_damaged, 9'000);
  EXPECT_LT(num_read, 4 * mcap_size);
}

TEST(Recordings, HaveNoTopicsWithoutAName) {
  const auto mcap = Writer().Raw(kMcapFileMagic).Raw(McapTopic(0, "")).Raw(McapMessage(0, kMadeStampNs, MakeImu(Encoding::kCdr))).bytes;
  const auto long_name =
      Writer().Raw(kMcapFileMagic).Raw(McapTopic(0, std::string(kMaxNameBytes + 1, 'x'))).Raw(McapMessage(0, kMadeStampNs, {})).bytes;
  const auto database = [](std::size_t size) {
    return MakeDatabase({{std::string(size, 'x'), "sensor_msgs/Imu", kMadeStampNs, MakeImu(Encoding::kCdr)}});
  };
  std::vector<std::unique_ptr<Recording>> recordings;
  recordings.push_back(OpenMcap(mcap));
  recordings.push_back(OpenMcap(long_name));
  recordings.push_back(std::make_unique<Rosbag2Database>(database(0)));
  recordings.push_back(std::make_unique<Rosbag2Database>(database(kMaxNameBytes + 1)));
  for (const auto& recording : recordings) {
    const auto read = ReadAll(*recording);
    EXPECT_TRUE(read.messages.empty());
    EXPECT_TRUE(recording->topics().empty());
    EXPECT_EQ(read.losses.num_bad_messages, 1);
  }
}

TEST(Recordings, RefuseTimesThatNoClockHas) {
  const auto make = [](std::int64_t time_ns) { return std::vector<Made>{{"/imu", "sensor_msgs/Imu", time_ns, MakeImu(Encoding::kCdr)}}; };
  for (const auto time_ns : {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(), kMinUtimeUs * 1000 - 1}) {
    Rosbag2Database database(MakeDatabase(make(time_ns)));
    EXPECT_EQ(ReadAll(database).losses.num_bad_messages, 1);
    EXPECT_EQ(ReadAll(*OpenMcap(MakeMcap(make(time_ns), Packing::kNone))).losses.num_bad_messages, 1);
  }
  EXPECT_EQ(ReadAll(*OpenMcap(MakeMcap(make(-1), Packing::kNone))).losses.num_bad_messages, 1);
}

// With what its writer has left in the -wal, and without any.
TEST(Rosbag2Database, LeavesNothingBesideTheFile) {
  const support::TempDir folder;
  const auto file = folder / "day.db3";
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  sqlite3_exec(database,
               "PRAGMA journal_mode=wal; PRAGMA wal_autocheckpoint=0; CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format);"
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data); INSERT INTO topics VALUES (1, '/a', 'a/msg/A', 'cdr');"
               "INSERT INTO messages VALUES (1, 1, 5, x'00')",
               nullptr, nullptr, nullptr);
  const support::TempDir left;
  for (const char* ending : {"", "-wal"}) {
    std::filesystem::copy_file(file.string() + ending, (left / "day.db3").string() + ending);
  }
  sqlite3_close(database);
  const auto read_in = [](const support::TempDir& place, std::size_t num_files) {
    {
      Rosbag2Database opened(place / "day.db3");
      EXPECT_EQ(ReadAll(opened).messages.size(), 1U);
    }
    std::size_t num_found = 0;
    for (const auto& entry : std::filesystem::directory_iterator(place.path())) num_found += entry.is_regular_file() ? 1 : 0;
    EXPECT_EQ(num_found, num_files);
  };
  read_in(folder, 1);
  read_in(left, 2);
}

TEST(Rosbag2Database, GivesItsMessagesInTheOrderOfTheirNumbers) {
  const auto made = SomeMessages(Encoding::kCdr);
  Rosbag2Database database(MakeDatabase(made));
  const auto read = ReadAll(database);
  ExpectEqual(read.messages, made);
  EXPECT_FALSE(read.losses.IsAny());
}

// As a recording of a VLS-128 that others published.
TEST(Rosbag2Database, TakesTopicsOfNoFormatForCdr) {
  const auto made = SomeMessages(Encoding::kCdr);
  Rosbag2Database database(MakeDatabase(made, ""));
  ExpectEqual(ReadAll(database).messages, made);
}

TEST(Rosbag2Database, UnpacksMessagesThatWerePackedOneByOne) {
  auto made = SomeMessages(Encoding::kCdr);
  auto packed = made;
  for (auto& message : packed) message.bytes = Pack(Packing::kZstd, message.bytes);
  packed[3].bytes.resize(packed[3].bytes.size() - 5);
  Rosbag2Database database(MakeDatabase(packed));
  const auto read = ReadAll(database);
  made.erase(made.begin() + 3);
  ExpectEqual(read.messages, made);
  EXPECT_EQ(read.losses.num_damaged, 1);
}

TEST(Rosbag2Database, IsNeitherAnotherDatabaseNorAView) {
  EXPECT_THROW(Rosbag2Database(Payload(100)), std::runtime_error);
  const support::TempDir folder;
  sqlite3* database = nullptr;
  sqlite3_open((folder / "endless.db3").c_str(), &database);
  sqlite3_exec(
      database,
      "CREATE TABLE topics(id, name, type, serialization_format); CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT "
      "id + 1 FROM n) SELECT id, 1 AS topic_id, 1 AS timestamp, x'00' AS data FROM n",
      nullptr, nullptr, nullptr);
  sqlite3_close(database);
  EXPECT_THROW(Rosbag2Database(folder / "endless.db3"), std::runtime_error);
}

// Cut and spoiled at a thousand places each: what comes out is a part of what was written, and the loss is told.
TEST(Recordings, CutAtAnyPlaceGiveWhatStandsBefore) {
  constexpr std::size_t kNumPlaces = 1000;
  const auto ros1 = SomeMessages(Encoding::kRos1);
  const auto cdr = SomeMessages(Encoding::kCdr);
  struct Case {
    const std::vector<Made>& made;
    Payload bytes;
    std::unique_ptr<Recording> (*open)(Payload);
    std::size_t end;  // behind the last chunk: from there on nothing is lost
  };
  std::vector<Case> cases;
  for (const auto packing : {Packing::kNone, Packing::kBzip2, Packing::kLz4}) cases.push_back({ros1, MakeBag(ros1, packing), OpenBag, 0});
  for (const auto packing : {Packing::kNone, Packing::kZstd, Packing::kLz4}) cases.push_back({cdr, MakeMcap(cdr, packing), OpenMcap, 0});
  for (const auto& one : cases) {
    std::size_t last = 0;
    for (std::size_t i = 0; i < kNumPlaces; ++i) {
      const auto size = 13 + (one.bytes.size() - 13) * i / kNumPlaces;
      const auto recording = one.open({one.bytes.begin(), one.bytes.begin() + static_cast<std::ptrdiff_t>(size)});
      recording->IndexedTopics();
      const auto read = ReadAll(*recording);
      ExpectSome(read.messages, one.made, last);
      last = read.messages.size();
      if (read.messages.size() < one.made.size() && read.messages.size() % 4 != 0) {
        EXPECT_TRUE(read.losses.IsAny()) << "cut at " << size;
      }
    }
    EXPECT_EQ(last, one.made.size());
  }
}

TEST(Recordings, SpoiledAtAnyPlaceGiveNothingThatIsNoMessage) {
  constexpr std::size_t kNumPlaces = 1000;
  const auto cdr = SomeMessages(Encoding::kCdr);
  for (const std::uint8_t value : {0x00, 0xFF, 0x80}) {
    for (std::size_t i = 0; i < kNumPlaces; ++i) {
      for (auto bytes : {MakeBag(SomeMessages(Encoding::kRos1), Packing::kLz4), MakeMcap(cdr, Packing::kZstd), MakeMcap(cdr, Packing::kNone)}) {
        const auto place = 8 + (bytes.size() - 8) * i / kNumPlaces;
        bytes[place] = value;
        const bool is_bag = bytes[0] == '#';
        const auto recording = is_bag ? OpenBag(bytes) : OpenMcap(bytes);
        recording->IndexedTopics();
        EXPECT_LE(ReadAll(*recording).messages.size(), 12U);
      }
      if (i % 4 != 0) continue;
      auto bytes = MakeDatabase(cdr);
      bytes[16 + (bytes.size() - 16) * i / kNumPlaces] = value;
      try {
        Rosbag2Database database(bytes);
        EXPECT_LE(ReadAll(database).messages.size(), 12U);
      } catch (const std::runtime_error&) {
        continue;  // no longer a recording
      }
    }
  }
}

TEST(Recordings, OfAFolderThatArePackedAreNamedWithTheCommandThatHelps) {
  const support::TempDir folder;
  support::WriteFile(folder / "day_0.db3.zstd", "x");
  try {
    FilesOfRecording(folder.path());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("zstd -d"), std::string::npos);
  }
}

// Messages of LCM decide how a file is read where there are some.
TEST(ImportRecording, TakesLcmAloneWhereItHasMessages) {
  const support::TempDir folder;
  const auto run = [&folder](const Payload& records) {
    support::WriteFile(folder / "in.mcap", std::string(records.begin(), records.end()));
    std::ostringstream notes;
    log::LogOutput output(folder / "out.log", {.force = true, .inputs = {}, .tell = [](const std::string&) {}});
    ImportRecording({support::kDemoConfig, {folder / "in.mcap"}, std::nullopt}, output, notes);
    output.Commit();
    return notes.str();
  };
  const auto made = SomeMessages(Encoding::kCdr);
  const auto topics = Writer().Raw(kMcapFileMagic).Raw(McapTopic(0, "/nmea")).Raw(McapTopic(1, "FOO", "x-lcm")).bytes;
  const auto ros = McapMessage(0, made[0].time_ns, made[0].bytes);
  const auto lcm = McapMessage(1, made[0].time_ns, Payload(8));
  EXPECT_NE(run(Writer().Raw(topics).Raw(ros).bytes).find("/nmea: 1 messages used"), std::string::npos);
  EXPECT_NE(run(Writer().Raw(topics).Raw(ros).Raw(lcm).bytes).find("1 messages of other encodings are not used"), std::string::npos);
  const auto long_name = Writer().Raw(kMcapFileMagic).Raw(McapTopic(1, std::string(bus::kMaxLogChannelBytes + 1, 'x'), "x-lcm")).Raw(lcm).bytes;
  EXPECT_THROW(run(long_name), std::runtime_error);
}

TEST(Recordings, OfAFolderAreInTheOrderOfTheirNumbers) {
  const support::TempDir folder;
  for (const char* name : {"day_10.db3", "day_9.db3", "day_0.db3", "metadata.yaml"}) support::WriteFile(folder / name, "x");
  const auto files = FilesOfRecording(folder.path());
  ASSERT_EQ(files.size(), 3U);
  EXPECT_EQ(files[0].filename(), "day_0.db3");
  EXPECT_EQ(files[2].filename(), "day_10.db3");
}

}  // namespace
}  // namespace lookout::importer
