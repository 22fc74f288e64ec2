// Whether an input comes: one rule for all processes.
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/core/utime.hpp"

namespace lookout {

/// HEALTH names an input that has been silent for so long. On a boat that is whole each of them comes once a second at least.
inline constexpr std::chrono::seconds kInputSilence{2};

/// By the host's time, live only: nothing is silent before the first AdvanceTo.
class InputWatch {
 public:
  /// @param name  of the channel, a literal
  explicit InputWatch(std::string_view name) : name_(name) {}

  std::string_view name() const { return name_; }

  /// A message came.
  void Note() { seen_ = now_; }

  /// Host time has come so far. Once a second or more.
  void AdvanceTo(Utime host_time) {
    // A clock that was set forward, or a stop of this process, is no silence of the inputs.
    constexpr std::chrono::seconds kLongestStep{10};
    if (now_ && seen_ && host_time - *now_ > kLongestStep) *seen_ += host_time - *now_;
    now_ = host_time;
    // Waiting begins with the first call, or again where the host's clock was set back.
    seen_ = std::min(seen_.value_or(host_time), host_time);
  }

  std::chrono::microseconds silence() const { return now_ && seen_ ? *now_ - *seen_ : std::chrono::microseconds(0); }
  bool is_silent() const { return silence() >= kInputSilence; }

  /// "no SEGMENTS for 3 s"; empty while they come.
  std::string Complaint() const { return is_silent() ? Text(name_, silence()) : std::string(); }

  /// One sentence for several inputs: "no SEGMENTS, POSE for 3 s", with the time of the silent input that was heard last.
  static std::string Complaint(std::span<const InputWatch> inputs) {
    std::string names;
    auto least = std::chrono::microseconds::max();
    for (const auto& input : inputs) {
      if (!input.is_silent()) continue;
      names += (names.empty() ? "" : ", ") + std::string(input.name_);
      least = std::min(least, input.silence());
    }
    return names.empty() ? std::string() : Text(names, least);
  }

 private:
  static std::string Text(std::string_view names, std::chrono::microseconds silence) {
    return "no " + std::string(names) + " for " + std::to_string(std::chrono::floor<std::chrono::seconds>(silence).count()) + " s";
  }

  std::string_view name_;
  std::optional<Utime> now_;
  std::optional<Utime> seen_;  // when the last one came, or waiting began
};

}  // namespace lookout
