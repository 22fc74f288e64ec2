// The truth after a scan, in the map frame of the boat.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>

#include "lab/data/labelled_scan.hpp"
#include "lab/eval/tracks/track_scan.hpp"
#include "lab/eval/truth.hpp"

namespace lookout::eval {

/// Latitude, longitude (deg) and height over the ellipsoid (m) of a map frame's origin.
using MapOrigin = std::array<double, 3>;

/// Objects of a truth, as IsLand asks for them.
std::map<std::int32_t, data::ScanObject> ObjectsOf(const Truth& truth);

/// Where a map frame lies on the earth: its origin, and the direction of its y axis, clockwise from north. The map frame of POSE on the earth has 0.
struct MapPlacement {
  MapOrigin origin{};
  double y_axis_rad = 0.0;
};

class TrackTruth {
 public:
  /// @param truth  outlives this; its outlines are read here, its returns are not
  TrackTruth(const Truth& truth, const MapPlacement& map);

  /// Objects with an outline, by id, and the own boat where it has one. Velocity: of the centre, over 100 ms around the time.
  /// @param num_returns  by object, of the scan
  TrueScan At(std::int64_t utime_us, const std::map<int, int>& num_returns) const;

 private:
  std::optional<Polygon> OutlineAt(int id, std::int64_t utime_us) const;
  TrueThing MakeThing(int id, const Polygon& outline_m) const;
  Eigen::Vector2d VelocityOf(int id, std::int64_t utime_us) const;

  std::map<std::int32_t, data::ScanObject> objects_;
  Outlines outlines_;  // east, north
  Eigen::Matrix2d R_map_north_;
  std::map<int, TrueThing> standing_;
};

}  // namespace lookout::eval
