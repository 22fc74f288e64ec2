#include "services/plotter/io/reopening_port.hpp"

#include <algorithm>

namespace lookout::plotter {

ReopeningPort::~ReopeningPort() {
  if (connection_) connection_->Close("");
}

void ReopeningPort::Send(std::string_view message) {
  if (is_open_) {
    connection_->Send(message);
  } else {
    ++traffic_->num_unsent;
  }
}

void ReopeningPort::Fail(const std::string& why, SteadyTime now) {
  fault_ = place_ + ": " + why;
  next_attempt_ = now + pause_;
  pause_ = std::min(2 * pause_, last_pause_);
}

void ReopeningPort::Tick(SteadyTime now) {
  if (!connection_) {
    if (now < next_attempt_) return;
    std::string why;
    connection_ = Open(why);
    if (!connection_) return Fail(why, now);
  }
  connection_->Tick(now);
  if (connection_->state() == Connection::State::kOpen && !is_open_) {
    is_open_ = true;
    opened_ = now;
    fault_.clear();
    ++traffic_->num_openings;
  }
  if (connection_->state() == Connection::State::kClosed) {
    // A server that takes everybody and drops them at once is no sound one.
    if (is_open_ && now - opened_ > last_pause_) pause_ = kFirstPause;
    is_open_ = false;
    Fail(connection_->reason(), now);
    connection_.reset();
  }
}

std::vector<Counter> ReopeningPort::counters() const {
  return names_.With(
      {traffic_->num_sent, traffic_->num_dropped, traffic_->num_unsent, traffic_->num_received, traffic_->num_refused, traffic_->num_openings});
}

}  // namespace lookout::plotter
