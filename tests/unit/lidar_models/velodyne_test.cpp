// Velodyne's packets of more than 16 lasers: the recordings at hand against truth, and packets made by hand.
#include "services/lidar/core/models/velodyne.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/unit/lidar_models/spinning_capture.hpp"
#include "tests/unit/lidar_models/velodyne_packet.hpp"

namespace lookout::lidar {
namespace {

using namespace std::chrono_literals;
using support::kRecordings;

void ExpectCapture(VelodyneModel model, const std::string& capture, const std::string& truth, std::size_t num_true_returns, const Totals& totals) {
  const auto folder = kRecordings / "lidars";
  if (!std::filesystem::exists(folder / capture)) GTEST_SKIP() << "no recording at " << folder / capture;
  VelodyneReader reader(model);
  std::size_t num_compared = 0;
  EXPECT_EQ(CheckCapture(folder / capture, folder / "truth" / truth, reader, false, num_compared), totals);
  EXPECT_EQ(num_compared, num_true_returns);
}

TEST(VelodyneCapture, OfAVlp32cGivesEachReturnAsTruthHasIt) {
  ExpectCapture(VelodyneModel::kVlp32c, "velodyne_vlp32c.pcap.xz", "velodyne_vlp32c.csv.xz", 52'661, {379, 131'305, 610'880'656, 6'028'208});
}

TEST(VelodyneCapture, OfAnHdl32eGivesEachReturnAsTruthHasIt) {
  ExpectCapture(VelodyneModel::kHdl32e, "../other_lidar/vv_hdl32_monterey.pcap", "velodyne_hdl32e.csv.xz", 63'910,
                {2702, 872'800, 11'930'321'460, 11'408'195});
}

/// The greatest distance between a packet's stamp and the one before plus its duration.
std::chrono::nanoseconds StampError(VelodyneModel model, const std::filesystem::path& file, std::chrono::nanoseconds last_stamp) {
  VelodyneReader reader(model);
  Packet packet;
  std::chrono::nanoseconds due = 0ns;
  std::chrono::nanoseconds error = 0ns;
  for (const auto& payload : PayloadsTo(2368, Unpacked(file))) {
    EXPECT_EQ(VelodyneModelOf(payload), model);
    EXPECT_EQ(reader.Read(payload, packet), PacketFault::kNone);
    if (due != 0ns) error = std::max(error, std::chrono::nanoseconds(std::chrono::abs(packet.stamp - due)));
    due = packet.stamp + packet.duration;
  }
  EXPECT_EQ(packet.stamp, last_stamp);
  return error;
}

TEST(VelodyneCapture, OfAnHdl32eHasStampsThatGoOnByTheDurations) {
  const auto file = kRecordings / "other_lidar/vv_hdl32_monterey.pcap";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  EXPECT_LT(StampError(VelodyneModel::kHdl32e, file, 394'697'428us), 3us);
}

// The head skips half of each rotation in the middle of a packet, which takes 49.7 ms: 0.1 % of it is how well the rate is known.
TEST(VelodyneCapture, OfAVlp32cHasStampsThatGoOnByTheDurationsOverAGap) {
  const auto file = kRecordings / "lidars/velodyne_vlp32c.pcap.xz";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  EXPECT_LT(StampError(VelodyneModel::kVlp32c, file, 626'108'735us), 50us);
}

constexpr std::array kVelodyneModels{VelodyneModel::kHdl32e, VelodyneModel::kVlp32c, VelodyneModel::kVls128};

TEST(Velodyne, ReadsEachModelInEachReturnMode) {
  using enum ReturnKind;
  const std::vector<std::pair<std::uint8_t, std::vector<ReturnKind>>> modes{{0x37, {kStrongest}}, {0x38, {kLast}}, {0x39, {kLast, kStrongest}}};
  for (const auto model : kVelodyneModels) {
    VelodyneReader reader(model);
    Packet packet;
    int num_heads = 0;
    for (const auto& [mode, kinds] : modes) {
      ASSERT_EQ(reader.Read(MakeVelodynePacket(model, mode, 35'990), packet), PacketFault::kNone) << reader.reason();
      const auto& head = reader.head();
      EXPECT_EQ(reader.head_number(), ++num_heads);
      EXPECT_EQ(head.returns, kinds);
      EXPECT_EQ(head.model, NameOf(model));
      EXPECT_EQ(head.stamp, StampKind::kPastHour);
      EXPECT_EQ(packet.stamp, 123'456'789us);
      EXPECT_FALSE(packet.number);
      EXPECT_TRUE(std::ranges::is_sorted(head.beams, {}, &Beam::elevation_rad));
      const std::size_t num_columns = 12 / (kinds.size() * (model == VelodyneModel::kVls128 ? 4 : 1));
      ASSERT_EQ(packet.columns.size(), num_columns);
      ASSERT_EQ(packet.range.size(), num_columns * head.num_cells_of_column());
      EXPECT_NEAR(packet.columns[1].azimuth_rad, 10 * std::numbers::pi / 18'000.0, 1e-12);
      EXPECT_EQ(packet.duration, static_cast<std::int64_t>(num_columns) * packet.columns[1].time);
      for (std::size_t cell = 0; cell < packet.range.size(); ++cell) {
        const auto laser = static_cast<std::uint32_t>(head.beams[cell / kinds.size() % head.beams.size()].channel);
        EXPECT_EQ(packet.range[cell], 1 + laser + 200 * (cell % kinds.size()) + 1000 * (cell / head.num_cells_of_column()));
        EXPECT_EQ(packet.reflectivity[cell], laser);
      }
    }
  }
}

// Some firmware may send the blocks of one return after those of the other: the flag names the bank.
TEST(Velodyne, FindsTheBanksOfAVls128ByTheirFlags) {
  const auto pairs = MakeVelodynePacket(VelodyneModel::kVls128, 0x39);
  auto rows = pairs;
  for (std::size_t block = 0; block < 8; ++block) {
    const std::size_t bank = block % 4;
    const std::size_t return_index = block / 4;
    std::copy_n(pairs.begin() + static_cast<std::ptrdiff_t>(100 * (2 * bank + return_index)), 100,
                rows.begin() + static_cast<std::ptrdiff_t>(100 * block));
  }
  VelodyneReader reader(VelodyneModel::kVls128);
  Packet one;
  Packet other;
  ASSERT_EQ(reader.Read(pairs, one), PacketFault::kNone);
  ASSERT_EQ(reader.Read(rows, other), PacketFault::kNone) << reader.reason();
  EXPECT_EQ(one.columns.size(), 1U);
  EXPECT_EQ(one.range, other.range);
}

TEST(Velodyne, TurnsOnUntilEachLaser) {
  for (const auto model : kVelodyneModels) {
    const VelodyneReader reader(model);
    for (const auto& beam : reader.head().beams) EXPECT_EQ(beam.turning_time, beam.time_offset);
  }
  const VelodyneReader vlp32c(VelodyneModel::kVlp32c);
  const auto& beams = vlp32c.head().beams;
  EXPECT_EQ(std::ranges::find(beams, 31, &Beam::channel)->time_offset, 15 * 2304ns);
  const VelodyneReader vls128(VelodyneModel::kVls128);
  EXPECT_EQ(std::ranges::find(vls128.head().beams, 63, &Beam::channel)->time_offset, 7 * 2760ns);
  EXPECT_EQ(std::ranges::find(vls128.head().beams, 64, &Beam::channel)->time_offset, 9 * 2760ns);
}

void SetVelodyneAzimuth(Payload& payload, std::size_t block, std::uint16_t azimuth_cdeg) {
  WriteU16LittleEndian(std::span(payload), 100 * block + 2, azimuth_cdeg);
}

TEST(Velodyne, GivesAJumpTheTimeThatTheHeadNeeds) {
  VelodyneReader reader(VelodyneModel::kVlp32c);
  Packet packet;
  ASSERT_EQ(reader.Read(MakeVelodynePacket(VelodyneModel::kVlp32c, 0x37), packet), PacketFault::kNone);
  EXPECT_EQ(packet.columns[6].time, 6 * 55'296ns);
  auto jump = MakeVelodynePacket(VelodyneModel::kVlp32c, 0x37);
  for (std::size_t block = 6; block < 12; ++block) SetVelodyneAzimuth(jump, block, static_cast<std::uint16_t>(1000 + 20 * (block + 899)));
  ASSERT_EQ(reader.Read(jump, packet), PacketFault::kNone);
  EXPECT_EQ(packet.columns[5].time, 5 * 55'296ns);
  EXPECT_EQ(packet.columns[6].time, (6 + 899) * 55'296ns);
  EXPECT_EQ(packet.duration, (12 + 899) * 55'296ns);
  auto back = MakeVelodynePacket(VelodyneModel::kVlp32c, 0x37);
  SetVelodyneAzimuth(back, 6, 1098);
  ASSERT_EQ(reader.Read(back, packet), PacketFault::kNone);
  EXPECT_EQ(packet.columns[11].time, 11 * 55'296ns);
}

TEST(Velodyne, TakesAJumpOfAHeadThatStandsForNoTime) {
  VelodyneReader reader(VelodyneModel::kHdl32e);
  Packet packet;
  auto still = MakeVelodynePacket(VelodyneModel::kHdl32e, 0x37);
  for (std::size_t block = 0; block < 12; ++block) SetVelodyneAzimuth(still, block, block < 6 ? 1000 : 9000);
  ASSERT_EQ(reader.Read(still, packet), PacketFault::kNone);
  EXPECT_EQ(packet.duration, 12 * 46'080ns);
}

/// Expects that the payload is refused, with the model in the reason, and that packet and head stay.
void ExpectVelodyneRefused(VelodyneModel model, const Payload& payload, PacketFault fault) {
  VelodyneReader reader(model);
  Packet packet;
  ASSERT_EQ(reader.Read(MakeVelodynePacket(model, 0x37), packet), PacketFault::kNone);
  const auto before = packet.range;
  EXPECT_EQ(reader.Read(payload, packet), fault) << reader.reason();
  EXPECT_NE(reader.reason().find(NameOf(model)), std::string::npos) << reader.reason();
  EXPECT_EQ(packet.range, before);
  EXPECT_EQ(reader.head_number(), 1);
}

TEST(Velodyne, RefusesPayloadsOfEveryOtherLength) {
  VelodyneReader reader(VelodyneModel::kVlp32c);
  Packet packet;
  for (std::size_t size = 0; size < 1600; ++size) {
    auto payload = MakeVelodynePacket(VelodyneModel::kVlp32c, 0x37);
    payload.resize(size);
    EXPECT_EQ(reader.Read(payload, packet), size == 1206 ? PacketFault::kNone : PacketFault::kSize);
    EXPECT_EQ(reader.MayBe(size), size == 1206);
  }
}

TEST(Velodyne, RefusesAnotherModelByName) {
  VelodyneReader reader(VelodyneModel::kVlp32c);
  Packet packet;
  EXPECT_EQ(reader.Read(MakeVelodynePacket(VelodyneModel::kHdl32e, 0x37), packet), PacketFault::kHead);
  EXPECT_EQ(reader.reason(), "Velodyne VLP-32C: the packet is of a Velodyne HDL-32E");
  auto vlp16 = MakeVelodynePacket(VelodyneModel::kVlp32c, 0x37);
  vlp16[1205] = 0x22;
  EXPECT_EQ(VelodyneModelOf(vlp16), std::nullopt);
  ExpectVelodyneRefused(VelodyneModel::kVlp32c, vlp16, PacketFault::kHead);
  auto early = MakeVelodynePacket(VelodyneModel::kVls128, 0x37);
  early[1205] = 0x63;
  EXPECT_EQ(VelodyneModelOf(early), VelodyneModel::kVls128);
}

TEST(Velodyne, RefusesFlagsModesAndAzimuthsThatAreNone) {
  for (const auto model : kVelodyneModels) {
    auto flag = MakeVelodynePacket(model, 0x37);
    flag[100 * 11] = 0;
    ExpectVelodyneRefused(model, flag, PacketFault::kHead);
    auto bank = MakeVelodynePacket(model, 0x37);
    bank[100 * 11 + 1] = 0xDD;
    ExpectVelodyneRefused(model, bank, PacketFault::kHead);
    for (const int mode : {0, 0x36, 0x3a, 0xff})
      ExpectVelodyneRefused(model, MakeVelodynePacket(model, static_cast<std::uint8_t>(mode)), PacketFault::kMode);
    auto beyond = MakeVelodynePacket(model, 0x37);
    for (std::size_t block = 0; block < 12; ++block) SetVelodyneAzimuth(beyond, block, 36'100);
    ExpectVelodyneRefused(model, beyond, PacketFault::kAzimuth);
    auto unequal = MakeVelodynePacket(model, 0x39);
    SetVelodyneAzimuth(unequal, 1, 1001);
    ExpectVelodyneRefused(model, unequal, PacketFault::kAzimuth);
  }
  auto round = MakeVelodynePacket(VelodyneModel::kVlp32c, 0x37);
  for (std::size_t block = 0; block < 12; ++block) SetVelodyneAzimuth(round, block, static_cast<std::uint16_t>(block % 3 * 12'000));
  ExpectVelodyneRefused(VelodyneModel::kVlp32c, round, PacketFault::kAzimuth);
}

TEST(Velodyne, TakesAnAzimuthThatIsRoundedToAFullTurn) {
  VelodyneReader reader(VelodyneModel::kVlp32c);
  Packet packet;
  auto payload = MakeVelodynePacket(VelodyneModel::kVlp32c, 0x37, 35'980);
  SetVelodyneAzimuth(payload, 1, 36'000);
  ASSERT_EQ(reader.Read(payload, packet), PacketFault::kNone);
  EXPECT_EQ(packet.columns[1].azimuth_rad, 0.0);
  EXPECT_EQ(packet.columns[2].time, 2 * 55'296ns);
}

}  // namespace
}  // namespace lookout::lidar
