#include "services/navigator/io/text_log_player.hpp"

#include <stdexcept>
#include <variant>

#include "services/navigator/core/nmea.hpp"
#include "services/navigator/core/sentence.hpp"

namespace lookout::navigator {

namespace {

using std::chrono::microseconds;

// The time of day in a line; nullopt when it says none.
std::optional<microseconds> TimeOfDayIn(const std::string& line) {
  const auto lines = SplitDatagram({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  if (lines.lines.empty()) return std::nullopt;
  const auto parsed = ParseSentence(lines.lines.front(), false);
  if (parsed.fault != SentenceFault::kNone) return std::nullopt;
  return std::visit(
      [](const auto& sentence) -> std::optional<microseconds> {
        if constexpr (requires { sentence.time_of_day; }) return sentence.time_of_day;
        return std::nullopt;
      },
      parsed.sentence);
}

}  // namespace

TextLogPlayer::TextLogPlayer(const std::string& name, const std::filesystem::path& file, double speed)
    : lines_name_(name + "_lines"), file_(file.string()), speed_(speed), in_(file, std::ios::binary) {
  if (!in_) throw std::runtime_error("text log " + file_ + " cannot be read");
}

// Sets line_ and when it is due.
bool TextLogPlayer::ReadLine() {
  if (!std::getline(in_, line_)) return false;
  line_ += '\n';
  ++num_lines_;
  const auto time = TimeOfDayIn(line_);
  if (!time) return true;
  if (last_time_ && speed_ > 0.0) {
    constexpr microseconds kDay = std::chrono::days(1);
    const auto pause = (*time - *last_time_ + kDay) % kDay;  // over midnight
    if (pause <= kMaxPause) *due_ += std::chrono::duration_cast<microseconds>(std::chrono::duration<double>(pause) / speed_);
  }
  last_time_ = time;
  return true;
}

std::optional<Source::Piece> TextLogPlayer::Receive(Utime now) {
  if (is_finished_) return std::nullopt;
  if (!due_) due_ = now;
  if (!has_line_) has_line_ = ReadLine();
  if (!has_line_) {
    is_finished_ = true;
    return std::nullopt;
  }
  if (now < *due_) return std::nullopt;
  has_line_ = false;
  return Piece{now, {reinterpret_cast<const std::uint8_t*>(line_.data()), line_.size()}, true};
}

}  // namespace lookout::navigator
