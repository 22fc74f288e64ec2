// Hesai's packets: the recordings at hand against truth by others, and packets made by hand in each return mode and with each fault.
#include "services/lidar/core/models/hesai.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/unit/lidar_models/hesai_packet.hpp"
#include "tests/unit/lidar_models/spinning_capture.hpp"

namespace lookout::lidar {
namespace {

using namespace std::chrono_literals;
using support::kRecordings;

struct HesaiCapture {
  HesaiModel model;
  std::string name;
  std::string angles;
  std::size_t num_true_returns;
  Totals totals;
};

class HesaiCaptureTest : public ::testing::TestWithParam<HesaiCapture> {};

TEST_P(HesaiCaptureTest, GivesEachReturnAsTruthHasIt) {
  const auto& capture = GetParam();
  const auto folder = kRecordings / "lidars";
  const auto file = folder / (capture.name + ".pcap.xz");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  HesaiReader reader(capture.model, ParseHesaiAngles(support::ReadFile(folder / "meta" / capture.angles)));
  std::size_t num_compared = 0;
  const auto totals = CheckCapture(file, folder / "truth" / (capture.name + ".csv.xz"), reader, true, num_compared);
  EXPECT_EQ(totals, capture.totals);
  EXPECT_EQ(num_compared, capture.num_true_returns);
  EXPECT_EQ(reader.head_number(), 1);
}

INSTANTIATE_TEST_SUITE_P(
    Recordings, HesaiCaptureTest,
    ::testing::Values(HesaiCapture{HesaiModel::kXt32, "hesai_xt32_dual", "PandarXT32.csv", 122'926, {2000, 486'606, 892'446'368, 9'650'921}},
                      HesaiCapture{HesaiModel::kXt16, "hesai_xt16_dual", "PandarXT16.csv", 50'662, {1626, 165'138, 484'196'132, 5'400'749}},
                      HesaiCapture{HesaiModel::kQt64, "hesai_qt64_dual", "PandarQT64.csv", 79'652, {1200, 299'376, 538'220'076, 45'253'952}}),
    [](const auto& capture) { return capture.param.name; });

TEST(HesaiCapture, HasStampsAndNumbersThatGoOn) {
  const auto file = kRecordings / "lidars/hesai_xt32_dual.pcap.xz";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  HesaiReader reader(HesaiModel::kXt32);
  Packet packet;
  std::optional<Packet> before;
  for (const auto& payload : PayloadsTo(2368, Unpacked(file))) {
    EXPECT_EQ(HesaiModelOf(payload), HesaiModel::kXt32);
    ASSERT_EQ(reader.Read(payload, packet), PacketFault::kNone);
    ASSERT_TRUE(packet.number);
    if (before) {
      EXPECT_EQ(packet.number->number, before->number->number + 1);
      EXPECT_LT(std::chrono::abs(packet.stamp - before->stamp - before->duration), 2us);
    } else {
      EXPECT_EQ(packet.stamp, 1'564'024'769'619'165us);
    }
    before = packet;
  }
  EXPECT_EQ(packet.stamp, 1'564'024'770'019'000us);
}

constexpr std::array kHesaiModels{HesaiModel::kXt16,  HesaiModel::kXt32,      HesaiModel::kXt32m,   HesaiModel::kQt64,
                                  HesaiModel::kQt128, HesaiModel::kPandar40p, HesaiModel::kPandar64};

std::size_t HesaiRingOf(const Head& head, int channel) {
  const auto found = std::ranges::find(head.beams, channel, &Beam::channel);
  return static_cast<std::size_t>(found - head.beams.begin());
}

struct HesaiCell {
  std::uint32_t range;
  std::uint8_t reflectivity;

  bool operator==(const HesaiCell&) const = default;
};
void PrintTo(const HesaiCell& cell, std::ostream* out) { *out << cell.range << " (" << int{cell.reflectivity} << ")"; }

HesaiCell HesaiCellOf(const Packet& packet, const Head& head, std::size_t column, int channel, std::size_t return_index) {
  const std::size_t cell = (column * head.beams.size() + HesaiRingOf(head, channel)) * head.returns.size() + return_index;
  return {packet.range[cell], packet.reflectivity[cell]};
}

/// Reads a pair (or three) of one shot of channel 3, as sent in this order.
std::vector<HesaiCell> ReadHesaiShot(HesaiReader& reader, HesaiModel model, std::uint8_t mode, const std::vector<HesaiCell>& sent) {
  MadeHesaiPacket made(model, mode);
  for (std::size_t i = 0; i < sent.size(); ++i) made.SetCell(i, 3, static_cast<std::uint16_t>(sent[i].range), sent[i].reflectivity);
  Packet packet;
  EXPECT_EQ(reader.Read(made.bytes, packet), PacketFault::kNone) << reader.reason();
  std::vector<HesaiCell> cells;
  for (std::size_t i = 0; i < reader.head().returns.size(); ++i) cells.push_back(HesaiCellOf(packet, reader.head(), 0, 3, i));
  return cells;
}

TEST(Hesai, TellsEachModelBySizeAndHead) {
  for (const auto model : kHesaiModels) {
    const MadeHesaiPacket made(model, 0x37);
    EXPECT_EQ(HesaiModelOf(made.bytes), model) << NameOf(model);
    auto other = made.bytes;
    other[made.head > 0 ? 0 : made.block] = 0;
    EXPECT_EQ(HesaiModelOf(other), std::nullopt) << NameOf(model);
  }
  EXPECT_EQ(HesaiModelOf({}), std::nullopt);
}

TEST(Hesai, ReadsEachModelsBlocksChannelsAndStamp) {
  for (const auto model : kHesaiModels) {
    MadeHesaiPacket made(model, 0x37);
    for (std::size_t block = 0; block < made.num_blocks; ++block) {
      made.SetAzimuth(block, static_cast<std::uint16_t>(35'900 + 10 * block));
      made.SetCell(block, 0, static_cast<std::uint16_t>(1000 + block), 7);
      made.SetCell(block, 15, 65'535, 255);
    }
    HesaiReader reader(model);
    Packet packet;
    ASSERT_EQ(reader.Read(made.bytes, packet), PacketFault::kNone) << reader.reason();
    const auto& head = reader.head();
    EXPECT_EQ(head.model, NameOf(model));
    EXPECT_EQ(head.stamp, StampKind::kAbsolute);
    EXPECT_DOUBLE_EQ(head.range_unit_m, model == HesaiModel::kXt32m ? 0.005 : 0.004);
    ASSERT_EQ(packet.columns.size(), made.num_blocks);
    EXPECT_EQ(packet.stamp, std::chrono::sys_days(std::chrono::year(2026) / 11 / 27).time_since_epoch() + 12h + 1s + 250us);
    for (std::size_t column = 0; column < made.num_blocks; ++column) {
      EXPECT_NEAR(packet.columns[column].azimuth_rad * 180.0 / std::numbers::pi, 359.0 + 0.1 * static_cast<double>(column), 1e-9);
      EXPECT_EQ(HesaiCellOf(packet, head, column, 0, 0), (HesaiCell{static_cast<std::uint32_t>(1000 + column), 7}));
      EXPECT_EQ(HesaiCellOf(packet, head, column, 15, 0), (HesaiCell{65'535, 255}));
      EXPECT_EQ(HesaiCellOf(packet, head, column, 1, 0), (HesaiCell{0, 0}));
    }
    EXPECT_TRUE(std::ranges::is_sorted(head.beams, {}, &Beam::elevation_rad));
    const auto step = packet.columns[1].time - packet.columns[0].time;
    EXPECT_LT(std::chrono::abs(packet.duration - static_cast<std::int64_t>(made.num_blocks) * step), 10ns);
  }
}

// Times of the first and of another channel in the first and last block, as public drivers compute them.
TEST(Hesai, FiresAtTheTimesOfTheMaker) {
  struct Shot {
    HesaiModel model;
    std::uint8_t mode;
    std::size_t column;
    int channel;
    double time_us;
  };
  const std::vector<Shot> shots{
      {HesaiModel::kXt32, 0x37, 0, 0, 5.632 - 350.0 + 0.368},
      {HesaiModel::kXt32, 0x39, 3, 31, 5.632 + 0.368 + 1.512 * 31},
      {HesaiModel::kXt16, 0x37, 7, 15, 5.632 + 0.368 + 3.024 * 15},
      {HesaiModel::kXt32m, 0x37, 0, 17, 5.632 - 250.0 + 0.368 + 2.888},
      {HesaiModel::kXt32m, 0x3d, 0, 0, 5.632 - 50.0 + 0.368},
      {HesaiModel::kQt64, 0x37, 3, 0, 25.71 + 500.0 + 12.31},
      {HesaiModel::kQt64, 0x3b, 1, 55, 25.71 + 166.67 + 129.6},
      {HesaiModel::kPandar40p, 0x37, 0, 0, -28.58 - 9 * 55.56 - 42.22},
      {HesaiModel::kPandar40p, 0x39, 4, 38, -28.58 - 16.04},
      {HesaiModel::kPandar64, 0x37, 0, 7, -42.58 - 5 * 55.56 - 46.796},
      {HesaiModel::kPandar64, 0x39, 2, 63, -42.58 - 12.748},
      {HesaiModel::kQt128, 0x37, 1, 0, 9.0 + 111.11 + 2.312},
      {HesaiModel::kQt128, 0x37, 0, 98, 9.0 + 0.6},
  };
  for (const auto& shot : shots) {
    HesaiReader reader(shot.model);
    Packet packet;
    ASSERT_EQ(reader.Read(MadeHesaiPacket(shot.model, shot.mode).bytes, packet), PacketFault::kNone);
    const auto time = packet.columns.at(shot.column).time + reader.head().beams[HesaiRingOf(reader.head(), shot.channel)].time_offset;
    EXPECT_NEAR(std::chrono::duration<double>(time).count() * 1e6, shot.time_us, 0.5) << NameOf(shot.model) << " channel " << shot.channel;
  }
}

TEST(Hesai, NamesTheReturnOfSingleModes) {
  using enum ReturnKind;
  HesaiReader reader(HesaiModel::kXt32);
  const std::vector<std::pair<std::uint8_t, ReturnKind>> modes{{0x33, kFirst}, {0x34, kSecond}, {0x37, kStrongest}, {0x38, kLast}};
  for (const auto& [mode, kind] : modes) {
    EXPECT_EQ(ReadHesaiShot(reader, HesaiModel::kXt32, mode, {{500, 9}}), (std::vector<HesaiCell>{{500, 9}}));
    EXPECT_EQ(reader.head().returns, std::vector{kind});
  }
  EXPECT_EQ(reader.head_number(), 4);
}

// XT32 sends the nearer first, XT16 the farther, both under 0x39: the place in the packet says nothing.
TEST(Hesai, NamesReturnsOfAPairByTheirRanges) {
  using enum ReturnKind;
  struct Pair {
    std::uint8_t mode;
    std::vector<ReturnKind> kinds;
  };
  for (const auto model : {HesaiModel::kXt32, HesaiModel::kPandar64}) {
    HesaiReader reader(model);
    for (const auto& [mode, kinds] :
         std::vector<Pair>{{0x39, {kStrongest, kLast}}, {0x3a, {kFirst, kSecond}}, {0x3b, {kFirst, kLast}}, {0x3c, {kFirst, kStrongest}}}) {
      EXPECT_EQ(ReadHesaiShot(reader, model, mode, {{500, 9}, {800, 2}}), (std::vector<HesaiCell>{{500, 9}, {800, 2}}));
      EXPECT_EQ(ReadHesaiShot(reader, model, mode, {{800, 2}, {500, 9}}), (std::vector<HesaiCell>{{500, 9}, {800, 2}}));
      EXPECT_EQ(ReadHesaiShot(reader, model, mode, {{500, 9}, {500, 9}}), (std::vector<HesaiCell>{{500, 9}, {500, 9}}));
      EXPECT_EQ(ReadHesaiShot(reader, model, mode, {{0, 9}, {65'535, 1}}), (std::vector<HesaiCell>{{65'535, 1}, {0, 0}}));
      EXPECT_EQ(ReadHesaiShot(reader, model, mode, {{65'535, 1}, {0, 9}}), (std::vector<HesaiCell>{{65'535, 1}, {0, 0}}));
      EXPECT_EQ(ReadHesaiShot(reader, model, mode, {{0, 1}, {0, 9}}), (std::vector<HesaiCell>{{0, 0}, {0, 0}}));
      EXPECT_EQ(reader.head().returns, kinds);
      EXPECT_FALSE(reader.head().is_hearing_three);
    }
  }
}

TEST(Hesai, KeepsStrongestAndSecondAsSent) {
  HesaiReader reader(HesaiModel::kXt32);
  EXPECT_EQ(ReadHesaiShot(reader, HesaiModel::kXt32, 0x3e, {{800, 9}, {500, 2}}), (std::vector<HesaiCell>{{800, 9}, {500, 2}}));
  EXPECT_EQ(reader.head().returns, (std::vector{ReturnKind::kStrongest, ReturnKind::kSecond}));
}

TEST(Hesai, KeepsFirstAndLastOfThreeReturns) {
  HesaiReader reader(HesaiModel::kXt32m);
  const std::vector<HesaiCell> nearest_and_farthest{{300, 3}, {900, 1}};
  EXPECT_EQ(ReadHesaiShot(reader, HesaiModel::kXt32m, 0x3d, {{300, 3}, {900, 1}, {500, 9}}), nearest_and_farthest);
  EXPECT_EQ(ReadHesaiShot(reader, HesaiModel::kXt32m, 0x3d, {{900, 1}, {500, 9}, {300, 3}}), nearest_and_farthest);
  EXPECT_EQ(ReadHesaiShot(reader, HesaiModel::kXt32m, 0x3d, {{0, 0}, {900, 1}, {300, 3}}), nearest_and_farthest);
  EXPECT_EQ(ReadHesaiShot(reader, HesaiModel::kXt32m, 0x3d, {{0, 0}, {900, 1}, {0, 0}}), (std::vector<HesaiCell>{{900, 1}, {0, 0}}));
  EXPECT_EQ(ReadHesaiShot(reader, HesaiModel::kXt32m, 0x3d, {}), (std::vector<HesaiCell>{{0, 0}, {0, 0}}));
  EXPECT_TRUE(reader.head().is_hearing_three);
  EXPECT_EQ(reader.head().returns, (std::vector{ReturnKind::kFirst, ReturnKind::kLast}));

  HesaiReader four_blocks(HesaiModel::kQt64);
  Packet packet;
  EXPECT_EQ(four_blocks.Read(MadeHesaiPacket(HesaiModel::kQt64, 0x3d).bytes, packet), PacketFault::kMode);
}

TEST(Hesai, TellsTheNewHeadWhenModeOrUnitChanges) {
  HesaiReader reader(HesaiModel::kXt32m);
  Packet packet;
  MadeHesaiPacket made(HesaiModel::kXt32m, 0x37);
  reader.Read(made.bytes, packet);
  reader.Read(made.bytes, packet);
  EXPECT_EQ(reader.head_number(), 1);
  made.bytes[9] = 4;
  reader.Read(made.bytes, packet);
  EXPECT_EQ(reader.head_number(), 2);
  EXPECT_DOUBLE_EQ(reader.head().range_unit_m, 0.004);
}

TEST(Hesai, NumbersPacketsWhereTheyEndWithANumber) {
  Packet packet;
  MadeHesaiPacket made(HesaiModel::kXt32, 0x37);
  WriteU32LittleEndian(std::span(made.bytes).last(4), 0, 0xFFFFFFFE);
  HesaiReader reader(HesaiModel::kXt32);
  ASSERT_EQ(reader.Read(made.bytes, packet), PacketFault::kNone);
  ASSERT_TRUE(packet.number);
  EXPECT_EQ(packet.number->number, 0xFFFFFFFEU);
  EXPECT_EQ(packet.number->modulus, 0x100000000U);

  MadeHesaiPacket short_packet(HesaiModel::kPandar64, 0x37);
  HesaiReader pandar(HesaiModel::kPandar64);
  ASSERT_EQ(pandar.Read(short_packet.bytes, packet), PacketFault::kNone);
  EXPECT_FALSE(packet.number);
  short_packet.bytes.insert(short_packet.bytes.end(), {5, 0, 0, 0});
  ASSERT_EQ(pandar.Read(short_packet.bytes, packet), PacketFault::kNone);
  ASSERT_TRUE(packet.number);
  EXPECT_EQ(packet.number->number, 5U);
}

/// Expects that the payload is refused, with the model in the reason, and that packet and head stay.
void ExpectHesaiRefused(HesaiModel model, const Payload& payload, PacketFault fault) {
  HesaiReader reader(model);
  Packet packet;
  MadeHesaiPacket good(model, 0x37);
  good.SetCell(0, 0, 700, 1);
  ASSERT_EQ(reader.Read(good.bytes, packet), PacketFault::kNone);
  const auto before = packet.range;
  EXPECT_EQ(reader.Read(payload, packet), fault) << reader.reason();
  EXPECT_NE(reader.reason().find(NameOf(model)), std::string::npos) << reader.reason();
  EXPECT_EQ(packet.range, before);
  EXPECT_EQ(reader.head_number(), 1);
}

TEST(Hesai, RefusesPayloadsOfEveryOtherLength) {
  for (const auto model : kHesaiModels) {
    HesaiReader reader(model);
    Packet packet;
    const MadeHesaiPacket made(model, 0x37);
    for (std::size_t size = 0; size < 1600; ++size) {
      auto cut = made.bytes;
      cut.resize(size);
      EXPECT_EQ(reader.Read(cut, packet), reader.MayBe(size) ? PacketFault::kNone : PacketFault::kSize);
    }
    EXPECT_TRUE(reader.MayBe(made.bytes.size()));
  }
}

TEST(Hesai, RefusesAnotherModelByName) {
  HesaiReader reader(HesaiModel::kXt32);
  Packet packet;
  EXPECT_EQ(reader.Read(MadeHesaiPacket(HesaiModel::kXt16, 0x37).bytes, packet), PacketFault::kSize);
  EXPECT_EQ(reader.reason(), "Hesai XT32: the packet is of a Hesai XT16");
  for (const std::size_t place : {0, 1, 6, 7}) {
    MadeHesaiPacket made(HesaiModel::kXt32, 0x37);
    made.bytes[place] ^= 0x40;
    ExpectHesaiRefused(HesaiModel::kXt32, made.bytes, PacketFault::kHead);
  }
  MadeHesaiPacket flag(HesaiModel::kPandar40p, 0x37);
  flag.bytes[9 * flag.block] = 0;
  ExpectHesaiRefused(HesaiModel::kPandar40p, flag.bytes, PacketFault::kHead);
}

TEST(Hesai, RefusesUnitsModesAzimuthsAndDatesThatAreNone) {
  for (const int unit_mm : {0, 9, 255}) {
    MadeHesaiPacket made(HesaiModel::kXt32, 0x37);
    made.bytes[9] = static_cast<std::uint8_t>(unit_mm);
    ExpectHesaiRefused(HesaiModel::kXt32, made.bytes, PacketFault::kHead);
  }
  for (int mode = 0; mode < 256; ++mode) {
    if ((mode >= 0x37 && mode <= 0x3e && mode != 0x3d) || mode == 0x33 || mode == 0x34) continue;
    ExpectHesaiRefused(HesaiModel::kXt32, MadeHesaiPacket(HesaiModel::kXt32, static_cast<std::uint8_t>(mode)).bytes, PacketFault::kMode);
  }
  for (const auto model : kHesaiModels) {
    for (const int azimuth_cdeg : {36'000, 65'535}) {
      MadeHesaiPacket made(model, 0x37);
      made.SetAzimuth(made.num_blocks - 1, static_cast<std::uint16_t>(azimuth_cdeg));
      ExpectHesaiRefused(model, made.bytes, PacketFault::kAzimuth);
    }
    MadeHesaiPacket dual(model, 0x39);
    dual.SetAzimuth(1, 20);
    ExpectHesaiRefused(model, dual.bytes, PacketFault::kAzimuth);
    // Month, day, hour, minute, second.
    const std::vector<std::pair<std::size_t, int>> wrong_dates{{1, 0}, {1, 13}, {2, 0}, {2, 31}, {3, 24}, {4, 60}, {5, 61}};
    for (const auto& [place, value] : wrong_dates) {
      MadeHesaiPacket made(model, 0x37);
      made.bytes[made.tail + made.date_at + place] = static_cast<std::uint8_t>(value);
      ExpectHesaiRefused(model, made.bytes, PacketFault::kStamp);
    }
    MadeHesaiPacket made(model, 0x37);
    WriteU32LittleEndian(std::span(made.bytes).subspan(made.tail + made.us_at), 0, 2'000'000);
    ExpectHesaiRefused(model, made.bytes, PacketFault::kStamp);
  }
}

TEST(Hesai, ReadsSecondsInPlaceOfADate) {
  MadeHesaiPacket made(HesaiModel::kXt32, 0x37);
  const Payload seconds{0, 0, 0x6A, 0x00, 0x00, 0x01};
  std::ranges::copy(seconds, made.bytes.begin() + static_cast<std::ptrdiff_t>(made.tail + made.date_at));
  HesaiReader reader(HesaiModel::kXt32);
  Packet packet;
  ASSERT_EQ(reader.Read(made.bytes, packet), PacketFault::kNone);
  EXPECT_EQ(packet.stamp, std::chrono::seconds(0x6A000001) + 250us);
}

std::uint32_t SlowCrc32Mpeg2(Bytes bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    for (int bit = 7; bit >= 0; --bit) {
      const bool is_odd = ((crc >> 31) ^ (byte >> bit & 1U)) != 0;
      crc = crc << 1 ^ (is_odd ? 0x04C11DB7U : 0U);
    }
  }
  return crc;
}

TEST(Hesai, RefusesAWrongChecksumOnlyOfASensorWhoseWasRight) {
  constexpr std::size_t kCrcAt = 1040;
  MadeHesaiPacket made(HesaiModel::kQt128, 0x37);
  made.SetCell(0, 5, 1234, 5);
  HesaiReader reader(HesaiModel::kQt128);
  Packet packet;
  EXPECT_EQ(reader.Read(made.bytes, packet), PacketFault::kNone) << "of an older firmware, without a checksum";
  auto right = made.bytes;
  WriteU32LittleEndian(std::span(right).subspan(kCrcAt), 0, SlowCrc32Mpeg2(Bytes(right).subspan(12, kCrcAt - 12)));
  EXPECT_EQ(reader.Read(right, packet), PacketFault::kNone);
  right[500] ^= 1;
  EXPECT_EQ(reader.Read(right, packet), PacketFault::kChecksum);
  EXPECT_EQ(reader.Read(made.bytes, packet), PacketFault::kChecksum);
}

std::string HesaiTable(std::size_t num_channels, const std::string& title, bool has_carriage_return) {
  std::string text = title;
  for (std::size_t i = 1; i <= num_channels; ++i) {
    text += std::to_string(i) + "," + std::to_string(15 - static_cast<int>(i)) + ".5,-1.042" + (has_carriage_return ? "\r\n" : "\n");
  }
  return text;
}

TEST(HesaiAngles, AreReadInEveryFormOfTheMaker) {
  const std::string byte_order_mark = "\xEF\xBB\xBF";
  const std::vector<std::string> titles{"",
                                        "Channel,Elevation,Azimuth\n",
                                        "Laser id,Elevation,Azimuth\r\n",
                                        byte_order_mark + "Channel,Elevation,Azimuth\r\n",
                                        "EEFF,1,1\nChannel,Elevation,Azimuth\n",
                                        "\n# of unit 7\nLaser ID, Elevation (deg), Azimuth Offset (deg)\n"};
  for (const auto& title : titles) {
    for (const bool has_carriage_return : {false, true}) {
      const auto angles = ParseHesaiAngles(HesaiTable(16, title, has_carriage_return));
      ASSERT_EQ(angles.size(), 16U) << title;
      EXPECT_EQ(angles[0], (HesaiAngle{14.5, -1.042})) << title;
      EXPECT_EQ(angles[15], (HesaiAngle{-1.5, -1.042})) << title;
    }
  }
  EXPECT_EQ(ParseHesaiAngles("Azimuth;Channel;Elevation\n358.9;1;+2\n0.5\t2\t-3,,\n").at(0).elevation_deg, 2.0);
  EXPECT_NEAR(ParseHesaiAngles("Azimuth;Channel;Elevation\n358.9;1;2\n0.5\t2\t-3,,\n").at(0).azimuth_offset_deg, -1.1, 1e-9);
}

TEST(HesaiAngles, AreRefusedWithTheLineWhereTheyAreWrong) {
  const auto reason_of = [](const std::string& csv) -> std::string {
    try {
      ParseHesaiAngles(csv);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(reason_of(""), "has no channels");
  EXPECT_EQ(reason_of("Channel,Elevation,Azimuth\n"), "has no channels");
  EXPECT_EQ(reason_of("Channel,Fire time\n1,2\n"), "line 1: must have the titles Channel, Elevation and Azimuth");
  EXPECT_EQ(reason_of("1,2,3\n2,2\n"), "line 2: must have a channel, an elevation and an azimuth");
  EXPECT_EQ(reason_of("1,2,3\n\n2,x,3\n"), "line 3: channel, elevation and azimuth must be numbers");
  EXPECT_EQ(reason_of("1,nan,3\n"), "line 1: channel, elevation and azimuth must be numbers");
  EXPECT_EQ(reason_of("1,2,1e999\n"), "line 1: channel, elevation and azimuth must be numbers");
  EXPECT_EQ(reason_of("0,2,3\n"), "line 1: channel must be 1 to 128");
  EXPECT_EQ(reason_of("1.5,2,3\n"), "line 1: channel must be 1 to 128");
  EXPECT_EQ(reason_of("129,2,3\n"), "line 1: channel must be 1 to 128");
  EXPECT_EQ(reason_of("1,90.1,3\n"), "line 1: elevation must be within -90 and 90 deg");
  EXPECT_EQ(reason_of("1,2,361\n"), "line 1: azimuth must be within -360 and 360 deg");
  EXPECT_EQ(reason_of("1,2,3\n1,4,3\n"), "line 2: channel 1 is there twice");
  EXPECT_EQ(reason_of("1,2,3\n3,4,3\n"), "channel 2 is missing");
  EXPECT_EQ(reason_of("1,0,0\n2,0,0\n"), "all channels have the same elevation");
  EXPECT_EQ(reason_of(std::string(70'000, '\n')), "has more than 65536 bytes: no table of angles");
}

TEST(HesaiAngles, OfAnotherNumberOfChannelsAreRefused) {
  EXPECT_THROW(HesaiReader(HesaiModel::kXt32, NominalHesaiAngles(HesaiModel::kXt16)), std::runtime_error);
}

TEST(HesaiAngles, AreKnownOfEachModelWithoutAFile) {
  for (const auto model : kHesaiModels) {
    const HesaiReader reader(model);
    EXPECT_EQ(reader.head().beams.size(), NominalHesaiAngles(model).size());
    for (const auto& beam : reader.head().beams) EXPECT_LT(std::abs(beam.azimuth_offset_rad), 0.2);
  }
  EXPECT_NEAR(NominalHesaiAngles(HesaiModel::kQt128)[127].elevation_deg, 52.627, 1e-9);
  EXPECT_NEAR(NominalHesaiAngles(HesaiModel::kQt128)[96].azimuth_offset_deg, -6.25, 1e-9);
}

}  // namespace
}  // namespace lookout::lidar
