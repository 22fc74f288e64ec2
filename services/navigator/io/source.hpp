// Where sentences come from: what main asks of every source.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"

namespace lookout::navigator {

class Source {
 public:
  struct Piece {
    Utime host_time;           // of the arrival
    Bytes bytes;               // until the next call of Receive()
    bool is_datagram = false;  // whole lines; else a stretch of a stream
  };

  Source() = default;
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  /// Readable while something waits; the same number for the life of the source; -1 = it gives by time alone.
  virtual int file_descriptor() const = 0;

  /// To be called often, about every 10 ms: opens what is closed, as far as it is time to.
  virtual void Poll(Utime now) = 0;

  /// @return what waits; nullopt when nothing does. Never waits itself.
  virtual std::optional<Piece> Receive(Utime now) = 0;

  /// How often it broke off: what came before and what comes after do not belong together.
  virtual std::int64_t num_lost() const { return 0; }

  /// Why it gives nothing; empty = nothing is known to be wrong.
  virtual std::string fault() const { return {}; }

  virtual std::vector<Counter> counters() { return {}; }
};

}  // namespace lookout::navigator
