#include "services/vlp16/core/data_packet.hpp"

#include <algorithm>
#include <optional>

namespace lookout::vlp16 {

namespace {

using namespace format;

// The counter of a sensor whose PPS sets it back at the hour may go a little beyond. One that never was set may hold any number, which is
// no time of an hour.
constexpr std::uint32_t kMaxStampUs = kMicrosecondsPerHour + 1'000'000;

// Steps that go back so little are noise of the encoder, not a turn of nearly a whole circle.
constexpr bool IsBack(int gap_cdeg) { return gap_cdeg > kAzimuthsPerTurn - kMaxGapCdeg; }

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
    if (azimuth_cdeg[i] >= kAzimuthsPerTurn) return refused(DataFault::kAzimuth);
  }
  const auto mode = ToReturnMode(payload[kReturnModeOffset]);
  if (!mode) return refused(DataFault::kReturnMode);
  packet.mode = *mode;
  packet.product = payload[kProductOffset];
  packet.stamp_us = ReadU32LittleEndian(payload, kStampOffset);
  if (packet.stamp_us >= kMaxStampUs) return refused(DataFault::kStamp);

  const int blocks_per_step = packet.num_returns();
  packet.num_steps = kNumBlocks / blocks_per_step;
  for (int i = 0; i < packet.num_steps; ++i) {
    packet.azimuth_cdeg[i] = azimuth_cdeg[i * blocks_per_step];
    if (azimuth_cdeg[i * blocks_per_step + blocks_per_step - 1] != packet.azimuth_cdeg[i]) return refused(DataFault::kDualPair);
  }
  if (SweepCdeg(packet) >= kAzimuthsPerTurn) return refused(DataFault::kAzimuthOrder);
  return {DataFault::kNone, packet};
}

Steps MeasureSteps(const DataPacket& packet, int fallback_cdeg) {
  Steps steps;
  std::array<int, kNumBlocks> usable{};
  int num_usable = 0;
  for (int i = 0; i + 1 < packet.num_steps; ++i) {
    steps.gap_cdeg[i] = ClockwiseCdeg(packet.azimuth_cdeg[i], packet.azimuth_cdeg[i + 1]);
    if (steps.gap_cdeg[i] <= kMaxGapCdeg) usable[num_usable++] = steps.gap_cdeg[i];
  }
  steps.gap_cdeg[packet.num_steps - 1] = num_usable > 0 ? usable[num_usable - 1] : fallback_cdeg;
  steps.duration = packet.period();
  if (num_usable == packet.num_steps - 1) return steps;

  int usual_cdeg = fallback_cdeg;
  if (num_usable > 0) {
    const auto middle = usable.begin() + (num_usable - 1) / 2;
    std::nth_element(usable.begin(), middle, usable.begin() + num_usable);
    usual_cdeg = *middle;
  }
  for (int i = 0; i + 1 < packet.num_steps; ++i) {
    if (steps.gap_cdeg[i] <= kMaxGapCdeg) continue;
    if (!IsBack(steps.gap_cdeg[i]) && usual_cdeg > 0) steps.duration += kBlockPeriod * (steps.gap_cdeg[i] - usual_cdeg) / usual_cdeg;
    steps.gap_cdeg[i] = usual_cdeg;
  }
  return steps;
}

}  // namespace lookout::vlp16
