// Packets of Ouster sensors: every profile, made by hand.
#include "services/lidar/core/models/ouster.hpp"

#include <bit>
#include <gtest/gtest.h>
#include <limits>

#include "common/core/angles.hpp"
#include "tests/unit/lidar_models/ouster_packet_maker.hpp"

namespace lookout::lidar::ouster_test {
namespace {

using namespace ouster_maker;
using namespace std::chrono_literals;

constexpr std::array kAllProfiles{OusterProfile::kLegacy, OusterProfile::kSingle, OusterProfile::kDual, OusterProfile::kLowBandwidth,
                                  OusterProfile::kFusaDual};

bool IsDual(OusterProfile profile) { return profile == OusterProfile::kDual || profile == OusterProfile::kFusaDual; }

bool IsCoarse(OusterProfile profile) { return profile == OusterProfile::kLowBandwidth || profile == OusterProfile::kFusaDual; }

TEST(OusterReader, GivesEveryReturnOfEveryProfile) {
  for (const auto profile : kAllProfiles) {
    for (const int num_rings : {16, 32, 64, 128}) {
      for (const int columns_per_packet : {1, 4, 8, 16}) {
        SCOPED_TRACE(std::string(NameOf(profile)) + ", " + std::to_string(num_rings) + " rings, " + std::to_string(columns_per_packet) + " columns");
        const auto metadata = MakeMetadata(profile, num_rings, columns_per_packet);
        OusterReader reader(metadata);
        Packet packet;
        const PacketText text{.first_id = 16 * columns_per_packet};
        ASSERT_EQ(reader.Read(MakePacket(metadata, text), packet), PacketFault::kNone) << reader.reason();
        const auto num_returns = static_cast<std::size_t>(IsDual(profile) ? 2 : 1);
        ASSERT_EQ(reader.head().returns.size(), num_returns);
        EXPECT_EQ(reader.head().range_unit_m, IsCoarse(profile) ? 0.008 : 0.001);
        ASSERT_EQ(packet.columns.size(), static_cast<std::size_t>(columns_per_packet));
        ASSERT_EQ(packet.range.size(), packet.columns.size() * reader.head().num_cells_of_column());
        ASSERT_EQ(packet.reflectivity.size(), packet.range.size());
        EXPECT_EQ(packet.stamp, 1s);
        std::size_t cell = 0;
        for (int column = 0; column < columns_per_packet; ++column) {
          EXPECT_DOUBLE_EQ(packet.columns[static_cast<std::size_t>(column)].azimuth_rad, kTwoPi * (16 * columns_per_packet + column) / 1024);
          EXPECT_EQ(packet.columns[static_cast<std::size_t>(column)].time, column * 97'656ns);
          for (int ring = 0; ring < num_rings; ++ring) {
            for (std::size_t i = 0; i < num_returns; ++i, ++cell) {
              const auto echo = text.echo(column, num_rings - 1 - ring, static_cast<int>(i));
              ASSERT_EQ(packet.range[cell], echo.range);
              ASSERT_EQ(packet.reflectivity[cell], echo.reflectivity);
            }
          }
        }
      }
    }
  }
}

TEST(OusterReader, HasBeamsFromTheLowestUp) {
  auto metadata = MakeMetadata(OusterProfile::kSingle, 32);
  metadata.beam_origin_height_m = 0.004;
  const OusterReader reader(metadata);
  const auto& head = reader.head();
  EXPECT_EQ(head.model, "Ouster OS1-32");
  EXPECT_EQ(head.stamp, StampKind::kAbsolute);
  ASSERT_EQ(head.beams.size(), 32U);
  for (std::size_t ring = 0; ring < 32; ++ring) {
    const auto& beam = head.beams[ring];
    EXPECT_EQ(beam.channel, 31 - static_cast<int>(ring));
    EXPECT_EQ(beam.elevation_rad, metadata.elevation_rad[31 - ring]);
    EXPECT_EQ(beam.azimuth_offset_rad, metadata.azimuth_offset_rad[31 - ring]);
    EXPECT_DOUBLE_EQ(beam.origin_height_m, 0.004 - 0.015 * std::sin(beam.elevation_rad));
    EXPECT_EQ(beam.time_offset, 0ns);
    EXPECT_EQ(beam.turning_time, 0ns);
  }
}

TEST(OusterReader, NamesReturnsAsTheirOrderSays) {
  auto metadata = MakeMetadata(OusterProfile::kDual, 32);
  EXPECT_EQ(OusterReader(metadata).head().returns, (std::vector{ReturnKind::kStrongest, ReturnKind::kSecond}));
  metadata.return_order = OusterReturnOrder::kNearestToFarthest;
  EXPECT_EQ(OusterReader(metadata).head().returns, (std::vector{ReturnKind::kFirst, ReturnKind::kSecond}));
  metadata.return_order = OusterReturnOrder::kFarthestToNearest;
  EXPECT_EQ(OusterReader(metadata).head().returns, (std::vector{ReturnKind::kLast, ReturnKind::kSecond}));
  metadata.profile = OusterProfile::kSingle;
  EXPECT_EQ(OusterReader(metadata).head().returns, std::vector{ReturnKind::kLast});
}

TEST(OusterReader, LeavesNoReflectivityWhereThereIsNoReturn) {
  for (const auto profile : kAllProfiles) {
    const auto metadata = MakeMetadata(profile, 16);
    OusterReader reader(metadata);
    Packet packet;
    PacketText text;
    text.echo = [](int /*column*/, int /*channel*/, int i) { return Echo{.range = i == 1 ? 7U : 0U, .reflectivity = 200}; };
    ASSERT_EQ(reader.Read(MakePacket(metadata, text), packet), PacketFault::kNone);
    const std::size_t num_returns = reader.head().returns.size();
    for (std::size_t cell = 0; cell < packet.range.size(); ++cell) {
      const bool is_second = cell % num_returns == 1;
      EXPECT_EQ(packet.range[cell], is_second ? 7U : 0U);
      EXPECT_EQ(packet.reflectivity[cell], is_second ? 200 : 0);
    }
  }
}

TEST(OusterReader, GivesTheFarthestRangeOfEachProfile) {
  for (const auto& [profile, max_range] : std::vector<std::pair<OusterProfile, std::uint32_t>>{{OusterProfile::kLegacy, 0xF'FFFF},
                                                                                               {OusterProfile::kSingle, 0x7'FFFF},
                                                                                               {OusterProfile::kDual, 0x7'FFFF},
                                                                                               {OusterProfile::kLowBandwidth, 0x7FFF},
                                                                                               {OusterProfile::kFusaDual, 0x7FFF}}) {
    const std::uint32_t range = max_range;  // for lambdas: a binding cannot be captured
    const auto metadata = MakeMetadata(profile, 16);
    OusterReader reader(metadata);
    Packet packet;
    PacketText text;
    text.echo = [range](int /*column*/, int /*channel*/, int /*i*/) { return Echo{.range = range, .reflectivity = 1}; };
    ASSERT_EQ(reader.Read(MakePacket(metadata, text), packet), PacketFault::kNone);
    EXPECT_TRUE(std::ranges::all_of(packet.range, [range](std::uint32_t one) { return one == range; })) << NameOf(profile);
  }
}

TEST(OusterReader, LeavesBadColumnsOutAndCountsTheirPacket) {
  for (const auto profile : kAllProfiles) {
    const auto metadata = MakeMetadata(profile, 16);
    OusterReader reader(metadata);
    Packet packet;
    PacketText text{.first_id = 32};
    text.is_good = [](int column) { return column >= 3 && column != 7; };
    ASSERT_EQ(reader.Read(MakePacket(metadata, text), packet), PacketFault::kNone) << reader.reason();
    ASSERT_EQ(packet.columns.size(), 12U);
    ASSERT_EQ(packet.range.size(), 12 * reader.head().num_cells_of_column());
    EXPECT_EQ(packet.stamp, 1s + 3 * 97'656ns) << "of the first good column";
    EXPECT_EQ(packet.columns[0].time, 0ns);
    EXPECT_DOUBLE_EQ(packet.columns[0].azimuth_rad, kTwoPi * 35 / 1024);
    EXPECT_EQ(packet.columns[4].time, 5 * 97'656ns);
    EXPECT_EQ(packet.range[0], text.echo(3, 15, 0).range);
    EXPECT_EQ(packet.duration, 13 * 97'656ns);
    ASSERT_TRUE(packet.number);
    EXPECT_EQ(packet.number->number, 5U * 64 + 2);

    text.first_id = 48;
    text.is_good = [](int /*column*/) { return false; };
    ASSERT_EQ(reader.Read(MakePacket(metadata, text), packet), PacketFault::kNone) << reader.reason();
    EXPECT_TRUE(packet.columns.empty());
    EXPECT_TRUE(packet.range.empty());
    EXPECT_TRUE(packet.reflectivity.empty());
    ASSERT_TRUE(packet.number);
    EXPECT_EQ(packet.number->number, 5U * 64 + 3);
    EXPECT_EQ(packet.stamp, 1s);
    EXPECT_EQ(packet.duration, 1562500ns) << "16 of 10 240 columns a second";
  }
}

TEST(OusterReader, NumbersGoOnWhereTheFrameIdBeginsAnew) {
  for (const auto profile : kAllProfiles) {
    const auto metadata = MakeMetadata(profile, 16);
    OusterReader reader(metadata);
    Packet packet;
    const bool is_fusa = profile == OusterProfile::kFusaDual;
    const std::uint32_t last_frame = is_fusa ? 0xFFFF'FFFF : 0xFFFF;
    ASSERT_EQ(reader.Read(MakePacket(metadata, {.frame = last_frame, .first_id = 1008}), packet), PacketFault::kNone);
    ASSERT_TRUE(packet.number);
    EXPECT_EQ(packet.number->modulus, is_fusa ? 64ULL << 32 : 64ULL << 16);
    EXPECT_EQ(packet.number->number, packet.number->modulus - 1);
    ASSERT_EQ(reader.Read(MakePacket(metadata, {.frame = 0, .stamp_ns = 1'001'562'500}), packet), PacketFault::kNone) << reader.reason();
    EXPECT_EQ(packet.number->number, 0U);
  }
}

// Packets outside of the window are not sent; those at its edges have columns of bad status.
TEST(OusterReader, NumbersTheTurnsPacketsThatHoldTheWindow) {
  for (const auto& window : std::vector<std::pair<int, int>>{{370, 85}, {2, 500}, {1020, 1023}, {10, 3}, {5, 5}, {1, 0}}) {
    const int first = window.first;
    const int last = window.second;
    SCOPED_TRACE(std::to_string(first) + " to " + std::to_string(last));
    auto metadata = MakeMetadata(OusterProfile::kLowBandwidth, 16);
    metadata.first_column = first;
    metadata.last_column = last;
    const auto is_inside = [first, last](int id) { return first <= last ? id >= first && id <= last : id >= first || id <= last; };
    OusterReader reader(metadata);
    Packet packet;
    std::vector<Packet> packets;
    for (std::uint32_t frame = 0; frame < 3; ++frame) {
      for (int id = 0; id < 1024; id += 16) {
        PacketText text{
            .frame = frame, .first_id = id, .stamp_ns = (frame * 1024U + static_cast<unsigned int>(id)) * 100'000ULL, .column_ns = 100'000};
        text.is_good = [&](int column) { return is_inside(id + column); };
        bool is_sent = false;
        for (int column = 0; column < 16; ++column) is_sent = is_sent || text.is_good(column);
        if (!is_sent) continue;
        ASSERT_EQ(reader.Read(MakePacket(metadata, text), packet), PacketFault::kNone) << reader.reason();
        packets.push_back(packet);
      }
    }
    ASSERT_GE(packets.size(), 3U);
    for (std::size_t i = 0; i < packets.size(); ++i) {
      ASSERT_TRUE(packets[i].number);
      EXPECT_EQ(packets[i].number->number, i);
      EXPECT_EQ(packets[i].number->modulus, (packets.size() / 3) << 16);
      // The nominal period, where a packet has one column, is 97.656 us.
      if (i + 1 < packets.size() && packets[i].columns.size() > 1) {
        EXPECT_EQ(packets[i].stamp + packets[i].duration, packets[i + 1].stamp) << i;
      }
    }
    EXPECT_FALSE(reader.has_other_window());
  }
}

TEST(OusterReader, GivesNoNumbersWhereTheWindowIsAnother) {
  auto metadata = MakeMetadata(OusterProfile::kSingle, 16);
  metadata.last_column = 511;
  OusterReader reader(metadata);
  Packet packet;
  ASSERT_EQ(reader.Read(MakePacket(metadata, {.first_id = 496}), packet), PacketFault::kNone);
  EXPECT_TRUE(packet.number);
  ASSERT_EQ(reader.Read(MakePacket(metadata, {.first_id = 512, .stamp_ns = 1'002'000'000}), packet), PacketFault::kNone);
  EXPECT_FALSE(packet.number);
  EXPECT_EQ(packet.columns.size(), 16U);
  EXPECT_EQ(packet.duration, 16 * 97'656ns);
  EXPECT_TRUE(reader.has_other_window());
  ASSERT_EQ(reader.Read(MakePacket(metadata, {.first_id = 32}), packet), PacketFault::kNone);
  EXPECT_FALSE(packet.number);
}

TEST(OusterReader, RefusesByTheChecksumOnceItWasRight) {
  const auto metadata = MakeMetadata(OusterProfile::kDual, 16);
  OusterReader reader(metadata);
  Packet packet;
  auto damaged = MakePacket(metadata, {});
  damaged[200] ^= 1;
  EXPECT_EQ(reader.Read(damaged, packet), PacketFault::kNone) << "a sensor may have none";
  EXPECT_FALSE(reader.has_checksum());
  EXPECT_EQ(reader.Read(MakePacket(metadata, {}), packet), PacketFault::kNone);
  EXPECT_TRUE(reader.has_checksum());
  const auto before = packet.range;
  EXPECT_EQ(reader.Read(damaged, packet), PacketFault::kChecksum);
  EXPECT_EQ(reader.reason(), "Ouster OS1-16: the checksum of the packet is wrong");
  EXPECT_EQ(packet.range, before);
  EXPECT_EQ(reader.Read(MakePacket(metadata, {.has_checksum = false}), packet), PacketFault::kChecksum);
}

// Not by the reader's own means: the check value of CRC-64/XZ in the catalogue of CRCs, and through the maker every length of a packet.
TEST(OusterReader, KnowsTheChecksumOfTheCatalogue) {
  EXPECT_EQ(Checksum({'1', '2', '3', '4', '5', '6', '7', '8', '9'}), 0x995DC9BBDF1939FAU);
  for (int num_rings = 1; num_rings <= 20; ++num_rings) {
    const auto metadata = MakeMetadata(OusterProfile::kLowBandwidth, num_rings, 3, 1023);
    OusterReader reader(metadata);
    Packet packet;
    ASSERT_EQ(reader.Read(MakePacket(metadata, {}), packet), PacketFault::kNone);
    EXPECT_TRUE(reader.has_checksum()) << num_rings;
  }
}

TEST(OusterReader, TakesASensorWithoutChecksums) {
  for (const auto profile : {OusterProfile::kSingle, OusterProfile::kFusaDual}) {
    const auto metadata = MakeMetadata(profile, 16);
    OusterReader reader(metadata);
    Packet packet;
    const auto bytes = MakePacket(metadata, {.has_checksum = false});
    for (int i = 0; i < 200; ++i) ASSERT_EQ(reader.Read(bytes, packet), PacketFault::kNone) << reader.reason();
    EXPECT_FALSE(reader.has_checksum());
  }
}

TEST(OusterReader, RefusesAnotherSensorByName) {
  for (const auto profile : {OusterProfile::kSingle, OusterProfile::kFusaDual}) {
    const auto metadata = MakeMetadata(profile, 16);
    OusterReader reader(metadata);
    Packet packet;
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.serial = 123'456'789'012}), packet), PacketFault::kHead);
    EXPECT_EQ(reader.reason(), "Ouster OS1-16: the packet is of the sensor with the serial number 123456789012, the metadata are of 122246000293");
    EXPECT_FALSE(reader.has_checksum()) << "that of another";
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.serial = 0}), packet), PacketFault::kNone);
    auto unknown = metadata;
    unknown.serial_number.reset();
    EXPECT_EQ(OusterReader(unknown).Read(MakePacket(metadata, {.serial = 5}), packet), PacketFault::kNone);
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.type = 2}), packet), PacketFault::kHead);
    EXPECT_EQ(reader.reason(), "Ouster OS1-16: packet type 2, where 1 is a lidar packet");
  }
}

TEST(OusterReader, TellsThatTheSensorWasInitialisedAnew) {
  for (const auto profile : {OusterProfile::kSingle, OusterProfile::kFusaDual}) {
    const auto metadata = MakeMetadata(profile, 16);
    OusterReader reader(metadata);
    Packet packet;
    ASSERT_EQ(reader.Read(MakePacket(metadata, {}), packet), PacketFault::kNone);
    EXPECT_FALSE(reader.has_other_init_id());
    ASSERT_EQ(reader.Read(MakePacket(metadata, {.init_id = 78}), packet), PacketFault::kNone);
    EXPECT_TRUE(reader.has_other_init_id());
  }
}

TEST(OusterReader, RefusesPayloadsOfAnyOtherSize) {
  for (const auto profile : kAllProfiles) {
    const auto metadata = MakeMetadata(profile, 16);
    OusterReader reader(metadata);
    Packet packet;
    packet.range = {1, 2, 3};
    auto whole = MakePacket(metadata, {});
    whole.resize(whole.size() + 1);
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      if (size == whole.size() - 1) continue;
      const auto fault = reader.Read(Bytes(whole).first(size), packet);
      ASSERT_EQ(fault, reader.MayBe(size) ? PacketFault::kMode : PacketFault::kSize) << size;
    }
    EXPECT_EQ(packet.range.size(), 3U);
    EXPECT_TRUE(reader.MayBe(whole.size() - 1));
    EXPECT_FALSE(reader.MayBe(48)) << "its IMU";
    EXPECT_FALSE(reader.MayBe(0));
  }
}

TEST(OusterReader, SaysThatTheProfileIsAnother) {
  OusterReader reader(MakeMetadata(OusterProfile::kSingle, 64));
  Packet packet;
  EXPECT_EQ(reader.Read(MakePacket(MakeMetadata(OusterProfile::kDual, 64), {}), packet), PacketFault::kMode);
  EXPECT_EQ(reader.reason(),
            "Ouster OS1-64: 16640 bytes, where a packet of RNG19_RFL8_SIG16_NIR16 has 12544: the sensor sends another profile than its metadata say");
}

TEST(OusterReader, RefusesColumnsThatCannotBe) {
  for (const auto profile : kAllProfiles) {
    const auto metadata = MakeMetadata(profile, 16);
    OusterReader reader(metadata);
    Packet packet;
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.first_id = 1009}), packet), PacketFault::kAzimuth) << NameOf(profile);
    EXPECT_EQ(reader.reason(), "Ouster OS1-16: column 1024 of a turn of 1024");
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.first_id = 65'000}), packet), PacketFault::kAzimuth);
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.stamp_ns = ~std::uint64_t{0}}), packet), PacketFault::kStamp);
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.stamp_ns = std::uint64_t{1} << 62}), packet), PacketFault::kStamp);
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.column_ns = 70'000'000}), packet), PacketFault::kStamp);
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.column_ns = ~std::uint64_t{0}}), packet), PacketFault::kStamp) << "backwards";
    EXPECT_EQ(reader.Read(MakePacket(metadata, {.column_ns = 0}), packet), PacketFault::kNone);
    EXPECT_EQ(packet.duration, 0ns);

    auto twice = MakePacket(metadata, {.has_checksum = false});
    const std::size_t head = profile == OusterProfile::kLegacy ? 0 : 32;
    const std::size_t column = (twice.size() - 2 * head) / 16;
    twice[head + 5 * column + 8] = 4;
    OusterReader other(metadata);
    EXPECT_EQ(other.Read(twice, packet), PacketFault::kHead);
    EXPECT_EQ(other.reason(), "Ouster OS1-16: the columns of the packet do not go round");

    PacketText bad{.first_id = 65'000};
    bad.is_good = [](int /*column*/) { return false; };
    EXPECT_EQ(other.Read(MakePacket(metadata, bad), packet), PacketFault::kNone);
    EXPECT_FALSE(packet.number) << "no place is known";
    auto filler = MakePacket(metadata, bad);
    std::fill(filler.begin() + static_cast<std::ptrdiff_t>(head), filler.end() - static_cast<std::ptrdiff_t>(head), std::uint8_t{0});
    EXPECT_EQ(OusterReader(metadata).Read(filler, packet), PacketFault::kNone);
    EXPECT_FALSE(packet.number) << "filler is no place";
  }
}

// Metadata of 1024 columns, but the sensor was set to 512: packets are as long, and every azimuth would be half of what it is.
TEST(OusterReader, RefusesASensorWhoseTurnsAreShorter) {
  for (const auto profile : {OusterProfile::kLegacy, OusterProfile::kSingle}) {
    for (const std::uint64_t column_ns : {97'656U, 195'312U}) {
      const auto metadata = MakeMetadata(profile, 16);
      OusterReader reader(metadata);
      Packet packet;
      PacketText text{.column_ns = column_ns};
      int num_refused = 0;
      for (int i = 0; i < 4 * 32; ++i) {
        text.first_id = 16 * (i % 32);
        text.frame = static_cast<std::uint32_t>(i / 32);
        const auto fault = reader.Read(MakePacket(metadata, text), packet);
        EXPECT_EQ(fault, i < 3 * 32 ? PacketFault::kNone : PacketFault::kMode) << i;  // a single one may be a clock that was set

        num_refused += fault == PacketFault::kMode ? 1 : 0;
        text.stamp_ns += 16 * column_ns;
      }
      EXPECT_EQ(num_refused, 32);
      EXPECT_EQ(reader.reason(),
                "Ouster OS1-16: turns end behind column 511, where the metadata say 1024 columns: the sensor was set to another mode");
      // It is set back.
      text.first_id = 512;
      EXPECT_EQ(reader.Read(MakePacket(metadata, text), packet), PacketFault::kNone);
    }
  }
}

// It fires in half of the circle, and its clock goes back in the dark half.
TEST(OusterReader, IsNotStoppedByAClockThatIsSetBackBesideItsWindow) {
  auto metadata = MakeMetadata(OusterProfile::kSingle, 16);
  metadata.first_column = 0;
  metadata.last_column = 511;
  OusterReader reader(metadata);
  Packet packet;
  for (std::uint32_t frame = 0; frame < 6; ++frame) {
    for (int id = 0; id < 512; id += 16) {
      const std::uint64_t set_back_ns = frame >= 2 ? 30'000'000 : 0;
      const std::uint64_t stamp_ns = 1'000'000'000 + (frame * 1024U + static_cast<unsigned int>(id)) * 97'656ULL - set_back_ns;
      EXPECT_EQ(reader.Read(MakePacket(metadata, {.frame = frame, .first_id = id, .stamp_ns = stamp_ns}), packet), PacketFault::kNone)
          << frame << " " << id;
    }
  }
}

TEST(OusterReader, TakesLossAndSilenceForNoShorterTurns) {
  const auto metadata = MakeMetadata(OusterProfile::kSingle, 16);
  OusterReader reader(metadata);
  Packet packet;
  const auto read = [&](std::uint32_t frame, int id) {
    return reader.Read(
        MakePacket(metadata, {.frame = frame, .first_id = id, .stamp_ns = (frame * 1024U + static_cast<unsigned int>(id)) * 97'656ULL}), packet);
  };
  EXPECT_EQ(read(1, 0), PacketFault::kNone);
  EXPECT_EQ(read(1, 256), PacketFault::kNone);
  EXPECT_EQ(read(2, 0), PacketFault::kNone) << "three quarters of a turn are lost";
  EXPECT_EQ(read(3, 512), PacketFault::kNone);
  EXPECT_EQ(read(60, 16), PacketFault::kNone);
  EXPECT_EQ(read(59, 1008), PacketFault::kNone) << "out of order";
  EXPECT_EQ(read(0, 16), PacketFault::kNone) << "started anew";
}

TEST(OusterImu, IsReadByItself) {
  std::vector<std::uint8_t> bytes;
  for (const std::uint64_t stamp : {1'000U, 2'000U, 3'000U}) Append(bytes, stamp, 8);
  for (const float value : {0.01F, -0.02F, 1.03F, 1.5F, -2.5F, 3.5F}) Append(bytes, std::bit_cast<std::uint32_t>(value), 4);
  const auto sample = ParseOusterImu(bytes);
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->stamp, 1000ns);
  EXPECT_EQ(sample->acceleration_stamp, 2000ns);
  EXPECT_EQ(sample->rate_stamp, 3000ns);
  EXPECT_EQ(sample->acceleration_g, (std::array{0.01F, -0.02F, 1.03F}));
  EXPECT_EQ(sample->rate_degps, (std::array{1.5F, -2.5F, 3.5F}));

  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(ParseOusterImu(Bytes(bytes).first(size)));
  const auto with = [&bytes](std::size_t offset, const std::vector<std::uint8_t>& part) {
    auto changed = bytes;
    std::ranges::copy(part, changed.begin() + static_cast<std::ptrdiff_t>(offset));
    return ParseOusterImu(changed).has_value();
  };
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 5000.0F, -5000.0F}) {
    std::vector<std::uint8_t> part;
    Append(part, std::bit_cast<std::uint32_t>(wrong), 4);
    for (std::size_t offset = 24; offset < 48; offset += 4) EXPECT_FALSE(with(offset, part)) << wrong << " at " << offset;
  }
  for (const std::size_t offset : {0, 8, 16}) EXPECT_FALSE(with(offset, std::vector<std::uint8_t>(8, 0xFF)));
  auto longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(ParseOusterImu(longer));
}

}  // namespace
}  // namespace lookout::lidar::ouster_test
