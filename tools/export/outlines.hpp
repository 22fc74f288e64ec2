// Outlines of obstacles and tracks on the earth.
#pragma once

#include <optional>
#include <vector>

#include "lookout/obstacle_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/track_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tools/export/map_geometry.hpp"

namespace lookout::exporter {

/// The map frame of a message; nullopt where its datum is not known or no place on the earth.
std::optional<MapOfDatum> MapOf(const obstacles_t& message);
std::optional<MapOfDatum> MapOf(const tracks_t& message);

/// @return nullopt where they are no place on the earth
std::optional<MapPlace> PlaceOf(double latitude_deg, double longitude_deg);

/// Corners of a message: `east` and `north` are of one length. Empty where one of them is not finite or is more than 1000 km from the datum.
std::vector<Eigen::Vector2d> CornersOf(const std::vector<float>& east_m, const std::vector<float>& north_m);

/// Land: its waterline. All else: the outline seen from above; of two returns a line, of one a point. nullopt where it has no place on the map.
std::optional<Geometry> OutlineOf(const obstacle_t& obstacle, const MapOfDatum& map);
std::optional<Geometry> OutlineOf(const track_t& track, const MapOfDatum& map);

/// Where its centre truly is with a probability of 95 %; nullopt where that is not known.
std::optional<Geometry> EllipseOf(const obstacle_t& obstacle, const MapOfDatum& map);
std::optional<Geometry> EllipseOf(const track_t& track, const MapOfDatum& map);

}  // namespace lookout::exporter
