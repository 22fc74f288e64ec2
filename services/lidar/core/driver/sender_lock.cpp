#include "services/lidar/core/driver/sender_lock.hpp"

#include <algorithm>
#include <utility>

namespace lookout::lidar {

std::string ToText(const Sender& sender) {
  const bool is_ipv6 = sender.address.find(':') != std::string::npos;
  return (is_ipv6 ? "[" + sender.address + "]" : sender.address) + ":" + std::to_string(sender.port);
}

SenderLock::SenderLock(JudgeMaker make_judge, std::vector<std::string> allowed) : make_judge_(std::move(make_judge)), allowed_(std::move(allowed)) {}

bool SenderLock::IsAllowed(const Sender& sender) const { return allowed_.empty() || std::ranges::find(allowed_, sender.address) != allowed_.end(); }

void SenderLock::Reset() { streams_ = {}; }

// The candidate on trial, if it is this sender. nullptr while another sender is on trial, and for a sender whose packet cannot be the lidar's: it
// would keep the lidar from its trial.
SenderLock::Candidate* SenderLock::CandidateFor(StreamState& state, Utime time, const Sender& sender, Verdict alone) const {
  auto& candidate = state.candidate;
  const bool is_over = !candidate || time < candidate->last || time - candidate->last > kTrialPause;
  if (candidate && candidate->sender == sender) {
    if (is_over) candidate->heard_for = std::chrono::microseconds(0);
    return &*candidate;
  }
  if (alone != Verdict::kValid && alone != Verdict::kUndecided) return nullptr;
  // Without a holder the first valid sender counts, not the first sender. Two senders that are known by their intervals alone are tried one after the
  // other: if they alternated, neither would show an interval.
  if (!is_over && (state.holder || alone == Verdict::kUndecided)) return nullptr;
  candidate = Candidate{sender, make_judge_(), time, std::chrono::microseconds(0)};
  return &*candidate;
}

SenderLock::Outcome SenderLock::Check(Utime time, Stream stream, const Sender& sender, Bytes payload) {
  if (!IsAllowed(sender)) return {};
  auto& data = streams_[static_cast<std::size_t>(Stream::kData)];
  auto& state = streams_[static_cast<std::size_t>(stream)];
  if (time < state.heard) state.heard = time;
  if (state.holder == sender) {
    const bool is_valid = state.judge->Judge(stream, payload) == Verdict::kValid;
    if (is_valid) {
      state.heard = time;
      state.candidate.reset();
    }
    return {.is_taken = true, .is_valid = is_valid};
  }
  Outcome outcome{.is_taken = !state.holder};
  if (stream == Stream::kPosition && data.holder) {
    outcome.is_taken = outcome.is_taken && data.holder->address == sender.address;
    if (data.holder->address != sender.address) return outcome;
  }
  const auto alone = make_judge_()->Judge(stream, payload);
  auto* candidate = CandidateFor(state, time, sender, alone);
  if (candidate == nullptr) {
    outcome.is_valid = alone == Verdict::kValid;
    // The decoder goes by intervals too: a mixture of two would pass for another lidar (an HDL-32E).
    if (alone == Verdict::kUndecided) outcome.is_taken = false;
    return outcome;
  }
  const auto verdict = candidate->judge->Judge(stream, payload);
  outcome.is_valid = verdict == Verdict::kValid;
  if (!outcome.is_valid) {
    if (verdict == Verdict::kOther) state.candidate.reset();
    return outcome;
  }
  if (time > candidate->last) candidate->heard_for += std::min<std::chrono::microseconds>(time - candidate->last, kTrialStep);
  candidate->last = time;
  if (state.holder) {
    const std::chrono::microseconds needed = state.holder->address == sender.address ? kPortSilence : kSilence;
    if (time - state.heard < needed || candidate->heard_for < kTrial) return outcome;
  }
  const bool is_other_address = !state.holder || state.holder->address != sender.address;
  state.holder = sender;
  state.judge = std::move(candidate->judge);
  state.heard = time;
  state.candidate.reset();
  if (stream == Stream::kData && is_other_address) {
    auto& position = streams_[static_cast<std::size_t>(Stream::kPosition)];
    if (position.holder && position.holder->address != sender.address) position = {};
  }
  return {.is_taken = true, .is_new_holder = true, .is_valid = true};
}

}  // namespace lookout::lidar
