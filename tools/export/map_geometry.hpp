// Points, lines and areas as maps hold them (GeoJSON, KML, GPX, WKT): WGS84, longitude before latitude, cut where they cross the 180th meridian.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/core/geodesy.hpp"

namespace lookout::exporter {

/// A place on the earth in whole 1e-9 deg (0.1 mm), as it is written: the numbers of the file are compared and cut.
struct MapPlace {
  std::int64_t longitude_ndeg = 0;  // -180e9 to 180e9
  std::int64_t latitude_ndeg = 0;   // -90e9 to 90e9

  auto operator<=>(const MapPlace&) const = default;
};

/// @param place  latitude -90 to 90, any finite longitude
MapPlace ToMapPlace(const GeodeticPlace& place);

/// Appends "longitude<separator>latitude" in degrees with 9 decimals.
void AppendPlace(const MapPlace& place, char separator, std::string& text);

/// A shape on a map, in parts that do not cross the 180th meridian.
struct Geometry {
  enum class Kind { kPoint, kPoints, kLine, kPolygon };

  Kind kind = Kind::kPoint;
  // kPoint: one place. kPoints: one part of any number. kLine: parts of two places or more. kPolygon: parts are rings, closed (the last place is the
  // first), counter-clockwise, without holes.
  std::vector<std::vector<MapPlace>> parts;
  // Times of a line, one for each place; empty for other shapes and lines without times.
  std::vector<std::vector<std::int64_t>> utimes_us;

  bool HasTimes() const { return !utimes_us.empty(); }
};

Geometry PointAt(const MapPlace& place);

/// Places that belong together, each for itself.
Geometry PointsAt(std::span<const MapPlace> places);

/// @param places     one or more; between two of them the line takes the shorter way round the earth
/// @param utimes_us  when the line was at each place; empty: the line has no times. A place where the line is cut gets a time between those of its
///         neighbours.
/// @return a point where all places are one and there are no times, or one place only
Geometry LineAlong(std::span<const MapPlace> places, std::span<const std::int64_t> utimes_us = {});

/// Several lines as one geometry; lines of a single place are left out.
Geometry LinesAlong(std::span<const std::vector<MapPlace>> lines);

/// @param corners  one or more, in either direction, closed or open; the line between them does not cross itself. An outline that goes round a pole
/// contains the pole.
/// @return a line or a point where no area is left
Geometry PolygonAround(std::span<const MapPlace> corners);

/// Well-known text (OGC 06-103r4), longitude first: "POLYGON((7.5 43.5,...))".
std::string Wkt(const Geometry& geometry);

/// The map frame of a message: its places lie on the height of its datum, which follows the curve of the earth.
class MapOfDatum {
 public:
  /// @param datum  finite, latitude -90 to 90
  explicit MapOfDatum(const GeodeticPlace& datum) : datum_(datum), frame_(datum) {}

  /// Whether the two are the same map.
  bool IsOf(const GeodeticPlace& datum) const;

  /// Error: below 1 cm at 100 km from the datum, for places within 0.5 m of its height.
  MapPlace PlaceAt(const Eigen::Vector2d& p_map_m) const;

  /// The corners of an outline, with more of them along its sides where it lies so near to a pole that meridians fan out.
  std::vector<MapPlace> Outline(std::span<const Eigen::Vector2d> corners_map_m) const;
  /// The places of an open line, with more of them as in Outline.
  std::vector<MapPlace> Line(std::span<const Eigen::Vector2d> corners_map_m) const;

  /// The ellipse that holds the true place with a probability of 95 %, by a normal distribution: 36 corners.
  ///
  /// @param covariance_m2  east-east, east-north, north-north
  /// @return empty where the covariance is none (not finite, not positive), or its longer half axis exceeds 100 km
  std::vector<MapPlace> Ellipse(const Eigen::Vector2d& center_map_m, const Eigen::Vector3d& covariance_m2) const;

 private:
  void AddSide(const Eigen::Vector2d& begin_m, const Eigen::Vector2d& end_m, const MapPlace& end, int depth, std::vector<MapPlace>& places) const;

  GeodeticPlace datum_;
  LocalFrame frame_;
};

/// A circle around a place.
class Near {
 public:
  /// @param place     latitude -90 to 90
  /// @param radius_m  above 0: along a straight line, which at 100 km is 1 m shorter than the way over the earth
  Near(const GeodeticPlace& place, double radius_m);

  bool Holds(const MapPlace& place) const;

  /// Whether a part of the geometry, or of the area inside it, is within the radius.
  bool Holds(const Geometry& geometry) const;

 private:
  Eigen::Vector3d From(const MapPlace& place) const;

  LocalFrame frame_;
  double radius_m_;
};

}  // namespace lookout::exporter
