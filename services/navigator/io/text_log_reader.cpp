#include "services/navigator/io/text_log_reader.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

namespace {

using std::chrono::microseconds;
using std::chrono::sys_days;

constexpr microseconds kDay = std::chrono::days(1);

// First bytes of captures and lcm-logs: gzip may have packed them.
constexpr std::array<std::string_view, 6> kOtherMagics{"\xA1\xB2\xC3\xD4", "\xD4\xC3\xB2\xA1", "\xA1\xB2\x3C\x4D",
                                                       "\x4D\x3C\xB2\xA1", "\x0A\x0D\x0D\x0A", "\xED\xA1\xDA\x01"};

// nullopt: no right sentence. A damaged one tells no time: a wrong time would move all that follow.
std::optional<Sentence> SentenceIn(const std::string& line) {
  const auto lines = SplitDatagram({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  if (lines.lines.empty()) return std::nullopt;
  const auto parsed = ParseSentence(lines.lines.front(), false);
  if (parsed.fault != SentenceFault::kNone) return std::nullopt;
  return parsed.sentence;
}

bool IsLineEnd(char letter) { return letter == '\n' || letter == '\r'; }

bool IsText(char letter) { return IsLineEnd(letter) || letter == '\t' || (letter >= 0x20 && letter < 0x7F); }

// From one time of day to the next a day has gone by.
bool IsOverMidnight(microseconds from, microseconds to) { return from - to > kDay / 2; }

// The log was written all the while. With several talkers on one line a time may come a little late.
bool GoesOn(microseconds from, microseconds to) {
  const auto step = to - from + (IsOverMidnight(from, to) ? kDay : microseconds(0));
  return step >= -TextLogReader::kMaxLate && step <= TextLogReader::kMostPause;
}

// GPS counts weeks in 10 bits: a second receiver whose count wrapped.
bool IsRollover(std::chrono::days step) { return step % std::chrono::duration_cast<std::chrono::days>(WeekRollovers(1)) == std::chrono::days(0); }

}  // namespace

bool IsTextLog(const std::filesystem::path& file) {
  io::TextFile in(file);
  constexpr std::size_t kLooked = 1024UL * 1024;
  std::string start;
  for (char letter = 0; start.size() < kLooked && in.Get(letter);) {
    // A file system that lost its power leaves blocks of zeros.
    if (!start.empty() || letter != 0) start += letter;
  }
  if (std::ranges::any_of(kOtherMagics, [&start](std::string_view magic) { return start.starts_with(magic); })) return false;
  // Text characters among ten bytes: a file with fewer is of another kind, in which a $ may stand anywhere.
  constexpr std::ptrdiff_t kMinTextOfTen = 9;
  const bool is_text = 10 * std::ranges::count_if(start, IsText) >= kMinTextOfTen * static_cast<std::ptrdiff_t>(start.size());
  const auto lines = SplitDatagram({reinterpret_cast<const std::uint8_t*>(start.data()), start.size()});
  const bool holds_sentence = std::ranges::any_of(
      lines.lines, [is_text](const std::string& line) { return BeginsAsSentence(line) && (is_text || Frame(line).fault == SentenceFault::kNone); });
  return holds_sentence || (is_text && TextLogReader::IsCsvRecording(file));
}

bool TextLogReader::IsCsvRecording(const std::filesystem::path& file) {
  TextLogReader reader(file, Opened{});
  return reader.is_csv();
}

TextLogReader::TextLogReader(const std::filesystem::path& file, Opened /*only*/) : in_(file) { FindColumns(); }

TextLogReader::TextLogReader(const std::filesystem::path& file, std::optional<sys_days> day) : TextLogReader(file, Opened{}) {
  if (columns_ && !FindFirstRow(file)) columns_.reset();
  if (!columns_) {
    const auto first = FindFirstTime(day);
    if (!first) throw std::runtime_error(file.string() + ": no sentence in it tells a time");
    last_ = *first;
  }
  in_.Seek(0);
}

// The head of a CSV recording is its first line, but for notes.
void TextLogReader::FindColumns() {
  while (ReadLine() && line_.front() == '#') {
  }
  columns_ = FindCsvColumns(line_);
  in_.Seek(0);
}

// The first date may be wrong: among the first dates the one counts with which most others agree. And the first time may be local time.
std::optional<Utime> TextLogReader::FindFirstTime(std::optional<sys_days> day) {
  struct Vote {
    sys_days day;  // of the first time
    int count = 0;
  };
  std::vector<Vote> votes;
  std::optional<Sentence> first;
  std::optional<microseconds> before;
  std::chrono::days num_midnights{0};
  for (int num_dates = 0; num_dates < kDatesCompared && ReadLine();) {
    const auto said = WithTime(SentenceIn(line_));
    if (!said) continue;
    const auto of_day = *said->time_of_day;
    // Where the log pauses, another day may begin.
    if (num_dates > 0 && !GoesOn(*before, of_day)) break;
    if (!first || (!GoesOn(*before, of_day) && time_zone_.IsLocal(Utime(of_day), *first))) {
      first = said;
      num_midnights = {};
    } else if (IsOverMidnight(*before, of_day)) {
      ++num_midnights;
    }
    before = of_day;
    if (!said->date) continue;
    ++num_dates;
    const auto vote = std::ranges::find(votes, *said->date - num_midnights, &Vote::day);
    if (vote == votes.end()) {
      votes.push_back({*said->date - num_midnights, 1});
    } else {
      ++vote->count;
    }
  }
  has_date_ = !votes.empty();
  if (has_date_) {
    day_ = std::ranges::max_element(votes, {}, &Vote::count)->day;  // the first among dates with equal votes
  } else if (day) {
    day_ = *day;
  }
  if (!first) return std::nullopt;
  time_zone_ = {};
  said_of_day_ = *first->time_of_day;
  time_zone_.Know(Utime(said_of_day_), *first);
  return day_ + *first->time_of_day;
}

// Itself, where it tells a time that is not of another zone.
std::optional<Sentence> TextLogReader::WithTime(const std::optional<Sentence>& sentence) {
  if (!sentence || !sentence->time_of_day || time_zone_.IsLocal(Utime(said_of_day_), *sentence)) return std::nullopt;
  said_of_day_ = *sentence->time_of_day;
  time_zone_.Know(Utime(said_of_day_), *sentence);
  return sentence;
}

// Whether the time of the sentence in line_ is rather that after a pause of whole quarter hours: the sentences that say more of time do not go on
// behind it as before it.
bool TextLogReader::IsPause() {
  constexpr int kMostLines = 200;
  bool goes_on = false;
  LookAhead([&, num_lines = 0]() mutable {
    const auto sentence = SentenceIn(line_);
    if (!sentence || !time_zone_.SaysAsMuch(*sentence)) return ++num_lines < kMostLines;
    goes_on = GoesOn(said_of_day_, *sentence->time_of_day);
    return false;
  });
  return !goes_on;
}

// Whether the step from day_ to a later date in line_ is right.
bool TextLogReader::IsStepRight(sys_days date, microseconds of_day) {
  if (IsRollover(date - day_)) return true;
  int num_dates = 1;
  int num_right = 1;
  LookAhead([&, expected = date, before = of_day]() mutable {
    const auto said = WithTime(SentenceIn(line_));
    if (!said) return true;
    if (!GoesOn(before, *said->time_of_day)) return false;
    if (IsOverMidnight(before, *said->time_of_day)) expected += std::chrono::days(1);
    before = *said->time_of_day;
    if (!said->date) return true;
    num_right += *said->date == expected ? 1 : 0;
    return ++num_dates < kDatesCompared;
  });
  // Where the log goes on without a pause the day does not step, unless all that follows says so.
  const bool is_pause = !of_day_ || !GoesOn(*of_day_, of_day);
  return 2 * num_right >= num_dates && (is_pause || num_dates == kDatesCompared);
}

void TextLogReader::LookAhead(const std::function<bool()>& look) {
  const auto position = in_.position();
  const auto time_zone = time_zone_;
  const auto said_of_day = said_of_day_;
  auto line = std::move(line_);
  while (ReadLine() && look()) {
  }
  line_ = std::move(line);
  said_of_day_ = said_of_day;
  time_zone_ = time_zone;
  in_.Seek(position);
}

// False: no row with a sentence has a time that can be read, so that the sentences have to tell it.
bool TextLogReader::FindFirstRow(const std::filesystem::path& file) {
  bool has_sentence = false;
  while (!has_date_ && ReadRow()) {
    has_sentence = has_sentence || row_.is_sentence;
    has_date_ = row_.is_sentence && row_.time;
  }
  if (!has_sentence) {
    throw std::runtime_error(file.string() +
                             ": is a CSV recording, and no row in it holds a sentence of NMEA 0183; rows of NMEA 2000 and Signal K are not read");
  }
  if (has_date_) last_ = *row_.time;
  in_.Seek(0);
  return has_date_;
}

// Sets line_ to the next that is not empty.
bool TextLogReader::ReadLine() {
  line_.clear();
  for (char letter = 0; in_.Get(letter);) {
    if (IsLineEnd(letter)) {
      if (line_.empty()) continue;
      return true;
    }
    if ((letter == '$' || letter == '!') && !columns_ && EndsInChecksum(line_)) {
      in_.Back();
      return true;
    }
    // No sentence is so long: the dropped bytes are binary, and a sentence may stand behind them.
    if (line_.size() == kMaxLineBytes && !columns_) line_.erase(0, kMaxLineBytes / 2);
    if (line_.size() < kMaxLineBytes) line_ += letter;
  }
  return !line_.empty();
}

// Sets row_ to the next that holds something.
bool TextLogReader::ReadRow() {
  while (ReadLine()) {
    if (line_.front() == '#') continue;
    row_ = ReadCsvRow(line_, *columns_);
    if (row_.time || row_.is_sentence) return true;
    // A head in the middle comes from recordings that were put one behind the other.
    if (const auto columns = FindCsvColumns(line_)) columns_ = columns;
  }
  return false;
}

std::optional<TextLogReader::Line> TextLogReader::NextRow() {
  while (ReadRow()) {
    if (!row_.is_sentence) {
      ++num_other_rows_;
      continue;
    }
    if (!row_.time) ++num_rows_without_time_;
    const auto time = row_.time.value_or(last_);
    if (time >= last_ || last_ - time > kMaxLate) last_ = time;
    return Line{last_, {reinterpret_cast<const std::uint8_t*>(row_.message.data()), row_.message.size()}};
  }
  return std::nullopt;
}

std::optional<TextLogReader::Line> TextLogReader::Next() {
  if (columns_) return NextRow();
  if (!ReadLine()) return std::nullopt;
  const auto sentence = SentenceIn(line_);
  if (!has_other_zone_ && sentence && time_zone_.IsLocal(Utime(said_of_day_), *sentence)) {
    has_other_zone_ = !IsPause();
    if (!has_other_zone_) time_zone_ = {};
  }
  if (const auto said = WithTime(sentence)) {
    UseTime(*said->time_of_day, said->date);
    num_local_ = 0;
  } else if (sentence && sentence->time_of_day && ++num_local_ == kMostLocal) {
    // The source that said more of time has ended.
    time_zone_ = {};
    has_other_zone_ = false;
  }
  return Line{last_, {reinterpret_cast<const std::uint8_t*>(line_.data()), line_.size()}};
}

void TextLogReader::UseTime(microseconds of_day, std::optional<sys_days> date) {
  // Just after midnight one of the day before may still come.
  const auto of_yesterday = Utime(day_ - std::chrono::days(1) + of_day);
  if (of_day_ && of_yesterday <= last_ && last_ - of_yesterday <= kMaxLate) return;
  if (of_day_ && IsOverMidnight(*of_day_, of_day)) day_ += std::chrono::days(1);
  // Forward only: of two receivers that tell different years (a week number that wrapped) the later one counts, and the log does not leap to and
  // fro.
  if (date && *date > day_ && IsStepRight(*date, of_day)) day_ = *date;
  of_day_ = of_day;
  const Utime time = day_ + of_day;
  if (time >= last_ || last_ - time > kMaxLate) last_ = time;
}

}  // namespace lookout::navigator
