// A way out of this computer: a socket, a device.
#pragma once

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

  /// Sends one whole message (a line or a text, as it is to go out) to whoever listens. Never waits. A receiver that takes less than it is sent is
  /// dropped once its buffer is full; what nobody takes is counted.
  virtual void Send(std::string_view message) = 0;

  /// What came in, whole: lines without CR LF of a stream, datagrams, texts of a WebSocket. At most a bounded number waits; the rest is counted.
  virtual std::optional<std::string> Receive() { return std::nullopt; }

  /// Bytes that may be sent now without falling behind: of a serial port by its speed; of a connection what its buffer here still takes, of several
  /// clients that of the quickest; over UDP what a receiver's buffer takes at once.
  virtual std::size_t room_bytes() const = 0;

  /// Counts a message that was not made since nobody could be sent to.
  virtual void NoteUnsent() {}

  /// Whether anybody can be sent to.
  virtual bool is_open() const = 0;

  /// Goes up with each new receiver (connection, client, port opened again): it knows nothing of what was sent before.
  virtual std::int64_t num_openings() const = 0;

  /// Why nothing can be sent now; empty = nothing is known to be wrong (a server without clients is no fault).
  virtual std::string fault() const = 0;

  /// What is worth a line in the journal and no fault of this computer: nobody listens where UDP is sent; empty = nothing.
  virtual std::string remark() const { return {}; }

  virtual std::vector<Counter> counters() const = 0;
};

}  // namespace lookout::plotter
