// Links at work, and plain sockets of this computer as the other side.
#pragma once

#include <chrono>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <thread>

#include "services/plotter/io/links.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/socket.hpp"

namespace lookout::plotter {

using namespace std::chrono_literals;

class LinksTest : public ::testing::Test {
 protected:
  // Polls until it is so.
  bool Until(const std::function<bool()>& is_so, std::chrono::milliseconds longest = 4s) {
    const auto end = std::chrono::steady_clock::now() + longest;
    while (std::chrono::steady_clock::now() < end) {
      links_.Poll();
      if (is_so()) return true;
      std::this_thread::sleep_for(5ms);
    }
    return false;
  }
  void PollFor(std::chrono::milliseconds time) {
    Until([] { return false; }, time);
  }
  static bool Holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

  Links links_;
};

using support::FreePort;
using support::Socket;

}  // namespace lookout::plotter
