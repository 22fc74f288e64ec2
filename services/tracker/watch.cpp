#include "services/tracker/watch.hpp"

namespace lookout::tracker {

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
  alert_->changed = host_time_;
  sent_.reset();
  return true;
}

}  // namespace lookout::tracker
