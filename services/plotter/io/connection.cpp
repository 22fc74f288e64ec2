#include "services/plotter/io/connection.hpp"

namespace lookout::plotter {

void Connection::Send(std::string_view message) {
  if (!is_open()) {
    ++traffic_->num_dropped;
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (num_queued_bytes() + message.size() > kMaxWaitingBytes) {
    ++traffic_->num_dropped;
    is_late_ = true;
    late_since_ = now;
    return;
  }
  waiting_.Add(message.size(), now);
  Write(message);
}

void Connection::Tick(SteadyTime now) {
  if (state_ == State::kOpening && now - began_ > kMaxOpening) return Close("does not answer");
  if (state_ != State::kOpen) return;
  if (!waiting_.is_empty()) traffic_->num_sent += waiting_.Confirm(num_waiting_bytes());
  if (!is_late_ && waiting_.IsLate(now)) {
    is_late_ = true;
    late_since_ = now;
  }
  if (is_late_ && (IsReachable() || now - late_since_ > kMaxUnreachable)) return Close("is too slow: what it had not taken was dropped");
  Check();
}

void Connection::Close(const std::string& reason) {
  if (state_ == State::kClosed) return;
  traffic_->num_dropped += waiting_.Clear();
  state_ = State::kClosed;
  reason_ = reason;
  CloseNow();
}

}  // namespace lookout::plotter
