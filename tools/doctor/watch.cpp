#include "tools/doctor/watch.hpp"

#include <algorithm>
#include <exception>
#include <optional>
#include <thread>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/core/utime.hpp"
#include "common/runtime/process.hpp"
#include "tools/doctor/notes.hpp"
#include "tools/doctor/own_sources.hpp"

namespace lookout::doctor {

namespace {

using SteadyClock = std::chrono::steady_clock;

// HEALTH comes once a second: who is silent for longer does not run.
constexpr std::chrono::milliseconds kHealthWait(1500);
constexpr std::chrono::milliseconds kPoll(5);

class Watcher {
 public:
  explicit Watcher(Observations& seen) : seen_(seen), notes_(seen, runtime::HostNow) {
    if (seen_.bus.fault.empty()) OpenBus();
  }

  void Run(std::chrono::milliseconds duration) {
    const auto start = SteadyClock::now();
    if (lcm_) TurnUntil(start + kHealthWait);
    notes_.TakeFrom(memory_, Via::kItself);
    OpenOwnSources();
    // Time to see a rate, whenever it began.
    TurnUntil(std::max(start + duration, SteadyClock::now() + duration / 2));
    if (navigator_) navigator_->Finish(seen_.navigation);
    ForgivePortsOfProcesses(seen_);
    seen_.end = runtime::HostNow();
    seen_.watched_s = ToSeconds(SteadyClock::now() - start);
    if (seen_.lidar.via == Via::kBus && seen_.lidar.num_packets > 0) {
      seen_.disk.rate_bytes_per_s = static_cast<double>(notes_.num_log_bytes()) / seen_.watched_s;
    }
    if (const auto* health = HealthOf("vlp16")) seen_.lidar.complaint = health->reason;
    if (const auto* health = HealthOf("navigator")) seen_.navigation.complaint = health->reason;
  }

 private:
  void OpenBus() {
    try {
      lcm_.emplace(seen_.bus.url);
      notes_.TakeFrom(*lcm_, Via::kBus);
      notes_.TakeRest(*lcm_);
      // For a navigator of our own, when the lidar's process runs.
      lcm_->SubscribeRaw(bus::kLidarNmea, [this](std::string_view, Bytes bytes) { memory_.Publish(bus::kLidarNmea, bytes); });
      lcm_->HandleOnce(std::chrono::milliseconds(0));  // joins LCM's group
    } catch (const std::exception& error) {
      seen_.bus.fault = error.what();
      lcm_.reset();
    }
  }

  void OpenOwnSources() {
    const auto& config = seen_.config;
    if (seen_.processes.contains("vlp16")) {
      seen_.lidar.via = Via::kBus;
    } else if (config.lidar &&
               (config.lidar->sources.kind == vlp16::Sources::Kind::kUdp || config.lidar->sources.kind == vlp16::Sources::Kind::kInterface)) {
      seen_.lidar.via = Via::kItself;
      try {
        lidar_.emplace(memory_, *config.lidar);
      } catch (const std::exception& error) {
        seen_.lidar.fault = error.what();
      }
    }
    if (seen_.processes.contains("navigator")) {
      seen_.navigation.via = Via::kBus;
    } else if (config.navigation && config.navigation->input == navigator::Input::kOutside) {
      seen_.navigation.via = Via::kItself;
      navigator_.emplace(memory_, *config.navigation, seen_.navigation);
    }
  }

  void TurnUntil(SteadyClock::time_point end) {
    while (SteadyClock::now() < end) {
      const auto now = runtime::HostNow();
      if (lidar_) lidar_->Poll(now, seen_.lidar);
      if (navigator_) navigator_->Poll(now, seen_.navigation);
      while (memory_.HandleOnce()) {
      }
      if (lcm_) {
        // Waits for one, then takes what came with it.
        if (lcm_->HandleOnce(kPoll)) {
          const auto round_end = std::min(end, SteadyClock::now() + kPoll);
          while (SteadyClock::now() < round_end && lcm_->HandleOnce(std::chrono::milliseconds(0))) {
          }
        }
      } else {
        std::this_thread::sleep_for(kPoll);
      }
    }
  }

  const health_t* HealthOf(const std::string& process) const {
    const auto found = seen_.processes.find(process);
    return found == seen_.processes.end() || found->second.empty() ? nullptr : &found->second.back().last;
  }

  Observations& seen_;
  Notes notes_;
  bus::MemoryBus memory_;
  std::optional<bus::LcmBus> lcm_;
  std::optional<OwnLidar> lidar_;
  std::optional<OwnNavigator> navigator_;
};

}  // namespace

void Watch(Observations& seen, std::chrono::milliseconds duration) { Watcher(seen).Run(duration); }

void ForgivePortsOfProcesses(Observations& seen) {
  if (!seen.lidar.fault.empty() && seen.processes.contains("vlp16")) {
    seen.lidar.fault.clear();
    seen.lidar.via = Via::kBus;
  }
  if (!seen.navigation.input_faults.empty() && seen.processes.contains("navigator")) {
    seen.navigation.input_faults.clear();
    seen.navigation.via = Via::kBus;
  }
}

}  // namespace lookout::doctor
