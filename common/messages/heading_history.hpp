// Headings of the last ten seconds of POSE, to be asked for at the time of a scan.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>

namespace lookout::messages {

class HeadingHistory {
 public:
  /// A heading that is not known (not finite) is left out.
  void Add(std::int64_t utime_us, double heading_rad) {
    // POSE comes every 20 ms of message time.
    constexpr std::size_t kMaxHeadings = 500;
    if (!std::isfinite(heading_rad)) return;
    if (headings_.size() == kMaxHeadings) headings_.pop_front();
    headings_.push_back({utime_us, heading_rad});
  }

  /// @return the heading that is nearest in time; nullopt where none is within 100 ms: in so long a boat turns by a degree at most
  std::optional<double> At(std::int64_t utime_us) const {
    constexpr std::uint64_t kMaxDistanceUs = 100'000;
    // Without sign, so that no pair of times out of corrupt messages overflows.
    const auto distance_us = [utime_us](const Heading& heading) {
      const auto [low, high] = std::minmax(heading.utime_us, utime_us);
      return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
    };
    const auto nearest = std::ranges::min_element(headings_, {}, distance_us);
    if (nearest == headings_.end() || distance_us(*nearest) > kMaxDistanceUs) return std::nullopt;
    return nearest->heading_rad;
  }

 private:
  struct Heading {
    std::int64_t utime_us;
    double heading_rad;
  };
  std::deque<Heading> headings_;
};

}  // namespace lookout::messages
