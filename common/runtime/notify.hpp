// Tells systemd how this process fares. Where no supervisor listens (NOTIFY_SOCKET is not set) nothing happens.
// There is no STOPPING=1: a process that starts itself anew (SIGHUP) would be ended by it.
#pragma once

#include "lookout/health_t.hpp"

namespace lookout::runtime {

/// READY=1: the bus is open, inputs are set up, the main loop begins.
void NotifyReady();

/// STATUS with state and reason of this HEALTH message, and WATCHDOG=1. To be called by the main loop only: what is fed anywhere else lives on when
/// the loop hangs.
void NotifyAlive(const health_t& health);

}  // namespace lookout::runtime
