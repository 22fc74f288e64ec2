// The outline of a thing seen from above, as how far it reaches in each of 16 directions; and the geometry of convex polygons.
//
// Polygons are convex and counter-clockwise. One of two corners is a line, one of one corner a point: the same functions hold for them. Lengths below
// 1 nm are rounding: what touches by so little overlaps.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "common/core/outlines.hpp"

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

/// @param corners_m  at least one, in any order
Support SupportOf(std::span<const Eigen::Vector2d> corners_m);

/// The polygon within all of them. Where they contradict each other, each gives way by the same distance, by no more than it takes: a line or a point
/// midway is left.
/// @return at least one corner, at most 16, none nearer than 1 um to its neighbour
std::vector<Eigen::Vector2d> Polygon(const Support& support);

bool Contains(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& point_m);

/// All differences of a point of the first and one of the second (Minkowski): one polygon, of at most as many corners as both have. It contains the
/// origin where they overlap.
/// @param first, second  at least one corner each
std::vector<Eigen::Vector2d> DifferenceOf(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second);

/// Least distance of two polygons, with two points that lie so far apart.
struct Gap {
  double distance_m = 0.0;                           // 0 where they overlap
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero();  // on the first
  Eigen::Vector2d to_m = Eigen::Vector2d::Zero();    // on the second; where they overlap the same point, which both share
};
/// @param first, second  at least one corner each
/// Cost: 1 us for two of 12 corners.
Gap GapOf(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second);

/// Area, signed: positive counter-clockwise.
double AreaOf(std::span<const Eigen::Vector2d> polygon);

/// The common part of both: a polygon, a line, a point; empty where there is none.
std::vector<Eigen::Vector2d> Intersection(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second);

}  // namespace lookout::tracker
