#include "tools/replay/progress.hpp"

#include <algorithm>

namespace lookout::replay {

namespace {

constexpr std::chrono::milliseconds kLinePeriod(500);
// A message is a matter of microseconds: the clock need not be read for each.
constexpr std::int64_t kCallsPerLook = 64;

}  // namespace

Progress::~Progress() {
  if (has_line_) std::fputc('\n', out_);
}

void Progress::Update(std::int64_t num_bytes_done, std::chrono::microseconds data_span) {
  if (out_ == nullptr || ++num_calls_ % kCallsPerLook != 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (has_line_ && now - last_ < kLinePeriod) return;
  last_ = now;
  has_line_ = true;
  const double elapsed_s = ToSeconds(now - start_);
  const double share = std::clamp(static_cast<double>(num_bytes_done) / static_cast<double>(std::max<std::int64_t>(1, num_bytes_)), 1e-6, 1.0);
  std::fprintf(out_, "\rreplay: %3.0f %%, %.0f times real time, %.0f s left  ", 100.0 * share, ToSeconds(data_span) / elapsed_s,
               elapsed_s * (1.0 - share) / share);
  std::fflush(out_);
}

}  // namespace lookout::replay
