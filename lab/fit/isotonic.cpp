#include "lab/fit/isotonic.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace lookout::fit {
namespace {

constexpr std::size_t kMaxCorners = 8;

// Sets of corners are bits of a number.
bool Holds(unsigned set, std::size_t corner) { return ((set >> corner) & 1U) != 0; }

}  // namespace

void ProjectOnSigns(std::span<const int> signs, std::span<const double> weights, std::span<double> values) {
  if (std::ranges::all_of(signs, [](int sign) { return sign == 0; })) return;
  const std::size_t count = values.size();
  // Sets that hold whatever must be at least as high as what they hold; the others are the sets that hold whatever must be as low.
  std::vector<unsigned> upper_sets;
  const unsigned all = (1U << count) - 1U;
  for (unsigned set = 0; set <= all; ++set) {
    bool is_upper = true;
    for (std::size_t corner = 0; corner < count; ++corner) {
      for (std::size_t bit = 0; bit < signs.size(); ++bit) {
        const std::size_t other = corner ^ (std::size_t{1} << bit);
        const bool is_other_higher = signs[bit] != 0 && (other > corner) == (signs[bit] > 0);
        if (is_other_higher && Holds(set, corner) && !Holds(set, other)) is_upper = false;
      }
    }
    if (is_upper) upper_sets.push_back(set);
  }
  std::array<double, kMaxCorners> projected{};
  for (std::size_t corner = 0; corner < count; ++corner) {
    double highest = -std::numeric_limits<double>::infinity();
    for (const unsigned upper : upper_sets) {
      if (!Holds(upper, corner)) continue;
      double lowest = std::numeric_limits<double>::infinity();
      for (const unsigned not_lower : upper_sets) {
        const unsigned both = upper & ~not_lower;
        if (!Holds(both, corner)) continue;
        double sum = 0.0;
        double weight = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
          if (!Holds(both, i)) continue;
          sum += weights[i] * values[i];
          weight += weights[i];
        }
        lowest = std::min(lowest, sum / weight);
      }
      highest = std::max(highest, lowest);
    }
    projected[corner] = highest;
  }
  std::copy_n(projected.begin(), count, values.begin());
}

}  // namespace lookout::fit
