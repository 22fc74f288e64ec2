#include "lab/sim/lidar_clock.hpp"

#include <algorithm>
#include <cmath>

#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::sim {
namespace {

using std::chrono::microseconds;
namespace format = vlp16::format;
using namespace std::chrono_literals;

microseconds ToMicroseconds(double seconds) { return microseconds(std::llround(seconds * 1e6)); }

// Time that a free-running clock gains in `duration`.
microseconds Gain(microseconds duration, double drift_ppm) {
  return microseconds(std::llround(static_cast<double>(duration.count()) * drift_ppm * 1e-6));
}

}  // namespace

bool LidarClock::IsOn(Utime time) const { return plan_.At(TimedFaultKind::kSensorRestart, time) == nullptr; }

// When a lidar that has been restarted has the time: its own while after the restart, or when the PPS has been back for a while, whichever is later.
Utime LidarClock::LockAfter(const TimedFault& restart) const {
  Utime lock = plan_.End(restart) + ToMicroseconds(restart.value);
  // By begin, so a loss that this one puts off is found as well.
  for (const auto& fault : plan_.faults()) {
    if (fault.kind != TimedFaultKind::kPpsLoss || plan_.Begin(fault) >= lock || plan_.End(fault) <= plan_.End(restart)) continue;
    lock = std::max(lock, plan_.End(fault) + kAcquiring);
  }
  return lock;
}

// The last restart that is over, while its clock is still its own.
const TimedFault* LidarClock::RestartBefore(Utime time) const {
  const auto* restart = plan_.LastBegun(TimedFaultKind::kSensorRestart, time);
  return restart != nullptr && time < LockAfter(*restart) ? restart : nullptr;
}

std::uint32_t LidarClock::StampUs(Utime time) const {
  microseconds clock = time.time_since_epoch();
  if (const auto* restart = RestartBefore(time)) {
    clock = time - plan_.End(*restart);
  } else {
    const auto* loss = plan_.LastBegun(TimedFaultKind::kPpsLoss, time);
    if (loss != nullptr && time < plan_.End(*loss) + kAcquiring) clock += Gain(time - plan_.Begin(*loss), loss->value);
    if (const auto* run = plan_.At(TimedFaultKind::kFreeRun, time)) clock += Gain(time - plan_.Begin(*run), run->value);
    clock += ToMicroseconds(plan_.ValueAt(TimedFaultKind::kWrongStamp, time));
  }
  const std::int64_t rest_us = clock.count() % format::kMicrosecondsPerHour;
  return static_cast<std::uint32_t>(rest_us < 0 ? rest_us + format::kMicrosecondsPerHour : rest_us);
}

std::uint8_t LidarClock::Pps(Utime time) const {
  if (const auto* restart = RestartBefore(time)) {
    return time < LockAfter(*restart) - kAcquiring ? format::kPpsAbsent : format::kPpsSynchronising;
  }
  const auto* loss = plan_.LastBegun(TimedFaultKind::kPpsLoss, time);
  if (loss == nullptr || time < plan_.Begin(*loss) + kPpsNoticed || time >= plan_.End(*loss) + kAcquiring) return format::kPpsLocked;
  return time < plan_.End(*loss) ? format::kPpsAbsent : format::kPpsSynchronising;
}

std::optional<Utime> LidarClock::SecondOfRmc(Utime time) const {
  const auto* restart = plan_.LastBegun(TimedFaultKind::kSensorRestart, time);
  const Utime last = std::chrono::floor<std::chrono::seconds>(time - kLidarRmcLatency);
  for (Utime second = last; second >= last - kOldestRmc; second -= 1s) {
    const Utime arrival = second + kLidarRmcLatency + ToMicroseconds(plan_.ValueAt(TimedFaultKind::kLateRmc, second));
    if (arrival > time) continue;
    if (restart != nullptr && arrival < plan_.End(*restart)) return std::nullopt;
    return second;
  }
  return std::nullopt;
}

std::chrono::hours LidarClock::RmcError(Utime second) const {
  return std::chrono::hours(std::lround(plan_.ValueAt(TimedFaultKind::kWrongHour, second)));
}

}  // namespace lookout::sim
