// Times as data sets write them: in the names of files, and in lists of times beside them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::importer {

struct Stamp {
  std::int64_t time_ns = 0;  // since 1970 where the stamp is dated
  bool is_dated = true;      // else time_ns counts from the begin of a recording
  bool is_zoneless = false;  // a date and a time of day without a zone: taken for UTC
};

/// "2011-09-26 13:02:25.964389445" (also with T or _ between, and other separators), or a number: whole or with a fraction, also as 1.5e+09. The size
/// of a number tells its unit: from 1e17 on nanoseconds, from 1e14 on microseconds, from 1e11 on milliseconds, else seconds; below 1e8 (1973) it is
/// not dated. Digits are exact to the nanosecond, but for numbers with an exponent.
///
/// @return nullopt where it is none of these, or before 1970 or after 2100
std::optional<Stamp> ParseStamp(std::string_view text);

/// The dated time in the name of a file without its extension: all of it, or its last part behind - or _, or the last two where they are seconds and
/// nanoseconds (scan_1621234567_123456789).
std::optional<Stamp> StampOfName(std::string_view stem);

/// A list of times: a line for each file, in their order or with their names.
class TimeList {
 public:
  /// A list is not longer, and a line of it neither.
  static constexpr std::size_t kMaxTimes = 1'000'000;
  static constexpr std::size_t kMaxTimeLineBytes = 4096;

  /// Lines "STAMP", "NAME STAMP" or "STAMP NAME"; a comma or semicolon parts words, too. # begins a comment. A line that is empty holds the place of
  /// a file. A first line that is no time is a heading; others without a time are counted.
  explicit TimeList(std::string_view text);

  std::size_t size() const { return lines_.size(); }
  std::size_t num_bad() const { return num_bad_; }

  /// @param stem   of the file
  /// @param place  among the files, by name
  /// @param count  of the files. With as many lines as files these go by place, else by the number that is their name
  std::optional<Stamp> Of(std::string_view stem, std::size_t place, std::size_t count) const;

 private:
  std::vector<std::optional<Stamp>> lines_;
  std::map<std::string, Stamp, std::less<>> by_name_;
  std::size_t num_bad_ = 0;
};

}  // namespace lookout::importer
