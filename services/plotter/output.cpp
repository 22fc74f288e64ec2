#include "services/plotter/output.hpp"

#include <utility>

namespace lookout::plotter {

// Where nobody listens nothing is made; who comes is told all.
bool Output::IsOpen() {
  if (!link_->is_open()) return false;
  if (num_openings_ != link_->num_openings()) {
    num_openings_ = link_->num_openings();
    waiting_.clear();
    SendAnew();
  }
  SendWaiting();
  return true;
}

void Output::TellOwnShip(const Told& told) {
  if (IsOpen()) SendOwnShip(told);
}

void Output::TellTargets(const Told& told) {
  if (IsOpen()) SendTargets(told);
}

void Output::StopTargets(const Told& told) {
  if (IsOpen()) EndTargets(told);
}

void Output::TellNotices(const Told& told) {
  if (IsOpen()) SendNotices(told);
}

void Output::SendWaiting() {
  while (!waiting_.empty() && link_->room_bytes() >= waiting_.front().size()) {
    link_->Send(waiting_.front());
    waiting_.pop_front();
  }
}

void Output::SendSurely(std::string message) {
  waiting_.push_back(std::move(message));
  SendWaiting();
  if (waiting_.size() <= kMostWaiting) return;
  waiting_.pop_front();
  ++num_dropped_;
}

bool Output::Send(const std::string& message) {
  if (!waiting_.empty() || link_->room_bytes() < message.size()) return false;
  link_->Send(message);
  return true;
}

std::vector<std::int64_t> Output::TakeAcknowledged(const Told& told) {
  constexpr int kMostMessages = 64;  // a flood holds nobody up
  std::vector<std::int64_t> keys;
  for (int i = 0; i < kMostMessages; ++i) {
    const auto message = link_->Receive();
    if (!message) break;
    if (!params_.takes_acknowledgements) continue;
    for (const auto key : Read(*message, told)) keys.push_back(key);
  }
  return keys;
}

}  // namespace lookout::plotter
