// What the tracker reads with any bytes of it changed, lost, doubled, late or of long ago: refused or tracked, and what is tracked is sound.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "common/bus/decode.hpp"
#include "services/tracker/service.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/tracker_shell/messages.hpp"

namespace {

using namespace lookout;

constexpr std::size_t kFingerprintBytes = 8;
constexpr std::size_t kPatchBytes = 4;  // place (2), value, and which message
constexpr int kNumScans = 12;
constexpr std::size_t kMostMessages = 200;
// Places from here on say what becomes of the message instead.
constexpr std::size_t kFirstFate = 0xFFF0;
enum class Fate { kLost = 0, kDoubled = 1, kLast = 2, kFirst = 3 };

bool IsShare(float value) { return value >= 0.0F && value <= 1.0F; }

void CheckTracks(const tracks_t& message) {
  if (!messages::IsWellFormed(message) || message.num_tracks > message.num_scan_tracks) std::abort();
  std::int64_t last_id = 0;
  for (const auto& track : message.tracks) {
    if (std::exchange(last_id, track.id) >= track.id) std::abort();
    if (track.status < track_t::STATUS_TENTATIVE || track.status > track_t::STATUS_LOST) std::abort();
    if (!std::isfinite(track.latitude_deg) || !std::isfinite(track.position_map_m[0]) || !std::isfinite(track.velocity_map_mps[1])) std::abort();
    for (int i = 0; i < 4; ++i) {
      if (!(track.covariance[i][i] >= 0.0)) std::abort();
    }
    if (!IsShare(track.existence_probability) || !IsShare(track.moving_probability) || !IsShare(track.cpa_probability)) std::abort();
  }
}

void CheckAlerts(const alerts_t& message) {
  for (const auto& alert : message.alerts) {
    if (alert.state < alert_t::STATE_ACTIVE || alert.state > alert_t::STATE_CLEARED || alert.id == 0) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace test = tracker::test;
  bus::MemoryBus bus;
  auto params = test::MakeParams();
  params.look_out.limits.guard_zone = {.range_m = 10.0};
  params.zone_sight.zone = params.look_out.limits.guard_zone;
  params.zone_sight.own_vessel_box_m = {Eigen::Vector3d(-1.0, -0.5, -1.0), Eigen::Vector3d(1.0, 0.5, 2.0)};
  tracker::Service service(bus, params);
  bus::Subscribe<tracks_t>(bus, bus::kTracks, CheckTracks);
  bus::Subscribe<alerts_t>(bus, bus::kAlerts, CheckAlerts);
  std::vector<std::pair<const bus::Channel*, std::vector<std::uint8_t>>> messages;
  const auto add = [&messages](const bus::Channel& channel, const auto& message) { messages.emplace_back(&channel, bus::Encode(message)); };
  for (int scan = 0; scan < kNumScans; ++scan) {
    const auto offset_us = test::kScanUs * scan;
    for (auto pose_us = offset_us; pose_us < offset_us + test::kScanUs; pose_us += 20'000) {
      auto pose = test::MakePose(pose_us, pose_us / 20'000);
      pose.position_map_m[1] = 3e-6 * static_cast<double>(pose_us);
      pose.velocity_map_mps[1] = 3.0;
      add(bus::kPose, pose);
    }
    add(bus::kLidarScan, test::MakeScan(offset_us, scan));
    add(bus::kSegments, test::MakeSegments(offset_us, scan));
    auto land = test::MakeObstacle(3, test::kStartUs + offset_us + 1000, {40.0, 30.0});
    land.kind = obstacle_t::KIND_LAND;
    land.num_waterline = land.num_waterline_map = 2;
    land.waterline_vessel_x_m = land.waterline_vessel_y_m = land.waterline_east_m = land.waterline_north_m = {30.0F, 40.0F};
    add(bus::kObstacles, test::MakeObstacles(offset_us, scan,
                                             {test::MakeObstacle(1, test::kStartUs + offset_us + 1000, {0.0, 25.0}),
                                              test::MakeObstacle(2, test::kStartUs + offset_us + 1000, {-20.0 + scan, 25.0}), land}));
  }
  add(bus::kAlertAck, alert_ack_t{});
  order_t order{};
  order.kind = order_t::KIND_SETTINGS;
  order.mode = order_t::MODE_HARBOUR;
  add(bus::kOrders, order);
  for (std::size_t i = 0; i + kPatchBytes <= size; i += kPatchBytes) {
    const std::size_t which = data[i + 3] % messages.size();
    auto& message = messages[which].second;
    const std::size_t place = data[i] | static_cast<std::size_t>(data[i + 1]) << 8;
    if (place >= kFirstFate && messages.size() > 2 && messages.size() < kMostMessages) {
      const auto at = messages.begin() + static_cast<std::ptrdiff_t>(which);
      switch (static_cast<Fate>(place - kFirstFate)) {
        case Fate::kLost:
          messages.erase(at);
          break;
        case Fate::kDoubled:
          messages.insert(at, std::pair(*at));
          break;
        case Fate::kLast:
          std::rotate(at, at + 1, messages.end());
          break;
        case Fate::kFirst:
          std::rotate(messages.begin(), at, at + 1);
          break;
        default:
          break;
      }
      continue;
    }
    message[kFingerprintBytes + place % (message.size() - kFingerprintBytes)] = data[i + 2];
  }
  for (const auto& [channel, bytes] : messages) bus.Publish(*channel, bytes);
  support::HandleAll(bus);
  service.AdvanceTo(Utime(std::chrono::seconds(1'000'000)));
  service.AdvanceTo(Utime(std::chrono::seconds(1'000'001)));
  service.Finish();
  support::HandleAll(bus);
  return 0;
}
