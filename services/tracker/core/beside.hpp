// Whether outlines lie beside each other.
#pragma once

#include <Eigen/Core>
#include <span>

#include "services/tracker/core/picture.hpp"

namespace lookout::tracker {

/// Precondition of both: the tracks have outlines.
bool IsWithin(const Track& one, const Track& other, double gap_m);
bool IsWithinAny(const Track& track, std::span<const Eigen::Vector2d> places_m, double gap_m);

}  // namespace lookout::tracker
