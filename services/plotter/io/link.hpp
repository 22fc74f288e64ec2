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

  /// The next received message, complete: a line of a stream without CR LF, a datagram, a text of a WebSocket; of a binary stream a piece, as it
  /// came. At most a bounded number of messages waits; further messages are counted.
  virtual std::optional<std::string> Receive() { return std::nullopt; }

  /// Bytes that may be sent now without falling behind: on a serial port by its speed; on a connection the free room of its buffer in this process
  /// (with several clients the quickest one's); over UDP the bytes that a receiver's buffer holds at once.
  virtual std::size_t room_bytes() const = 0;

  /// Time until a message that is sent now begins to leave: on a serial port the time for its unsent bytes; 0 where it is not known.
  virtual std::chrono::microseconds delay() const { return std::chrono::microseconds(0); }

  /// Counts a message that was not made as it could be sent to nobody.
  virtual void NoteUnsent() {}

  /// Whether a message can be sent to anybody.
  virtual bool is_open() const = 0;

  /// Goes up with each new receiver (connection, client, port opened again): such a receiver knows nothing of earlier messages.
  virtual std::int64_t num_openings() const = 0;

  /// Why nothing can be sent now; empty = nothing is known to be wrong (a server without clients is no fault).
  virtual std::string fault() const = 0;

  /// A line for the journal that is no fault of this computer: nobody listens where UDP is sent; empty = none.
  virtual std::string remark() const { return {}; }

  virtual std::vector<Counter> counters() const = 0;
};

}  // namespace lookout::plotter
