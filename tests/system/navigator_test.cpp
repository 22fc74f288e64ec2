// lookout-navigator on a live bus with an autopilot at a serial port, and its heading by UDP: poses, and the same from the log again.
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "lookout/health_t.hpp"
#include "lookout/pose_t.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/support/live_test.hpp"
#include "tests/support/pseudo_terminal.hpp"
#include "tests/support/socket.hpp"
#include "tests/unit/navigator/mavlink_frames.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
using std::chrono::seconds;

constexpr int kPilotPort = 14551;

class AutopilotSource : public LiveTest {
 protected:
  AutopilotSource() {
    std::ofstream(folder_ / "config/navigator.txtpb")
        << "source: LIVE use_lidar_nmea: false heading_offset_deg: 0 pitch_offset_deg: 0 roll_offset_deg: 0\n"
        << "input { name: 'pilot' protocol: MAVLINK serial { device: '" << terminal_.device << "' baud: 115200 } role: GNSS }\n"
        << "input { name: 'angles' protocol: MAVLINK udp { bind_address: '127.0.0.1' port: " << kPilotPort << " } role: ATTITUDE }\n";
    bus::Subscribe<health_t>(bus_, bus::kHealth, [this](const health_t& message) {
      if (message.process == "navigator") health_ = message;
      is_recorded_ = is_recorded_ || message.process == "recorder";
    });
    bus::Subscribe<pose_t>(bus_, bus::kPose, [this](const pose_t& message) { pose_ = message; });
  }

  // What the autopilot sends in 100 ms: northward at 2 m/s, heading 0.5 rad, and a message of another system.
  void Send() {
    boot_ms_ += 100;
    const double way_deg = 2.0 * boot_ms_ / 1000.0 / 111'200.0;
    auto bytes = navigator::PositionFrame(boot_ms_, 54.0 + way_deg, 10.0, 2.0, 0.0, 1000) + navigator::golden::kAttitudeOfSystem42;
    if (boot_ms_ % 500 == 0) bytes += navigator::GpsFrame(has_fix_ ? 3 : 1, 900) + AutopilotHeartbeat();
    // As a serial port gives them: in pieces.
    terminal_.Write(bytes.substr(0, 17));
    terminal_.Write(bytes.substr(17));
    const auto attitude = navigator::AttitudeFrame(boot_ms_, 0.1F, -0.05F, 0.5F);
    EXPECT_TRUE(socket_.SendTo(Ipv4("127.0.0.1", kPilotPort), {reinterpret_cast<const std::uint8_t*>(attitude.data()), attitude.size()}));
  }
  template <typename Condition>
  bool Until(const Condition& is_so) {
    return SendUntil(
        bus_, is_so, [this] { Send(); }, seconds(30));
  }

  PseudoTerminal terminal_;
  Socket socket_{SOCK_DGRAM};
  bus::LcmBus bus_{bus::DefaultLcmUrl()};
  health_t health_{};
  pose_t pose_{};
  bool is_recorded_ = false;
  std::uint32_t boot_ms_ = 1000;
  bool has_fix_ = true;
};

TEST_F(AutopilotSource, GivesPosesThatItsLogGivesAgainAndHearsNothing) {
  Start("recorder");
  ASSERT_TRUE(HandleUntil(bus_, [this] { return is_recorded_; })) << children_["recorder"]->Output();
  Start("navigator");
  ASSERT_TRUE(HandleUntil(bus_, [this] { return CountOf(health_, "pilot_opened") == 1; })) << children_["navigator"]->Output();
  ASSERT_TRUE(Until([this] { return pose_.status == pose_t::STATUS_OK && CountOf(health_, "mavlink_other_sender") > 10; })) << health_.reason;
  EXPECT_EQ(pose_.heading_source, pose_t::HEADING_PASHR);
  EXPECT_NEAR(pose_.heading_rad, 0.5, 0.05);
  EXPECT_NEAR(pose_.roll_rad, 0.1, 0.02);
  EXPECT_NEAR(pose_.pitch_rad, -0.05, 0.02);
  EXPECT_NEAR(pose_.velocity_map_mps[1], 2.0, 0.3);
  // Its receiver loses the fix, and it goes on by itself.
  has_fix_ = false;
  ASSERT_TRUE(Until([this] { return pose_.status == pose_t::STATUS_NO_POSITION; })) << health_.reason;
  EXPECT_EQ(terminal_.Read(), "") << "nothing is sent to an autopilot";
  EXPECT_EQ(children_["navigator"]->Terminate().value_or(-1), 0) << children_["navigator"]->Output();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(children_["recorder"]->Terminate().value_or(-1), 0) << children_["recorder"]->Output();
  const auto log = FirstLogIn(folder_ / "logs");
  const auto replay = RunProgram({Bin("replay"), "--config", Config(), "--in", log.string(), "--out", (folder_ / "again").string()},
                                 (folder_ / "replay.out").string());
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  const auto live = ReadLog(log);
  const auto again = ReadLog(folder_ / "again");
  for (const char* channel : {"GNSS_FIX", "ATTITUDE", "POSE"}) {
    ASSERT_TRUE(live.contains(channel) && again.contains(channel)) << channel;
    EXPECT_TRUE(live.at(channel) == again.at(channel)) << channel << ": " << live.at(channel).size() << ", " << again.at(channel).size();
  }
}

}  // namespace
}  // namespace lookout::system_test
