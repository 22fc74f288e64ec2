#include "common/runtime/progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <spdlog/fmt/fmt.h>
#include <utility>

namespace lookout::runtime {

namespace {

constexpr std::chrono::milliseconds kTerminalPeriod(500);
constexpr std::size_t kUnknownColumns = 80;
constexpr double kLeastToForetell = 0.001;

// "3 h 12 min", "4 min 10 s", "7 s"
std::string DurationText(double duration_s) {
  const auto seconds = std::llround(std::clamp(duration_s, 0.0, 1e9));
  if (seconds >= 3600) return fmt::format("{} h {} min", seconds / 3600, seconds % 3600 / 60);
  if (seconds >= 60) return fmt::format("{} min {} s", seconds / 60, seconds % 60);
  return fmt::format("{} s", seconds);
}

}  // namespace

std::FILE* OnlyTerminal(std::FILE* out) { return out != nullptr && isatty(fileno(out)) != 0 ? out : nullptr; }

Progress::Progress(std::string program, std::FILE* out) : Progress(std::move(program), out, OnlyTerminal(out) != nullptr) {}

Progress::Progress(std::string program, std::FILE* out, bool as_on_terminal, std::chrono::milliseconds line_period,
                   std::function<Clock::time_point()> now)
    : program_(std::move(program)),
      out_(out),
      is_terminal_(as_on_terminal),
      period_(as_on_terminal ? kTerminalPeriod : line_period),
      now_(std::move(now)),
      start_(now_()),
      next_(start_) {
  if (!is_terminal_) next_ += period_;
}

Progress::~Progress() { Clear(); }

void Progress::Update(double share, const std::function<std::string()>& remark) {
  if (out_ == nullptr) return;
  const auto now = now_();
  if (now < next_) return;
  next_ = now + period_;
  const double done = std::clamp(share, 0.0, 1.0);
  auto line = fmt::format("{}: {:.0f} %", program_, 100.0 * done);
  if (remark) line += ", " + remark();
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  // Before anything is done nobody knows.
  if (done >= kLeastToForetell) line += fmt::format(", {} left", DurationText(elapsed_s * (1.0 - done) / done));
  Show(std::move(line));
}

void Progress::Show(std::string line) {
  if (!is_terminal_) {
    std::fprintf(out_, "%s\n", line.c_str());
    std::fflush(out_);
    return;
  }
  line.resize(std::min(line.size(), Columns() - 1));  // a line that wraps could not be written over
  // A shorter line is filled up, so that nothing of the one before stands behind it.
  std::fprintf(out_, "\r%-*s", static_cast<int>(num_shown_), line.c_str());
  std::fflush(out_);
  num_shown_ = line.size();
}

void Progress::Clear() {
  if (num_shown_ == 0) return;
  // The terminal may have become narrower.
  const auto width = static_cast<int>(std::min(num_shown_, Columns() - 1));
  std::fprintf(out_, "\r%*s\r", width, "");
  std::fflush(out_);
  num_shown_ = 0;
}

std::size_t Progress::Columns() const {
  winsize size{};
  if (ioctl(fileno(out_), TIOCGWINSZ, &size) != 0 || size.ws_col < 2) return kUnknownColumns;
  return size.ws_col;
}

}  // namespace lookout::runtime
