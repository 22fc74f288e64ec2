#include "tools/eval/progress.hpp"

namespace lookout::eval {
namespace {

constexpr std::chrono::seconds kPeriod(2);  // often enough to see that it goes on, seldom enough for a log

std::string DurationText(std::chrono::seconds duration) {
  const auto minutes = std::chrono::floor<std::chrono::minutes>(duration);
  const auto seconds = duration - minutes;
  if (minutes.count() == 0) return std::to_string(seconds.count()) + " s";
  return std::to_string(minutes.count()) + " min " + std::to_string(seconds.count()) + " s";
}

}  // namespace

Progress::Progress(std::ostream* out, std::int64_t num_steps)
    : out_(out), num_steps_(num_steps), begin_(std::chrono::steady_clock::now()), last_(begin_) {}

void Progress::Step(const std::string& doing) {
  ++num_done_;
  const auto now = std::chrono::steady_clock::now();
  if (out_ == nullptr || (now - last_ < kPeriod && num_done_ < num_steps_)) return;
  last_ = now;
  const auto left = std::chrono::duration_cast<std::chrono::seconds>((now - begin_) * (num_steps_ - num_done_) / num_done_);
  *out_ << doing << ": " << 100 * num_done_ / num_steps_ << " %, about " << DurationText(left) << " left" << std::endl;
}

}  // namespace lookout::eval
