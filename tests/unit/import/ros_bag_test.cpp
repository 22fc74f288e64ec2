// ROS bags, whole and damaged.
#include "tools/import/ros_bag.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/unit/import/read_recordings.hpp"

namespace lookout::importer {
namespace {

using namespace test;

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

}  // namespace
}  // namespace lookout::importer
