// What the decoder's fuzz target reads, and the corpus is written in: a head, then records of a control byte and a payload.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::vlp16::script {

using namespace std::chrono_literals;

/// Head: model choice, time choice, cut in tenths of a turn; each byte counts modulo the number of choices.
inline constexpr std::size_t kHeadSizeBytes = 3;
inline constexpr int kNumModels = 3;
inline constexpr int kNumTimes = 3;
inline constexpr int kNumCuts = 10;

/// Control byte: what the record is (low two bits), and by what the host's clock goes on before it (next three).
enum class Kind : std::uint8_t { kData = 0, kPosition = 1, kFlush = 2, kReset = 3 };
inline constexpr std::array<std::chrono::microseconds, 8> kHostSteps{1327us, 664us, 0us, 20ms, 300ms, 3500ms, -5ms, -2s};

constexpr std::uint8_t ControlByte(Kind kind, std::size_t host_step) {
  return static_cast<std::uint8_t>(static_cast<std::size_t>(kind) | host_step << 2);
}
constexpr Kind KindOf(std::uint8_t control) { return static_cast<Kind>(control & 3U); }
constexpr std::chrono::microseconds HostStepOf(std::uint8_t control) { return kHostSteps.at(control >> 2 & 7U); }

/// Of the payload that follows; a script that ends early has a shorter one.
constexpr std::size_t PayloadSizeBytes(Kind kind) {
  if (kind == Kind::kData) return format::kDataPacketSizeBytes;
  return kind == Kind::kPosition ? format::kPositionPacketSizeBytes : 0;
}

class Writer {
 public:
  Writer(int model, int time, int cut) : bytes_{static_cast<std::uint8_t>(model), static_cast<std::uint8_t>(time), static_cast<std::uint8_t>(cut)} {}

  Writer& Add(Kind kind, std::size_t host_step, const std::vector<std::uint8_t>& payload = {}) {
    bytes_.push_back(ControlByte(kind, host_step));
    bytes_.insert(bytes_.end(), payload.begin(), payload.end());
    return *this;
  }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace lookout::vlp16::script
