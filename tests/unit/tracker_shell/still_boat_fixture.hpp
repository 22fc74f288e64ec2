// A tracker beside one thing, in a boat that lies still.
#pragma once

#include <chrono>
#include <cstdint>

#include "tests/unit/tracker_shell/messages.hpp"
#include "tests/unit/tracker_shell/service_fixture.hpp"

namespace lookout::tracker {

// By the clock of the host.
inline Utime Host(std::chrono::milliseconds time) { return Utime(std::chrono::microseconds(1'000'000'000'000'000)) + time; }

class TrackerService : public test::ServiceFixture {
 protected:
  // A boat that lies still.
  void SendPoses(std::int64_t first_us, std::int64_t last_us, std::int64_t first_seq = 0) {
    for (auto offset_us = first_us; offset_us <= last_us; offset_us += 20'000) Send(bus::kPose, test::MakePose(offset_us, first_seq++));
  }
  // One thing, 20 m to the north, and so far to the east.
  static obstacles_t Obstacles(std::int64_t number, std::int64_t seq, double east_m = 0.0) {
    const auto offset_us = test::kScanUs * number;
    return test::MakeObstacles(offset_us, seq, {test::MakeObstacle(1, test::kStartUs + offset_us + 50'000, {east_m, 20.0})});
  }
  void SendScan(std::int64_t number, std::int64_t seq) {
    SendSight(number, seq);
    Send(bus::kObstacles, Obstacles(number, seq));
  }
};

}  // namespace lookout::tracker
