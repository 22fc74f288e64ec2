// Messages and bytes per second over the last five seconds, in constant memory.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

namespace lookout::top {

/// Monotonic time of this computer; always an argument, never read here.
using TimePoint = std::chrono::steady_clock::time_point;

struct Rate {
  double messages_hz = 0.0;
  double bytes_per_s = 0.0;
};

class RateMeter {
 public:
  /// @param start  since when there has been somebody to count
  explicit RateMeter(TimePoint start) : start_(start) {}

  void Add(TimePoint now, std::int64_t num_bytes) {
    auto& slot = slots_[IndexOf(NumberOf(now))];
    if (slot.number != NumberOf(now)) slot = {NumberOf(now), 0, 0};
    ++slot.num_messages;
    slot.num_bytes += num_bytes;
  }

  /// @return nullopt in the first second: too early to tell
  std::optional<Rate> At(TimePoint now) const {
    // The slot of now is not full yet: it counts for as much of it as is over.
    const std::int64_t newest = NumberOf(now);
    const TimePoint window_start = std::max(start_, TimePoint((newest - kNumSlots + 1) * kSlot));
    const double window_s = std::chrono::duration<double>(now - window_start).count();
    if (window_s < 1.0) return std::nullopt;
    Rate rate;
    for (const auto& slot : slots_) {
      if (slot.number > newest - kNumSlots && slot.number <= newest) {
        rate.messages_hz += static_cast<double>(slot.num_messages);
        rate.bytes_per_s += static_cast<double>(slot.num_bytes);
      }
    }
    rate.messages_hz /= window_s;
    rate.bytes_per_s /= window_s;
    return rate;
  }

 private:
  static constexpr std::int64_t kNumSlots = 10;
  static constexpr std::chrono::milliseconds kSlot{500};

  struct Slot {
    std::int64_t number = -1;  // number of the slot's half second; -1 = never used
    std::int64_t num_messages = 0;
    std::int64_t num_bytes = 0;
  };

  static std::int64_t NumberOf(TimePoint time) { return time.time_since_epoch() / kSlot; }
  static std::size_t IndexOf(std::int64_t number) { return static_cast<std::size_t>(number % kNumSlots); }

  TimePoint start_;
  std::array<Slot, static_cast<std::size_t>(kNumSlots)> slots_{};
};

}  // namespace lookout::top
