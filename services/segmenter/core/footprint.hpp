// The shape of a segment seen from above.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lookout::segmenter {

struct FootprintPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  std::int32_t return_index = 0;
};

/// Convex hull, by the monotone chain.
///
/// @param points  at least one; where several are at one place, the least return_index stands for them
/// @return corners counter-clockwise from the one of least x (then y), none of them on the line between its neighbours; one corner when all
///         points are at one place, two when they are on a line. Cost: n log n.
std::vector<FootprintPoint> ConvexHull(std::vector<FootprintPoint> points);

/// A hull of at most kMaxHullCorners: where it has more, the farthest corner in each of so many directions, evenly spread. It lies inside of the
/// hull, keeps its extremes along x and y, and cuts nothing off that is farther from the edge in its place than 0.62 % of that edge
/// (tan(pi / 256) / 2: between two directions the hull turns by 2 pi / 256).
std::vector<FootprintPoint> SimplifyHull(std::vector<FootprintPoint> hull);

/// 256 corners are 3 kB of a message of 120 kB.
inline constexpr std::size_t kMaxHullCorners = 256;
inline constexpr std::size_t kMaxWaterlineCorners = 256;

struct Rectangle {
  float length_m = 0.0F;  // longer side
  float width_m = 0.0F;
  float length_azimuth_rad = 0.0F;  // direction of the longer side in [0, pi), clockwise from x
};

/// The rectangle of least area around a hull; one of its sides is along an edge. Of equals, that of the first edge. Cost: corners squared.
Rectangle LeastAreaRectangle(std::span<const FootprintPoint> hull);

}  // namespace lookout::segmenter
