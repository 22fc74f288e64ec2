#include "services/plotter/core/mavlink.hpp"

#include <fmt/format.h>

#include <gtest/gtest.h>
#include <string>

#include "services/plotter/mavlink_output.hpp"
#include "tests/support/mavlink_frames.hpp"

namespace lookout::plotter {
namespace {

std::string Hex(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<std::uint8_t>(byte));
  return text;
}

// The bytes of node-mavlink 2.3.0 for the same values; tests/peers compares more of them.
TEST(Mavlink, HasTheBytesOfAnotherLibrary) {
  MavlinkWriter writer(1, 196);
  EXPECT_EQ(Hex(writer.Heartbeat(MavState::kActive)), "fd0900000001c4000000000000001208000403f49a");
  const auto text = writer.StatusText(MavSeverity::kNotice, "Lookout: the look-out is back");
  ASSERT_EQ(text.size(), 1U);
  EXPECT_EQ(Hex(text.front()), "fd1e00000101c4fd0000054c6f6f6b6f75743a20746865206c6f6f6b2d6f7574206973206261636b2368");
  MavSectors sectors{.time_us = 1'782'901'230'456'789, .max_distance_cm = 4000};
  for (std::size_t i = 0; i < kNumSectors; ++i) {
    sectors.distance_cm[i] = i % 3 == 0 ? MavSectors::kUnknown : static_cast<std::uint16_t>(i % 3 == 1 ? 4001 : 100 + 10 * i);
  }
  EXPECT_EQ(
      Hex(writer.ObstacleDistance(sectors)),
      "fda700000201c44a0100d5cf820a8a550600ffffa10f7800ffffa10f9600ffffa10fb400ffffa10fd200ffffa10ff000ffffa10f0e01ffffa10f2c01ffffa10f4a01ffffa10f"
      "6801ffffa10f8601ffffa10fa401ffffa10fc201ffffa10fe001ffffa10ffe01ffffa10f1c02ffffa10f3a02ffffa10f5802ffffa10f7602ffffa10f9402ffffa10fb202ffff"
      "a10fd002ffffa10fee02ffffa10f0c03ffffa10f2a030100a00f00050000a040000000000ce8a3");
}

TEST(Mavlink, CountsItsFramesFrom0To255) {
  MavlinkWriter writer(1, 196);
  std::string last;
  const MavPoint point{.time_ms = 123'456, .x_m = 12.5, .y_m = -3.25, .min_distance_m = 0.01, .max_distance_m = 40.0};
  for (int i = 0; i < 256; ++i) last = writer.ObstacleDistance3d(point);
  EXPECT_EQ(Hex(last), "fd1c0000ff01c41d2b0040e2010000004841000050c0000000000ad7233c00002042ffff000c5e09");
  EXPECT_EQ(support::ReadMavlink(writer.Heartbeat(MavState::kActive)).front().sequence, 0);
}

TEST(Mavlink, SendsALongTextInPartsOfWhichTheLastIsNotFull) {
  MavlinkWriter writer(7, 8);
  for (const std::size_t size : {0U, 50U, 51U, 100U, 130U}) {
    const std::string text(size, 'x');
    std::string joined;
    std::string whole;
    for (const auto& frame : writer.StatusText(MavSeverity::kWarning, text)) whole += frame;
    const auto frames = support::ReadMavlink(whole);
    ASSERT_EQ(frames.size(), size <= 50 ? 1U : size / 50 + 1) << size;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].system_id, 7);
      EXPECT_EQ(frames[i].component_id, 8);
      EXPECT_EQ(frames[i].At<std::uint8_t>(0), 4);
      EXPECT_EQ(frames[i].At<std::uint16_t>(51) != 0, frames.size() > 1);
      EXPECT_EQ(frames[i].At<std::uint8_t>(53), i);
      joined += frames[i].text();
    }
    EXPECT_EQ(joined, text);
  }
}

TEST(MavlinkReader, CountsTheHeartbeatsOfAnAutopilotWhereverTheyAreCut) {
  MavlinkWriter own(1, 196);
  const std::string stream = "boot text\r\n" + support::AutopilotHeartbeat(true) + own.StatusText(MavSeverity::kInfo, "text").front() + "\xFE\xFD" +
                             support::AutopilotHeartbeat(false) + "\xFD" + support::AutopilotHeartbeat(true) + std::string(30, '\xFE');
  EXPECT_EQ(MavlinkReader().CountHeartbeats(stream), 3);
  for (std::size_t piece = 1; piece < 40; ++piece) {
    MavlinkReader reader;
    int num_heartbeats = 0;
    for (std::size_t at = 0; at < stream.size(); at += piece) num_heartbeats += reader.CountHeartbeats(stream.substr(at, piece));
    EXPECT_EQ(num_heartbeats, 3) << piece;
  }
}

TEST(MavlinkReader, CountsNeitherOthersNorWhatIsDamaged) {
  MavlinkReader reader;
  EXPECT_EQ(reader.CountHeartbeats(MavlinkWriter(1, 196).Heartbeat(MavState::kActive)), 0) << "ours, that came back";
  EXPECT_EQ(reader.CountHeartbeats(support::AutopilotHeartbeat(true, '\x08')), 0) << "a ground station";
  for (const bool is_second : {true, false}) {
    const auto good = support::AutopilotHeartbeat(is_second);
    for (std::size_t i = 0; i < good.size(); ++i) {
      auto bad = good;
      bad[i] = static_cast<char>(bad[i] ^ 0x20);
      // Flags and the number of a frame are under the checksum, too.
      EXPECT_EQ(MavlinkReader().CountHeartbeats(bad + std::string(20, '\0')), 0) << i;
    }
  }
  // Whatever comes, at most the beginning of a heartbeat is kept, and the next one is found.
  std::uint32_t state = 1;
  for (int i = 0; i < 200'000; ++i) {
    state = state * 1'664'525 + 1'013'904'223;
    const char byte = state >> 31U != 0 ? '\xFD' : static_cast<char>(state >> 24U);
    reader.CountHeartbeats({&byte, 1});
  }
  EXPECT_EQ(reader.CountHeartbeats(std::string(300, '\0') + support::AutopilotHeartbeat(true)), 1);
}

Look LookedAllRound() {
  Look look;
  look.is_looked.fill(true);
  look.reach_m = 40.0;
  return look;
}

TEST(MavSectors, SayNearClearAndUnknown) {
  auto look = LookedAllRound();
  look.is_looked[3] = look.is_looked[5] = false;
  look.sectors.AddPoint({10.009, 0.0});
  look.sectors.AddPoint({0.0, -40.01});  // to starboard, beyond the distance
  look.sectors.AddPoint({-0.002, 0.0});  // receivers take no 0
  look.sectors.AddPoint({20.0 * Cos(DegToRad(25.0)), -20.0 * Sin(DegToRad(25.0))});
  const auto message = ToMavSectors(look, Utime(std::chrono::microseconds(5)), 40.0);
  EXPECT_EQ(message.time_us, 5U);
  EXPECT_EQ(message.distance_cm[0], 1000);  // never farther than the truth
  EXPECT_EQ(message.distance_cm[18], 4001);
  EXPECT_EQ(message.distance_cm[36], 1);
  EXPECT_EQ(message.distance_cm[3], MavSectors::kUnknown);
  EXPECT_NEAR(message.distance_cm[5], 2000, 1);  // a thing is told where nobody looked now, too
  EXPECT_EQ(message.distance_cm[1], 4001);
}

TEST(MavPoints, ComeNearestFirstWithOneStamp) {
  auto look = LookedAllRound();
  look.sectors.AddPoint({30.0, 0.0});
  look.sectors.AddPoint({0.0, 5.0});  // to port
  look.sectors.AddPoint({0.0, -50.0});
  look.sectors.AddPoint({-20.0, -0.1});
  const auto points = ToMavPoints(look, Utime(std::chrono::milliseconds(77)), 40.0);
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].y_m, -5.0);  // y is to starboard
  EXPECT_EQ(points[1].x_m, -20.0);
  EXPECT_EQ(points[2].x_m, 30.0);
  for (const auto& point : points) {
    EXPECT_EQ(point.time_ms, 77U);
    EXPECT_EQ(point.max_distance_m, 40.0);
  }
}

// ArduPilot keeps the points of the stamp before until one of another stamp comes: one that is too far to be taken.
TEST(MavPoints, AreOneBeyondTheDistanceWhereNothingIs) {
  const auto points = ToMavPoints(LookedAllRound(), Utime(), 40.0);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points.front().x_m, 41.0);
}

}  // namespace
}  // namespace lookout::plotter
