// lookout-doctor in a network namespace of its own, with the simulator and the processes live; and where nothing is.
#include <chrono>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/services.hpp"
#include "lookout/obstacles_t.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/support/live_test.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

class Doctor : public LiveTest {
 protected:
  RunResult Ask() const { return RunProgram({Bin("doctor"), "--config", Config(), "--seconds", "2"}, Output("doctor")); }

  // All but the disk's: how much room this computer has is no matter of the test.
  static void ExpectNoFault(const RunResult& result) {
    std::istringstream lines(result.output);
    for (std::string line; std::getline(lines, line);) EXPECT_TRUE(line.rfind("fault ", 0) != 0 || line.find(" disk ") != std::string::npos) << line;
    EXPECT_LE(result.exit_code, 1) << result.output;
    EXPECT_EQ(result.exit_code, Has(result, "\n0 faults") ? 0 : 1) << result.output;
  }
  // Wrapped lines count as one.
  static bool Has(const RunResult& result, const std::string& text) {
    static const std::regex kWrap("\n {20}");
    return std::regex_replace(result.output, kWrap, " ").find(text) != std::string::npos;
  }
};

bool IsRouteThere() { return bus::HasRoute(*bus::ParseMulticast(bus::DefaultLcmUrl())); }

TEST_F(Doctor, SeesASimulatedBoatByItselfAndThroughItsProcesses) {
  if (!IsRouteThere()) GTEST_SKIP() << "for the namespace with a route";
  Start("sim", {"--scene", "lake", "--seed", "3", "--seconds", "60", "--udp", "127.0.0.1"});
  const auto by_itself = Ask();
  ExpectNoFault(by_itself);
  for (const auto& text :
       {"ok       lidar      VLP-16, strongest return", "600 rpm", "datagrams from 127.0.0.1 to port 2368; this computer is 127.0.0.1 on lo",
        "ok       clock      the lidar is locked to PPS", "ok       gnss       RTK, fixed", "ok       heading", "ok       attitude",
        "ok       mounting   the lidar looks forward", "warning  process    none of Lookout's processes is heard"}) {
    EXPECT_TRUE(Has(by_itself, text)) << text << " is missing in\n" << by_itself.output;
  }

  bus::LcmBus lcm(bus::DefaultLcmUrl());
  int num_placed = 0;
  bus::Subscribe<obstacles_t>(lcm, bus::kObstacles, [&](const obstacles_t& message) {
    if (message.num_obstacles > 0 && message.obstacles[0].status == obstacle_t::STATUS_OK) ++num_placed;
  });
  lcm.HandleOnce(milliseconds(0));  // joins LCM's group
  for (const auto& service : bus::StartOrder()) Start(service);
  ASSERT_TRUE(HandleUntil(lcm, [&] { return num_placed >= 3; }));
  const auto through_processes = Ask();
  ExpectNoFault(through_processes);
  for (const auto& text :
       {" lidar      VLP-16, strongest return", "clock      the lidar is locked to PPS", "ok       gnss       RTK, fixed", "ok       heading",
        "(heard on the bus)", "process    lidar (pid ", "process    segmenter (pid ", "process    navigator (pid ", "process    georeferencer (pid ",
        "process    tracker (pid ", "process    recorder (pid ", " obstacles  ", " look-out   "}) {
    EXPECT_TRUE(Has(through_processes, text)) << text << " is missing in\n" << through_processes.output;
  }

  children_["segmenter"]->Signal(SIGKILL);
  children_["segmenter"]->Wait(seconds(5));
  const auto without = Ask();
  EXPECT_EQ(without.exit_code, 1);
  EXPECT_TRUE(Has(without, "fault    process    segmenter is not heard, others are")) << without.output;
  EXPECT_TRUE(Has(without, "fault    obstacles  the lidar runs, but no OBSTACLES come")) << without.output;
}

TEST_F(Doctor, SaysWhatIsMissingWhereNothingIs) {
  if (IsRouteThere()) GTEST_SKIP() << "for the namespace without a route";
  std::ofstream(folder_ / "config/recorder.txtpb") << "max_file_s: 0\n";
  const auto result = Ask();
  EXPECT_EQ(result.exit_code, 1);
  for (const auto& text :
       {"config/recorder.txtpb:1: max_file_s: must be at least 1", "fault    route", "ip route add 239.255.76.0/24 dev lo",
        "fault    lidar      no lidar packets", "no interface but loopback", "fault    gnss       no sentence came", "fault    process"}) {
    EXPECT_TRUE(Has(result, text)) << text << " is missing in\n" << result.output;
  }
  EXPECT_FALSE(fs::exists(folder_ / "logs")) << "it looks, and makes nothing";
}

}  // namespace
}  // namespace lookout::system_test
