#include "services/navigator/io/text_log_player.hpp"

#include <algorithm>

#include "services/navigator/core/item_sequencer.hpp"

namespace lookout::navigator {

namespace {

using std::chrono::steady_clock;

constexpr std::chrono::microseconds kNoPause{0};

std::chrono::microseconds PauseBetween(Utime from, Utime to) {
  const auto pause = to - from;
  return pause < kNoPause || pause > TextLogPlayer::kMaxPause ? kNoPause : pause;
}

}  // namespace

TextLogPlayer::TextLogPlayer(const std::vector<Log>& logs, double speed) : speed_(speed) {
  readings_.reserve(logs.size());
  for (const auto& log : logs) {
    readings_.push_back({.log = log,
                         .reader = TextLogReader(log.file, log.day),
                         .line = {},
                         .counter = log.name + "_lines",
                         .other_rows_counter = log.name + "_other_rows",
                         .without_time_counter = log.name + "_rows_without_time"});
    readings_.back().line = readings_.back().reader.Next();
  }
  FindNext();
  if (next_) start_ = time_ = readings_[*next_].line->time;
}

// Finds the earliest line; at equal times the line of the first log.
void TextLogPlayer::FindNext() {
  next_.reset();
  for (std::size_t i = 0; i < readings_.size(); ++i) {
    const auto& line = readings_[i].line;
    if (line && (!next_ || line->time < readings_[*next_].line->time)) next_ = i;
  }
}

void TextLogPlayer::Play(steady_clock::time_point now, const Taker& taker) {
  if (!due_) due_ = now;
  const Utime round_start = time_;
  while (next_ && now >= *due_ && time_ - round_start <= kMaxRound) {
    auto& reading = readings_[*next_];
    time_ = reading.line->time;
    ++reading.num_lines;
    taker.advance_to(time_);
    taker.take_line(time_, reading.line->bytes, reading.log.name);
    reading.line = reading.reader.Next();
    FindNext();
    if (!next_ || speed_ <= 0.0) continue;
    const std::chrono::duration<double> pause = PauseBetween(time_, readings_[*next_].line->time);
    *due_ += std::chrono::duration_cast<steady_clock::duration>(pause / speed_);
  }
  if (!next_ || speed_ <= 0.0 || now >= *due_) return;
  // On the way to the next line. In a longer silence there are no ticks, however it is gone through.
  const Utime next_time = readings_[*next_].line->time;
  if (next_time - time_ > ItemSequencer::kMaxTickGap || next_time <= time_) return;
  const auto rest = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::duration<double>(*due_ - now) * speed_);
  const Utime on_the_way = next_time - rest;
  if (on_the_way > time_) taker.advance_to(std::min(on_the_way, next_time));
}

std::vector<std::string> TextLogPlayer::dateless() const {
  std::vector<std::string> names;
  for (const auto& reading : readings_) {
    if (!reading.reader.has_date() && !reading.log.day) names.push_back(reading.log.name);
  }
  return names;
}

std::vector<Counter> TextLogPlayer::counters() const {
  std::vector<Counter> counters;
  for (const auto& reading : readings_) {
    counters.push_back({reading.counter, reading.num_lines});
    if (!reading.reader.is_csv()) continue;
    counters.push_back({reading.other_rows_counter, reading.reader.num_other_rows()});
    counters.push_back({reading.without_time_counter, reading.reader.num_rows_without_time()});
  }
  return counters;
}

std::string TextLogPlayer::fault() const {
  std::string fault;
  for (const auto& reading : readings_) {
    if (!reading.reader.fault().empty()) fault += (fault.empty() ? "" : "; ") + reading.log.file.string() + ": " + reading.reader.fault();
  }
  return fault;
}

}  // namespace lookout::navigator
