#include "services/lidar/core/vlp16/data_packet.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace lookout::vlp16 {

namespace {

using namespace format;

// The head rounds 359.996 deg to 36000, and may be a step beyond before it wraps (real packets: 35979, 36000, 18).
constexpr int kMaxAzimuthCdeg = kAzimuthsPerRevolution + kMaxGapCdeg;

// A head that rotates slower than half the least rate of the manual is starting or stands: its jumps are of the encoder, and take no time.
constexpr double kMinRateCdeg =
    0.5 * kMinRpm / 60.0 * kAzimuthsPerRevolution * static_cast<double>(kBlockPeriod.count()) / static_cast<double>(std::nano::den);

// Steps that go back so little are noise of the encoder, not a rotation by nearly a whole circle.
constexpr bool IsBack(int gap_cdeg) { return gap_cdeg > kAzimuthsPerRevolution - kMaxGapCdeg; }

std::optional<ReturnMode> ToReturnMode(std::uint8_t byte) {
  switch (byte) {
    case kModeStrongest:
      return ReturnMode::kStrongest;
    case kModeLast:
      return ReturnMode::kLast;
    case kModeDual:
      return ReturnMode::kDual;
    default:
      return std::nullopt;
  }
}

int SweepCdeg(const DataPacket& packet) {
  int sweep_cdeg = 0;
  for (int i = 0; i + 1 < packet.num_steps; ++i) {
    const int gap_cdeg = ClockwiseCdeg(packet.azimuth_cdeg[i], packet.azimuth_cdeg[i + 1]);
    if (!IsBack(gap_cdeg)) sweep_cdeg += gap_cdeg;
  }
  return sweep_cdeg;
}

}  // namespace

DataPacketResult ParseDataPacket(Bytes payload) {
  const auto refused = [](DataFault fault) { return DataPacketResult{fault, {}}; };
  if (payload.size() != kDataPacketSizeBytes) return refused(DataFault::kSize);
  DataPacket packet;
  packet.payload = payload;
  std::array<int, kNumBlocks> azimuth_cdeg{};
  for (int i = 0; i < kNumBlocks; ++i) {
    const std::size_t block = i * kBlockSizeBytes;
    if (ReadU16LittleEndian(payload, block + kBlockFlagOffset) != kBlockFlag) return refused(DataFault::kFlag);
    azimuth_cdeg[i] = ReadU16LittleEndian(payload, block + kBlockAzimuthOffset);
    if (azimuth_cdeg[i] > kMaxAzimuthCdeg) return refused(DataFault::kAzimuth);
    if (azimuth_cdeg[i] >= kAzimuthsPerRevolution) {
      azimuth_cdeg[i] -= kAzimuthsPerRevolution;
      packet.has_wrapped_azimuth = true;
    }
  }
  const auto mode = ToReturnMode(payload[kReturnModeOffset]);
  if (!mode) return refused(DataFault::kReturnMode);
  packet.mode = *mode;
  packet.product = payload[kProductOffset];
  packet.stamp_us = ReadU32LittleEndian(payload, kStampOffset);

  const int blocks_per_step = packet.num_returns();
  packet.num_steps = kNumBlocks / blocks_per_step;
  for (int i = 0; i < packet.num_steps; ++i) {
    packet.azimuth_cdeg[i] = azimuth_cdeg[i * blocks_per_step];
    if (azimuth_cdeg[i * blocks_per_step + blocks_per_step - 1] != packet.azimuth_cdeg[i]) return refused(DataFault::kDualPair);
  }
  if (SweepCdeg(packet) >= kAzimuthsPerRevolution) return refused(DataFault::kAzimuthOrder);
  return {DataFault::kNone, packet};
}

Steps MeasureSteps(const DataPacket& packet, double known_cdeg) {
  Steps steps;
  const int num_steps = packet.num_steps;
  const int fallback_cdeg = static_cast<int>(std::lround(known_cdeg));
  std::array<int, kNumBlocks> usable{};
  int num_usable = 0;
  for (int i = 0; i + 1 < num_steps; ++i) {
    steps.gap_cdeg[i] = ClockwiseCdeg(packet.azimuth_cdeg[i], packet.azimuth_cdeg[i + 1]);
    steps.time[i + 1] = (i + 1) * kBlockPeriod;
    if (steps.gap_cdeg[i] <= kMaxGapCdeg) usable[num_usable++] = steps.gap_cdeg[i];
  }
  steps.gap_cdeg[num_steps - 1] = num_usable > 0 ? usable[num_usable - 1] : fallback_cdeg;
  steps.duration = packet.period();
  steps.end_cdeg = (packet.azimuth_cdeg[num_steps - 1] + steps.gap_cdeg[num_steps - 1]) % kAzimuthsPerRevolution;
  if (num_usable == num_steps - 1) return steps;

  const int sum_cdeg = std::accumulate(usable.begin(), usable.begin() + num_usable, 0);
  const double rate_cdeg = known_cdeg > 0.0 ? known_cdeg : static_cast<double>(sum_cdeg) / std::max(1, num_usable);
  int usual_cdeg = fallback_cdeg;
  if (num_usable > 0) {
    const auto middle = usable.begin() + (num_usable - 1) / 2;
    std::nth_element(usable.begin(), middle, usable.begin() + num_usable);
    usual_cdeg = *middle;
  }
  std::chrono::nanoseconds waited{0};  // in jumps so far
  int widest_cdeg = 0;
  for (int i = 0; i + 1 < num_steps; ++i) {
    const int gap_cdeg = steps.gap_cdeg[i];
    if (gap_cdeg > kMaxGapCdeg) {
      if (!IsBack(gap_cdeg)) {
        const double num_periods = rate_cdeg >= kMinRateCdeg ? gap_cdeg / rate_cdeg - 1.0 : 0.0;
        waited += std::chrono::nanoseconds(std::llround(num_periods * static_cast<double>(kBlockPeriod.count())));
        if (gap_cdeg > widest_cdeg) steps.jump = Gap{(packet.azimuth_cdeg[i] + usual_cdeg) % kAzimuthsPerRevolution, packet.azimuth_cdeg[i + 1]};
        widest_cdeg = std::max(widest_cdeg, gap_cdeg);
      }
      steps.gap_cdeg[i] = usual_cdeg;
    }
    steps.time[i + 1] += waited;
  }
  steps.duration += waited;
  return steps;
}

}  // namespace lookout::vlp16
