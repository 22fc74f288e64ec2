// Packets of other lidars, made by their documents, and recordings of two of them where they are at hand.
#include "services/lidar/core/vlp16/foreign_sensor.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <random>

#include "services/lidar/io/capture_reader.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using test::Payload;

Payload Starting(std::string_view start, std::size_t size_bytes) {
  Payload payload(size_bytes);
  std::ranges::transform(start, payload.begin(), [](char one) { return static_cast<std::uint8_t>(one); });
  return payload;
}

Payload WithFlags(const std::vector<std::uint16_t>& flags, std::uint8_t product) {
  auto payload = test::MakeDataPacket(test::Azimuths(0, 20), 0, format::kModeStrongest, product);
  for (std::size_t block = 0; block < format::kNumBlocks; ++block) {
    WriteU16LittleEndian(payload, block * format::kBlockSizeBytes, flags[block % flags.size()]);
  }
  return payload;
}

// Columns of `column_bytes` from `first`, numbered from 500.
Payload Columns(std::size_t size_bytes, std::size_t first, std::size_t column_bytes) {
  Payload payload(size_bytes);
  for (std::size_t column = 0; column < 16; ++column) {
    WriteU16LittleEndian(payload, first + column * column_bytes + 8, static_cast<std::uint16_t>(500 + column));
  }
  return payload;
}

TEST(NameOfForeignPayload, IsEmptyForNothingAndForNoise) {
  EXPECT_EQ(NameOfForeignPayload({}), "");
  std::mt19937 random(7);
  for (const std::size_t size : {1, 2, 3, 18, 36, 37, 48, 99, 512, 1080, 1206, 1212, 1248, 1318, 3392, 12608, 24832}) {
    EXPECT_EQ(NameOfForeignPayload(Payload(size)), "") << size;
    EXPECT_EQ(NameOfForeignPayload(Payload(size, 0xFF)), "") << size;
    for (int round = 0; round < 100; ++round) {
      Payload payload(size);
      std::ranges::generate(payload, [&random] { return static_cast<std::uint8_t>(random()); });
      EXPECT_EQ(NameOfForeignPayload(payload), "") << size;
    }
  }
}

TEST(NameOfForeignPayload, IsEmptyForWhateverTheOwnFamilySends) {
  for (const std::uint8_t product : {format::kProductVlp16, format::kProductPuckHiRes, format::kProductHdl32e}) {
    for (const std::uint8_t mode : {format::kModeStrongest, format::kModeLast, format::kModeDual}) {
      for (const int range : {0, 1, 500, 65535}) {
        const auto payload = test::MakeDataPacket(test::Azimuths(35900, 20, mode == format::kModeDual), 3'599'999'999, mode, product,
                                                  {static_cast<std::uint16_t>(range), 255});
        EXPECT_EQ(NameOfForeignPayload(payload), "") << int{product} << " " << int{mode};
      }
    }
  }
  EXPECT_EQ(NameOfForeignPayload(test::MakePositionPacket(1, format::kPpsLocked, test::kValidRmc)), "");
}

TEST(NameOfForeignPayload, KnowsOtherVelodynesByProductByte) {
  for (int product = 0; product < 256; ++product) {
    const auto byte = static_cast<std::uint8_t>(product);
    const auto name = NameOfForeignPayload(test::MakeDataPacket(test::Azimuths(0, 20), 0, format::kModeStrongest, byte));
    if (product == 0x28) {
      EXPECT_EQ(name, "Velodyne VLP-32C");
    } else if (product == 0x31) {
      EXPECT_EQ(name, "Velodyne Velarray");
    } else if (product == 0x63 || product == 0xA1) {
      EXPECT_EQ(name, "Velodyne VLS-128 (Alpha Prime)");
    } else if (product == 0x10 || product == 0x20) {
      EXPECT_EQ(name, "LeiShen");
    } else {
      EXPECT_EQ(name, "") << product;
    }
  }
  EXPECT_EQ(NameOfProduct(0x21), "Velodyne HDL-32E");
  EXPECT_EQ(NameOfProduct(0x22), "Velodyne VLP-16");
  EXPECT_EQ(NameOfProduct(0x24), "Velodyne Puck Hi-Res");
  EXPECT_EQ(NameOfProduct(0x23), "");  // sources differ
}

TEST(NameOfForeignPayload, KnowsOtherVelodynesByTheFlagsOfTheirBanks) {
  EXPECT_EQ(NameOfForeignPayload(WithFlags({0xEEFF, 0xDDFF}, 0x00)), "Velodyne HDL-64E");
  EXPECT_EQ(NameOfForeignPayload(WithFlags({0xEEFF, 0xDDFF}, 0x22)), "Velodyne HDL-64E");  // its last bytes are a status that may hold anything
  EXPECT_EQ(NameOfForeignPayload(WithFlags({0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF}, 0xA1)), "Velodyne VLS-128 (Alpha Prime)");
  EXPECT_EQ(NameOfForeignPayload(WithFlags({0xEEFF, 0x1234}, 0x28)), "");  // damaged
}

TEST(NameOfForeignPayload, KnowsHesaiByItsHeadOfEitherKind) {
  EXPECT_EQ(NameOfForeignPayload(Starting({"\xEE\xFF\x40\x06\x00\x04\x00\x00", 8}, 1194)), "Hesai");                   // Pandar64
  EXPECT_EQ(NameOfForeignPayload(Starting({"\xEE\xFF\x06\x01\x00\x00\x20\x08\x00\x04\x01\x01", 12}, 1080)), "Hesai");  // PandarXT-32
  EXPECT_EQ(NameOfForeignPayload(Starting({"\xEE\xFF\x03\x01\x00\x00\x80\x02\x00\x04\x01\x01", 12}, 1127)), "Hesai");  // QT128
  EXPECT_EQ(NameOfForeignPayload(Starting({"\xEE\xFF\x07\x07\x00\x07\x07\x07\x00\x07\x01\x01", 12}, 1080)), "");
  EXPECT_EQ(NameOfForeignPayload(Starting("\xEE\xFF", 2)), "");
}

TEST(NameOfForeignPayload, KnowsRobosenseByItsMarks) {
  EXPECT_EQ(NameOfForeignPayload(Starting("\x55\xAA\x05\x0A\x5A\xA5\x50\xA0", 1248)), "RoboSense");
  EXPECT_EQ(NameOfForeignPayload(Starting("\x55\xAA\x05\x5A", 1248)), "RoboSense");
  EXPECT_EQ(NameOfForeignPayload(Starting({"\xA5\xFF\x00\x5A\x11\x11\x55\x55", 8}, 1248)), "RoboSense");
  EXPECT_EQ(NameOfForeignPayload(Starting("\x55\xAA\x05\x0A\x5A\xA5\x50\xA0", 1247)), "");
}

TEST(NameOfForeignPayload, KnowsLeishenWhoseBlocksAreThoseOfAVlp16) {
  auto payload = test::MakeDataPacket(test::Azimuths(0, 20), 0);
  payload.resize(1212);
  EXPECT_EQ(NameOfForeignPayload(payload), "LeiShen");
  auto device = Starting({"\xA5\xFF\x00\x5A\x11\x11\x55\x55", 8}, 1206);
  EXPECT_EQ(NameOfForeignPayload(device), "");
  device[1204] = 0x0F;
  device[1205] = 0xF0;
  EXPECT_EQ(NameOfForeignPayload(device), "LeiShen");
}

TEST(NameOfForeignPayload, KnowsOusterBySizeAndColumnsInOrder) {
  for (const std::size_t rows : {16, 32, 64, 128}) {
    const std::size_t legacy_bytes = 16 + 12 * rows + 4;
    auto legacy = Columns(16 * legacy_bytes, 0, legacy_bytes);
    EXPECT_EQ(NameOfForeignPayload(legacy), "Ouster") << rows;
    WriteU16LittleEndian(legacy, 3 * legacy_bytes + 8, 9);
    EXPECT_EQ(NameOfForeignPayload(legacy), "") << rows;
    for (const std::size_t pixel_bytes : {4, 8, 12, 16}) {
      const std::size_t column_bytes = 12 + pixel_bytes * rows;
      auto payload = Columns(64 + 16 * column_bytes, 32, column_bytes);
      EXPECT_EQ(NameOfForeignPayload(payload), "") << "packet type 0";
      payload[0] = 1;
      EXPECT_EQ(NameOfForeignPayload(payload), "Ouster") << rows << " " << pixel_bytes;
    }
  }
}

TEST(NameOfForeignPayload, KnowsLivoxOfBothGenerations) {
  auto old = Starting("\x05", 18 + 100 * 13);
  EXPECT_EQ(NameOfForeignPayload(old), "Livox");
  old[9] = 2;
  EXPECT_EQ(NameOfForeignPayload(old), "");
  old.resize(18 + 96 * 14);
  EXPECT_EQ(NameOfForeignPayload(old), "Livox");
  Payload mid360(36 + 96 * 14);
  WriteU16LittleEndian(mid360, 1, static_cast<std::uint16_t>(mid360.size()));
  WriteU16LittleEndian(mid360, 5, 96);
  mid360[10] = 1;
  EXPECT_EQ(NameOfForeignPayload(mid360), "Livox");
  mid360[5] = 95;
  EXPECT_EQ(NameOfForeignPayload(mid360), "");
}

std::filesystem::path Recording(const std::string& name) { return support::kRecordings / name; }

TEST(NameOfForeignPayloadRecordings, NameAnOusterAndLeaveTheHdl32eToThePacketInterval) {
  const auto ouster = Recording("other_lidar/ouster_single_packet_fragmented.pcap");
  const auto hdl32e = Recording("other_lidar/vv_hdl32_monterey.pcap");
  if (!std::filesystem::exists(ouster) || !std::filesystem::exists(hdl32e)) GTEST_SKIP() << "recordings of other lidars are not at hand";
  std::vector<std::string_view> names;
  CaptureReader reader(ouster);
  while (const auto datagram = reader.Next()) names.push_back(NameOfForeignPayload(datagram->payload));
  EXPECT_EQ(names, std::vector<std::string_view>{"Ouster"});
  CaptureReader others(hdl32e);
  while (const auto datagram = others.Next()) ASSERT_EQ(NameOfForeignPayload(datagram->payload), "");
}

TEST(NameOfForeignPayloadRecordings, NameNoPacketOfARealVlp16) {
  const auto folder = Recording("vlp16");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "recordings of a VLP-16 are not at hand";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".pcap") continue;
    CaptureReader reader(entry.path());
    while (const auto datagram = reader.Next()) {
      ASSERT_EQ(NameOfForeignPayload(datagram->payload), "") << entry.path();
      ++count;
    }
  }
  EXPECT_GT(count, 1000);
}

}  // namespace
}  // namespace lookout::vlp16
