#include "services/tracker/watch.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lookout::tracker {

void Watch::NoteScan(Utime scan_time, bool is_whole) {
  if (!last_good_) last_good_ = time_.passed();
  if (!is_whole) return;
  last_whole_ = time_.passed();
  std::erase_if(whole_, [scan_time](Utime other) { return std::chrono::abs(scan_time - other) > kWithin; });
  whole_.push_back(scan_time);
  if (whole_.size() < kScans) return;
  whole_.erase(whole_.begin(), whole_.end() - kScans);
  last_good_ = time_.passed();
  has_looked_ = true;
}

std::string Watch::Complaint() const {
  if (!host_time_ || (has_looked_ && !is_failing())) return {};
  if (!last_whole_) return "no whole scan yet";
  const auto unseen = time_.passed() - *last_whole_;
  if (unseen >= kLongest) return fmt::format("no whole scan for {:.1f} s", ToSeconds(unseen));
  return fmt::format("less than {} whole scans within {:.1f} s", kScans, ToSeconds(kWithin));
}

void Watch::AdvanceTo(Utime host_time) {
  time_.Advance(host_time);
  host_time_ = host_time;
  if (is_failing() && !alert_) {
    ++num_failures_;
    alert_.emplace();
    alert_->id = -num_failures_;
    alert_->cause = AlertCause::kWatch;
    alert_->level = AlertLevel::kWarning;
    alert_->raised = alert_->changed = host_time;
  } else if (!is_failing() && alert_ && alert_->state != AlertState::kCleared) {
    alert_->state = AlertState::kCleared;
    alert_->changed = host_time;
    sent_.reset();
  }
}

bool Watch::TakeTurn() {
  if (!alert_) return false;
  const bool is_over = alert_->state == AlertState::kCleared;
  if (is_over && sent_) {
    alert_.reset();
    sent_.reset();
    return false;
  }
  if (sent_ && time_.passed() - *sent_ < kLongest) return false;
  sent_ = time_.passed();
  return true;
}

bool Watch::Acknowledge(const Acknowledgement& acknowledgement) {
  if (!alert_ || alert_->id != acknowledgement.alert_id || alert_->raised != acknowledgement.raised || alert_->state != AlertState::kActive)
    return false;
  alert_->state = AlertState::kAcknowledged;
  alert_->changed = *host_time_;
  sent_.reset();
  return true;
}

}  // namespace lookout::tracker
