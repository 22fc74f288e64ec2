// Makes text out of the messages of a log.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/core/bytes.hpp"

namespace lookout::exporter {

enum class Taken {
  kOk,
  kUndecodable,   // not a whole message of the channel's type
  kInconsistent,  // the message was decoded, but its counts or times contradict each other
};

class Sink {
 public:
  virtual ~Sink() = default;

  /// Channels that it reads; the first is the one that must be there.
  virtual std::vector<bus::Channel> Channels() const = 0;

  /// Takes a message of one of its channels, in the order of the log, and appends its output to `text`.
  virtual Taken Take(std::string_view channel, Bytes bytes, std::string& text) = 0;

  /// Whether messages of one of its channels are taken whatever part of the log is asked for.
  virtual bool IsWantedAtAnyTime(std::string_view /*channel*/) const { return false; }

  /// End of the input: appends the rest.
  virtual void Finish(std::string& text) = 0;

  /// After that: what takes the place of the first bytes of its output; empty: they stay.
  virtual std::string Head() const { return {}; }

  /// Whether later messages cannot change the result.
  virtual bool IsDone() const { return false; }

  /// Lines for people about unexpected input.
  virtual std::vector<std::string> Remarks() const { return {}; }
};

}  // namespace lookout::exporter
