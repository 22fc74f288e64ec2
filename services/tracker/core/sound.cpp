#include "services/tracker/core/sound.hpp"

#include <utility>

namespace lookout::tracker {

void Sound::Silence(Utime time) {
  silenced_until_ = time + kSilence;
  for (auto& [id, heard] : heard_) heard.is_silenced = true;
}

std::int64_t Sound::Update(Utime time, std::span<const Alert> alerts) {
  // Silence also ends where time goes back.
  if (silenced_until_ && (time >= *silenced_until_ || time < *silenced_until_ - kSilence)) {
    silenced_until_.reset();
    for (auto& [id, heard] : heard_) heard.is_silenced = false;
  }
  std::int64_t sounding = 0;
  for (const auto& alert : alerts) {
    const bool is_active = alert.state == AlertState::kActive;
    const auto known = heard_.find(alert.id);
    if (known == heard_.end() && !is_active) continue;
    auto& heard = known == heard_.end() ? heard_[alert.id] : known->second;
    const bool was_acknowledged = known != heard_.end() && heard.state == AlertState::kAcknowledged;
    const bool rises = is_active && alert.level > heard.level;
    if (is_active && (known == heard_.end() || rises || was_acknowledged)) {
      heard.begin = time;
      heard.is_silenced = silenced_until_ && alert.level != AlertLevel::kWarning;
    }
    heard.known = time;
    heard.state = alert.state;
    if (!is_active) continue;
    heard.level = alert.level;
    const bool sounds = alert.level == AlertLevel::kWarning || time - heard.begin < kOnce;
    if (sounds && !heard.is_silenced && sounding == 0) sounding = alert.id;
  }
  std::erase_if(heard_, [time](const auto& item) { return std::chrono::abs(time - item.second.known) > kRemembered; });
  return sounding;
}

}  // namespace lookout::tracker
