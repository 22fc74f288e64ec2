// The exported part of a log: a time, and a circle around a place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/bytes.hpp"
#include "common/core/geodesy.hpp"

namespace lookout::exporter {

/// Places within `radius_m` (above 0) of a place.
struct Circle {
  GeodeticPlace place;
  double radius_m = 0.0;
};

/// "LATITUDE,LONGITUDE,RADIUS" in degrees, degrees and metres, decimals with a point.
///
/// @return nullopt where it is not that, the latitude is beyond 90, the longitude beyond 180, or the radius is not above 0
std::optional<Circle> ParseCircle(std::string_view text);

/// So many bytes of a message of any type of the bus hold its time: LCM begins with eight bytes that tell the type, then come the members.
inline constexpr std::size_t kTimeEndBytes = 16;

/// @return the time with which a message of any type of the bus begins (of a message of a scan: the scan's first shot); nullopt where the message is
///         too short
std::optional<std::int64_t> UtimeUsOf(Bytes message);

/// Times of measurement, half open.
struct Span {
  std::optional<std::int64_t> from_us = std::nullopt;
  std::optional<std::int64_t> to_us = std::nullopt;  // the first time that is left out

  bool IsAll() const { return !from_us && !to_us; }

  /// @param message  of any type of the bus. A message that is too short to have a time is held, so that it is counted as undecodable.
  bool Holds(Bytes message) const;
};

/// "between 2026-07-01T10:00:00.000000Z and ...", for messages
std::string TextOf(const Span& span);

/// "within 100 m of 43.7022, -72.2895", for messages
std::string TextOf(const Circle& circle);

}  // namespace lookout::exporter
