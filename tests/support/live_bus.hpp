// Waiting while the messages of a live bus are handled.
#pragma once

#include <chrono>

#include "common/bus/lcm_bus.hpp"

namespace lookout::support {

/// Handles messages until `is_true`, at most so long, and calls `send` every 100 ms meanwhile.
/// @return whether it is true
template <typename Condition, typename Send>
bool SendUntil(bus::LcmBus& bus, const Condition& is_true, const Send& send, std::chrono::milliseconds longest = std::chrono::seconds(30)) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + longest;
  for (auto next = Clock::now(); !is_true() && Clock::now() < deadline; bus.HandleOnce(std::chrono::milliseconds(5))) {
    if (Clock::now() < next) continue;
    next += std::chrono::milliseconds(100);
    send();
  }
  return is_true();
}

/// The same without sending.
template <typename Condition>
bool HandleUntil(bus::LcmBus& bus, const Condition& is_true, std::chrono::milliseconds longest = std::chrono::seconds(30)) {
  return SendUntil(
      bus, is_true, [] {}, longest);
}

}  // namespace lookout::support
