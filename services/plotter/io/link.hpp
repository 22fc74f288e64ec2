// A way out of this computer: a socket, a device.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/health.hpp"

namespace lookout::plotter {

class Link {
 public:
  Link() = default;
  virtual ~Link() = default;
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// Sends one whole message (a line or a text, as it is to go out) to all listeners. Never waits. A receiver that takes less than it is sent is
  /// dropped once its buffer is full; a message without a receiver is counted.
  virtual void Send(std::string_view message) = 0;

  /// Received messages, complete: lines without CR LF of a stream, datagrams, texts of a WebSocket; of a binary stream pieces, as they come. At most
  /// a bounded number waits; the rest is counted.
  virtual std::optional<std::string> Receive() { return std::nullopt; }

  /// Bytes that may be sent now without falling behind: of a serial port by its speed; of a connection the free room of its buffer here, of several
  /// clients that of the quickest; over UDP the bytes that a receiver's buffer takes at once.
  virtual std::size_t room_bytes() const = 0;

  /// After which a message that is sent now begins to leave: of a serial port the time that its unsent bytes take; 0 where nothing tells.
  virtual std::chrono::microseconds delay() const { return std::chrono::microseconds(0); }

  /// Counts a message that was not made since nobody could be sent to.
  virtual void NoteUnsent() {}

  /// Whether anybody can be sent to.
  virtual bool is_open() const = 0;

  /// Goes up with each new receiver (connection, client, port opened again): it knows nothing of earlier messages.
  virtual std::int64_t num_openings() const = 0;

  /// Why nothing can be sent now; empty = nothing is known to be wrong (a server without clients is no fault).
  virtual std::string fault() const = 0;

  /// A line for the journal that is no fault of this computer: nobody listens where UDP is sent; empty = none.
  virtual std::string remark() const { return {}; }

  virtual std::vector<Counter> counters() const = 0;
};

}  // namespace lookout::plotter
