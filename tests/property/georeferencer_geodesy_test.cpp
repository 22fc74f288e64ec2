// Latitudes and longitudes of obstacles against numbers from elsewhere: the date line, near the poles, the south, the equator.
//
// East, north and up of each place were computed with 40 digits by the closed formulas (geodetic to geocentric on WGS84, then turned into the axes
// of the datum; Hofmann-Wellenhof et al., GNSS, 2008, equations 8.4 and 8.46), without GeographicLib. So computed the first is the example of
// GeographicLib's own CartConvert(1): `echo 33.3 44.4 6000 | CartConvert -l 33 44 20` prints 37288.97 33374.29.
#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "services/georeferencer/core/placement.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

struct Case {
  const char* name;
  Datum datum;
  double latitude_deg;
  double longitude_deg;
  Eigen::Vector3d east_north_up_m;
};

const Case kCases[] = {
    {"example of CartConvert", {33.0, 44.0, 20.0}, 33.3, 44.4, {37288.97319662, 33374.2949469, 5783.646615518}},
    {"east over the date line", {-16.79, 179.998, 55.0}, -16.795, -179.997, {533.0093260118, -553.3467341427, 1.453590510033}},
    {"west over the date line", {-16.79, -179.998, 55.0}, -16.785, 179.9975, {-479.7333132078, 553.3340875879, -1.042179961447}},
    {"over the north pole", {89.99, 12.0, 14.0}, 89.995, -170.0, {19.49036401466, 1675.073395546, 0.7807482482713}},
    {"beside the south pole", {-89.98, 0.0, 2800.0}, -89.975, 60.0, {2419.303942885, -838.0713680053, 0.488051281261}},
    {"southern hemisphere", {-54.801, -68.303, 20.0}, -54.811, -68.293, {642.9476625761, -1113.248515629, -2.129486816617}},
    {"over the equator and Greenwich", {0.0, 0.0, 0.0}, -0.004, 0.005, {556.5975391791, -442.2971727475, 0.9602747669368}},
    {"the lake of the simulator", {43.63, -72.15, 201.0}, 43.6304, -72.1497, {24.2114888583, 44.44346359445, 0.9997989840735}},
};

// A degree of latitude, metres; 1 % does not matter here.
constexpr double kMetresPerDegree = 111'000.0;

TEST(GeoreferencerGeodesy, PlacesOfOtherSourcesAreMetWithinAMillimetre) {
  for (const auto& one : kCases) {
    SCOPED_TRACE(one.name);
    // The boat lies at the datum and heads south-west: its north is that of the map.
    const Eigen::Vector3d& way_m = one.east_north_up_m;
    PoseHistory poses;
    for (const std::int64_t offset_us : {0, 20'000}) {
      Pose pose = test::MakePose(offset_us);
      pose.datum = one.datum;
      pose.position_map_m = Eigen::Vector3d::Zero();
      pose.heading_rad = DegToRad(225.0);
      poses.Add(pose);
    }
    // Ahead is south-west, port is south-east.
    const double ahead_m = -(way_m.x() + way_m.y()) / std::sqrt(2.0);
    const double port_m = (way_m.x() - way_m.y()) / std::sqrt(2.0);
    const auto obstacle = PlaceSegment(test::MakePoint(10'000, ahead_m, port_m, way_m.z()), poses, one.datum, false, {});
    ASSERT_EQ(obstacle.status, ObstacleStatus::kOk);
    EXPECT_LT(std::abs(obstacle.latitude_deg - one.latitude_deg) * kMetresPerDegree, 1e-3) << obstacle.latitude_deg;
    const double longitude_error_rad = WrapToPi(DegToRad(obstacle.longitude_deg - one.longitude_deg));
    EXPECT_LT(std::abs(RadToDeg(longitude_error_rad)) * kMetresPerDegree * std::cos(DegToRad(one.latitude_deg)), 1e-3) << obstacle.longitude_deg;
    EXPECT_LE(std::abs(obstacle.longitude_deg), 180.0);
    EXPECT_LT((obstacle.position_map_m - one.east_north_up_m.head<2>()).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace lookout::georeferencer
