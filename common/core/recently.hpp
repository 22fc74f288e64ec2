// A count that grows is named as a reason for one minute; afterwards its counter alone shows it.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include "common/core/utime.hpp"

namespace lookout {

/// Elapsed time from host times whose clock may be set: a step back counts as 0, a step ahead as `most`.
class PassedTime {
 public:
  /// @param most  a little longer than the period in which Advance is called
  explicit PassedTime(std::chrono::microseconds most) : most_(most) {}

  /// @return time since the first call
  std::chrono::microseconds Advance(Utime now) {
    if (last_) passed_ += std::clamp(std::chrono::duration_cast<std::chrono::microseconds>(now - *last_), std::chrono::microseconds(0), most_);
    last_ = now;
    return passed_;
  }
  std::chrono::microseconds passed() const { return passed_; }

 private:
  std::chrono::microseconds most_;
  std::chrono::microseconds passed_{0};
  std::optional<Utime> last_;
};

/// Whether a count has grown within the last minute.
class Recently {
 public:
  void Note(std::int64_t count, std::chrono::microseconds passed) {
    if (count > count_) last_ = passed;
    count_ = count;
  }
  bool HasGrown(std::chrono::microseconds passed) const { return last_ && passed - *last_ < kToldFor; }

  static constexpr std::chrono::minutes kToldFor{1};

 private:
  std::int64_t count_ = 0;
  std::optional<std::chrono::microseconds> last_;
};

}  // namespace lookout
