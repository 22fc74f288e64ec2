#include "services/plotter/output.hpp"

#include <algorithm>
#include <utility>

namespace lookout::plotter {

// Where nobody listens nothing is made; a new receiver is told all.
bool Output::IsOpen(std::chrono::microseconds passed) {
  if (!link_->is_open()) {
    link_->NoteUnsent();
    return false;
  }
  if (num_openings_ != link_->num_openings()) {
    num_openings_ = link_->num_openings();
    owes_anew_ = true;
  }
  if (owes_anew_ && (!anew_ || passed - *anew_ >= kAnewPeriod)) {
    owes_anew_ = false;
    anew_ = passed;
    waiting_.clear();
    SendAnew();
  }
  SendWaiting();
  return true;
}

void Output::TellOwnShip(const Told& told) {
  if (IsOpen(told.passed)) SendOwnShip(told);
}

void Output::TellTargets(const Told& told) {
  if (IsOpen(told.passed)) SendTargets(told);
}

void Output::TellLook(const Told& told) {
  if (link_->is_open() && IsOpen(told.passed)) SendLook(told);
}

void Output::StopTargets(const Told& told) {
  if (link_->is_open() && IsOpen(told.passed)) EndTargets(told);
}

void Output::TellNotices(const Told& told) {
  if (link_->is_open() && IsOpen(told.passed)) SendNotices(told);
}

void Output::Finish(const Told& told) {
  if (link_->is_open() && IsOpen(told.passed)) FinishTargets(told);
}

void Output::SendWaiting() {
  while (!waiting_.empty() && link_->room_bytes() >= waiting_.front().message.size()) {
    link_->Send(waiting_.front().message);
    waiting_.pop_front();
  }
}

void Output::SendSurely(std::string message, const std::string& subject) {
  const auto same = subject.empty() ? waiting_.end() : std::ranges::find(waiting_, subject, &WaitingMessage::subject);
  if (same != waiting_.end()) {
    same->message = std::move(message);
  } else {
    waiting_.push_back({subject, std::move(message)});
  }
  SendWaiting();
  if (waiting_.size() <= kMostWaiting) return;
  waiting_.pop_front();
  ++num_dropped_;
}

void Output::DropWaiting(std::string_view subject_begin) {
  std::erase_if(waiting_, [subject_begin](const WaitingMessage& one) { return one.subject.starts_with(subject_begin); });
}

bool Output::Send(const std::string& message) {
  if (!waiting_.empty() || link_->room_bytes() < message.size()) return false;
  link_->Send(message);
  return true;
}

Commands Output::TakeCommands(const Told& told) {
  Commands commands;
  for (int i = 0; i < most_read(); ++i) {
    const auto message = link_->Receive();
    if (!message) break;
    const auto read = Read(*message, told);
    if (!params_.takes_acknowledgements) continue;
    commands.acknowledged.insert(commands.acknowledged.end(), read.acknowledged.begin(), read.acknowledged.end());
    commands.silences = commands.silences || read.silences;
  }
  return commands;
}

}  // namespace lookout::plotter
