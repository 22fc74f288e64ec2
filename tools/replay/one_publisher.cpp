#include "tools/replay/one_publisher.hpp"

#include <chrono>
#include <utility>

namespace lookout::replay {

namespace {

// Some twenty seconds of a boat's log. Beyond it what is held first is given up.
constexpr std::size_t kMaxBytes = 64'000'000;

bus::StreamGuard::Time GuardTime(Utime time) { return time.time_since_epoch(); }

}  // namespace

void OnePublisher::Add(std::int64_t event, Utime time, const bus::Channel& channel, Bytes bytes) {
  const auto now = GuardTime(time);
  for (auto& [name, guard] : guards_) {
    if (name != channel.name && guard.Release(now)) Resolve(*bus::FindChannel(name), State::kTaken);
  }
  State state = State::kTaken;
  const auto place = bus::IsGuarded(channel) ? bus::PlaceOf(channel, bytes) : std::nullopt;
  if (place) {
    auto& guard = guards_.try_emplace(channel.name, channel).first->second;
    const auto decision = guard.Next(*place, now, event);
    if (decision.held == bus::StreamGuard::Held::kTake) Resolve(channel, State::kTaken);
    if (decision.held == bus::StreamGuard::Held::kRefuse) Resolve(channel, State::kRefused);
    if (decision.act == bus::StreamGuard::Act::kHold) state = State::kHeld;
    if (decision.act == bus::StreamGuard::Act::kRefuse) state = State::kRefused;
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
    auto& oldest = waiting_.front();  // is held, or it would not wait
    oldest.state = State::kRefused;
    guards_.at(oldest.channel->name).RefuseOldestHeld(now);
    HandOn();
  }
}

void OnePublisher::Finish() {
  for (auto& [name, guard] : guards_) {
    if (guard.ReleaseAtEnd()) Resolve(*bus::FindChannel(name), State::kTaken);
  }
  HandOn();
}

void OnePublisher::Resolve(const bus::Channel& channel, State state) {
  for (auto& event : waiting_) {
    if (event.state == State::kHeld && event.channel->name == channel.name) event.state = state;
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

std::vector<OnePublisher::Interleaving> OnePublisher::Interleavings() const {
  std::vector<Interleaving> interleavings;
  for (const auto& [name, guard] : guards_) {
    const auto& first = guard.first_interleaving();
    if (!first) continue;
    interleavings.push_back({name, first->mark, Utime(std::chrono::duration_cast<std::chrono::microseconds>(first->time)), guard.num_refused()});
  }
  return interleavings;
}

std::int64_t OnePublisher::num_left_out() const {
  std::int64_t num_left_out = 0;
  for (const auto& [name, guard] : guards_) num_left_out += guard.num_refused();
  return num_left_out;
}

}  // namespace lookout::replay
