// The seam between services and LCM. A service cannot tell a live bus from one in memory.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/header.hpp"
#include "common/bus/sequence.hpp"
#include "common/core/bytes.hpp"

namespace lookout::bus {

/// Traffic of this process on one channel, for HEALTH.
struct ChannelTraffic {
  std::int64_t num_messages = 0;
  std::int64_t num_undecodable = 0;
  std::int64_t num_lost = 0;
  std::chrono::nanoseconds total_handling_time{0};
  std::deque<std::chrono::microseconds> handling_times;  // of the latest messages, at most kMaxTimes

  /// A message that was sent: the time of its measurement, and when it went out.
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
  void Publish(const Channel& channel, Bytes bytes);
  /// The same for bytes that the caller needs no more.
  void Publish(const Channel& channel, std::vector<std::uint8_t>&& bytes);

  /// Messages that the transport did not take.
  std::int64_t num_unsent() const { return num_unsent_; }

  /// Calls `handler` for each message on `channel`. Handlers run inside HandleOnce, one at a time.
  void SubscribeRaw(const Channel& channel, RawHandler handler);

  /// Calls `handler` for each message on any channel, also unknown ones.
  void SubscribeAll(RawHandler handler);

  /// Waits at most `timeout` for a message and handles it.
  ///
  /// @return whether a message was handled
  /// @throws what a handler threw, after the transport has let go of the message
  virtual bool HandleOnce(std::chrono::milliseconds timeout) = 0;

  const std::map<std::string, ChannelTraffic, std::less<>>& input_traffic() const { return inputs_; }
  const std::map<std::string, ChannelTraffic, std::less<>>& output_traffic() const { return outputs_; }
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
  virtual bool Send(const Channel& channel, Bytes bytes) = 0;
  /// The same; a transport that holds messages may keep the bytes.
  virtual bool SendOwned(const Channel& channel, std::vector<std::uint8_t>&& bytes) { return Send(channel, bytes); }
  /// `channel` is nullptr for all channels.
  virtual void Attach(const Channel* channel, RawHandler handler) = 0;

 private:
  void NoteSent(const Channel& channel, std::optional<MessageHeader> header, bool was_taken);

  std::map<std::string, ChannelTraffic, std::less<>> inputs_;
  std::map<std::string, ChannelTraffic, std::less<>> outputs_;
  std::int64_t num_unsent_ = 0;
};

/// Sends a message, encoded.
template <typename T>
void Publish(Bus& bus, const Channel& channel, const T& message) {
  bus.Publish(channel, Encode(message));
}

/// Calls `handler` for each message on `channel` that decodes to T; the others are counted. Gaps in seq are counted.
template <typename T, typename Handler>
void Subscribe(Bus& bus, const Channel& channel, Handler handler) {
  auto& traffic = bus.input_traffic()[std::string(channel.name)];
  bus.SubscribeRaw(channel, [&traffic, handler = std::move(handler), sequence = SequenceWatch{}](std::string_view, Bytes bytes) mutable {
    const auto message = Decode<T>(bytes);
    if (!message) {
      ++traffic.num_undecodable;
      return;
    }
    if constexpr (requires { message->part_index; }) {
      traffic.num_lost += sequence.NumLostBefore(message->seq, message->part_index, message->num_parts);
    } else if constexpr (requires { message->seq; }) {
      traffic.num_lost += sequence.NumLostBefore(message->seq);
    }
    handler(*message);
  });
}

}  // namespace lookout::bus
