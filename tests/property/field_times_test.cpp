// Inputs of a field trial whose places or times cannot be right, end to end: through the services of a replay, against the boat that they were made
// of.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/geodesy.hpp"
#include "common/runtime/progress.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/pose_t.hpp"
#include "tests/support/files.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/input.hpp"

namespace lookout {
namespace {

using std::chrono::sys_days;

// The boat of all of them: from here east at 2 m/s.
constexpr GeodeticPlace kStart{54.5, 10.2, 0.0};
constexpr double kSpeedMps = 2.0;
constexpr Utime kTime = sys_days(std::chrono::year(2026) / 8 / 29) + std::chrono::hours(10);

struct Outcome {
  std::vector<pose_t> poses;
  int num_fixes = 0;   // GNSS_FIX
  int num_places = 0;  // of these with a place
  int num_starts = 0;  // start marks
  std::map<std::string, std::int64_t> counters;

  int Count(std::int32_t status, double from_s = 0.0, double to_s = 1e9) const {
    return static_cast<int>(std::ranges::count_if(poses, [&](const pose_t& pose) {
      const double time_s = SecondsOf(pose);
      return pose.status == status && time_s >= from_s && time_s < to_s;
    }));
  }
  static double SecondsOf(const pose_t& pose) { return 1e-6 * static_cast<double>(pose.utime_us - ToUtimeUs(kTime)); }
  // From the boat, wherever POSE has a place.
  double WorstM() const {
    const LocalFrame map(kStart);
    double worst_m = 0.0;
    for (const auto& pose : poses) {
      if (std::isnan(pose.latitude_deg)) continue;
      const auto p_map_m = map.Forward({pose.latitude_deg, pose.longitude_deg, 0.0});
      worst_m = std::max(worst_m, std::hypot(p_map_m.x() - kSpeedMps * SecondsOf(pose), p_map_m.y()));
    }
    return worst_m;
  }
};

class FieldTimes : public ::testing::Test {
 protected:
  // @return false: the file is not at hand, and the test is skipped
  bool Replay(const std::string& name) {
    const auto file = support::kRecordings / "field" / name;
    if (!std::filesystem::exists(file)) return false;
    const auto inspection = replay::Inspect({file}, {});
    replay::Chain chain(support::kCatabotConfig, inspection.plan, [this](Utime, std::string_view channel, Bytes bytes) { Take(channel, bytes); });
    runtime::Progress progress("test", nullptr);
    replay::Finish(replay::Feed({file}, inspection, chain, progress), inspection, chain);
    for (const auto& [counter, count] : chain.Counters()) outcome_.counters[counter] = count;
    return true;
  }

  void Take(std::string_view channel, Bytes bytes) {
    if (channel == bus::kPose.name) outcome_.poses.push_back(bus::Decode<pose_t>(bytes).value());
    if (channel == bus::kNavRaw.name) outcome_.num_starts += bus::Decode<nav_raw_t>(bytes).value().kind == nav_raw_t::KIND_START ? 1 : 0;
    if (channel != bus::kGnssFix.name) return;
    ++outcome_.num_fixes;
    outcome_.num_places += std::isnan(bus::Decode<gnss_fix_t>(bytes).value().latitude_deg) ? 0 : 1;
  }

  std::int64_t Counter(const std::string& name) { return outcome_.counters["navigator." + name]; }

  Outcome outcome_;
};

#define LOOKOUT_REPLAY_OR_SKIP(name) \
  if (!Replay(name)) GTEST_SKIP() << support::kRecordings / "field" / (name) << " is not at hand"

// POSE was ok at 0 N 0 E, which became the datum of the run.
TEST_F(FieldTimes, NoFixAtZeroZeroAtTheStart) {
  LOOKOUT_REPLAY_OR_SKIP("null_at_start.pcap");
  EXPECT_EQ(Counter("null_fix"), 5);
  EXPECT_EQ(outcome_.num_places, 25);
  EXPECT_EQ(outcome_.Count(pose_t::STATUS_OK, 0.0, 5.2), 0);
  EXPECT_GT(outcome_.Count(pose_t::STATUS_OK, 5.2), 1150);
  EXPECT_LT(outcome_.WorstM(), 5.0);
  EXPECT_NEAR(outcome_.poses.back().datum_latitude_deg, kStart.latitude_deg, 1e-3);
}

TEST_F(FieldTimes, NoFixAtZeroZeroInGga) {
  LOOKOUT_REPLAY_OR_SKIP("null_gga.nmea");
  EXPECT_EQ(Counter("null_fix"), 6);
  EXPECT_EQ(outcome_.num_places, 14);
  EXPECT_EQ(outcome_.Count(pose_t::STATUS_OK, 0.0, 6.0), 0);
  EXPECT_LT(outcome_.WorstM(), 5.0);
  EXPECT_NEAR(outcome_.poses.back().datum_latitude_deg, kStart.latitude_deg, 1e-3);
}

TEST_F(FieldTimes, NoFixAtZeroZeroInBetween) {
  LOOKOUT_REPLAY_OR_SKIP("null_in_between.pcap");
  EXPECT_EQ(Counter("null_fix"), 9);
  EXPECT_LT(outcome_.WorstM(), 5.0);
  EXPECT_GT(outcome_.Count(pose_t::STATUS_COASTING), 0);
  EXPECT_GT(outcome_.Count(pose_t::STATUS_NO_POSITION), 0);
  EXPECT_EQ(outcome_.poses.back().status, pose_t::STATUS_OK);
}

// POSE was lost for 70 % of the run.
TEST_F(FieldTimes, UtcEveryTenSeconds) {
  LOOKOUT_REPLAY_OR_SKIP("utc_every_10s.pcap");
  EXPECT_EQ(outcome_.num_places, 40);
  EXPECT_EQ(Counter("late_fix"), 0);
  EXPECT_EQ(outcome_.Count(pose_t::STATUS_NO_POSITION, 0.22), 0);
  EXPECT_GT(outcome_.Count(pose_t::STATUS_OK), 1800);
  EXPECT_LT(outcome_.WorstM(), 12.0);
}

// 19 START marks, and no POSE that was ok.
TEST_F(FieldTimes, GllInLocalTime) {
  LOOKOUT_REPLAY_OR_SKIP("gll_local_time.nmea");
  EXPECT_EQ(outcome_.num_starts, 1);
  EXPECT_EQ(Counter("local_time"), 20);
  EXPECT_EQ(Counter("time_backwards"), 0);
  EXPECT_GE(outcome_.Count(pose_t::STATUS_OK), 940);
  EXPECT_LT(outcome_.WorstM(), 5.0);
}

// All behind it were a day late.
TEST_F(FieldTimes, OneWrongDate) {
  LOOKOUT_REPLAY_OR_SKIP("date_one_wrong.nmea");
  EXPECT_EQ(outcome_.num_starts, 1);
  EXPECT_EQ(Counter("date_unusable"), 1);
  EXPECT_EQ(outcome_.num_places, 30);
  EXPECT_GE(outcome_.Count(pose_t::STATUS_OK), 1440);
  EXPECT_LT(outcome_.WorstM(), 5.0);
}

}  // namespace
}  // namespace lookout
