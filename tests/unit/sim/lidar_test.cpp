#include "lab/sim/lidar.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <tuple>

#include "common/core/angles.hpp"
#include "common/core/bytes.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;
namespace format = vlp16::format;

const Utime kStart = Utime(1'781'532'600s);  // 10 minutes past the hour

// Without strays and noise of the range.
Scene QuietScene(double own_heading_rad, std::vector<Part> parts, config::Scene::ReturnMode mode = config::Scene::STRONGEST) {
  Scene scene = StillScene(own_heading_rad, std::move(parts));
  scene.effects.set_stray_probability(0.0);
  scene.effects.set_range_sd_m(0.0);
  scene.effects.set_return_mode(mode);
  return scene;
}

struct Decoded {
  double azimuth_deg;  // of the block
  int sequence;
  std::size_t laser;
  double range_m;
  int reflectivity;
};

// By the offsets of the manual, without the decoder.
std::vector<Decoded> Decode(const LidarPacket& packet) {
  std::vector<Decoded> returns;
  for (std::size_t block = 0; block < 12; ++block) {
    const std::size_t offset = block * 100;
    EXPECT_EQ(packet.payload[offset], 0xFF);
    EXPECT_EQ(packet.payload[offset + 1], 0xEE);
    const double azimuth_deg = ReadU16LittleEndian(packet.payload, offset + 2) / 100.0;
    EXPECT_LT(azimuth_deg, 360.0);
    for (int sequence = 0; sequence < 2; ++sequence) {
      for (std::size_t laser = 0; laser < 16; ++laser) {
        const std::size_t at = offset + 4 + (static_cast<std::size_t>(sequence) * 16 + laser) * 3;
        const auto range_2mm = ReadU16LittleEndian(packet.payload, at);
        if (range_2mm != 0) returns.push_back({azimuth_deg, sequence, laser, range_2mm * 0.002, packet.payload[at + 2]});
      }
    }
  }
  return returns;
}

std::vector<Part> Wall(double north_m) { return {{Prism{Rectangle(north_m, north_m + 1.0, -200.0, 200.0), 0.0, 50.0}, {0.6}}}; }

TEST(Lidar, MeasuresAWallWhereItStands) {
  const auto scene = QuietScene(0.0, Wall(20.0));
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kStart, 1);
  int num_checked = 0;
  for (int i = 0; i < 76; ++i) {
    for (const auto& made : Decode(lidar.Next())) {
      // 600 rpm: 0.2 deg a sequence, and the laser's share of it.
      const double azimuth_deg = made.azimuth_deg + 0.1990656 * made.sequence + 3.6e3 * 2.304e-6 * static_cast<double>(made.laser);
      if (std::abs(WrapToPi(DegToRad(azimuth_deg))) > DegToRad(50.0)) continue;  // also keeps the own boat out
      const double cosine = std::cos(DegToRad(azimuth_deg)) * std::cos(DegToRad(format::kElevationDegVlp16[made.laser]));
      EXPECT_NEAR(made.range_m, 20.0 / cosine, 0.02) << azimuth_deg << " laser " << made.laser;
      EXPECT_GT(made.reflectivity, 20);
      ++num_checked;
    }
  }
  // 500 columns of which the lasers above -5.7 deg see the wall before the water: 11 or more.
  EXPECT_GT(num_checked, 500 * 10);
}

TEST(Lidar, WaterGivesNothingAndLowBeamsSeeTheOwnBoat) {
  const auto scene = QuietScene(0.0, {{Cylinder{{50.0, 0.0}, 0.01, 0.0, 0.01}, {0.5}}});
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kStart, 1);
  int num_own = 0;
  for (int i = 0; i < 76; ++i) {
    const auto packet = lidar.Next();
    for (const auto& made : packet.returns) {
      EXPECT_EQ(made.object_id, kOwnVessel);
      EXPECT_LT(made.ring, 8);
      ++num_own;
    }
    for (const auto& made : Decode(packet)) {
      EXPECT_LT(made.range_m, 2.5);
      EXPECT_LT(std::abs(made.azimuth_deg - 180.0), 90.0) << "motor and post stand aft";
    }
  }
  EXPECT_GT(num_own, 100);
}

// A post at a bearing from the bow must appear at that azimuth.
void ExpectPostAt(double own_heading_deg, double bearing_deg) {
  const double true_bearing_rad = DegToRad(own_heading_deg + bearing_deg);
  // Object frame: x north, y west.
  const Eigen::Vector2d foot_m = 20.0 * Eigen::Vector2d(std::cos(true_bearing_rad), -std::sin(true_bearing_rad));
  const auto scene = QuietScene(DegToRad(own_heading_deg), {{Cylinder{foot_m, 0.2, 0.0, 10.0}, {0.6}}});
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kStart, 1);
  int num_seen = 0;
  for (int i = 0; i < 76; ++i) {
    for (const auto& made : Decode(lidar.Next())) {
      if (made.range_m < 5.0) continue;
      const double difference_deg = RadToDeg(WrapToPi(DegToRad(made.azimuth_deg - bearing_deg)));
      EXPECT_LT(std::abs(difference_deg), 1.1) << "heading " << own_heading_deg << " bearing " << bearing_deg;
      ++num_seen;
    }
  }
  EXPECT_GT(num_seen, 20);
}

TEST(Lidar, StarboardAheadIsAtPositiveAzimuthOnEveryHeading) {
  for (const double heading_deg : {0.0, 90.0, 217.0, 359.5}) {
    ExpectPostAt(heading_deg, 30.0);
    ExpectPostAt(heading_deg, 270.0);
    ExpectPostAt(heading_deg, 0.0);
  }
}

TEST(Lidar, MountingYawTurnsWhatItSeesTheOtherWay) {
  auto boat = SmallBoat();
  boat.lidar.yaw_rad = DegToRad(10.0);  // the lidar's x axis to port: a thing ahead is to the right of it
  boat.T_vessel_lidar = TransformVesselSensor(boat.lidar);
  const auto scene = QuietScene(0.0, {{Cylinder{{20.0, 0.0}, 0.2, 0.0, 10.0}, {0.6}}});
  Lidar lidar(scene, boat, LidarParams{}, kStart, 1);
  int num_seen = 0;
  for (int i = 0; i < 76; ++i) {
    for (const auto& made : Decode(lidar.Next())) {
      if (made.range_m < 5.0) continue;
      EXPECT_NEAR(made.azimuth_deg, 10.0, 1.1);
      ++num_seen;
    }
  }
  EXPECT_GT(num_seen, 20);
}

TEST(Lidar, RollToStarboardLowersTheBeamsThere) {
  // A low wall all around: rolled by 6 deg to starboard the level beams pass over it to port and go into the water to starboard.
  auto scene =
      QuietScene(0.0, {{Prism{Rectangle(-30.0, 30.0, -21.0, -20.0), 0.0, 1.0}, {0.6}}, {Prism{Rectangle(-30.0, 30.0, 20.0, 21.0), 0.0, 1.0}, {0.6}}});
  scene.own_motion.roll_rad = {{DegToRad(6.0), 1e9, kPi / 2.0}};
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kStart, 1);
  std::map<bool, double> highest_elevation_deg{{true, -90.0}, {false, -90.0}};
  for (int i = 0; i < 76; ++i) {
    for (const auto& made : Decode(lidar.Next())) {
      if (made.range_m < 5.0 || std::abs(std::abs(made.azimuth_deg - 180.0) - 90.0) > 10.0) continue;  // abeam
      auto& highest = highest_elevation_deg[made.azimuth_deg < 180.0];
      highest = std::max(highest, format::kElevationDegVlp16[made.laser]);
    }
  }
  EXPECT_GE(highest_elevation_deg[true], 1.0) << "to starboard beams point 6 deg lower than they say";
  EXPECT_LE(highest_elevation_deg[false], -9.0);
  EXPECT_GT(highest_elevation_deg[false], -90.0);
}

TEST(Lidar, StampsFollowThePacketPeriodAcrossTheHour) {
  const auto scene = QuietScene(0.0, Wall(20.0));
  const Utime start = Utime(1'781'532'000s) - 2000us;  // 14:00:00 comes 2 ms later
  Lidar lidar(scene, SmallBoat(), LidarParams{}, start, 1);
  EXPECT_EQ(ReadU32LittleEndian(lidar.Next().payload, 1200), 3'600'000'000U - 2000U);
  EXPECT_EQ(ReadU32LittleEndian(lidar.Next().payload, 1200), 3'600'000'000U - 2000U + 1327U);
  EXPECT_EQ(ReadU32LittleEndian(lidar.Next().payload, 1200), 654U);  // 2 x 1327.104 - 2000, whole microseconds
}

TEST(Lidar, DualPacketsHavePairsOfOneAzimuthAndTheTruthNumbersTheirReturns) {
  std::vector<Part> parts = Wall(30.0);
  parts.push_back({Ellipsoid{{15.0, 0.0, 3.0}, {2.0, 6.0, 4.0}}, {0.5, true}});
  const auto scene = QuietScene(0.0, parts, config::Scene::DUAL);
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kStart, 1);
  int num_apart = 0;
  for (int i = 0; i < 151; ++i) {
    const auto packet = lidar.Next();
    EXPECT_EQ(packet.payload[1204], 0x39);
    EXPECT_EQ(ReadU32LittleEndian(packet.payload, 1200), 600'000'000U + static_cast<unsigned>(663.552 * i));
    std::size_t num_returns = 0;
    for (std::size_t pair = 0; pair < 6; ++pair) {
      EXPECT_EQ(ReadU16LittleEndian(packet.payload, pair * 200 + 2), ReadU16LittleEndian(packet.payload, pair * 200 + 102));
      for (std::size_t k = 0; k < 32; ++k) {
        const auto last = ReadU16LittleEndian(packet.payload, pair * 200 + 4 + k * 3);
        const auto strongest = ReadU16LittleEndian(packet.payload, pair * 200 + 104 + k * 3);
        EXPECT_GE(last, strongest);
        num_apart += last > strongest ? 1 : 0;
        num_returns += (last != 0 ? 1U : 0U) + (strongest != 0 ? 1U : 0U);
      }
    }
    EXPECT_EQ(packet.returns.size(), num_returns);
  }
  EXPECT_GT(num_apart, 100);
}

TEST(Lidar, TruthHasARowPerReturnWithTheTimeOfItsShot) {
  const auto scene = StillScene(0.0, Wall(20.0));
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kStart, 1);
  for (int i = 0; i < 100; ++i) {
    const auto packet = lidar.Next();
    const auto decoded = Decode(packet);
    ASSERT_EQ(packet.returns.size(), decoded.size());
    const std::int64_t stamp_us = ReadU32LittleEndian(packet.payload, 1200);
    std::size_t index = 0;
    for (std::size_t block = 0; block < 12; ++block) {
      for (std::size_t k = 0; k < 32; ++k) {
        if (ReadU16LittleEndian(packet.payload, block * 100 + 4 + k * 3) == 0) continue;
        const auto& made = packet.returns[index++];
        const double shot_us = 110.592 * static_cast<double>(block) + 55.296 * static_cast<double>(k / 16) + 2.304 * static_cast<double>(k % 16);
        EXPECT_EQ(ToUtimeUs(made.time) % 3'600'000'000, stamp_us + std::llround(shot_us));
        EXPECT_NEAR(format::kElevationDegVlp16[k % 16], -15.0 + 2.0 * made.ring, 1e-9);
      }
    }
  }
}

TEST(Lidar, RotorNeitherDriftsFromItsRateNorJumps) {
  const auto scene = StillScene(0.0, Wall(20.0));
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kStart, 4);
  const double mean_radps = (lidar.AzimuthAt(1000.0) - lidar.AzimuthAt(0.0)) / 1000.0;
  EXPECT_NEAR(mean_radps, 20.0 * kPi, 20.0 * kPi * 0.004);
  for (int i = 0; i < 1000; ++i) {
    const double step_rad = lidar.AzimuthAt((i + 1) * 0.0011) - lidar.AzimuthAt(i * 0.0011);
    EXPECT_NEAR(step_rad, mean_radps * 0.0011, DegToRad(0.05));
  }
}

TEST(Lidar, BlackThingsAreLostEarlierThanBrightOnes) {
  const auto count = [](double reflectance) {
    const auto scene = QuietScene(0.0, {{Prism{Rectangle(40.0, 41.0, -5.0, 5.0), 0.0, 5.0}, {reflectance}}});
    Lidar lidar(scene, SmallBoat(), LidarParams{}, kStart, 1);
    int num_seen = 0;
    for (int i = 0; i < 76; ++i) {
      for (const auto& made : lidar.Next().returns) num_seen += made.object_id == 1 ? 1 : 0;
    }
    return num_seen;
  };
  EXPECT_GT(count(0.6), 100);
  EXPECT_LT(count(0.03), 5);
}

TEST(Lidar, OnlyRetroReflectorsAreBrighterThanAHundred) {
  for (const double reflectance : {0.99, 2.0}) {
    const auto scene = QuietScene(0.0, {{Prism{Rectangle(10.0, 11.0, -5.0, 5.0), 0.0, 5.0}, {reflectance}}});
    Lidar lidar(scene, SmallBoat(), LidarParams{}, kStart, 1);
    int greatest = 0;
    for (int i = 0; i < 76; ++i) {
      for (const auto& decoded : Decode(lidar.Next())) greatest = std::max(greatest, decoded.reflectivity);
    }
    EXPECT_NEAR(greatest, reflectance > 1.0 ? 200 : 100, reflectance > 1.0 ? 10 : 0);
  }
}

TEST(Lidar, APuckHiResLooksAlongItsOwnBeams) {
  const auto scene = QuietScene(0.0, Wall(20.0));
  LidarParams params;
  params.model = vlp16::Model::kPuckHiRes;
  Lidar lidar(scene, SmallBoat(), params, kStart, 1);
  int num_checked = 0;
  for (int i = 0; i < 76; ++i) {
    const auto packet = lidar.Next();
    EXPECT_EQ(packet.payload[1205], 0x24);
    for (const auto& made : packet.returns) EXPECT_LT(made.ring, 16);
    for (const auto& made : Decode(packet)) {
      const double azimuth_deg = made.azimuth_deg + 0.1990656 * made.sequence + 3.6e3 * 2.304e-6 * static_cast<double>(made.laser);
      if (std::abs(WrapToPi(DegToRad(azimuth_deg))) > DegToRad(50.0)) continue;
      const double cosine = std::cos(DegToRad(azimuth_deg)) * std::cos(DegToRad(format::kElevationDegPuckHiRes[made.laser]));
      EXPECT_NEAR(made.range_m, 20.0 / cosine, 0.02) << azimuth_deg << " laser " << made.laser;
      ++num_checked;
    }
  }
  // The lasers above -5.7 deg see the wall before the water: 12 or more of 16.
  EXPECT_GT(num_checked, 500 * 11);
}

TEST(Lidar, VerticalOriginsAreThoseOfTheModel) {
  // A level wall of beams cannot be had; the lowest beam of each model meets flat ground 1.5 m below at a range that tells its origin.
  const auto range_of_lowest_m = [](vlp16::Model model, bool use_vertical_origin_offsets) {
    const auto scene = QuietScene(0.0, {{Prism{Rectangle(-50.0, 50.0, -50.0, 50.0), 0.0, 0.5}, {0.9}}});
    LidarParams params;
    params.model = model;
    params.use_vertical_origin_offsets = use_vertical_origin_offsets;
    Lidar lidar(scene, SmallBoat(), params, kStart, 1);
    double sum_m = 0.0;
    int count = 0;
    for (int i = 0; i < 76; ++i) {
      for (const auto& made : Decode(lidar.Next())) {
        if (made.laser != 0 || made.range_m < 5.0) continue;
        sum_m += made.range_m;
        ++count;
      }
    }
    EXPECT_GT(count, 500);
    return sum_m / count;
  };
  EXPECT_NEAR(range_of_lowest_m(vlp16::Model::kVlp16, false), 1.5 / std::sin(DegToRad(15.0)), 0.002);
  EXPECT_NEAR(range_of_lowest_m(vlp16::Model::kVlp16, true), 1.5112 / std::sin(DegToRad(15.0)), 0.002);
  EXPECT_NEAR(range_of_lowest_m(vlp16::Model::kPuckHiRes, false), 1.5 / std::sin(DegToRad(10.0)), 0.002);
  EXPECT_NEAR(range_of_lowest_m(vlp16::Model::kPuckHiRes, true), 1.5074 / std::sin(DegToRad(10.0)), 0.002);
}

struct Jumps {
  int within_packets = 0;
  int between_packets = 0;
};

// Azimuths and stamps against the rotor itself.
Jumps ExpectFieldOfView(double from_deg, double to_deg, config::Scene::ReturnMode mode, double rpm) {
  SCOPED_TRACE(testing::Message() << from_deg << " to " << to_deg << " at " << rpm << (mode == config::Scene::DUAL ? " dual" : ""));
  const auto scene = QuietScene(0.0, Wall(20.0), mode);
  LidarParams params;
  params.rotation_rpm = rpm;
  params.field_of_view = {DegToRad(from_deg), WrapTo2Pi(DegToRad(to_deg - from_deg))};
  Lidar lidar(scene, SmallBoat(), params, kStart, 1);
  const double width_deg = RadToDeg(params.field_of_view.width_rad);
  const double block_deg = rpm * 6.0 * 110.592e-6;
  const std::size_t blocks_per_step = mode == config::Scene::DUAL ? 2 : 1;
  int num_jumps_within = 0;
  int num_jumps_between = 0;
  double last_azimuth_deg = -1.0;
  Utime last_end = kStart - 1us;
  for (int i = 0; i < 300; ++i) {
    const auto packet = lidar.Next();
    // The stamp is the time of the first block: there the rotor stands at that block's azimuth.
    const std::int64_t past_hour_us = ReadU32LittleEndian(packet.payload, 1200);
    const double stamp_s = static_cast<double>(past_hour_us - 600'000'000) * 1e-6;
    EXPECT_NEAR(RadToDeg(WrapToPi(lidar.AzimuthAt(stamp_s) - DegToRad(ReadU16LittleEndian(packet.payload, 2) / 100.0))), 0.0, 0.02);
    EXPECT_GT(Utime(1'781'532'000s) + std::chrono::microseconds(past_hour_us), last_end);
    last_end = packet.end_time;
    for (std::size_t block = 0; block < 12; block += blocks_per_step) {
      const double azimuth_deg = ReadU16LittleEndian(packet.payload, block * 100 + 2) / 100.0;
      const double inside_deg = RadToDeg(WrapTo2Pi(DegToRad(azimuth_deg - from_deg)));
      EXPECT_LT(inside_deg, width_deg - block_deg * 0.75);  // the second sequence fires inside too
      const double step_deg = last_azimuth_deg < 0.0 ? block_deg : RadToDeg(WrapTo2Pi(DegToRad(azimuth_deg - last_azimuth_deg)));
      if (std::abs(step_deg - block_deg) > 0.1) {
        EXPECT_NEAR(step_deg, 360.0 - width_deg + block_deg * 1.5, block_deg * 1.5);
        ++(block == 0 ? num_jumps_between : num_jumps_within);
      }
      last_azimuth_deg = azimuth_deg;
      // Each block is filled: the wall ahead is seen by the upper lasers in both sequences.
      if (std::abs(WrapToPi(DegToRad(azimuth_deg))) > DegToRad(45.0)) continue;
      EXPECT_NE(ReadU16LittleEndian(packet.payload, block * 100 + 4 + 15 * 3), 0) << azimuth_deg;
      EXPECT_NE(ReadU16LittleEndian(packet.payload, block * 100 + 4 + 31 * 3), 0) << azimuth_deg;
    }
  }
  return {num_jumps_within, num_jumps_between};
}

TEST(Lidar, FiresOnlyInItsFieldOfViewAndStampsWhatItFires) {
  Jumps total;
  const auto check = [&total](double from_deg, double to_deg, config::Scene::ReturnMode mode, double rpm) {
    const auto jumps = ExpectFieldOfView(from_deg, to_deg, mode, rpm);
    EXPECT_GE(jumps.within_packets + jumps.between_packets, 1) << from_deg << " to " << to_deg << " at " << rpm;
    total.within_packets += jumps.within_packets;
    total.between_packets += jumps.between_packets;
  };
  for (const auto mode : {config::Scene::STRONGEST, config::Scene::DUAL}) {
    for (const double rpm : {300.0, 600.0, 1200.0}) {
      check(300.0, 60.0, mode, rpm);
      check(0.0, 90.0, mode, rpm);
    }
    check(10.0, 350.0, mode, 1200.0);
  }
  check(20.0, 22.0, config::Scene::STRONGEST, 1200.0);
  EXPECT_GT(total.within_packets, 100);
  EXPECT_GT(total.between_packets, 5);
}

TEST(Lidar, TruthOfAPacketAcrossTheGapHasTheTimesOfItsShots) {
  const auto scene = QuietScene(0.0, Wall(20.0));
  LidarParams params;
  params.field_of_view = {DegToRad(330.0), DegToRad(60.0)};
  Lidar lidar(scene, SmallBoat(), params, kStart, 1);
  int num_across = 0;
  for (int i = 0; i < 300; ++i) {
    const auto packet = lidar.Next();
    const auto decoded = Decode(packet);
    ASSERT_EQ(packet.returns.size(), decoded.size());
    ASSERT_FALSE(decoded.empty());
    num_across += packet.returns.back().time - packet.returns.front().time > 50ms ? 1 : 0;
    for (std::size_t k = 0; k < decoded.size(); ++k) {
      const double time_s =
          ToSeconds(packet.returns[k].time - kStart) - 55.296e-6 * decoded[k].sequence - 2.304e-6 * static_cast<double>(decoded[k].laser);
      EXPECT_NEAR(RadToDeg(WrapToPi(lidar.AzimuthAt(time_s) - DegToRad(decoded[k].azimuth_deg))), 0.0, 0.02);
    }
  }
  EXPECT_GT(num_across, 5);
}

}  // namespace
}  // namespace lookout::sim
