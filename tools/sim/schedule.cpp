#include "tools/sim/schedule.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lookout::sim {

Schedule::Clock::time_point Schedule::DueAt(Utime time) const {
  const std::chrono::duration<double, std::micro> wait(speed_ > 0.0 ? static_cast<double>((time - start_).count()) / speed_ : 0.0);
  return base_ + std::chrono::duration_cast<Clock::duration>(wait);
}

std::optional<std::string> Schedule::Tell(Utime time, Clock::time_point now) {
  ++num_sent_;
  if (speed_ <= 0.0) return std::nullopt;
  const auto late = now - DueAt(time);
  if (late <= kLate) return std::nullopt;
  ++num_late_;
  greatest_ = std::max(greatest_, late);
  if (last_told_ && now - *last_told_ < kTellEvery) return std::nullopt;
  last_told_ = now;
  return fmt::format("{:.2f} s behind its schedule: this computer is too slow for the scene, or too busy; what is sent comes late", ToSeconds(late));
}

std::string Schedule::Summary() const {
  if (num_late_ == 0) return {};
  return fmt::format("{} of {} datagrams went out more than {:.2f} s late, the latest {:.2f} s", num_late_, num_sent_, ToSeconds(kLate),
                     ToSeconds(greatest_));
}

}  // namespace lookout::sim
