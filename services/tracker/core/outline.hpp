// The outline of a thing seen from above, as how far it reaches in each of 16 directions.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lookout::tracker {

/// Directions of a compass: 0 = east, counter-clockwise, 22.5 deg apart.
inline constexpr std::size_t kDirections = 16;
using Directions = std::array<Eigen::Vector2d, kDirections>;
/// Unit vectors.
const Directions& CompassDirections();
constexpr std::size_t Opposite(std::size_t direction) { return (direction + kDirections / 2) % kDirections; }

/// Support function of a convex outline: how far it reaches along each direction from the origin of its frame. Where two neighbours contradict the
/// third between them, the nearest counts (Polygon).
using Support = std::array<double, kDirections>;

/// @param corners_m  at least one
Support SupportOf(std::span<const Eigen::Vector2d> corners_m);

/// What lies within all of them.
/// @return counter-clockwise; at least one corner, at most 16. Where they contradict each other, the middle
std::vector<Eigen::Vector2d> Polygon(const Support& support);

/// Rectangle of least area round a convex polygon.
struct Rectangle {
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
  double length_m = 0.0;  // longer side
  double width_m = 0.0;
  double length_angle_rad = 0.0;  // of the longer side from the first axis, counter-clockwise, 0 to pi
};
Rectangle RectangleAround(std::span<const Eigen::Vector2d> corners_m);

/// @param polygon  convex, counter-clockwise; may be a line or a point
bool Contains(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& point_m);
/// Least distance of two convex polygons, with the vector along which it lies. 0 where they overlap.
struct Gap {
  double distance_m = 0.0;
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero();  // on the first
  Eigen::Vector2d to_m = Eigen::Vector2d::Zero();    // on the second
};
Gap GapOf(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second);
/// Area, signed: positive counter-clockwise.
double AreaOf(std::span<const Eigen::Vector2d> polygon);
/// Intersection of two convex polygons; empty where there is none.
std::vector<Eigen::Vector2d> Intersection(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second);

}  // namespace lookout::tracker
