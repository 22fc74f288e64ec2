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
  float center_x_m = 0.0F;
  float center_y_m = 0.0F;
  float length_m = 0.0F;  // longer side
  float width_m = 0.0F;
  float length_azimuth_rad = 0.0F;  // direction of the longer side in [0, pi), clockwise from x
};

/// The rectangle of least area around a hull; one of its sides is along an edge. Of equals, that of the first edge. Cost: corners.
Rectangle LeastAreaRectangle(std::span<const FootprintPoint> hull);

/// The box of a thing within a hull of which only two sides may be seen: their corner and ends make a triangle, around which three rectangles have
/// the same area. Of the rectangles with a side along an edge whose area is at most kBoxArea times the least, the one whose sides the points lie
/// closest to in the mean (the closeness of X. Zhang et al., "Efficient L-Shape Fitting for Vehicle Detection Using Laser Scanners", IV 2017, here
/// over the edges of the hull instead of all directions).
///
/// A hull longer than kLongestBoxM is no boat: its rectangle is that of least area.
///
/// @param points  of the hull; of more than kBoxPoints every n-th is looked at
Rectangle FitBox(std::span<const FootprintPoint> hull, std::span<const FootprintPoint> points);

inline constexpr double kBoxArea = 1.3;
inline constexpr double kLongestBoxM = 40.0;
inline constexpr std::size_t kBoxPoints = 32;

/// The steps above with memory that is used again.
class Footprint {
 public:
  /// @param points  at least one
  void Measure(const std::vector<FootprintPoint>& points);

  std::span<const FootprintPoint> hull() const { return hull_; }  // ConvexHull, simplified
  const Rectangle& box() const { return box_; }

 private:
  std::vector<FootprintPoint> corners_;
  std::vector<FootprintPoint> dealt_;
  std::vector<std::size_t> ends_;
  std::vector<bool> is_kept_;
  std::vector<FootprintPoint> hull_;
  Rectangle box_;
};

}  // namespace lookout::segmenter
