// DBSCAN: clusters of points that lie close together, and noise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/returns.hpp"

namespace lookout::eval {

struct DbscanParams {
  double radius_m = 1.0;
  int min_points = 1;  // within the radius of a core point, which counts itself
};

inline constexpr std::int32_t kNoise = -1;

/// Clusters, numbered from 0 in the order of their first core point; kNoise for points that no core point reaches. A point on the border of two
/// clusters is of the first.
///
/// Source: Ester, Kriegel, Sander, Xu: KDD 1996.
std::vector<std::int32_t> Dbscan(std::span<const segmenter::Point> points_m, const DbscanParams& params);

}  // namespace lookout::eval
