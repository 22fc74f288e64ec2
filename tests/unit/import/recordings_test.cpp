// ROS bags, MCAP files and databases of rosbag2, whole and damaged.
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/files.hpp"
#include "tests/unit/import/made_recordings.hpp"
#include "tools/import/byte_source.hpp"
#include "tools/import/mcap_file.hpp"
#include "tools/import/ros_bag.hpp"
#include "tools/import/rosbag2_database.hpp"

namespace lookout::importer {
namespace {

using namespace test;

struct Read {
  std::vector<Made> messages;
  Losses losses;
};

Read ReadAll(Recording& recording) {
  Read read;
  while (const auto message = recording.Next()) {
    read.messages.push_back({message->topic->name, message->topic->type, message->time_ns, {message->bytes.begin(), message->bytes.end()}});
  }
  read.losses = recording.losses();
  return read;
}

std::unique_ptr<Recording> OpenBag(Payload bytes) { return std::make_unique<RosBag>(std::make_unique<MemorySource>(std::move(bytes))); }
std::unique_ptr<Recording> OpenMcap(Payload bytes) { return std::make_unique<McapFile>(std::make_unique<MemorySource>(std::move(bytes))); }

void ExpectEqual(const std::vector<Made>& read, const std::vector<Made>& made) {
  ASSERT_EQ(read.size(), made.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    EXPECT_EQ(read[i].topic, made[i].topic);
    EXPECT_EQ(read[i].type, made[i].type);
    EXPECT_EQ(read[i].time_ns, made[i].time_ns);
    EXPECT_EQ(read[i].bytes, made[i].bytes);
  }
}

// Those that are read are messages that were written, in their order; none is made up.
void ExpectSome(const std::vector<Made>& read, const std::vector<Made>& made, std::size_t least) {
  EXPECT_GE(read.size(), least);
  auto next = made.begin();
  for (const auto& message : read) {
    next = std::find_if(next, made.end(), [&](const Made& one) { return one.topic == message.topic && one.time_ns == message.time_ns; });
    ASSERT_NE(next, made.end());
    EXPECT_EQ(next->bytes, message.bytes);
  }
}

std::map<std::string, std::int64_t> CountsOf(const Topics& topics) {
  std::map<std::string, std::int64_t> counts;
  for (const auto& [number, topic] : topics) counts[topic.name] = topic.num_messages;
  return counts;
}

const std::map<std::string, std::int64_t> kFourEach{{"/imu", 4}, {"/nmea", 4}, {"/packets", 4}};

TEST(RosBag, GivesItsMessagesInTheOrderOfTheFile) {
  const auto made = SomeMessages(Encoding::kRos1);
  for (const auto packing : {Packing::kNone, Packing::kBzip2, Packing::kLz4}) {
    const auto bag = OpenBag(MakeBag(made, packing));
    EXPECT_EQ(CountsOf(bag->IndexedTopics()), kFourEach);
    const auto read = ReadAll(*bag);
    ExpectEqual(read.messages, made);
    EXPECT_FALSE(read.losses.IsAny());
    EXPECT_DOUBLE_EQ(bag->share(), 1.0);
  }
}

// rosbag that was killed has not gone back to the head of its chunk, which says 0 bytes.
TEST(RosBag, GivesMessagesBehindAChunkThatWasNeverClosed) {
  const auto made = SomeMessages(Encoding::kRos1);
  Writer file;
  file.Raw("#ROSBAG V2.0\n").Raw(BagRecord({{"index_pos", BagNumber(std::uint64_t{0})}, {"op", {3}}}, Payload(64, ' ')));
  file.Raw(BagRecord({{"compression", BagBytes("none")}, {"op", {5}}, {"size", BagNumber(0U)}}, {}));
  file.Raw(BagConnection(0, made[0].topic, made[0].type)).Raw(BagMessage(0, made[0].time_ns, made[0].bytes));
  const auto bag = OpenBag(file.bytes);
  EXPECT_TRUE(bag->IndexedTopics().empty());
  ExpectEqual(ReadAll(*bag).messages, {made[0]});
}

TEST(RosBag, GoesOnBehindADamagedChunk) {
  const auto made = SomeMessages(Encoding::kRos1);
  for (const auto packing : {Packing::kBzip2, Packing::kLz4}) {
    auto bytes = MakeBag(made, packing);
    const auto whole = bytes;
    std::fill_n(bytes.begin() + 250, 40, std::uint8_t{0xFF});  // inside of the first chunk
    const auto bag = OpenBag(bytes);
    auto read = ReadAll(*bag);
    EXPECT_TRUE(read.losses.IsAny());
    EXPECT_GE(read.losses.num_damaged, 1);
    EXPECT_NE(read.losses.first_fault.find("byte "), std::string::npos);
  }
}

TEST(RosBag, LooksForTheNextChunkWhereAHeadIsDamaged) {
  const auto made = SomeMessages(Encoding::kRos1);
  auto bytes = MakeBag(made, Packing::kLz4, 6);
  const auto head = BagRecord(
      {{"index_pos", BagNumber(std::uint64_t{0})}, {"conn_count", BagNumber(0U)}, {"chunk_count", BagNumber(0U)}, {"op", {3}}}, Payload(64, ' '));
  const auto first_chunk = 13 + head.size();
  bytes[first_chunk + 3] = 0x7F;  // the length of its header
  const auto bag = OpenBag(bytes);
  const auto read = ReadAll(*bag);
  EXPECT_EQ(read.losses.num_damaged, 1);
  EXPECT_GT(read.losses.num_bytes_skipped, 0);
  // The topics stood in the first chunk: messages of the second are of none that is known.
  EXPECT_EQ(read.losses.num_bad_messages, 6);
}

TEST(RosBag, BoundsWhatItTakesForAHostileLength) {
  for (const std::uint32_t size : {0xFFFFFFFFU, 0x7FFFFFFFU, 100U << 20}) {
    Writer file;
    file.Raw("#ROSBAG V2.0\n")
        .Raw(BagRecord({{"compression", BagBytes("lz4")}, {"op", {5}}, {"size", BagNumber(size)}}, Pack(Packing::kLz4, Payload(100))));
    EXPECT_GE(ReadAll(*OpenBag(file.bytes)).losses.num_damaged, 1);
    Writer other;
    other.Raw("#ROSBAG V2.0\n").Number(size).Raw("op=");
    EXPECT_GE(ReadAll(*OpenBag(other.bytes)).losses.num_damaged, 1);
    Writer message;
    message.Raw("#ROSBAG V2.0\n").Sized(BagHeader({{"op", {2}}, {"conn", BagNumber(0U)}})).Number(size);
    EXPECT_GE(ReadAll(*OpenBag(message.bytes)).losses.num_damaged, 1);
  }
}

TEST(McapFile, GivesItsMessagesInTheOrderOfTheFile) {
  const auto made = SomeMessages(Encoding::kCdr);
  for (const auto packing : {Packing::kNone, Packing::kZstd, Packing::kLz4}) {
    const auto file = OpenMcap(MakeMcap(made, packing));
    EXPECT_EQ(CountsOf(file->IndexedTopics()), kFourEach);
    const auto read = ReadAll(*file);
    ExpectEqual(read.messages, made);
    EXPECT_FALSE(read.losses.IsAny());
  }
}

TEST(McapFile, LeavesOutAChunkOfAWrongChecksumAndGoesOn) {
  const auto made = SomeMessages(Encoding::kCdr);
  auto bytes = MakeMcap(made, Packing::kNone);
  const std::string text = "$GPHDT,92.0";
  const auto place = std::search(bytes.begin(), bytes.end(), text.begin(), text.end());
  ASSERT_NE(place, bytes.end());
  *place = '!';
  const auto read = ReadAll(*OpenMcap(bytes));
  EXPECT_EQ(read.losses.num_damaged, 1);
  EXPECT_EQ(read.messages.size(), 8U);
  ExpectSome(read.messages, made, 8);
}

TEST(McapFile, LooksForTheNextChunkWhereARecordIsDamaged) {
  const auto made = SomeMessages(Encoding::kCdr);
  for (const auto packing : {Packing::kNone, Packing::kZstd}) {
    auto bytes = MakeMcap(made, packing);
    const auto header_size = 8 + 9 + 4 + 4 + 4 + 4;
    auto second = static_cast<std::size_t>(header_size) + 9 + ReadU32LittleEndian(bytes, header_size + 1);
    ASSERT_EQ(bytes[second], 6);
    bytes[second] = 0;
    const auto read = ReadAll(*OpenMcap(bytes));
    EXPECT_EQ(read.losses.num_damaged, 1);
    EXPECT_GT(read.losses.num_bytes_skipped, 0);
    ExpectSome(read.messages, made, 8);
  }
}

TEST(McapFile, BoundsWhatItTakesForAHostileLength) {
  for (const std::uint64_t size : {~std::uint64_t{0}, std::uint64_t{1} << 62, std::uint64_t{1} << 31}) {
    for (const std::uint8_t opcode : {3, 4, 5, 6, 8}) {
      const auto bytes = Writer().Raw(kMcapFileMagic).Number(opcode).Number(size).Raw(Payload(50)).bytes;
      EXPECT_TRUE(ReadAll(*OpenMcap(bytes)).losses.IsAny());
    }
    const auto chunk = McapRecord(6, Writer()
                                         .Raw(Payload(16))
                                         .Number(size)
                                         .Number(0U)
                                         .Sized(std::string_view("zstd"))
                                         .Number(std::uint64_t{4})
                                         .Raw(Payload{0x28, 0xB5, 0x2F, 0xFD})
                                         .bytes);
    EXPECT_TRUE(ReadAll(*OpenMcap(Writer().Raw(kMcapFileMagic).Raw(chunk).bytes)).losses.IsAny());
  }
}

TEST(Rosbag2Database, GivesItsMessagesInTheOrderOfTheirNumbers) {
  const auto made = SomeMessages(Encoding::kCdr);
  Rosbag2Database database(MakeDatabase(made));
  const auto read = ReadAll(database);
  ExpectEqual(read.messages, made);
  EXPECT_FALSE(read.losses.IsAny());
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

TEST(McapFile, GivesMessagesOutsideOfChunks) {
  const auto made = SomeMessages(Encoding::kCdr);
  Writer file;
  file.Raw(kMcapFileMagic).Raw(McapRecord(1, Payload(8)));
  file.Raw(McapRecord(3, Writer()
                             .Number(std::uint16_t{1})
                             .Sized(std::string_view("nmea_msgs/msg/Sentence"))
                             .Sized(std::string_view("ros2msg"))
                             .Sized(std::string_view())
                             .bytes));
  file.Raw(McapRecord(4, Writer()
                             .Number(std::uint16_t{0})
                             .Number(std::uint16_t{1})
                             .Sized(std::string_view("/nmea"))
                             .Sized(std::string_view("cdr"))
                             .Number(std::uint32_t{0})
                             .bytes));
  const auto time_ns = static_cast<std::uint64_t>(made[0].time_ns);
  file.Raw(McapRecord(5, Writer().Number(std::uint16_t{0}).Number(std::uint32_t{0}).Number(time_ns).Number(time_ns).Raw(made[0].bytes).bytes));
  // Cut off: no end of data, no footer.
  const auto read = ReadAll(*OpenMcap(file.bytes));
  ExpectEqual(read.messages, {made[0]});
  EXPECT_TRUE(read.losses.is_cut);
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
