// Which alert sounds.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include "common/core/utime.hpp"
#include "services/tracker/core/alerts.hpp"

namespace lookout::tracker {

/// One sound: the gravest active alert. A warning sounds until it is acknowledged, a caution once. A warning that becomes a caution does not sound
/// again, a caution that becomes a warning does. Silence is no acknowledgement: alerts stay as they are, and an alert that comes up as a warning, or
/// becomes one, meanwhile sounds all the same.
class Sound {
 public:
  static constexpr std::chrono::seconds kSilence{30};
  static constexpr std::chrono::seconds kOnce{1};
  /// An alert that comes up again within this time is the same (Alerts::kSameS), and was heard.
  static constexpr std::chrono::seconds kRemembered{10};

  void Silence(Utime time);

  /// One scan.
  /// @param alerts  the gravest first
  /// @return id of the alert that sounds; 0: none
  std::int64_t Update(Utime time, std::span<const Alert> alerts);

  /// nullopt: the sound is not silenced.
  std::optional<Utime> silenced_until() const { return silenced_until_; }

 private:
  struct Heard {
    AlertLevel level = AlertLevel::kCaution;  // of the alert, when it was active last
    AlertState state = AlertState::kActive;
    Utime begin;  // when it became active
    Utime known;  // when the alert was there last
    bool is_silenced = false;
  };

  std::map<std::int64_t, Heard> heard_;  // by alert
  std::optional<Utime> silenced_until_;
};

}  // namespace lookout::tracker
