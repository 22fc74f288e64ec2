// The base of tests of a service on a bus of its own.
#pragma once

#include <gtest/gtest.h>

#include "tests/support/counters.hpp"
#include "tests/support/memory_bus.hpp"

namespace lookout::support {

/// A test with a bus of its own.
class BusTest : public ::testing::Test {
 protected:
  void HandleAll() { support::HandleAll(bus_); }
  template <typename Message>
  void Send(const bus::Channel& channel, const Message& message) {
    support::Send(bus_, channel, message);
  }

  bus::MemoryBus bus_;
};

}  // namespace lookout::support
