#include "services/navigator/core/mavlink_lines.hpp"

#include <gtest/gtest.h>
#include <random>

#include "services/navigator/core/mavlink_messages.hpp"
#include "tests/unit/navigator/mavlink_frames.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using std::chrono::milliseconds;

std::string LineOf(const std::string& frame) { return ToMavlinkLine(frame); }

TEST(MavlinkCutter, FindsTheFramesOfOtherLibraries) {
  MavlinkCutter cutter(1);
  const std::vector<std::string> frames{golden::kAttitude, golden::kAttitude1, golden::kPosition,      golden::kPosition1,     golden::kGps,
                                        golden::kPlainGps, golden::kNoFix,     golden::kLevelAttitude, golden::kSignedAttitude};
  for (const auto& frame : frames) {
    const auto found = cutter.Add(NoonPlus(0), ToBytes(frame), "a");
    ASSERT_EQ(found.lines, std::vector{LineOf(frame)});
    EXPECT_TRUE(IsLine(found.lines.front()));
    EXPECT_EQ(MavlinkBytesOf(found.lines.front()), frame);
    EXPECT_EQ(found.num_bad_checksum + found.num_other_sender + found.num_skipped_bytes, 0);
  }
  EXPECT_EQ(LineOf(golden::kLevelAttitude), "$PLKMAV,FD0100000F01011E000007BB42*" + LineOf(golden::kLevelAttitude).substr(35));
}

// A GPS_RAW_INT of all extensions that have a name, with a signature, is far from the longest line.
TEST(MavlinkCutter, MakesNoLineThatNavRawDoesNotTake) {
  EXPECT_TRUE(IsLine(LineOf(std::string(MaxMavlinkFrameBytes(kMaxMavlinkPayloadBytes), '\xFF'))));
  const auto longest = MakeFrame(24, 24, std::string(kMaxMavlinkPayloadBytes, '\x01'));
  EXPECT_EQ(MavlinkCutter(1).Add(NoonPlus(0), ToBytes(longest)).lines, std::vector{LineOf(longest)});
  const auto too_long = MakeFrame(24, 24, std::string(kMaxMavlinkPayloadBytes + 1, '\x01'));
  const auto found = MavlinkCutter(1).Add(NoonPlus(0), ToBytes(too_long));
  EXPECT_TRUE(found.lines.empty());
  EXPECT_EQ(found.num_skipped_bytes, static_cast<std::int64_t>(too_long.size()));
}

TEST(MavlinkCutter, PutsFramesTogetherWhereverTheyAreCut) {
  const std::string noise = "boot\r\n$GPHDT,1,T\xFE\xFD";
  const std::string heartbeat = support::AutopilotHeartbeat();
  const std::string stream =
      noise + golden::kAttitude + heartbeat + golden::kPosition1 + "\xFD" + golden::kGps + golden::kSignedAttitude + golden::kAttitude1;
  const std::vector<std::string> expected{LineOf(golden::kAttitude), LineOf(golden::kPosition1), LineOf(golden::kGps),
                                          LineOf(golden::kSignedAttitude), LineOf(golden::kAttitude1)};
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    MavlinkCutter cutter(1);
    std::vector<std::string> lines;
    std::int64_t num_skipped = 0;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      const auto found = cutter.Add(NoonPlus(0), ToBytes(stream.substr(at, piece)), "a");
      lines.insert(lines.end(), found.lines.begin(), found.lines.end());
      num_skipped += found.num_skipped_bytes;
      EXPECT_EQ(found.num_bad_checksum, 0);
    }
    ASSERT_EQ(lines, expected) << piece;
    EXPECT_EQ(num_skipped, static_cast<std::int64_t>(noise.size() + heartbeat.size() + 1)) << "each byte is read or counted";
  }
}

TEST(MavlinkCutter, JoinsNeitherTwoSendersNorWhatComesTooLate) {
  MavlinkCutter cutter(1);
  const auto begin = golden::kAttitude.substr(0, 20);
  const auto rest = golden::kAttitude.substr(20);
  EXPECT_TRUE(cutter.Add(NoonPlus(0), ToBytes(begin), "a").lines.empty());
  EXPECT_TRUE(cutter.Add(NoonPlus(0), ToBytes(rest), "b").lines.empty());
  EXPECT_EQ(cutter.Add(NoonPlus(0.1), ToBytes(rest), "a").lines.size(), 1U);
  EXPECT_TRUE(cutter.Add(NoonPlus(1), ToBytes(begin), "a").lines.empty());
  const auto late = cutter.Add(NoonPlus(1.31), ToBytes(rest), "a");
  EXPECT_TRUE(late.lines.empty());
  EXPECT_EQ(late.num_skipped_bytes, static_cast<std::int64_t>(golden::kAttitude.size()));
  // The clock was set back.
  cutter.Add(NoonPlus(2), ToBytes(begin), "a");
  EXPECT_TRUE(cutter.Add(NoonPlus(1.9), ToBytes(rest), "a").lines.empty());
  cutter.Add(NoonPlus(3), ToBytes(begin));
  cutter.Clear();
  EXPECT_TRUE(cutter.Add(NoonPlus(3), ToBytes(rest)).lines.empty()) << "the stream broke off";
}

TEST(MavlinkCutter, HoldsTheBeginsOfManySendersAndNoMore) {
  MavlinkCutter cutter(1);
  const auto begin = golden::kAttitude.substr(0, 20);
  for (std::size_t i = 0; i < MavlinkCutter::kMaxSenders; ++i) {
    EXPECT_EQ(cutter.Add(NoonPlus(1e-3 * static_cast<double>(i)), ToBytes(begin), std::to_string(i)).num_skipped_bytes, 0);
  }
  EXPECT_EQ(cutter.Add(NoonPlus(0.1), ToBytes(begin), "one more").num_skipped_bytes, 20);
  EXPECT_TRUE(cutter.Add(NoonPlus(0.1), ToBytes(golden::kAttitude.substr(20)), "0").lines.empty()) << "heard longest ago";
  EXPECT_EQ(cutter.Add(NoonPlus(0.1), ToBytes(golden::kAttitude.substr(20)), "1").lines.size(), 1U);
}

TEST(MavlinkCutter, CountsOtherSystemsAndDamagedFrames) {
  MavlinkCutter cutter(1);
  for (const auto& frame : {golden::kAttitudeOfSystem42, golden::kAttitudeOfComponent196}) {
    const auto found = cutter.Add(NoonPlus(0), ToBytes(frame));
    EXPECT_TRUE(found.lines.empty());
    EXPECT_EQ(found.num_other_sender, 1);
  }
  EXPECT_EQ(MavlinkCutter(42).Add(NoonPlus(0), ToBytes(golden::kAttitudeOfSystem42)).lines.size(), 1U);
  for (const auto& good : {golden::kAttitude, golden::kAttitude1}) {
    for (std::size_t i = 0; i < good.size(); ++i) {
      auto bad = good;
      bad[i] = static_cast<char>(bad[i] ^ 0x40);
      MavlinkCutter damaged(1);
      auto found = damaged.Add(NoonPlus(0), ToBytes(bad + std::string(120, '\0') + good));
      EXPECT_EQ(found.lines, std::vector{LineOf(good)}) << i << ": the next frame is found";
    }
  }
  auto bad = golden::kAttitude;
  bad.back() = static_cast<char>(bad.back() ^ 1);
  EXPECT_EQ(cutter.Add(NoonPlus(0), ToBytes(bad)).num_bad_checksum, 1);
  // Flags that a receiver does not know change what a frame means.
  bad = golden::kAttitude;
  bad[2] = 2;
  const auto crc = Field(support::MavlinkCrc(bad.substr(1, bad.size() - 3) + '\x27'));
  bad.replace(bad.size() - 2, 2, crc);
  EXPECT_TRUE(cutter.Add(NoonPlus(0), ToBytes(bad)).lines.empty());
}

TEST(MavlinkCutter, FindsTheNextFrameBehindAnyNoise) {
  MavlinkCutter cutter(1);
  std::mt19937 random(1);
  std::int64_t num_bytes = 0;
  std::int64_t num_skipped = 0;
  for (int i = 0; i < 200'000; ++i) {
    // The begins of frames, mostly.
    static constexpr char kLikely[] = {'\xFD', '\xFE', '\x1C', '\0', '\x01', '\x1E', '\x18'};
    const char byte = random() % 4 == 0 ? static_cast<char>(random()) : kLikely[random() % sizeof kLikely];
    num_skipped += cutter.Add(NoonPlus(0), ToBytes(std::string(1, byte))).num_skipped_bytes;
    ++num_bytes;
  }
  EXPECT_LE(num_bytes - num_skipped, static_cast<std::int64_t>(MaxMavlinkFrameBytes(kMaxMavlinkPayloadBytes)));
  EXPECT_EQ(cutter.Add(NoonPlus(0), ToBytes(std::string(200, '\0') + golden::kAttitude)).lines.size(), 1U);
}

TEST(MavlinkLine, HasOneForm) {
  const auto line = LineOf(golden::kAttitude);
  ASSERT_TRUE(MavlinkBytesOf(line));
  const auto body = line.substr(1, line.size() - 4);
  for (const auto& other : {Line(body, '!'), Line(body + "0"), Line(body + ",00"), Line("PLKMAV"), Line("PLKMAW" + body.substr(6)),
                            Line("PLKMAV,fd" + body.substr(9)), Line("PLKMAV,0G"), "$" + body, line + "0", std::string("$")}) {
    EXPECT_FALSE(MavlinkBytesOf(other)) << other;
  }
}

TEST(MavlinkMessages, SayWhatTheAutopilotMeans) {
  for (const auto& frame : {golden::kAttitude, golden::kAttitude1, golden::kSignedAttitude}) {
    const auto [fault, said] = ParseMavlinkLine(LineOf(frame));
    ASSERT_EQ(fault, SentenceFault::kNone);
    EXPECT_EQ(said.type, SentenceType::kMavAttitude);
    EXPECT_EQ(said.time_boot_ms, 123'456U);
    EXPECT_NEAR(said.roll_rad, 0.05, 1e-8);
    EXPECT_NEAR(said.pitch_rad, 0.02, 1e-8);
    EXPECT_NEAR(said.heading_rad, 2 * 3.14159265358979 - 0.25, 1e-8);
    EXPECT_EQ(said.turn_rate_radps, 0.125);
  }
  for (const auto& frame : {golden::kPosition, golden::kPosition1}) {
    const auto [fault, said] = ParseMavlinkLine(LineOf(frame));
    ASSERT_EQ(fault, SentenceFault::kNone);
    EXPECT_EQ(said.time_boot_ms, 123'460U);
    EXPECT_NEAR(said.position->latitude_deg, 54.1234567, 1e-12);
    EXPECT_NEAR(said.position->longitude_deg, -10.654321, 1e-12);
    EXPECT_NEAR(said.msl_height_m, 12.345, 1e-12);
    EXPECT_NEAR(said.speed_mps, 5.0, 1e-12);
    EXPECT_NEAR(said.course_rad, 2 * 3.14159265358979 - std::atan2(4.0, 3.0), 1e-12) << "3 m/s north and 4 m/s west";
    EXPECT_EQ(said.quality, FixQuality::kNone) << "the receiver's message tells it";
  }
  const auto gps = ParseMavlinkLine(LineOf(golden::kGps)).sentence;
  EXPECT_EQ(gps.quality, FixQuality::kDifferential);
  EXPECT_EQ(gps.num_satellites, 14);
  EXPECT_NEAR(gps.hdop, 0.9, 1e-12);
  EXPECT_NEAR(gps.geoid_separation_m, 43.0, 1e-9);
  EXPECT_NEAR(gps.horizontal_sd_m, 0.8, 1e-12);
  EXPECT_NEAR(gps.vertical_sd_m, 1.5, 1e-12);
  EXPECT_NEAR(gps.velocity_sd_mps, 0.12, 1e-12);
  EXPECT_NEAR(gps.heading_sd_rad, 2.5 * 3.14159265358979 / 180, 1e-12);
  const auto plain = ParseMavlinkLine(LineOf(golden::kPlainGps)).sentence;
  EXPECT_EQ(plain.quality, FixQuality::kGnss);
  EXPECT_TRUE(std::isnan(plain.horizontal_sd_m) && std::isnan(plain.geoid_separation_m) && std::isnan(plain.heading_sd_rad));
  EXPECT_EQ(ParseMavlinkLine(LineOf(golden::kNoFix)).sentence.quality, FixQuality::kNone);
  EXPECT_TRUE(std::isnan(ParseMavlinkLine(LineOf(golden::kNoFix)).sentence.hdop));
  EXPECT_TRUE(std::isnan(ParseMavlinkLine(LineOf(GpsFrame(3, 500, 250'000))).sentence.heading_sd_rad)) << "of the course: no two antennas";
}

TEST(MavlinkMessages, HaveTheirTrailingZerosAgain) {
  const auto [fault, said] = ParseMavlinkLine(LineOf(golden::kLevelAttitude));
  ASSERT_EQ(fault, SentenceFault::kNone);
  EXPECT_EQ(said.time_boot_ms, 7U);
  EXPECT_EQ(said.roll_rad, 0.0);
  EXPECT_EQ(said.pitch_rad, 0.0);
  EXPECT_EQ(said.heading_rad, 0.0);
  EXPECT_EQ(said.turn_rate_radps, 0.0);
}

TEST(MavlinkMessages, AreRefusedWhereTheyCannotBe) {
  const auto fault_of = [](const std::string& frame) { return ParseMavlinkLine(LineOf(frame)).fault; };
  EXPECT_EQ(fault_of(AttitudeFrame(1, 3.1415927F, -1.5707964F, 3.1415927F)), SentenceFault::kNone);
  EXPECT_EQ(fault_of(AttitudeFrame(1, std::nanf(""), 0.0F, 0.0F)), SentenceFault::kImplausible);
  EXPECT_EQ(fault_of(AttitudeFrame(1, 0.0F, 1.6F, 0.0F)), SentenceFault::kImplausible);
  EXPECT_EQ(fault_of(AttitudeFrame(1, 0.0F, 0.0F, 1e30F)), SentenceFault::kImplausible);
  EXPECT_EQ(fault_of(AttitudeFrame(1, 0.0F, 0.0F, 0.0F, 1e9F)), SentenceFault::kImplausible);
  EXPECT_EQ(fault_of(PositionFrame(1, 90.0, 180.0)), SentenceFault::kNone);
  EXPECT_EQ(fault_of(PositionFrame(1, 90.1, 0.0)), SentenceFault::kImplausible);
  EXPECT_EQ(fault_of(PositionFrame(1, 0.0, -180.1)), SentenceFault::kImplausible);
  EXPECT_EQ(fault_of(PositionFrame(1, 54.0, 10.0, 99.0, 99.0)), SentenceFault::kImplausible);
  EXPECT_EQ(fault_of(PositionFrame(1, 54.0, 10.0, 0.0, 0.0, -2'000'000)), SentenceFault::kImplausible);
  EXPECT_EQ(fault_of(golden::kAttitude + golden::kAttitude), SentenceFault::kBadField) << "one frame a line";
  EXPECT_EQ(fault_of(support::AutopilotHeartbeat()), SentenceFault::kBadField);
  EXPECT_EQ(fault_of(""), SentenceFault::kBadField);
  EXPECT_EQ(fault_of(golden::kAttitude.substr(0, 30)), SentenceFault::kBadField);
  auto bad = golden::kAttitude;
  bad[12] = static_cast<char>(bad[12] ^ 1);
  EXPECT_EQ(fault_of(bad), SentenceFault::kBadChecksum);
  EXPECT_EQ(ParseMavlinkLine("$PLKMAV,FD*00").fault, SentenceFault::kBadChecksum);
  EXPECT_EQ(ParseMavlinkLine("$GPHDT,1.0,T").fault, SentenceFault::kNoChecksum);
  EXPECT_EQ(ParseMavlinkLine(HdtLine(1.0)).fault, SentenceFault::kBadField);
}

}  // namespace
}  // namespace lookout::navigator
