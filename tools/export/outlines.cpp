#include "tools/export/outlines.hpp"

#include <cmath>
#include <cstddef>

namespace lookout::exporter {

namespace {

// No boat gets so far from its datum in a run; further out the curve of the earth is not followed any more.
constexpr double kFarthestM = 1e6;

// False for NaN, too.
bool IsWithinReach(const Eigen::Vector2d& place_m) { return std::abs(place_m.x()) < kFarthestM && std::abs(place_m.y()) < kFarthestM; }

template <typename Message>
std::optional<MapOfDatum> MapOfMessage(const Message& message) {
  // As Datum::Map: a height that is not known counts as 0.
  const double height_m = std::isfinite(message.datum_ellipsoid_height_m) ? message.datum_ellipsoid_height_m : 0.0;
  const GeodeticPlace datum{message.datum_latitude_deg, message.datum_longitude_deg, height_m};
  if (!PlaceOf(datum.latitude_deg, datum.longitude_deg) || !(std::abs(datum.ellipsoid_height_m) < kFarthestM)) return std::nullopt;
  return MapOfDatum(datum);
}

std::optional<Geometry> PolygonOrNone(const std::vector<MapPlace>& places) {
  if (places.empty()) return std::nullopt;
  return PolygonAround(places);
}

std::optional<Geometry> Ellipse(const MapOfDatum& map, const Eigen::Vector2d& center_m, const Eigen::Vector3d& covariance_m2) {
  if (!IsWithinReach(center_m)) return std::nullopt;
  return PolygonOrNone(map.Ellipse(center_m, covariance_m2));
}

}  // namespace

std::optional<MapOfDatum> MapOf(const obstacles_t& message) { return MapOfMessage(message); }
std::optional<MapOfDatum> MapOf(const tracks_t& message) { return MapOfMessage(message); }

std::optional<MapPlace> PlaceOf(double latitude_deg, double longitude_deg) {
  if (!(std::abs(latitude_deg) <= 90.0) || !(std::abs(longitude_deg) <= 180.0)) return std::nullopt;
  return ToMapPlace({latitude_deg, longitude_deg, 0.0});
}

std::vector<Eigen::Vector2d> CornersOf(const std::vector<float>& east_m, const std::vector<float>& north_m) {
  std::vector<Eigen::Vector2d> corners_m;
  corners_m.reserve(east_m.size());
  for (std::size_t i = 0; i < east_m.size(); ++i) {
    corners_m.emplace_back(east_m[i], north_m[i]);
    if (!IsWithinReach(corners_m.back())) return {};
  }
  return corners_m;
}

std::optional<Geometry> OutlineOf(const obstacle_t& obstacle, const MapOfDatum& map) {
  if (obstacle.status != obstacle_t::STATUS_OK) return std::nullopt;
  const auto waterline_m = CornersOf(obstacle.waterline_east_m, obstacle.waterline_north_m);
  if (obstacle.kind == obstacle_t::KIND_LAND && !waterline_m.empty()) return LineAlong(map.Line(waterline_m));
  return PolygonOrNone(map.Outline(CornersOf(obstacle.footprint_east_m, obstacle.footprint_north_m)));
}

std::optional<Geometry> OutlineOf(const track_t& track, const MapOfDatum& map) {
  return PolygonOrNone(map.Outline(CornersOf(track.outline_east_m, track.outline_north_m)));
}

std::optional<Geometry> EllipseOf(const obstacle_t& obstacle, const MapOfDatum& map) {
  if (obstacle.status != obstacle_t::STATUS_OK) return std::nullopt;
  return Ellipse(map, Eigen::Vector2d(obstacle.position_map_m), Eigen::Vector3d(obstacle.covariance_m2));
}

std::optional<Geometry> EllipseOf(const track_t& track, const MapOfDatum& map) {
  return Ellipse(map, Eigen::Vector2d(track.position_map_m), {track.covariance[0][0], track.covariance[0][1], track.covariance[1][1]});
}

}  // namespace lookout::exporter
