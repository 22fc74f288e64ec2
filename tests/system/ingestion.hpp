// A live lookout-lidar with what it says of itself, and a lidar that keeps its deadlines: what the tests and the load of ingestion share.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/core/utime.hpp"
#include "lookout/health_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"
#include "tests/support/socket.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::system_test {

using support::Child;
using support::RunProgram;
using support::RunResult;

/// lookout-lidar with the config of the simulated boat, on loopback.
class LiveVlp16 {
 public:
  /// @param folder  for its config and what it prints; made here
  explicit LiveVlp16(const std::filesystem::path& folder) : config_folder_(folder / "config"), bus_(bus::DefaultLcmUrl()) {
    std::filesystem::create_directories(folder);
    std::filesystem::copy(support::kDemoConfig, config_folder_);
    bus::Subscribe<health_t>(bus_, bus::kHealth, [this](const health_t& message) {
      if (message.process == "lidar") health_ = message;
    });
    process_.emplace(std::vector<std::string>{support::Bin("lidar"), "--config", config_folder_.string()}, (folder / "lidar.out").string());
  }

  const std::filesystem::path& config_folder() const { return config_folder_; }
  Child& process() { return *process_; }

  /// Takes the reports that wait: a queue that nobody empties loses the last ones.
  void Poll() {
    while (bus_.HandleOnce(std::chrono::milliseconds(0))) continue;
  }

  /// @return the first report that is made from now on; nullopt after 10 s without one
  std::optional<health_t> NextHealth() {
    const auto since = HostUtimeUs();
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::chrono::steady_clock::now() < deadline) {
      bus_.HandleOnce(std::chrono::milliseconds(50));
      if (health_ && health_->utime_us >= since) return health_;
    }
    return std::nullopt;
  }

  /// The counters once all that was sent has been consumed: a bundle waits for 100 ms.
  std::optional<health_t> HealthAtRest() {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    return NextHealth();
  }

 private:
  static std::int64_t HostUtimeUs() { return ToUtimeUs(std::chrono::time_point_cast<std::chrono::microseconds>(std::chrono::system_clock::now())); }

  std::filesystem::path config_folder_;
  bus::LcmBus bus_;
  std::optional<health_t> health_;
  std::optional<Child> process_;
};

/// What the counters of a lookout-lidar must be when so many different packets came, each once and in order.
inline std::vector<std::pair<std::string_view, std::int64_t>> CountersOfACleanRun(std::int64_t num_sent) {
  return {{"data_packets_whole", num_sent},
          {"data_lost", 0},
          {"data_duplicate", 0},
          {"data_reordered", 0},
          {"data_late", 0},
          {"data_overlapping", 0},
          {"data_azimuth_disagrees", 0},
          {"data_kernel_drops", 0},
          {"sensor_restarts", 0},
          {"sensor_clock_steps", 0},
          {"datagrams_other_port", 0}};
}

struct SendResult {
  std::int64_t num_sent = 0;
  std::int64_t num_refused = 0;        // by the network
  std::chrono::nanoseconds latest{0};  // behind its deadline
};

/// Sends a lidar's data packets to loopback, so many a second; each has a deadline of its own, so delays do not add up. The sensor's stamps
/// advance by a packet period each, whatever the rate.
///
/// @param poll  called after each thousandth packet
inline SendResult SendDataPackets(double packets_per_s, double seconds, const std::function<void()>& poll) {
  constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
  const auto address = support::Ipv4("127.0.0.1", vlp16::format::kDataPort);
  const support::Socket sender(SOCK_DGRAM);
  vlp16::test::SpinningSensor sensor;
  SendResult result;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t start_ns = now.tv_sec * kNanosecondsPerSecond + now.tv_nsec;
  const auto num_packets = static_cast<std::int64_t>(packets_per_s * seconds);
  for (std::int64_t i = 0; i < num_packets; ++i) {
    const auto payload = sensor.Next();
    const std::int64_t due_ns = start_ns + static_cast<std::int64_t>(static_cast<double>(i) / packets_per_s * 1e9);
    const timespec due{due_ns / kNanosecondsPerSecond, due_ns % kNanosecondsPerSecond};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) continue;
    clock_gettime(CLOCK_MONOTONIC, &now);
    result.latest = std::max(result.latest, std::chrono::nanoseconds(now.tv_sec * kNanosecondsPerSecond + now.tv_nsec - due_ns));
    ++(sender.SendTo(address, payload) ? result.num_sent : result.num_refused);
    if (i % 1000 == 999) poll();
  }
  return result;
}

}  // namespace lookout::system_test
