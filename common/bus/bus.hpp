// The seam between services and LCM. A service cannot tell a live bus from one in memory.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/sequence.hpp"
#include "common/bus/stream_guard.hpp"
#include "common/core/bytes.hpp"

namespace lookout::bus {

/// Traffic of this process on one channel, for HEALTH.
struct ChannelTraffic {
  std::int64_t num_messages = 0;
  std::int64_t num_undecodable = 0;
  std::int64_t num_lost = 0;
  WholeCount scans;                               // scans (of a channel without parts: messages) that came whole, and that did not
  std::int64_t num_refused = 0;                   // messages of a second publisher of the channel
  std::optional<StreamGuard::Time> second_heard;  // Bus::GuardNow() when a second publisher was last heard
  std::chrono::nanoseconds total_handling_time{0};
  std::deque<std::chrono::microseconds> handling_times;  // of the latest messages, at most kMaxTimes

  /// A message that was sent: time of its measurement, and when it went out.
  struct Sent {
    std::int64_t utime_us = 0;
    std::chrono::steady_clock::time_point time;
  };
  std::deque<Sent> sent;  // the latest, at most kMaxTimes

  static constexpr std::size_t kMaxTimes = 1000;
};

class Bus {
 public:
  using RawHandler = std::function<void(std::string_view channel, Bytes bytes)>;

  Bus() = default;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  virtual ~Bus() = default;

  /// Sends bytes. A transport that fails (no route, no buffer) does not end a look-out: the message is lost and counted.
  /// @throws std::runtime_error when the message is larger than the transport carries
  void Publish(const Channel& channel, std::vector<std::uint8_t> bytes);

  /// Messages that the transport did not take.
  std::int64_t num_unsent() const { return num_unsent_; }

  /// Calls `handler` for each message on `channel`. Handlers run inside HandleOnce, one at a time.
  void SubscribeRaw(const Channel& channel, RawHandler handler);

  /// Calls `handler` for each message on any channel, also unknown ones.
  void SubscribeAll(RawHandler handler);

  /// From now on typed subscriptions keep to the publisher of a channel that they heard first, and refuse a second one (StreamGuard). For a live bus:
  /// in a replay each channel has one publisher, or its reader has seen to it.
  ///
  /// @param clock  any that goes forward
  void GuardStreams(std::function<std::chrono::nanoseconds()> clock) { clock_ = std::move(clock); }
  bool is_guarded() const { return clock_ != nullptr; }

  /// Time for which this process has looked after its bus: a stop of the process shows in it as kMostUnattended at most, so that a publisher whose
  /// messages wait does not count as silent. Precondition: is_guarded().
  StreamGuard::Time GuardNow();

  /// Calls `handler` each time that ReleaseHeld is called.
  void OnRelease(std::function<void(bool is_end)> handler) { on_release_.push_back(std::move(handler)); }

  /// Hands out held messages that turn out to belong to the kept publisher. Must be called some ten times a second.
  ///
  /// @param is_end  no further message will come
  /// @throws exceptions of a handler
  void ReleaseHeld(bool is_end = false);

  static constexpr std::chrono::milliseconds kMostUnattended{250};

  /// Waits at most `timeout` for a message and handles it.
  ///
  /// @return whether a message was handled
  /// @throws what a handler threw, after the transport has let go of the message
  virtual bool HandleOnce(std::chrono::milliseconds timeout) = 0;

  std::map<std::string, ChannelTraffic, std::less<>>& input_traffic() { return inputs_; }
  std::map<std::string, ChannelTraffic, std::less<>>& output_traffic() { return outputs_; }

  /// Messages waiting on a subscribed channel; -1 = not known.
  virtual int QueueDepth(std::string_view channel) const = 0;

  /// Datagrams that the kernel did not hand over: refused at the socket, or without room in its buffer (it counts both as one). nullopt = not known.
  virtual std::optional<std::int64_t> NumDatagramsDropped() const { return std::nullopt; }

  /// Why anybody's datagram could end this process; empty where none can.
  virtual std::string GuardFault() const { return {}; }

 protected:
  /// @return whether the transport took the message
  virtual bool Send(const Channel& channel, std::vector<std::uint8_t>&& bytes) = 0;
  /// `channel` is nullptr for all channels.
  virtual void Attach(const Channel* channel, RawHandler handler) = 0;

 private:
  std::map<std::string, ChannelTraffic, std::less<>> inputs_;
  std::map<std::string, ChannelTraffic, std::less<>> outputs_;
  std::int64_t num_unsent_ = 0;
  std::function<std::chrono::nanoseconds()> clock_;
  std::optional<std::chrono::nanoseconds> last_clock_;
  StreamGuard::Time guard_now_{0};
  std::vector<std::function<void(bool)>> on_release_;
};

/// Hands the messages of one channel on: those of the publisher that was heard first, in their order.
template <typename T, typename Handler>
class StreamReceiver {
 public:
  StreamReceiver(Bus& bus, const Channel& channel, Handler handler)
      : bus_(bus),
        is_guarded_(IsGuarded(channel)),
        is_numbered_(!HasSeveralPublishers(channel)),
        guard_(channel),
        handler_(std::move(handler)),
        traffic_(bus.input_traffic()[std::string(channel.name)]) {}  // a map: references stay valid

  void Take(Bytes bytes) {
    auto message = Decode<T>(bytes);
    if (!message) {
      ++traffic_.num_undecodable;
      return;
    }
    if (!is_guarded_ || !bus_.is_guarded()) {
      if (is_numbered_) CountLost(*message);
      HandOut(*message, bytes);
      return;
    }
    const auto now = bus_.GuardNow();
    const auto place = PlaceOf(*message, bytes);
    const auto decision = guard_.Next(place, now);
    traffic_.num_lost += decision.num_lost;
    if (decision.held == StreamGuard::Held::kTake) HandleHeld();
    if (decision.held == StreamGuard::Held::kRefuse) ClearHeld();
    if (decision.act == StreamGuard::Act::kHold) Hold(std::move(*message), bytes.size(), now);
    NoteRefused(now);
    if (decision.act != StreamGuard::Act::kTake) return;
    traffic_.scans.Note(place.seq, place.part_index, place.num_parts, decision.num_lost);
    HandOut(*message, bytes);
  }

  void Release(bool is_end) {
    if (held_.empty()) return;
    const auto now = bus_.GuardNow();
    const auto num_lost = is_end ? guard_.ReleaseAtEnd() : guard_.Release(now);
    if (!num_lost) return;
    traffic_.num_lost += *num_lost;
    HandleHeld();
  }

 private:
  // Some ten seconds of the busiest channel, or a second of the largest messages.
  static constexpr std::size_t kMaxHeld = 5000;
  static constexpr std::size_t kMaxHeldBytes = 32'000'000;

  struct HeldMessage {
    T message;
    std::size_t num_bytes;
  };

  static constexpr bool kWantsBytes = std::is_invocable_v<Handler, const T&, Bytes>;

  void HandOut(const T& message, Bytes bytes) {
    if constexpr (kWantsBytes) {
      handler_(message, bytes);
    } else {
      handler_(message);
    }
  }
  void CountLost(const T& message) {
    if constexpr (requires { message.part_index; }) {
      traffic_.num_lost += sequence_.NumLostBefore(message.seq, message.part_index, message.num_parts);
    } else {
      traffic_.num_lost += sequence_.NumLostBefore(message.seq);
    }
  }
  void Hold(T&& message, std::size_t num_bytes, StreamGuard::Time now) {
    held_.push_back({std::move(message), num_bytes});
    num_held_bytes_ += num_bytes;
    while (held_.size() > kMaxHeld || num_held_bytes_ > kMaxHeldBytes) {
      num_held_bytes_ -= held_.front().num_bytes;
      held_.pop_front();
      guard_.RefuseOldestHeld(now);
    }
  }
  void HandleHeld() {
    const auto held = std::move(held_);
    ClearHeld();
    for (const auto& entry : held) {
      if constexpr (kWantsBytes) {
        HandOut(entry.message, Encode(entry.message));
      } else {
        handler_(entry.message);
      }
    }
  }
  void ClearHeld() {
    held_.clear();
    num_held_bytes_ = 0;
  }
  void NoteRefused(StreamGuard::Time now) {
    traffic_.num_refused = guard_.num_refused();
    if (guard_.HasSecond(now, StreamGuard::Time(1))) traffic_.second_heard = now;
  }

  Bus& bus_;
  bool is_guarded_;
  bool is_numbered_;  // by one publisher
  StreamGuard guard_;
  SequenceWatch sequence_;  // of a bus that is not guarded
  Handler handler_;
  ChannelTraffic& traffic_;
  std::deque<HeldMessage> held_;
  std::size_t num_held_bytes_ = 0;
};

/// Sends a message, encoded.
template <typename T>
void Publish(Bus& bus, const Channel& channel, const T& message) {
  bus.Publish(channel, Encode(message));
}

/// Calls `handler` for each message on `channel` that decodes to T; the others are counted. Gaps in seq are counted. On a bus that is guarded those
/// of a second publisher are refused and counted, and a new start of the publisher is handed out up to a second late. A handler that takes Bytes as
/// well gets the message as it was on the bus, too.
template <typename T, typename Handler>
void Subscribe(Bus& bus, const Channel& channel, Handler handler) {
  auto receiver = std::make_shared<StreamReceiver<T, Handler>>(bus, channel, std::move(handler));
  bus.SubscribeRaw(channel, [receiver](std::string_view, Bytes bytes) { receiver->Take(bytes); });
  bus.OnRelease([receiver](bool is_end) { receiver->Release(is_end); });
}

}  // namespace lookout::bus
