#include "common/core/datum_check.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace lookout {

namespace {

double DistanceM(const GeodeticPlace& a, const GeodeticPlace& b) { return LocalFrame(OnEllipsoid(a)).Forward(OnEllipsoid(b)).norm(); }

}  // namespace

std::string PlaceInWords(const GeodeticPlace& place) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.5f %c %.5f %c", std::abs(place.latitude_deg), place.latitude_deg < 0.0 ? 'S' : 'N',
                std::abs(place.longitude_deg), place.longitude_deg < 0.0 ? 'W' : 'E');
  return text.data();
}

std::string DatumComplaint(const GeodeticPlace& datum, const GeodeticPlace& place, std::string_view what) {
  const double distance_m = DistanceM(datum, place);
  if (!(distance_m > kMaxDatumDistanceM)) return {};
  const auto is_near = [&place](double latitude_deg, double longitude_deg) {
    return std::abs(latitude_deg) <= 90.0 && DistanceM({latitude_deg, longitude_deg, 0.0}, place) <= kMaxDatumDistanceM;
  };
  std::array<char, 32> distance{};
  std::snprintf(distance.data(), distance.size(), "%.0f km", distance_m / 1e3);
  std::string text =
      "datum " + PlaceInWords(datum) + " of boat.txtpb is " + distance.data() + " from " + std::string(what) + " at " + PlaceInWords(place);
  if (is_near(datum.longitude_deg, datum.latitude_deg)) return text + ": swapped latitude and longitude?";
  if (is_near(datum.latitude_deg, -datum.longitude_deg)) return text + ": longitude of the wrong sign (west is negative)?";
  if (is_near(-datum.latitude_deg, datum.longitude_deg)) return text + ": latitude of the wrong sign (south is negative)?";
  return text + ": positions are right all the same; is it meant?";
}

}  // namespace lookout
