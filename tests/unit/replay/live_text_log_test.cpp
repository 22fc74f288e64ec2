// A text log that the navigator plays, at whatever speed, and its replay.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

#include "services/navigator/io/text_log_player.hpp"
#include "services/navigator/service.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/navigator/nmea_text.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/input.hpp"

namespace lookout::replay {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Messages = std::map<std::string, std::vector<std::vector<std::uint8_t>>, std::less<>>;

class LiveTextLog : public ::testing::Test {
 protected:
  Messages Replay() const {
    Messages messages;
    runtime::Progress progress("test", stderr, false);
    const auto inspection = Inspect({file_}, {});
    Chain chain(config_, inspection.plan, [&messages](Utime, std::string_view channel, Bytes bytes) {
      messages[std::string(channel)].emplace_back(bytes.begin(), bytes.end());
    });
    const auto summary = Feed({file_}, inspection, chain, progress);
    Finish(summary, inspection, chain);
    return messages;
  }

  // As main runs it, but for the clock, which goes by 7 to 13 ms a round.
  Messages Play(double speed) const {
    Messages messages;
    bus::MemoryBus bus;
    bus.SubscribeAll([&messages](std::string_view channel, Bytes bytes) { messages[std::string(channel)].emplace_back(bytes.begin(), bytes.end()); });
    auto params = navigator::LoadParams(config_);
    params.use_lidar_nmea = false;
    navigator::Service service(bus, params);
    navigator::TextLogPlayer player({{navigator::kUdpSource, file_, {}}}, speed);
    auto now = std::chrono::steady_clock::time_point(1000h);
    for (int round = 0; !player.is_finished(); ++round) {
      player.Play(now, {[&service](Utime time) { service.AdvanceTo(time); },
                        [&service](Utime time, Bytes line, const std::string& name) { service.OnDatagram(time, line, name); }});
      support::HandleAll(bus);
      now += 7ms + std::chrono::milliseconds(round % 7);
    }
    EXPECT_EQ(service.Report().reason.find("off UTC"), std::string::npos) << service.Report().reason;
    service.Finish(player.time());
    support::HandleAll(bus);
    return messages;
  }

  support::TempDir folder_;
  const fs::path file_ = folder_ / "log";
  const fs::path config_ = support::kDemoConfig;
};

// Sentences stand in captures and in logs too.
TEST_F(LiveTextLog, IsNotWhatBeginsAsACaptureOrHoldsAnEventOfLcm) {
  const auto sentence = navigator::HdtLine(1.0) + "\r\n";
  const auto kind_of = [this](const std::string& text) {
    std::ofstream(file_, std::ios::binary) << text;
    return KindOf(file_);
  };
  EXPECT_EQ(kind_of(sentence), InputKind::kTextLog);
  EXPECT_EQ(kind_of("\xD4\xC3\xB2\xA1" + sentence), InputKind::kCapture);
  EXPECT_EQ(kind_of("\x0A\x0D\x0D\x0A" + sentence), InputKind::kCapture);
  EXPECT_EQ(kind_of("\xED\xA1\xDA\x01" + sentence), InputKind::kLog);
  EXPECT_EQ(kind_of("no sentence"), InputKind::kCapture) << "libpcap says what it is not";
}

// A boat at 10 m/s: at ten times the speed its poses were up to 178 m off, with the stamps of the computer's clock.
TEST_F(LiveTextLog, GivesTheMessagesOfItsReplayAtAnySpeed) {
  {
    std::ofstream log(file_);
    for (int tenth = 0; tenth < 300; ++tenth) {
      // A silence in which no ticks come, one in which they do, and a sentence without a time.
      const double at_s = tenth < 100 ? tenth * 0.1 : tenth < 200 ? tenth * 0.1 + 20.0 : tenth * 0.1 + 24.5;
      if (tenth % 2 == 0) log << navigator::RmcLine(navigator::NoonPlus(at_s), 50.0 + at_s * 9e-5, 8.0, 10.0, 0.0) << "\r\n";
      log << navigator::HdtLine(1.0 + 0.01 * tenth) << "\n";
    }
  }
  const auto replayed = Replay();
  ASSERT_GT(replayed.at("POSE").size(), 1000U);
  for (const double speed : {0.1, 1.0, 10.0, 137.0, 0.0}) {
    SCOPED_TRACE(speed);
    const auto played = Play(speed);
    for (const char* channel : {"NAV_RAW", "GNSS_FIX", "ATTITUDE", "POSE"}) {
      EXPECT_TRUE(played.at(channel) == replayed.at(channel)) << channel << ": " << played.at(channel).size() << " " << replayed.at(channel).size();
    }
  }
}

}  // namespace
}  // namespace lookout::replay
