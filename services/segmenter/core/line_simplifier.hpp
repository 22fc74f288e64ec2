// Lines of many points as lines of few.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "services/segmenter/core/footprint.hpp"

namespace lookout::segmenter {

/// Douglas and Peucker (1973), with memory that is used again.
class LineSimplifier {
 public:
  /// Keeps the ends, and as few points between them that no other lies farther than `off_m` from the line. Where more than max_points would stay,
  /// `off_m` is doubled until they do not.
  ///
  /// @param max_points  2 or more
  /// @return the points that are kept, in order; until the next call. Cost: n log n, at worst n squared
  std::span<const FootprintPoint> Simplify(std::span<const FootprintPoint> line, double off_m, std::size_t max_points);

 private:
  void Keep(std::span<const FootprintPoint> line, double off_m);

  std::vector<bool> is_kept_;
  std::vector<std::pair<std::size_t, std::size_t>> stretches_;  // still to be looked at
  std::vector<FootprintPoint> kept_;
};

}  // namespace lookout::segmenter
