// Keeps the events of a log to one publisher a channel, in their order.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "tools/log/publishers.hpp"

namespace lookout::replay {

/// Where a channel has two publishers at a time the messages of the second are left out, as the live processes did; messages of a publisher that
/// starts anew are handed on. Which of the two cases it is shows up to 1 s later: events wait until then, and none overtakes another.
class OnePublisher {
 public:
  using Take = std::function<void(Utime time, const bus::Channel& channel, Bytes bytes)>;

  explicit OnePublisher(Take take) : take_(std::move(take)) {}

  /// @param event  its number, for Interleavings
  void Add(std::int64_t event, Utime time, const bus::Channel& channel, Bytes bytes);

  /// End of the input: waiting messages are handed on.
  void Finish();

  /// Channels with two publishers, in the order in which the second was first heard.
  std::vector<log::Interleaving> Interleavings() const { return publishers_.Interleavings(); }

  /// Lone messages whose number does not fit were left out, too.
  std::int64_t num_left_out() const;

 private:
  enum class State { kTaken, kHeld, kRefused };
  struct Waiting {
    Utime time;
    const bus::Channel* channel;
    std::vector<std::uint8_t> bytes;
    State state;
  };

  void Resolve(std::string_view channel, State state);
  void HandOn();

  Take take_;
  log::Publishers publishers_;
  std::deque<Waiting> waiting_;
  std::size_t num_bytes_ = 0;
};

}  // namespace lookout::replay
