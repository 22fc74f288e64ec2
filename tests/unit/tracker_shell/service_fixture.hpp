// The tracker's service on a bus of its own, and what it sent.
#pragma once

#include <cstdint>
#include <gtest/gtest.h>
#include <string_view>
#include <vector>

#include "services/tracker/service.hpp"
#include "tests/support/bus_fixture.hpp"
#include "tests/unit/tracker_shell/messages.hpp"

namespace lookout::tracker::test {

class ServiceFixture : public support::BusTest {
 protected:
  Service service_{bus_, MakeParams()};
  support::Kept<tracks_t> tracks_{bus_, bus::kTracks};
  support::Kept<alerts_t> alerts_{bus_, bus::kAlerts};

  void SendSight(std::int64_t number, std::int64_t seq) {
    Send(bus::kLidarScan, MakeScan(kScanUs * number, seq));
    Send(bus::kSegments, MakeSegments(kScanUs * number, seq));
  }
  std::int64_t Count(std::string_view name) const { return support::CountOf(service_, name); }
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
