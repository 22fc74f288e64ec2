// How far a long run is, for people: on a terminal one line that is written over, elsewhere a line a minute.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <string>

namespace lookout::runtime {

/// For tools that tell how far they are to people alone, and nothing to what reads their standard error.
///
/// @return `out` where it is a terminal; else nullptr, with which Progress is silent
std::FILE* OnlyTerminal(std::FILE* out);

class Progress {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param program  stands in front of each line: "replay"
  /// @param out      stays open and outlives this; nullptr: silent
  Progress(std::string program, std::FILE* out);

  /// @param as_on_terminal  also where `out` is none
  /// @param line_period     from line to line where it is not as on a terminal
  /// @param now             the time: tests bring their own
  Progress(std::string program, std::FILE* out, bool as_on_terminal, std::chrono::milliseconds line_period = std::chrono::minutes(1),
           std::function<Clock::time_point()> now = Clock::now);

  /// Leaves no trace on a terminal.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// To be called at each step, however short (it reads the clock) or long: says no more often than is useful what part is done and how long the rest
  /// will take at the speed so far.
  ///
  /// @param share   done so far, 0 to 1
  /// @param remark  asked for when a line is made; stands between the part and the time left: "80 times real time"
  void Update(double share, const std::function<std::string()>& remark = nullptr);

  /// Takes the line away: before something else is written to the terminal. It comes again with the next Update that says something.
  void Clear();

 private:
  std::size_t Columns() const;
  void Show(std::string line);

  std::string program_;
  std::FILE* out_;
  bool is_terminal_;
  Clock::duration period_;
  std::function<Clock::time_point()> now_;
  std::size_t num_shown_ = 0;  // characters of the line on the terminal
  Clock::time_point start_;
  Clock::time_point next_;
};

}  // namespace lookout::runtime
