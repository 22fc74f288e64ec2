// Our closed forms against GeographicLib, which takes its functions from the C library.
#include "common/core/geodesy.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/NormalGravity.hpp>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout {
namespace {

constexpr double kMetresPerDegree = 111'320.0;  // at most

double Between(std::mt19937_64& random, double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

// Poles, equator, date line, Greenwich and what is beside them; then anywhere.
std::vector<GeodeticPlace> Places(std::uint64_t seed, int num_random, double least_height_m, double greatest_height_m) {
  std::vector<GeodeticPlace> places;
  for (const double latitude_deg : {-90.0, -89.9999999, -45.0, -1e-12, 0.0, 1e-9, 33.3, 89.0, 89.99999999, 90.0}) {
    for (const double longitude_deg : {-180.0, -179.9999999, -90.0, -1e-10, 0.0, 44.4, 90.0, 179.9999999, 180.0}) {
      for (const double height_m : {least_height_m, 0.0, greatest_height_m}) places.push_back({latitude_deg, longitude_deg, height_m});
    }
  }
  std::mt19937_64 random(seed);
  for (int i = 0; i < num_random; ++i) {
    const double latitude_deg = RadToDeg(std::asin(Between(random, -1.0, 1.0)));
    places.push_back({latitude_deg, Between(random, -180.0, 180.0), Between(random, least_height_m, greatest_height_m)});
  }
  return places;
}

// Metres between two places that are near each other.
double DistanceM(const GeodeticPlace& one, const GeodeticPlace& other) {
  const double north_m = (one.latitude_deg - other.latitude_deg) * kMetresPerDegree;
  const double cosine = std::cos(DegToRad(other.latitude_deg));
  const double east_m = RadToDeg(std::sin(DegToRad(one.longitude_deg - other.longitude_deg))) * kMetresPerDegree * cosine;
  return std::sqrt(north_m * north_m + east_m * east_m + std::pow(one.ellipsoid_height_m - other.ellipsoid_height_m, 2));
}

TEST(LocalFrame, MapsPlacesAllOverTheEarthAsGeographicLibDoes) {
  constexpr std::uint64_t kSeed = 1;
  double worst_m = 0.0;
  const auto places = Places(kSeed, 3000, -1000.0, 10'000.0);
  for (std::size_t i = 0; i < places.size(); i += 7) {
    const auto& datum = places[i];
    const LocalFrame map(datum);
    const GeographicLib::LocalCartesian reference(datum.latitude_deg, datum.longitude_deg, datum.ellipsoid_height_m);
    for (std::size_t k = i % 5; k < places.size(); k += 5) {
      Eigen::Vector3d expected_m;
      reference.Forward(places[k].latitude_deg, places[k].longitude_deg, places[k].ellipsoid_height_m, expected_m.x(), expected_m.y(),
                        expected_m.z());
      worst_m = std::max(worst_m, (map.Forward(places[k]) - expected_m).norm());
    }
  }
  EXPECT_LT(worst_m, 1e-8) << "seed " << kSeed;
  std::printf("worst %.3g m\n", worst_m);
}

TEST(LocalFrame, GivesPlacesBackAsGeographicLibDoes) {
  constexpr std::uint64_t kSeed = 2;
  double worst_m = 0.0;
  double worst_latitude_deg = 0.0;
  const auto places = Places(kSeed, 3000, -1000.0, 10'000.0);
  for (std::size_t i = 0; i < places.size(); i += 7) {
    const auto& datum = places[i];
    const LocalFrame map(datum);
    const GeographicLib::LocalCartesian reference(datum.latitude_deg, datum.longitude_deg, datum.ellipsoid_height_m);
    for (std::size_t k = i % 5; k < places.size(); k += 5) {
      const Eigen::Vector3d p_map_m = map.Forward(places[k]);
      const GeodeticPlace found = map.Reverse(p_map_m);
      GeodeticPlace expected;
      reference.Reverse(p_map_m.x(), p_map_m.y(), p_map_m.z(), expected.latitude_deg, expected.longitude_deg, expected.ellipsoid_height_m);
      worst_m = std::max({worst_m, DistanceM(found, expected), DistanceM(found, places[k])});
      worst_latitude_deg = std::max(worst_latitude_deg, std::abs(found.latitude_deg - expected.latitude_deg));
      EXPECT_LE(std::abs(found.latitude_deg), 90.0);
      EXPECT_LE(std::abs(found.longitude_deg), 180.0);
    }
  }
  EXPECT_LT(worst_m, 1e-8) << "seed " << kSeed;
  EXPECT_LT(worst_latitude_deg, 1e-13) << "seed " << kSeed;
  std::printf("worst %.3g m, latitude %.3g deg\n", worst_m, worst_latitude_deg);
}

TEST(LocalFrame, IsAsGoodFarAboveTheEarth) {
  constexpr std::uint64_t kSeed = 3;
  double worst_m = 0.0;
  const LocalFrame map({43.63, -72.15, 201.0});
  for (const auto& place : Places(kSeed, 20'000, -100'000.0, 1'000'000.0)) {
    const GeodeticPlace found = map.Reverse(map.Forward(place));
    worst_m = std::max(worst_m, DistanceM(found, place));
  }
  EXPECT_LT(worst_m, 1e-8) << "seed " << kSeed;
  double worst_far_m = 0.0;
  for (const auto& place : Places(kSeed, 20'000, 1'000'000.0, 100'000'000.0)) {
    const GeodeticPlace found = map.Reverse(map.Forward(place));
    worst_far_m = std::max(worst_far_m, DistanceM(found, place));
  }
  EXPECT_LT(worst_far_m, 1e-7) << "seed " << kSeed;
  std::printf("worst %.3g m, far off %.3g m\n", worst_m, worst_far_m);
}

TEST(LocalFrame, IsDefinedAtThePolesOnTheAxisAndAtTheCentreOfTheEarth) {
  for (const double pole_deg : {-90.0, 90.0}) {
    const LocalFrame map({pole_deg, 0.0, 0.0});
    const GeodeticPlace pole = map.Reverse({0.0, 0.0, 5.0});
    EXPECT_EQ(pole.latitude_deg, pole_deg);
    EXPECT_EQ(pole.longitude_deg, 0.0);
    EXPECT_NEAR(pole.ellipsoid_height_m, 5.0, 1e-8);
    // A metre north of the north pole there is Greenwich behind one, and the date line ahead.
    EXPECT_NEAR(std::abs(map.Reverse({0.0, 1.0, 0.0}).longitude_deg), pole_deg > 0.0 ? 180.0 : 0.0, 1e-9);
  }
  constexpr double kEquatorRadiusM = 6378137.0;
  const GeodeticPlace centre = LocalFrame({0.0, 0.0, 0.0}).Reverse({0.0, 0.0, -kEquatorRadiusM});
  EXPECT_EQ(centre.latitude_deg, 90.0);
  EXPECT_NEAR(centre.ellipsoid_height_m, -6356752.314245, 1e-3);
  // Not a right answer, but a finite one, for all that a message may hold.
  for (const double x_m : {-1e6, 0.0, 1e6}) {
    for (const double z_m : {-kEquatorRadiusM - 40'000.0, -kEquatorRadiusM + 1.0, -1e5, 1e5}) {
      const GeodeticPlace place = LocalFrame({0.0, 0.0, 0.0}).Reverse({x_m, 1.0, z_m});
      EXPECT_TRUE(std::isfinite(place.latitude_deg + place.longitude_deg + place.ellipsoid_height_m)) << x_m << ", " << z_m;
    }
  }
}

TEST(LocalFrame, GivesNoPlaceForWhatIsNone) {
  const LocalFrame map({43.63, -72.15, 201.0});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d p_map_m(1.0, 2.0, 3.0);
    p_map_m[axis] = kNan;
    const GeodeticPlace place = map.Reverse(p_map_m);
    EXPECT_TRUE(std::isnan(place.latitude_deg)) << axis;
    EXPECT_TRUE(std::isnan(place.longitude_deg)) << axis;
    EXPECT_TRUE(std::isnan(place.ellipsoid_height_m)) << axis;
  }
}

TEST(NormalGravity, IsThatOfGeographicLib) {
  constexpr std::uint64_t kSeed = 4;
  double worst_mps2 = 0.0;
  const auto& reference = GeographicLib::NormalGravity::WGS84();
  for (const auto& place : Places(kSeed, 20'000, -1000.0, 10'000.0)) {
    double north_mps2 = 0.0;
    double up_mps2 = 0.0;
    reference.Gravity(place.latitude_deg, place.ellipsoid_height_m, north_mps2, up_mps2);
    worst_mps2 = std::max(worst_mps2, std::abs(NormalGravityMps2(place.latitude_deg, place.ellipsoid_height_m) + up_mps2));
  }
  EXPECT_LT(worst_mps2, 1e-6) << "seed " << kSeed;
  EXPECT_EQ(kEarthRateRadps, reference.AngularVelocity());
  std::printf("worst %.3g m/s2\n", worst_mps2);
}

}  // namespace
}  // namespace lookout
