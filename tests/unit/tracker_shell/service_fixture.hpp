// The tracker's service on a bus of its own, and what it sent.
#pragma once

#include <cstdint>
#include <gtest/gtest.h>
#include <string_view>
#include <vector>

#include "common/bus/memory_bus.hpp"
#include "services/tracker/service.hpp"
#include "tests/unit/tracker_shell/messages.hpp"

namespace lookout::tracker::test {

class ServiceFixture : public ::testing::Test {
 protected:
  bus::MemoryBus bus_;
  Service service_{bus_, MakeParams()};
  std::vector<tracks_t> tracks_;
  std::vector<alerts_t> alerts_;

  void SetUp() override {
    bus::Subscribe<tracks_t>(bus_, bus::kTracks, [this](const tracks_t& message) { tracks_.push_back(message); });
    bus::Subscribe<alerts_t>(bus_, bus::kAlerts, [this](const alerts_t& message) { alerts_.push_back(message); });
  }
  void HandleAll() {
    while (bus_.HandleOnce()) {
    }
  }
  template <typename Message>
  void Send(const bus::Channel& channel, const Message& message) {
    bus::Publish(bus_, channel, message);
    HandleAll();
  }
  void SendSight(std::int64_t number, std::int64_t seq) {
    Send(bus::kLidarScan, MakeScan(kScanUs * number, seq));
    Send(bus::kSegments, MakeSegments(kScanUs * number, seq));
  }
  /// Of a counter of HEALTH; -1: there is none of this name.
  std::int64_t Count(std::string_view name) const {
    for (const auto& counter : service_.Report().counters) {
      if (counter.name == name) return counter.count;
    }
    return -1;
  }
};

/// The same as georeferencer sends it where its place on the earth is not known.
inline obstacles_t InTheVesselFrame(obstacles_t message, std::int32_t status = obstacle_t::STATUS_VESSEL_FRAME_ONLY) {
  for (auto& obstacle : message.obstacles) {
    obstacle.status = status;
    obstacle.num_map = 0;
    obstacle.footprint_east_m.clear();
    obstacle.footprint_north_m.clear();
  }
  return message;
}

}  // namespace lookout::tracker::test
