// Files of sentences, played at the pace and by the times of their sentences.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/navigator/io/text_log_reader.hpp"

namespace lookout::navigator {

/// Plays the lines of one text log, or of several in the order of their times, each at the time that the log says. The clock of the computer decides
/// when a line is played, and nothing else: at whatever speed the same calls are made, but for calls of advance_to between two lines.
class TextLogPlayer {
 public:
  /// A longer silence in the log, and a time that runs back, are not waited for.
  static constexpr std::chrono::seconds kMaxPause{60};
  /// Stretch of the log that one call of Play reads at most: POSE of a longer stretch at once would not pass the bus.
  static constexpr std::chrono::seconds kMaxRound{1};

  struct Log {
    std::string name;  // of the input
    std::filesystem::path file;
    std::optional<std::chrono::sys_days> day;  // as in TextLogReader
  };

  struct Taker {
    std::function<void(Utime log_time)> advance_to;  // called before each line, and in between while the next line is not due
    std::function<void(Utime log_time, Bytes line, const std::string& name)> take_line;
  };

  /// @param speed  times as fast as the sentences say; 0 = a call of Play after the other
  /// @throws std::runtime_error as TextLogReader
  TextLogPlayer(const std::vector<Log>& logs, double speed);

  /// Plays the due lines.
  void Play(std::chrono::steady_clock::time_point now, const Taker& taker);

  bool is_finished() const { return !next_; }

  /// Times of the first line of all logs, and of the line played last: UTC as the logs say.
  Utime start() const { return start_; }
  Utime time() const { return time_; }

  /// Logs in which no sentence holds a date, and for which the config has none.
  std::vector<std::string> dateless() const;

  /// Why a log was not read to its end (what gzip packed is cut short); empty: all were, as far as they are played.
  std::string fault() const;

  std::vector<Counter> counters() const;

 private:
  struct Reading {
    Log log;
    TextLogReader reader;
    std::optional<TextLogReader::Line> line;  // read, and not played yet
    std::string counter;
    std::string other_rows_counter;
    std::string without_time_counter;
    std::int64_t num_lines = 0;
  };
  void FindNext();

  double speed_;
  std::vector<Reading> readings_;
  std::optional<std::size_t> next_;  // whose line is next
  Utime start_{};
  Utime time_{};
  std::optional<std::chrono::steady_clock::time_point> due_;  // of the next line
};

}  // namespace lookout::navigator
