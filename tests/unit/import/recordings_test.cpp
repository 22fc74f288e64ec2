// ROS bags, MCAP files and databases of rosbag2, whole and damaged.
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
#include "tests/unit/import/made_recordings.hpp"
#include "tools/import/byte_source.hpp"
#include "tools/import/import_recording.hpp"
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

// A source that counts the bytes that were read of it.
class CountingSource final : public ByteSource {
 public:
  CountingSource(Payload bytes, std::uint64_t& num_read) : source_(std::move(bytes)), num_read_(num_read) {}
  std::uint64_t size() const override { return source_.size(); }
  std::size_t Read(std::uint64_t offset, std::span<std::uint8_t> out) const override {
    const auto count = source_.Read(offset, out);
    num_read_ += count;
    return count;
  }

 private:
  MemorySource source_;
  std::uint64_t& num_read_;
};

// A schema, and a channel of it.
Payload McapTopic(std::uint16_t number, const std::string& name, std::string_view encoding = "cdr") {
  const auto schema = static_cast<std::uint16_t>(number + 1);
  return Writer()
      .Raw(McapRecord(3,
                      Writer().Number(schema).Sized(std::string_view("nmea_msgs/msg/Sentence")).Sized(std::string_view("ros2msg")).Number(0U).bytes))
      .Raw(McapRecord(4, Writer().Number(number).Number(schema).Sized(name).Sized(encoding).Number(0U).bytes))
      .bytes;
}

Payload McapMessage(std::uint16_t number, std::int64_t time_ns, const Payload& bytes) {
  return McapRecord(5, Writer().Number(number).Number(0U).Number(time_ns).Number(time_ns).Raw(bytes).bytes);
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

// A record that is too large to be read, and lies in the file as a whole.
TEST(RosBag, StepsOverARecordThatIsTooLarge) {
  const auto made = SomeMessages(Encoding::kRos1);
  const auto begin = Writer()
                         .Raw("#ROSBAG V2.0\n")
                         .Raw(BagRecord({{"index_pos", BagNumber(std::uint64_t{0})}, {"op", {3}}}, Payload(64, ' ')))
                         .Raw(BagConnection(0, made[0].topic, made[0].type))
                         .Raw(BagMessage(0, made[0].time_ns, Payload(kMaxPieceBytes + 1)))
                         .bytes;
  const auto read = ReadAll(*OpenBag(Writer().Raw(begin).Raw(BagMessage(0, made[3].time_ns, made[3].bytes)).bytes));
  ExpectEqual(read.messages, {made[3]});
  EXPECT_EQ(read.losses.num_damaged, 1);
  EXPECT_GT(read.losses.num_bytes_skipped, static_cast<std::int64_t>(kMaxPieceBytes));
  // Where no record stands behind it, its length is the damage: the next chunk is looked for, inside of it, too.
  auto damaged = Writer().Raw(begin).Raw(Payload(100, 0xFF)).bytes;
  const auto chunk = BagChunk(Packing::kNone, BagMessage(0, made[3].time_ns, made[3].bytes));
  std::ranges::copy(chunk, damaged.begin() + 5000);
  ExpectEqual(ReadAll(*OpenBag(damaged)).messages, {made[3]});
}

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

TEST(McapFile, StepsOverARecordThatIsTooLarge) {
  const auto made = SomeMessages(Encoding::kCdr);
  const auto begin = Writer().Raw(kMcapFileMagic).Raw(McapTopic(0, "/nmea")).Raw(McapMessage(0, made[0].time_ns, Payload(kMaxPieceBytes))).bytes;
  const auto read = ReadAll(*OpenMcap(Writer().Raw(begin).Raw(McapMessage(0, made[3].time_ns, made[3].bytes)).bytes));
  ExpectEqual(read.messages, {made[3]});
  EXPECT_EQ(read.losses.num_damaged, 1);
  EXPECT_GT(read.losses.num_bytes_skipped, static_cast<std::int64_t>(kMaxPieceBytes));
  auto damaged = Writer().Raw(begin).Raw(Payload(100)).bytes;
  const auto chunk = McapChunk(Packing::kNone, McapMessage(0, made[3].time_ns, made[3].bytes));
  std::ranges::copy(chunk, damaged.begin() + 5000);
  ExpectEqual(ReadAll(*OpenMcap(damaged)).messages, {made[3]});
}

// Statistics without counts of channels: the writer did not count.
TEST(McapFile, WithoutCountsSaysNone) {
  const auto make = [](std::uint64_t num_messages) {
    Writer file;
    file.Raw(kMcapFileMagic).Raw(McapTopic(0, "/nmea")).Raw(McapRecord(0x0F, Payload(4)));
    const auto summary_at = file.bytes.size();
    file.Raw(McapTopic(0, "/nmea")).Raw(McapRecord(0x0B, Writer().Number(num_messages).Raw(Payload(34)).Number(0U).bytes));
    file.Raw(McapRecord(2, Writer().Number(static_cast<std::uint64_t>(summary_at)).Raw(Payload(12)).bytes));
    return file.Raw(kMcapFileMagic).bytes;
  };
  EXPECT_EQ(OpenMcap(make(7))->IndexedTopics().at(0).num_messages, -1);
  EXPECT_EQ(OpenMcap(make(0))->IndexedTopics().at(0).num_messages, 0);
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
