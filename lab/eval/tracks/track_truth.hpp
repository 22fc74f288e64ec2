// The truth after a scan, in the map frame of the boat.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>

#include "lab/data/labelled_scan.hpp"
#include "lab/eval/tracks/track_scan.hpp"
#include "lab/eval/truth.hpp"

namespace lookout::eval {

/// Latitude, longitude (deg) and height over the ellipsoid (m) of a map frame's origin.
using MapOrigin = std::array<double, 3>;

/// Objects of a truth, as IsLand asks for them.
std::map<std::int32_t, data::ScanObject> ObjectsOf(const Truth& truth);

class TrackTruth {
 public:
  /// @param truth  outlives this; its outlines are read here, its returns are not
  TrackTruth(const Truth& truth, const MapOrigin& origin);

  /// Objects with an outline, by id, and the own boat where it has one. Velocity: of the centre, over 100 ms around the time.
  /// @param num_returns  by object, of the scan
  TrueScan At(std::int64_t utime_us, const std::map<int, int>& num_returns) const;

 private:
  TrueThing MakeThing(int id, const Polygon& outline_m) const;
  Eigen::Vector2d VelocityOf(int id, std::int64_t utime_us) const;

  std::map<std::int32_t, data::ScanObject> objects_;
  Outlines outlines_;
  std::map<int, TrueThing> standing_;
};

}  // namespace lookout::eval
