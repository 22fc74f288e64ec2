// The alert of ALERTS that sounds, for programs that show alerts.
#pragma once

#include <chrono>
#include <cstdint>

#include "lookout/alert_t.hpp"
#include "lookout/alerts_t.hpp"

namespace lookout::messages {

enum class AlertSound : std::uint8_t { kQuiet, kSounds, kSilenced };

/// Silenced is an active warning that was one when silence began: without silence it would sound.
/// @param alert  one of those of `alerts`
inline AlertSound SoundOf(const alerts_t& alerts, const alert_t& alert) {
  constexpr std::int64_t kSilenceUs = std::chrono::microseconds(std::chrono::seconds(30)).count();  // order_t, SILENCE
  if (alert.state != alert_t::STATE_ACTIVE) return AlertSound::kQuiet;
  if (alert.id == alerts.sounding_alert_id) return AlertSound::kSounds;
  const bool is_silenced = alert.id > 0 && alert.level == alert_t::LEVEL_WARNING && alerts.silenced_until_utime_us >= kSilenceUs &&
                           alert.changed_utime_us < alerts.silenced_until_utime_us - kSilenceUs;
  return is_silenced ? AlertSound::kSilenced : AlertSound::kQuiet;
}

}  // namespace lookout::messages
