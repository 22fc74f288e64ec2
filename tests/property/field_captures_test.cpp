// Forms of captures and logs that public bug reports describe, read where they lie: ../shared/data/field, whose README says what is right.
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "lab/data/xz_file.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/pose_t.hpp"
#include "tests/support/files.hpp"
#include "tools/log/commands.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/input.hpp"

namespace lookout::replay {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

// 2026-08-29 10:00:00 UTC, from 54.5 N 10.2 E east at 2 m/s.
constexpr std::int64_t kBeginUs = 1'787'997'600'000'000;
constexpr double kLatitudeDeg = 54.5;
constexpr double kLongitudeDeg = 10.2;
constexpr double kSpeedMps = 2.0;
constexpr double kMetresPerDegree = 111'300.0;

class FieldCapture : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kField)) GTEST_SKIP() << "no inputs at " << kField;
  }

  // What a replay computes of a file with the config of the demo.
  void Replay(const fs::path& file) {
    runtime::Progress progress("test", nullptr, false);
    const auto inspection = Inspect({file}, {});
    Chain chain(support::kDemoConfig, inspection.plan, [this](Utime, std::string_view channel, Bytes bytes) {
      if (channel == bus::kGnssFix.name) fixes_.push_back(*bus::Decode<gnss_fix_t>(bytes));
      if (channel == bus::kPose.name) poses_.push_back(*bus::Decode<pose_t>(bytes));
      if (channel == bus::kLidarClock.name) clocks_.push_back(*bus::Decode<lidar_clock_t>(bytes));
    });
    const auto summary = Feed({file}, inspection, chain, progress);
    Finish(summary, inspection, chain);
    refused_ = {summary.refused.begin(), summary.refused.end()};
    for (const auto& [name, count] : chain.Counters()) counters_[name] = count;
  }

  // Of a boat that begins its way at that time.
  void ExpectTheBoat(std::int64_t begin_us, int num_fixes) const {
    int num_with_place = 0;
    for (const auto& fix : fixes_) num_with_place += std::isnan(fix.latitude_deg) ? 0 : 1;
    EXPECT_EQ(num_with_place, num_fixes);
    int num_poses = 0;
    for (const auto& pose : poses_) {
      EXPECT_GE(pose.utime_us, begin_us);
      EXPECT_LE(pose.utime_us, begin_us + 30'000'000);
      if (pose.status != pose_t::STATUS_OK) continue;
      ++num_poses;
      const double east_m = kSpeedMps * 1e-6 * static_cast<double>(pose.utime_us - begin_us);
      const double north_off_m = (pose.latitude_deg - kLatitudeDeg) * kMetresPerDegree;
      const double east_off_m = (pose.longitude_deg - kLongitudeDeg) * kMetresPerDegree * std::cos(DegToRad(kLatitudeDeg)) - east_m;
      EXPECT_LT(std::hypot(north_off_m, east_off_m), 5.0) << pose.utime_us;
    }
    EXPECT_GT(num_poses, 500);
  }

  const fs::path kField = support::kRecordings / "field";
  support::TempDir folder_;
  std::vector<gnss_fix_t> fixes_;
  std::vector<pose_t> poses_;
  std::vector<lidar_clock_t> clocks_;
  std::map<std::string, std::int64_t> refused_;
  std::map<std::string, std::int64_t> counters_;
};

// The seconds of pcap have 32 bits and no sign: POSE of 2039 had a time in 1902.
TEST_F(FieldCapture, OfTheYear2039IsOfThatYear) {
  Replay(kField / "host_2039.pcap");
  constexpr std::int64_t k2039Us = 2'177'488'800'000'000;  // 2039-01-01 10:00:00 UTC
  ExpectTheBoat(k2039Us, 20);
}

// libpcap refuses what describes a second interface of another link type, also where that has no packet.
TEST_F(FieldCapture, OfTwoLinkTypesIsReadByItsInterfaces) {
  for (const char* file : {"ng_two_linktypes.pcapng", "ng_two_linktypes_used.pcapng"}) {
    SCOPED_TRACE(file);
    fixes_.clear();
    poses_.clear();
    Replay(kField / file);
    ExpectTheBoat(kBeginUs, 20);
    EXPECT_TRUE(refused_.empty());
  }
}

TEST_F(FieldCapture, PackedByGzipIsReadAsWhatItHolds) {
  Replay(kField / "packed.pcap.gz");
  EXPECT_GE(fixes_.size(), 20U);
  EXPECT_TRUE(refused_.empty());
  EXPECT_EQ(fixes_.front().utime_us, kBeginUs);
}

// A real VLP-16 writes the IP length of a data packet into its position packets: they were refused, and its clock was never locked.
TEST_F(FieldCapture, WithTheIpLengthOfADataPacketInPositionPacketsLocksTheClock) {
  const auto file = folder_ / "position.pcap";
  {
    data::XzFile packed(kField / "position_ip_length.pcap.xz", 64UL * 1024 * 1024);
    std::vector<std::uint8_t> bytes(64UL * 1024);
    std::ofstream out(file, std::ios::binary);
    while (const auto size = packed.Read(bytes)) out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(size));
  }
  Replay(file);
  EXPECT_TRUE(refused_.empty());
  EXPECT_EQ(counters_["lidar.position_packets_whole"], 4);
  ASSERT_FALSE(clocks_.empty());
  EXPECT_EQ(clocks_.back().pps, 2);
  ASSERT_FALSE(fixes_.empty());
  EXPECT_EQ(fixes_.front().source, "lidar");
  EXPECT_NEAR(fixes_.front().latitude_deg, kLatitudeDeg, 1e-6);
}

// repair and slice promised the same bytes of a sound log, and numbered its events anew.
TEST_F(FieldCapture, LogWithEventNumbersOfItsOwnIsCopiedByteForByte) {
  for (const char* name : {"number_restarts.lcmlog", "numbers_all_0.lcmlog"}) {
    SCOPED_TRACE(name);
    std::ostringstream out;
    std::ostringstream errors;
    const auto copy = folder_ / "copy";
    log::Repair(kField / name, copy, true, out, errors);
    EXPECT_EQ(support::ReadFile(copy), support::ReadFile(kField / name));
    log::SliceRequest request;
    request.inputs = {kField / name};
    request.output = copy;
    request.force = true;
    log::Slice(request, out, errors);
    EXPECT_EQ(support::ReadFile(copy), support::ReadFile(kField / name));
    log::Info({kField / name}, out);
    EXPECT_NE(out.str().find("damage    none"), std::string::npos) << out.str();
    EXPECT_NE(out.str().find("events    50"), std::string::npos) << out.str();
  }
}

}  // namespace
}  // namespace lookout::replay
