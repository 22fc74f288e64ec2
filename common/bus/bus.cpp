#include "common/bus/bus.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace lookout::bus {

namespace {

void AddHandlingTime(ChannelTraffic& traffic, std::chrono::steady_clock::duration duration) {
  traffic.total_handling_time += duration;
  if (traffic.handling_times.size() == ChannelTraffic::kMaxTimes) traffic.handling_times.pop_front();
  traffic.handling_times.push_back(std::chrono::duration_cast<std::chrono::microseconds>(duration));
}

}  // namespace

void Bus::Publish(const Channel& channel, std::vector<std::uint8_t> bytes) {
  if (bytes.size() > kMaxMessageBytes) {
    throw std::runtime_error(std::string(channel.name) + ": a message of " + std::to_string(bytes.size()) + " bytes is larger than " +
                             std::to_string(kMaxMessageBytes));
  }
  const auto header = ReadHeader(bytes);  // the bytes may be gone afterwards
  if (!Send(channel, std::move(bytes))) {
    ++num_unsent_;
    return;
  }
  auto entry = outputs_.find(channel.name);
  if (entry == outputs_.end()) entry = outputs_.try_emplace(std::string(channel.name)).first;
  auto& traffic = entry->second;
  ++traffic.num_messages;
  if (!header) return;
  if (traffic.sent.size() == ChannelTraffic::kMaxTimes) traffic.sent.pop_front();
  traffic.sent.push_back({header->utime_us, std::chrono::steady_clock::now()});  // for HEALTH only
}

void Bus::SubscribeRaw(const Channel& channel, RawHandler handler) {
  auto& traffic = inputs_[std::string(channel.name)];  // a map: references stay valid
  Attach(&channel, [&traffic, handler = std::move(handler)](std::string_view name, Bytes bytes) {
    ++traffic.num_messages;
    const auto start = std::chrono::steady_clock::now();  // for HEALTH only
    handler(name, bytes);
    AddHandlingTime(traffic, std::chrono::steady_clock::now() - start);
  });
}

StreamGuard::Time Bus::GuardNow() {
  const auto now = clock_();
  if (last_clock_) guard_now_ += std::clamp<std::chrono::nanoseconds>(now - *last_clock_, std::chrono::nanoseconds(0), kMostUnattended);
  last_clock_ = now;
  return guard_now_;
}

void Bus::ReleaseHeld(bool is_end) {
  if (!is_guarded()) return;
  GuardNow();
  for (const auto& handler : on_release_) handler(is_end);
}

void Bus::SubscribeAll(RawHandler handler) { Attach(nullptr, std::move(handler)); }

}  // namespace lookout::bus
