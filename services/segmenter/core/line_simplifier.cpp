#include "services/segmenter/core/line_simplifier.hpp"

#include <algorithm>
#include <cmath>

namespace lookout::segmenter {

namespace {

// Squared distance from a point to the stretch between two others.
double SquaredOff(const FootprintPoint& point, const FootprintPoint& from, const FootprintPoint& to) {
  const double x_m = static_cast<double>(to.x_m) - from.x_m;
  const double y_m = static_cast<double>(to.y_m) - from.y_m;
  const double point_x_m = static_cast<double>(point.x_m) - from.x_m;
  const double point_y_m = static_cast<double>(point.y_m) - from.y_m;
  const double length_m2 = x_m * x_m + y_m * y_m;
  const double share = length_m2 > 0.0 ? std::clamp((point_x_m * x_m + point_y_m * y_m) / length_m2, 0.0, 1.0) : 0.0;
  const double off_x_m = point_x_m - share * x_m;
  const double off_y_m = point_y_m - share * y_m;
  return off_x_m * off_x_m + off_y_m * off_y_m;
}

}  // namespace

std::span<const FootprintPoint> LineSimplifier::Simplify(std::span<const FootprintPoint> line, double off_m, std::size_t max_points) {
  if (line.size() < 3) {
    kept_.assign(line.begin(), line.end());
    return kept_;
  }
  for (;; off_m *= 2.0) {
    Keep(line, off_m);
    if (static_cast<std::size_t>(std::ranges::count(is_kept_, true)) <= max_points) break;
  }
  kept_.clear();
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (is_kept_[i]) kept_.push_back(line[i]);
  }
  return kept_;
}

void LineSimplifier::Keep(std::span<const FootprintPoint> line, double off_m) {
  is_kept_.assign(line.size(), false);
  is_kept_.front() = is_kept_.back() = true;
  stretches_.assign(1, {0, line.size() - 1});
  while (!stretches_.empty()) {
    const auto [begin, end] = stretches_.back();
    stretches_.pop_back();
    std::size_t farthest = begin;
    double farthest_m2 = off_m * off_m;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const double squared_m2 = SquaredOff(line[i], line[begin], line[end]);
      if (squared_m2 <= farthest_m2) continue;
      farthest_m2 = squared_m2;
      farthest = i;
    }
    if (farthest == begin) continue;
    is_kept_[farthest] = true;
    stretches_.emplace_back(begin, farthest);
    stretches_.emplace_back(farthest, end);
  }
}

}  // namespace lookout::segmenter
