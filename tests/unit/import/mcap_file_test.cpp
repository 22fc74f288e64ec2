// MCAP files, whole and damaged.
#include "tools/import/mcap_file.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/unit/import/read_recordings.hpp"

namespace lookout::importer {
namespace {

using namespace test;

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

}  // namespace
}  // namespace lookout::importer
