// Where a service reads besides the bus: a socket, a device, an interface.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"

namespace lookout::io {

class Source {
 public:
  enum class Kind {
    kDatagram,  // whole, as it was sent
    kStream,    // a stretch of a stream, cut anywhere
    kBreak,     // no bytes: the stream before and the stream after do not belong together
  };
  struct Piece {
    Utime host_time;  // of the arrival; a datagram's is the kernel's stamp
    Bytes bytes;      // until the next call of Receive()
    Kind kind = Kind::kDatagram;
    int port = 0;                     // of a datagram: the UDP port it was sent to
    std::string source_address = {};  // of a datagram: numeric, without zone
    int source_port = 0;
    std::string destination_address = {};  // of a datagram out of a frame: numeric; empty where it is not known
  };

  Source() = default;
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  /// Readable while something waits; the same number for the life of the source; -1: there is none.
  virtual int file_descriptor() const { return -1; }

  /// Must be called every 5 to 10 ms: opens closed sockets and devices, follows an interface that goes and comes.
  ///
  /// @return changes since the last call, for the log; empty = none
  virtual std::string Poll(Utime now) = 0;

  /// Never waits.
  ///
  /// @return the next piece that waits; nullopt when none does, and after a bounded number of refused ones: is_empty() says which
  virtual std::optional<Piece> Receive(Utime now) = 0;

  /// The last Receive() left nothing behind.
  virtual bool is_empty() const { return true; }

  /// Kernel stamp of the last datagram read, refused or not: all that came before it has been read. 1970 before the first.
  virtual Utime last_time() const { return {}; }

  /// Why nothing can be received now; empty = nothing is known to be wrong.
  virtual std::string fault() const { return {}; }

  virtual std::vector<Counter> counters() = 0;
};

}  // namespace lookout::io
