// The alarm of lookout-georeferencer on a live bus: told at once, not with the next second; and that nobody looks.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "lookout/health_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;
namespace messages = georeferencer::test;

class Alarm : public ::testing::Test {
 protected:
  Alarm() : bus_(bus::DefaultLcmUrl()) {
    bus_.SubscribeRaw(bus::kHealth, [this](std::string_view, Bytes bytes) { reports_.push_back(bus::Decode<health_t>(bytes).value()); });
  }

  // Sends a scan every 100 ms where asked to, until a report is so.
  template <typename Condition>
  bool Until(const Condition& is_so, bool has_scans, bool has_obstacle = false) {
    const auto deadline = Clock::now() + seconds(30);
    auto next_scan = Clock::now();
    while (Clock::now() < deadline) {
      if (has_scans && Clock::now() >= next_scan) {
        next_scan += milliseconds(100);
        const std::int64_t offset_us = 100'000 * seq_;
        bus::Publish(bus_, bus::kSegments,
                     messages::MakeSegmentsMessage(
                         offset_us, seq_++, has_obstacle ? std::vector{messages::MakeSegmentMessage(1, offset_us)} : std::vector<segment_t>{}));
      }
      const auto num_before = reports_.size();
      bus_.HandleOnce(milliseconds(10));
      if (reports_.size() > num_before && is_so(reports_.back())) return true;
    }
    return false;
  }

  static bool Says(const health_t& report, const std::string& piece) { return report.reason.find(piece) != std::string::npos; }

  // Regular reports are a second apart, late rather than early; what tells of an interval in one between is repeated.
  bool IsLastBetween() const {
    return reports_.size() == 1 ? reports_[0].num_channels == 0 : reports_.back().interval_s == reports_[reports_.size() - 2].interval_s;
  }

  bus::LcmBus bus_;
  std::vector<health_t> reports_;
  std::int64_t seq_ = 0;
};

TEST_F(Alarm, IsToldWhenItComesAndNotWithTheNextSecond) {
  // The demo's guard zone, 10 m ahead, and an obstacle 10 m ahead of a lidar that stands 0.5 m forward: a larger zone.
  const TempDir temp_dir;
  const auto folder = temp_dir / "config";
  std::filesystem::copy(kDemoConfig, folder);
  ReplaceIn(folder / "georeferencer.txtpb", "range_m: 10", "range_m: 15");
  Child child({Bin("georeferencer"), "--config", folder.string()}, (temp_dir / "out").string());
  ASSERT_TRUE(Until([](const health_t&) { return true; }, false)) << child.Output();
  EXPECT_EQ(reports_.back().state, health_t::STATE_STARTING);
  EXPECT_EQ(reports_.back().reason, "guard zone not watched: no whole scan yet");
  int num_between = IsLastBetween() ? 1 : 0;
  ASSERT_TRUE(Until([](const health_t& report) { return !Says(report, "guard zone not watched"); }, true));
  num_between += IsLastBetween() ? 1 : 0;
  ASSERT_TRUE(Until([](const health_t& report) { return Says(report, "obstacle within 15.0 m: "); }, true, true));
  num_between += IsLastBetween() ? 1 : 0;
  ASSERT_TRUE(Until([](const health_t& report) { return Says(report, "guard zone not watched: no whole scan for "); }, false));
  num_between += IsLastBetween() ? 1 : 0;
  EXPECT_TRUE(Says(reports_.back(), "obstacle within 15.0 m: ")) << "an alarm that stands does not end because nobody looks";
  // On a busy computer a change may fall into the very round of the loop that reports anyway.
  EXPECT_GE(num_between, 2) << "of four changes";
  EXPECT_EQ(child.Terminate(), 0);
}

}  // namespace
}  // namespace lookout::system_test
