#include "common/runtime/notify.hpp"

#include <algorithm>
#include <string>
#include <systemd/sd-daemon.h>

namespace lookout::runtime {

namespace {

// Each call opens the socket anew; a message that nobody reads is no reason to end a look-out.
void NotifySupervisor(const std::string& message) { sd_notify(0, message.c_str()); }

std::string HealthStateName(std::int32_t state) {
  switch (state) {
    case health_t::STATE_OK:
      return "ok";
    case health_t::STATE_DEGRADED:
      return "degraded";
    case health_t::STATE_FAILED:
      return "failed";
    case health_t::STATE_STARTING:
      return "starting";
    default:
      return "unknown";
  }
}

}  // namespace

void NotifyReady() { NotifySupervisor("READY=1\nSTATUS=started"); }

void NotifyAlive(const health_t& health) {
  std::string reason = health.reason;
  std::ranges::replace(reason, '\n', ' ');  // a line is an assignment of its own
  NotifySupervisor("WATCHDOG=1\nSTATUS=" + HealthStateName(health.state) + (reason.empty() ? "" : ": ") + reason);
}

}  // namespace lookout::runtime
