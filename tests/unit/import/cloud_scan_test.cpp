// Point clouds of drivers become scans.
#include "tools/import/cloud_scan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/messages/checks.hpp"
#include "tests/unit/import/made_recordings.hpp"
#include "tools/import/ros_message.hpp"

namespace lookout::importer {
namespace {

using namespace test;

// A lidar of 3 rings, 400 columns at 1 ms, 10 us from ring to ring; walls at 10 and 30 m. Ring 0 is the topmost.
struct MadeTurn {
  static constexpr int kNumRings = 3;
  static constexpr int kNumColumns = 400;
  static constexpr std::array<double, 3> kElevationsDeg{10.0, 1.0, -6.0};
  static constexpr double kHeightM = 0.04;
  static double RangeM(int column) { return column % 2 == 0 ? 10.0 : 30.0; }
  static std::array<double, 3> PlaceM(int ring, int column, double azimuth_rad) {
    const double level_m = RangeM(column) * std::cos(DegToRad(kElevationsDeg.at(static_cast<std::size_t>(ring))));
    return {level_m * std::cos(azimuth_rad), -level_m * std::sin(azimuth_rad),
            kHeightM + RangeM(column) * std::sin(DegToRad(kElevationsDeg.at(static_cast<std::size_t>(ring))))};
  }
};

enum class Layout { kVelodyne, kPacketTimes, kRings, kHesai, kOrganised, kBare };

Payload MakeTurnCloud(Layout layout) {
  Writer data;
  const auto write = [&](int ring, int column) {
    const double azimuth_rad = kTwoPi * (column + 0.01 * ring) / MadeTurn::kNumColumns;
    for (const double place_m : MadeTurn::PlaceM(ring, column, azimuth_rad)) data.Number(static_cast<float>(place_m));
    const auto time_ns = column * 1'000'000LL + ring * 10'000LL;
    // Some drivers count from the begin of each packet.
    const auto since_ns = layout == Layout::kPacketTimes ? time_ns % 4'000'000 : time_ns;
    if (layout == Layout::kVelodyne || layout == Layout::kPacketTimes) {
      data.Number(42.0F).Number(static_cast<std::uint16_t>(ring)).Number(static_cast<float>(1e-9 * static_cast<double>(since_ns)));
    }
    if (layout == Layout::kRings) data.Number(static_cast<std::uint16_t>(ring));
    if (layout == Layout::kHesai)
      data.Number(42.0F)
          .Number(static_cast<double>(kMadeStampNs / 1'000'000'000) + 1e-9 * static_cast<double>(time_ns))
          .Number(static_cast<std::uint16_t>(ring));
    if (layout == Layout::kOrganised) data.Number(static_cast<std::uint32_t>(time_ns)).Number(std::uint16_t{42});
  };
  if (layout == Layout::kOrganised) {
    for (int ring = 0; ring < MadeTurn::kNumRings; ++ring) {
      for (int column = 0; column < MadeTurn::kNumColumns; ++column) write(ring, column);
    }
    return MakeCloud(Encoding::kRos1, MadeTurn::kNumRings, MadeTurn::kNumColumns, 18,
                     {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"t", 12, 6}, {"reflectivity", 16, 4}}, data.bytes);
  }
  for (int column = 0; column < MadeTurn::kNumColumns; ++column) {
    for (int ring = 0; ring < MadeTurn::kNumRings; ++ring) write(ring, column);
  }
  const auto num_points = static_cast<std::uint32_t>(MadeTurn::kNumRings * MadeTurn::kNumColumns);
  if (layout == Layout::kRings) {
    return MakeCloud(Encoding::kRos1, 1, num_points, 14, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 4}}, data.bytes);
  }
  if (layout == Layout::kVelodyne || layout == Layout::kPacketTimes) {
    return MakeCloud(Encoding::kRos1, 1, num_points, 22,
                     {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"intensity", 12, 7}, {"ring", 16, 4}, {"time", 18, 7}}, data.bytes);
  }
  if (layout == Layout::kHesai) {
    return MakeCloud(Encoding::kRos1, 1, num_points, 26,
                     {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"intensity", 12, 7}, {"timestamp", 16, 8}, {"ring", 24, 4}}, data.bytes);
  }
  return MakeCloud(Encoding::kRos1, 1, num_points, 12, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}}, data.bytes);
}

// The same points as a Livox's driver sends them.
Payload MakeLivoxTurn(Encoding encoding) {
  constexpr auto kNumPoints = static_cast<std::uint32_t>(MadeTurn::kNumRings * MadeTurn::kNumColumns);
  RosWriter writer(encoding);
  writer.Header().Number(static_cast<std::uint64_t>(kMadeStampNs)).Number(kNumPoints).Raw(Payload{1, 0, 0, 0}).Number(kNumPoints);
  for (int column = 0; column < MadeTurn::kNumColumns; ++column) {
    for (int ring = 0; ring < MadeTurn::kNumRings; ++ring) {
      writer.Number(static_cast<std::uint32_t>(column * 1'000'000 + ring * 10'000));
      const double azimuth_rad = kTwoPi * (column + 0.01 * ring) / MadeTurn::kNumColumns;
      for (const double place_m : MadeTurn::PlaceM(ring, column, azimuth_rad)) writer.Number(static_cast<float>(place_m));
      writer.Number(std::uint8_t{42}).Number(std::uint8_t{0x10}).Number(static_cast<std::uint8_t>(ring));
    }
  }
  return writer.Bytes();
}

TEST(CloudScans, OfALivoxAreThoseOfACloud) {
  CloudScans clouds;
  const auto bytes = MakeTurnCloud(Layout::kVelodyne);
  const auto wanted = clouds.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
  for (const auto encoding : {Encoding::kRos1, Encoding::kCdr}) {
    auto livox = MakeLivoxTurn(encoding);
    const auto cloud = ParseLivoxPoints(encoding, livox);
    ASSERT_TRUE(cloud);
    CloudScans scans;
    const auto parts = scans.Convert(*cloud, kMadeStampNs, "model");
    ASSERT_EQ(parts.size(), wanted.size());
    EXPECT_EQ(parts[0].range, wanted[0].range);
    EXPECT_EQ(parts[0].reflectivity, wanted[0].reflectivity);
    EXPECT_EQ(parts[0].elevation_rad, wanted[0].elevation_rad);
    livox.resize(livox.size() - 9);
    EXPECT_FALSE(ParseLivoxPoints(encoding, livox));
  }
}

TEST(CloudScans, OfEachDriverGiveTheSameScan) {
  for (const auto layout : {Layout::kVelodyne, Layout::kHesai, Layout::kOrganised}) {
    SCOPED_TRACE(static_cast<int>(layout));
    const auto bytes = MakeTurnCloud(layout);
    const auto cloud = ParsePointCloud(Encoding::kRos1, bytes);
    ASSERT_TRUE(cloud);
    CloudScans scans;
    const auto parts = scans.Convert(*cloud, kMadeStampNs, "model");
    ASSERT_EQ(parts.size(), 1U);
    const auto& scan = parts[0];
    ASSERT_EQ(scan.num_rings, MadeTurn::kNumRings);
    ASSERT_EQ(scan.num_turn_columns, MadeTurn::kNumColumns);
    EXPECT_EQ(scan.utime_us, kMadeStampNs / 1000);
    EXPECT_NEAR(static_cast<double>(scan.end_utime_us - scan.utime_us), 399'021.0, 2.0);
    EXPECT_DOUBLE_EQ(scan.range_unit_m, 0.002);
    for (int ring = 0; ring < MadeTurn::kNumRings; ++ring) {
      const auto up = static_cast<std::size_t>(MadeTurn::kNumRings - 1 - ring);  // from the lowest
      EXPECT_NEAR(scan.elevation_rad[up], DegToRad(MadeTurn::kElevationsDeg.at(static_cast<std::size_t>(ring))), 1e-6);
      EXPECT_NEAR(scan.origin_height_m[up], MadeTurn::kHeightM, 1e-5);
      EXPECT_NEAR(scan.time_offset_ns[up], ring * 10'000, 100);
      for (int column = 0; column < MadeTurn::kNumColumns; ++column) {
        const auto place = static_cast<std::size_t>(column);
        const double azimuth_rad = kTwoPi * (column + 0.01 * ring) / MadeTurn::kNumColumns;
        EXPECT_NEAR(WrapToPi(scan.azimuth_rad[place] + scan.azimuth_offset_rad[up] - azimuth_rad), 0.0, 1e-6);
        EXPECT_NEAR(scan.time_ns[place] + scan.time_offset_ns[up], column * 1'000'000 + ring * 10'000, 300);
        const auto cell = place * MadeTurn::kNumRings + up;
        EXPECT_EQ(scan.range[cell], static_cast<std::int16_t>(MadeTurn::RangeM(column) / 0.002));
        EXPECT_EQ(scan.reflectivity[cell], 42);
      }
    }
    EXPECT_EQ(scans.counts().num_hidden + scans.counts().num_no_ring, 0);
    EXPECT_TRUE(scans.Remarks().empty());
  }
}

// Times that say nothing of the firing, or none: the azimuths tell which points are of one firing, also where rings look to different sides.
TEST(CloudScans, WithoutUsableTimesGoByTheAzimuthsOfTheShots) {
  for (const auto layout : {Layout::kPacketTimes, Layout::kRings}) {
    SCOPED_TRACE(static_cast<int>(layout));
    const auto bytes = MakeTurnCloud(layout);
    CloudScans scans;
    const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_EQ(scans.counts().num_hidden, 0);
    ASSERT_EQ(parts[0].num_turn_columns, MadeTurn::kNumColumns);
    std::vector<std::int16_t> ranges;
    for (std::size_t column = 0; column < static_cast<std::size_t>(MadeTurn::kNumColumns); ++column) {
      const double turned = WrapTo2Pi(parts[0].azimuth_rad[column] + parts[0].azimuth_offset_rad[2] + 1e-6) / kTwoPi * MadeTurn::kNumColumns;
      EXPECT_NEAR(turned - std::floor(turned), 0.0, 1e-3);
      EXPECT_EQ(parts[0].range[column * 3 + 2], static_cast<std::int16_t>(MadeTurn::RangeM(static_cast<int>(turned)) / 0.002));
    }
  }
}

TEST(CloudScans, WithoutRingsAndTimesSayWhatTheyLack) {
  const auto bytes = MakeTurnCloud(Layout::kBare);
  const auto cloud = ParsePointCloud(Encoding::kRos1, bytes);
  CloudScans scans;
  const auto parts = scans.Convert(*cloud, kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].end_utime_us, parts[0].utime_us);
  EXPECT_EQ(scans.Remarks().size(), 3U);
  EXPECT_GE(parts[0].num_rings, MadeTurn::kNumRings);
  EXPECT_LE(scans.counts().num_hidden, 12);
}

// A turn of 4 rings and 360 columns with times, and a second return of every tenth shot, 5 m behind the first.
Payload MakeDualTurn(bool has_times, bool is_same_direction) {
  Writer data;
  std::uint32_t num_points = 0;
  const auto put = [&](int column, int ring, double range_m, double off_rad) {
    const double elevation_rad = DegToRad(2.0 * ring - 3.0);
    const double azimuth_rad = kTwoPi * column / 360 + off_rad;
    data.Number(static_cast<float>(range_m * std::cos(elevation_rad) * std::cos(azimuth_rad)));
    data.Number(static_cast<float>(-range_m * std::cos(elevation_rad) * std::sin(azimuth_rad)));
    data.Number(static_cast<float>(range_m * std::sin(elevation_rad))).Number(static_cast<std::uint16_t>(ring));
    data.Number(static_cast<float>(has_times ? 0.1 * column / 360 : 0.0)).Number(static_cast<std::uint32_t>(range_m));
    ++num_points;
  };
  for (int column = 0; column < 360; ++column) {
    for (int ring = 0; ring < 4; ++ring) {
      const bool has_second = (column + ring) % 10 == 0;
      if (has_second) put(column, ring, 25.0, is_same_direction ? 0.0 : 0.003);
      put(column, ring, 20.0, 0.0);
    }
  }
  return MakeCloud(Encoding::kRos1, 1, num_points, 22, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 4}, {"time", 14, 7}, {"label", 18, 6}},
                   data.bytes);
}

TEST(CloudScans, KeepBothReturnsOfAShot) {
  for (const bool has_times : {true, false}) {
    CloudScans scans;
    const auto bytes = MakeDualTurn(has_times, true);
    const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
    ASSERT_EQ(parts.size(), 1U);
    const auto& scan = parts[0];
    EXPECT_FALSE(messages::FaultOf(scan, bus::kMaxMessageBytes));
    ASSERT_EQ(scan.num_returns, 2);
    EXPECT_EQ(scan.return_kind, (std::vector<std::int32_t>{lidar_scan_t::RETURN_STRONGEST, lidar_scan_t::RETURN_LAST}));
    ASSERT_EQ(scan.num_columns, 360);
    EXPECT_EQ(scans.counts().num_hidden, 0);
    for (std::size_t shot = 0; shot < 360 * 4; ++shot) {
      const bool has_second = (shot / 4 + shot % 4) % 10 == 0;
      EXPECT_EQ(scan.range[2 * shot], 10'000);
      EXPECT_EQ(scan.range[2 * shot + 1], has_second ? 12'500 : 0);
      EXPECT_EQ(scans.cell_labels()[2 * shot + 1], has_second ? 25U : 0U);
    }
    EXPECT_TRUE(std::ranges::any_of(scans.Remarks(), [](const auto& remark) { return remark.find("two returns") != std::string::npos; }));
  }
}

// Points that share a cell by the rounding of a grid are no second returns.
TEST(CloudScans, TakeNoOtherShotForASecondReturn) {
  CloudScans scans;
  const auto bytes = MakeDualTurn(false, false);
  const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].num_returns, 1);
  EXPECT_EQ(scans.counts().num_hidden, 144);
}

// Of a cloud without rings 100 rings share 64 bands, and stand above each other.
TEST(CloudScans, TakeNoOtherRingOfABandForASecondReturn) {
  Writer data;
  for (int column = 0; column < 360; ++column) {
    for (int ring = 0; ring < 100; ++ring) {
      const double level_m = 20.0 + ring % 2;
      data.Number(static_cast<float>(level_m * std::cos(DegToRad(column)))).Number(static_cast<float>(-level_m * std::sin(DegToRad(column))));
      data.Number(static_cast<float>(level_m * std::tan(DegToRad(0.2 * ring))));
    }
  }
  const auto bytes = MakeCloud(Encoding::kRos1, 1, 36'000, 12, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}}, data.bytes);
  CloudScans scans;
  const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
  ASSERT_FALSE(parts.empty());
  EXPECT_EQ(parts[0].num_returns, 1);
  EXPECT_GT(scans.counts().num_hidden, 10'000);
}

// Points at 20 m, at each of these elevations once in a degree.
Payload MakeBareTurn(const std::vector<double>& elevations_deg) {
  Writer data;
  for (int column = 0; column < 360; ++column) {
    for (const double elevation_deg : elevations_deg) {
      const double level_m = 20.0 * std::cos(DegToRad(elevation_deg));
      data.Number(static_cast<float>(level_m * std::cos(DegToRad(column)))).Number(static_cast<float>(-level_m * std::sin(DegToRad(column))));
      data.Number(static_cast<float>(20.0 * std::sin(DegToRad(elevation_deg))));
    }
  }
  return MakeCloud(Encoding::kRos1, 1, static_cast<std::uint32_t>(360 * elevations_deg.size()), 12, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}},
                   data.bytes);
}

TEST(CloudScans, WithoutRingsHaveBandsOfAllThatWasLearned) {
  const auto flat = MakeBareTurn({0.0, 1.0, 2.0});
  const auto tall = MakeBareTurn({-15.0, -5.0, 5.0, 15.0});
  const auto taller = MakeBareTurn({-15.0, -5.0, 5.0, 15.0, 25.0});
  CloudScans scans;
  EXPECT_TRUE(scans.Learn(*ParsePointCloud(Encoding::kRos1, flat)));
  EXPECT_TRUE(scans.Learn(*ParsePointCloud(Encoding::kRos1, tall)));
  auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, tall), kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_NEAR(parts[0].elevation_rad.front(), DegToRad(-15.0), 1e-4);
  EXPECT_NEAR(parts[0].elevation_rad.back(), DegToRad(15.0), 1e-4);
  EXPECT_EQ(scans.counts().num_out_of_range + scans.counts().num_hidden, 0);
  // What comes later outside of the bands is none of theirs.
  parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, taller), kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_NEAR(parts[0].elevation_rad.back(), DegToRad(15.0), 1e-4);
  EXPECT_EQ(scans.counts().num_out_of_range, 360);
}

// Lines that are no rings: the first cloud alone does not show how far they go.
TEST(CloudScans, OfScatteredRingsHaveBandsOfAllThatWasLearned) {
  const auto make = [](double highest_deg) {
    Writer data;
    for (int i = 0; i < 2000; ++i) {
      const double elevation_rad = DegToRad(highest_deg * std::sin(0.7 * i));
      const double azimuth_rad = DegToRad(0.02 * i);
      data.Number(static_cast<float>(20.0 * std::cos(elevation_rad) * std::cos(azimuth_rad)));
      data.Number(static_cast<float>(-20.0 * std::cos(elevation_rad) * std::sin(azimuth_rad)));
      data.Number(static_cast<float>(20.0 * std::sin(elevation_rad))).Number(static_cast<std::uint16_t>(i % 4));
    }
    return MakeCloud(Encoding::kRos1, 1, 2000, 14, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"line", 12, 4}}, data.bytes);
  };
  const auto low = make(5.0);
  const auto high = make(20.0);
  CloudScans scans;
  scans.Learn(*ParsePointCloud(Encoding::kRos1, low));
  scans.Learn(*ParsePointCloud(Encoding::kRos1, high));
  const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, high), kMadeStampNs, "model");
  ASSERT_FALSE(parts.empty());
  EXPECT_LT(parts[0].elevation_rad.front(), DegToRad(-19.0));
  EXPECT_GT(parts[0].elevation_rad.back(), DegToRad(19.0));
  EXPECT_EQ(scans.counts().num_out_of_range + scans.counts().num_no_ring, 0);
}

// A turn of 16 rings and 100 columns at 1 ms, with these times.
template <typename T, typename TimeOf>
Payload MakeTimedTurn(const std::string& field, std::uint8_t type, const TimeOf& time_of) {
  Writer data;
  for (int column = 0; column < 100; ++column) {
    for (int ring = 0; ring < 16; ++ring) {
      const double elevation_rad = DegToRad(2.0 * ring - 15.0);
      const double azimuth_rad = kTwoPi * column / 100;
      data.Number(static_cast<float>(20.0 * std::cos(elevation_rad) * std::cos(azimuth_rad)));
      data.Number(static_cast<float>(-20.0 * std::cos(elevation_rad) * std::sin(azimuth_rad)));
      data.Number(static_cast<float>(20.0 * std::sin(elevation_rad))).Number(static_cast<std::uint16_t>(ring));
      data.Number(static_cast<T>(time_of(column, ring)));
    }
  }
  return MakeCloud(Encoding::kRos1, 1, 1600, static_cast<std::uint32_t>(14 + sizeof(T)),
                   {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 4}, {field, 14, type}}, data.bytes);
}

TEST(CloudScans, AreNotMovedByAPointWithoutATime) {
  const double stamp_s = static_cast<double>(kMadeStampNs / 1'000'000'000);
  for (const double begin_s : {stamp_s, 5000.0}) {
    for (const double bad_s : {0.0, static_cast<double>(NAN), 1e300, stamp_s + 3.0}) {
      const auto bytes =
          MakeTimedTurn<double>("timestamp", 8, [&](int column, int ring) { return column == 50 && ring == 3 ? bad_s : begin_s + 1e-3 * column; });
      CloudScans scans;
      const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
      ASSERT_EQ(parts.size(), 1U);
      EXPECT_NEAR(static_cast<double>(parts[0].utime_us - kMadeStampNs / 1000), 0.0, 2.0) << begin_s << " " << bad_s;
      EXPECT_NEAR(static_cast<double>(parts[0].end_utime_us - parts[0].utime_us), 99'000.0, 2.0) << begin_s << " " << bad_s;
      EXPECT_EQ(parts[0].num_turn_columns, 100);
      EXPECT_EQ(scans.counts().num_no_time, 1);
      EXPECT_EQ(scans.counts().num_hidden, 0);
      EXPECT_EQ(scans.Remarks().size(), begin_s == 5000.0 ? 2U : 1U);  // another clock, and no reflectivity
    }
  }
}

TEST(CloudScans, OfTimesInAnotherUnitHaveNone) {
  const auto microseconds = MakeTimedTurn<float>("time", 7, [](int column, int ring) { return 1000.0 * column + ring; });
  const auto none = MakeTimedTurn<float>("time", 7, [](int, int) { return NAN; });
  for (const auto& bytes : {microseconds, none}) {
    CloudScans scans;
    const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_EQ(parts[0].utime_us, kMadeStampNs / 1000);
    EXPECT_EQ(parts[0].end_utime_us, parts[0].utime_us);
    EXPECT_EQ(scans.counts().num_times_refused, 1);
    EXPECT_EQ(scans.counts().num_hidden, 0);
    EXPECT_NE(scans.Remarks().at(0).find("1 clouds have times of points"), std::string::npos);
  }
}

TEST(CloudScans, TakeAWiderUnitWhereAPointIsFartherThan131Metres) {
  Writer data;
  for (int i = 0; i < 40; ++i) data.Number(i == 7 ? 300.0F : 10.0F).Number(static_cast<float>(i) * 0.1F).Number(0.0F).Number(std::uint16_t{0});
  const auto bytes = MakeCloud(Encoding::kRos1, 1, 40, 14, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 4}}, data.bytes);
  CloudScans scans;
  const auto parts = scans.Convert(*ParsePointCloud(Encoding::kRos1, bytes), kMadeStampNs, "model");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_DOUBLE_EQ(parts[0].range_unit_m, 0.006);
}

TEST(CloudScans, RefuseCloudsThatAreNone) {
  CloudScans scans;
  const auto refuse = [&](const Payload& bytes) {
    const auto cloud = ParsePointCloud(Encoding::kRos1, bytes);
    ASSERT_TRUE(cloud);
    EXPECT_TRUE(scans.Convert(*cloud, kMadeStampNs, "model").empty());
  };
  refuse(MakeCloud(Encoding::kRos1, 1, 4, 8, {{"x", 0, 7}, {"y", 4, 7}}, Payload(32)));
  refuse(MakeCloud(Encoding::kRos1, 1, 4, 8, {{"x", 0, 7}, {"y", 4, 7}, {"z", 6, 7}}, Payload(32)));  // beyond the point
  refuse(MakeCloud(Encoding::kRos1, 0, 0, 12, {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}}, {}));
  EXPECT_EQ(scans.counts().num_refused, 3);
}

}  // namespace
}  // namespace lookout::importer
