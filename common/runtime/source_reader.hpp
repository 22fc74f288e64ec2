// The sources that a service reads besides the bus, as part of its main loop.
#pragma once

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "common/io/source.hpp"
#include "common/runtime/process.hpp"

namespace lookout::runtime {

class SourceReader {
 public:
  explicit SourceReader(std::chrono::milliseconds period) : period_(period) {}
  virtual ~SourceReader() = default;
  SourceReader(const SourceReader&) = delete;
  SourceReader& operator=(const SourceReader&) = delete;

  std::chrono::milliseconds period() const { return period_; }

  /// Must be called once per period: reads waiting or due bytes, for a bounded time, and passes them to the service.
  ///
  /// @return false when all has been read, and nothing will follow
  virtual bool Read() = 0;

  /// Before the first Read(): sources that are to be read as soon as they are readable, too.
  virtual void WatchReadable(Process&) {}

  /// Time of the clock that stamps the bytes: the computer's, or a recording's.
  virtual Utime Now() const { return HostNow(); }

  virtual std::string fault() const = 0;
  virtual std::vector<Counter> counters() const = 0;

 private:
  std::chrono::milliseconds period_;
};

/// Sources of the present, read one after another.
class LiveReader final : public SourceReader {
 public:
  struct NamedSource {
    std::string name;  // in log and HEALTH: "input 'gnss': ..."; empty where the source names itself
    std::unique_ptr<io::Source> source;
  };
  /// How long one source may be read before signals, the bus, timers and the other sources get their turn.
  struct Limits {
    std::chrono::milliseconds period;
    int max_pieces = std::numeric_limits<int>::max();
    std::chrono::milliseconds max_time = std::chrono::hours(1);
    bool reads_when_readable = false;  // else once per period alone
  };
  /// Host times of one Read() of all sources.
  struct Round {
    Utime start;
    Utime latest;       // the later one of start and the arrival of the last piece
    Utime read_before;  // every piece that arrived before this has been read; start, or earlier when a limit cut the round short
  };
  struct Handlers {
    std::function<void(const std::string& name, const io::Source::Piece&)> on_piece;
    std::function<void(const Round&)> on_round;  // after the pieces
  };

  LiveReader(std::vector<NamedSource> sources, const Limits& limits, Handlers handlers);

  bool Read() override;
  void WatchReadable(Process& process) override;
  std::string fault() const override;  // each different one once

  /// Those of the same name are added up.
  std::vector<Counter> counters() const override;

 private:
  Utime ReadOne(NamedSource& source);

  std::vector<NamedSource> sources_;
  Limits limits_;
  Handlers handlers_;
};

/// Runs `process` with the sources: their counters and fault are in HEALTH, before what `report` says; the run ends when all has been read.
///
/// @param sources  nullptr: the service reads the bus alone
/// @return the time of the end, by the clock of the sources
Utime RunSources(Process& process, SourceReader* sources, const std::function<HealthReport()>& report);

}  // namespace lookout::runtime
