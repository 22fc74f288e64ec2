// The map of the simulation: east, north, up at its datum; up is 0 on the calm water.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>

#include "common/config/boat.hpp"

namespace lookout::sim {

/// Origin of the map where boat.txtpb holds no datum: a lake in New Hampshire; west of Greenwich, so that a wrong sign shows.
inline constexpr GeodeticPlace kLakeDatum{43.6300, -72.1500, 201.0};

inline GeographicLib::LocalCartesian MapFrame(const config::BoatFacts& boat) {
  const auto datum = boat.datum.value_or(kLakeDatum);
  return {datum.latitude_deg, datum.longitude_deg, datum.ellipsoid_height_m};
}

}  // namespace lookout::sim
