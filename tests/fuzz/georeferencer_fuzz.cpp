// SEGMENTS and POSE with any bytes of theirs changed: refused or placed, and what is placed is sound.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "common/bus/decode.hpp"
#include "services/georeferencer/service.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace {

using namespace lookout;

constexpr std::size_t kFingerprintBytes = 8;
constexpr std::size_t kPatchBytes = 4;  // place (2), value, and which message

void Check(const obstacles_t& message) {
  for (const auto& obstacle : message.obstacles) {
    const bool is_ok = obstacle.status == obstacle_t::STATUS_OK;
    if (obstacle.num_waterline_map != (is_ok ? obstacle.num_waterline : 0)) std::abort();
    if (obstacle.confidence != obstacle_t::CONFIDENCE_TENTATIVE && obstacle.confidence != obstacle_t::CONFIDENCE_SURE) std::abort();
    if (!(obstacle.seen_share >= 0.0F && obstacle.seen_share <= 1.0F)) std::abort();
    if (obstacle.thing_probability < 0.0F || obstacle.thing_probability > 1.0F) std::abort();
    if (is_ok != (obstacle.num_map > 0) || is_ok != std::isfinite(obstacle.latitude_deg)) std::abort();
    if (!std::isfinite(obstacle.range_m) || !(obstacle.bearing_rad >= 0.0F) || !std::isfinite(obstacle.top_above_water_m)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace test = georeferencer::test;
  static const auto kSegments = bus::Encode(test::MakeGoodSegments());
  bus::MemoryBus bus;
  georeferencer::Service service(bus, georeferencer::Params{georeferencer::PlacementParams{}, std::chrono::milliseconds(500)});
  bus::Subscribe<obstacles_t>(bus, bus::kObstacles, Check);
  auto segments = kSegments;
  std::vector<std::vector<std::uint8_t>> poses;
  for (int i = 0; i <= 5; ++i) poses.push_back(bus::Encode(test::MakePoseMessage(20'000 * i, i)));
  for (std::size_t i = 0; i + kPatchBytes <= size; i += kPatchBytes) {
    auto& message = data[i + 3] % 2 == 0 ? segments : poses[data[i + 3] / 2 % poses.size()];
    const std::size_t place = data[i] | static_cast<std::size_t>(data[i + 1]) << 8;
    message[kFingerprintBytes + place % (message.size() - kFingerprintBytes)] = data[i + 2];
  }
  bus.Publish(bus::kSegments, segments);
  for (const auto& pose : poses) bus.Publish(bus::kPose, pose);
  bus.Publish(bus::kSegments, segments);
  support::HandleAll(bus);
  service.AdvanceTo(test::At(0));
  service.AdvanceTo(test::At(1'000'000));
  service.Finish();
  support::HandleAll(bus);
  return 0;
}
