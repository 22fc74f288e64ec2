#include "tools/replay/one_publisher.hpp"

#include <utility>

namespace lookout::replay {

namespace {

// Some twenty seconds of a boat's log. Beyond it the first held message is given up.
constexpr std::size_t kMaxBytes = 64'000'000;

}  // namespace

void OnePublisher::Add(std::int64_t event, Utime time, const bus::Channel& channel, Bytes bytes) {
  const auto now = time.time_since_epoch();
  for (auto& [name, guard] : publishers_.guards()) {
    if (name != channel.name && guard.Release(now)) Resolve(name, State::kTaken);
  }
  State state = State::kTaken;
  if (const auto decision = publishers_.Add(event, time, channel.name, bytes)) {
    if (decision->held == bus::StreamGuard::Held::kTake) Resolve(channel.name, State::kTaken);
    if (decision->held == bus::StreamGuard::Held::kRefuse) Resolve(channel.name, State::kRefused);
    if (decision->act == bus::StreamGuard::Act::kHold) state = State::kHeld;
    if (decision->act == bus::StreamGuard::Act::kRefuse) state = State::kRefused;
  }
  HandOn();
  if (state == State::kRefused) return;
  if (waiting_.empty() && state == State::kTaken) {
    take_(time, channel, bytes);
    return;
  }
  waiting_.push_back({time, &channel, {bytes.begin(), bytes.end()}, state});
  num_bytes_ += bytes.size();
  while (num_bytes_ > kMaxBytes) {
    auto& oldest = waiting_.front();  // the guard holds this message, or it would not wait
    oldest.state = State::kRefused;
    publishers_.guards().find(oldest.channel->name)->second.RefuseOldestHeld(now);
    HandOn();
  }
}

void OnePublisher::Finish() {
  for (auto& [name, guard] : publishers_.guards()) {
    if (guard.ReleaseAtEnd()) Resolve(name, State::kTaken);
  }
  HandOn();
}

void OnePublisher::Resolve(std::string_view channel, State state) {
  for (auto& event : waiting_) {
    if (event.state == State::kHeld && event.channel->name == channel) event.state = state;
  }
}

void OnePublisher::HandOn() {
  while (!waiting_.empty() && waiting_.front().state != State::kHeld) {
    const auto event = std::move(waiting_.front());
    waiting_.pop_front();
    num_bytes_ -= event.bytes.size();
    if (event.state == State::kTaken) take_(event.time, *event.channel, event.bytes);
  }
}

std::int64_t OnePublisher::num_left_out() const {
  std::int64_t num_left_out = 0;
  for (const auto& [name, guard] : publishers_.guards()) num_left_out += guard.num_refused();
  return num_left_out;
}

}  // namespace lookout::replay
