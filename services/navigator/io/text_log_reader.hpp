// Text logs of NMEA 0183 sentences: a line each, as receivers and plotters write them, with the times that the sentences say; or a row of CSV each,
// with the times of the rows. As they are, packed by gzip, or in UTF-16.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "common/io/text_file.hpp"
#include "services/navigator/core/csv_recording.hpp"
#include "services/navigator/core/time_zone.hpp"

namespace lookout::navigator {

/// Whether a file is a text log: in its first MB, behind zero bytes at its start, stands a sentence whose checksum is right; or it is text, but for
/// one byte in ten at most, with something that begins as a sentence does; or it begins with the head of a CSV recording.
///
/// Bytes between the sentences do not matter: a byte order mark, notes in any coding, tag blocks, binary messages of the receiver. A gzip file is a
/// text log if its content is one, but never where that begins as a capture or an lcm-log.
/// @throws std::runtime_error when it cannot be read
bool IsTextLog(const std::filesystem::path& file);

class TextLogReader {
 public:
  /// A sentence that is older than the one before it by no more than this came late, as happens with several talkers on one line: it takes the time
  /// of the sentence before. A sentence that runs back further begins anew.
  static constexpr std::chrono::seconds kMaxLate{10};

  /// A date that is a step from the dates before counts where at least half of the kDatesCompared dates from it on agree with it. A wrong date is
  /// left out.
  static constexpr int kDatesCompared = 16;
  /// So many local times in a row, and nothing that says more of time: then they count.
  static constexpr int kMostLocal = 100;
  /// Between two sentences farther apart the log was not written.
  static constexpr std::chrono::minutes kMostPause{10};

  /// Reads the file once as far as its first dates.
  ///
  /// @param day  of the first time in the file, for a file in which no sentence tells a date
  /// @throws std::runtime_error when it cannot be read, or no sentence (of a CSV recording: no row with a sentence) in it tells a time
  explicit TextLogReader(const std::filesystem::path& file, std::optional<std::chrono::sys_days> day = {});

  /// Whether the file begins with the head of a CSV recording, or a row of one. @throws std::runtime_error when it cannot be read
  static bool IsCsvRecording(const std::filesystem::path& file);

  struct Line {
    Utime time;   // UTC of the sentence, or of its row; without one, UTC of the line before; before any UTC, the first that follows
    Bytes bytes;  // the line without its end, or the message of a row; valid until the next call
  };

  /// @return the next line that is not empty, whatever it holds; nullopt at the end. CR, LF or both end a line, and a checksum with another sentence
  ///         behind it; of a line that is longer than kMaxLineBytes only the last part is returned. In a CSV recording: the next row with a sentence.
  std::optional<Line> Next();
  static constexpr std::size_t kMaxLineBytes = 4096;

  /// The file is a CSV recording whose rows tell the time.
  bool is_csv() const { return columns_.has_value(); }

  /// Rows of a CSV recording that were left out: NMEA 2000, Signal K; and rows without a time, which get the time of the row before.
  std::int64_t num_other_rows() const { return num_other_rows_; }
  std::int64_t num_rows_without_time() const { return num_rows_without_time_; }

  /// Why reading ended before the end of the file (what gzip packed is cut short); empty: it did not.
  const std::string& fault() const { return in_.fault(); }

  /// False: no sentence of the file holds a date; times are on the given day, or on 1970-01-01.
  bool has_date() const { return has_date_; }

  /// Bytes read so far.
  std::int64_t position() const { return in_.position_bytes(); }

 private:
  struct Opened {};
  TextLogReader(const std::filesystem::path& file, Opened only);
  bool ReadLine();
  void FindColumns();
  bool ReadRow();
  std::optional<Sentence> WithTime(const std::optional<Sentence>& sentence);
  void UseTime(std::chrono::microseconds of_day, std::optional<std::chrono::sys_days> date);
  std::optional<Utime> FindFirstTime(std::optional<std::chrono::sys_days> day);
  // Reads on, line by line, while `look` returns true, and then goes back to where it was.
  void LookAhead(const std::function<bool()>& look);
  bool IsPause();
  bool IsStepRight(std::chrono::sys_days date, std::chrono::microseconds of_day);
  bool FindFirstRow(const std::filesystem::path& file);
  std::optional<Line> NextRow();

  io::TextFile in_;
  std::string line_;
  std::optional<CsvColumns> columns_;
  CsvRow row_;
  std::int64_t num_other_rows_ = 0;
  std::int64_t num_rows_without_time_ = 0;
  bool has_date_ = false;
  TimeZoneCheck time_zone_;
  int num_local_ = 0;                                // in a row
  bool has_other_zone_ = false;                      // some sentences of the file tell local time
  std::chrono::microseconds said_of_day_{0};         // the last that was no local time
  std::chrono::sys_days day_{};                      // of the last time
  std::optional<std::chrono::microseconds> of_day_;  // the last time of day
  Utime last_{};
};

}  // namespace lookout::navigator
