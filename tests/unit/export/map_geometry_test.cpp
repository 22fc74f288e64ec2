#include "tools/export/map_geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>

#include "tools/export/geojson.hpp"

namespace lookout::exporter {
namespace {

MapPlace Place(double longitude_deg, double latitude_deg) { return ToMapPlace({latitude_deg, longitude_deg, 0.0}); }

std::string Json(const Geometry& geometry) {
  std::string json;
  AppendJsonGeometry(geometry, json);
  return json;
}

// In square degrees, positive counter-clockwise.
double AreaDeg2(const std::vector<MapPlace>& ring) {
  double sum = 0.0;
  for (std::size_t i = 1; i < ring.size(); ++i) {
    sum += 1e-18 * (static_cast<double>(ring[i - 1].longitude_ndeg) * static_cast<double>(ring[i].latitude_ndeg) -
                    static_cast<double>(ring[i].longitude_ndeg) * static_cast<double>(ring[i - 1].latitude_ndeg));
  }
  return 0.5 * sum;
}

TEST(MapPlace, IsWrittenLongitudeFirstWithNineDecimals) {
  EXPECT_EQ(Wkt(PointAt(Place(-72.2895, 43.7022))), "POINT(-72.289500000 43.702200000)");
  EXPECT_EQ(Json(PointAt(Place(-1e-10, 0.0))), R"({"type":"Point","coordinates":[0.000000000,0.000000000]})");
  EXPECT_EQ(Place(190.0, 0.0), Place(-170.0, 0.0));
}

TEST(Polygon, IsClosedAndCounterClockwise) {
  const std::vector<MapPlace> clockwise{Place(0.0, 0.0), Place(0.0, 1.0), Place(1.0, 1.0), Place(1.0, 0.0)};
  const auto polygon = PolygonAround(clockwise);
  ASSERT_EQ(polygon.kind, Geometry::Kind::kPolygon);
  ASSERT_EQ(polygon.parts.size(), 1U);
  EXPECT_EQ(polygon.parts[0].front(), polygon.parts[0].back());
  EXPECT_EQ(polygon.parts[0].size(), 5U);
  EXPECT_DOUBLE_EQ(AreaDeg2(polygon.parts[0]), 1.0);
  auto closed = clockwise;
  closed.push_back(closed.front());
  EXPECT_EQ(PolygonAround(closed).parts, polygon.parts);
  EXPECT_EQ(Wkt(polygon),
            "POLYGON((0.000000000 0.000000000,1.000000000 0.000000000,1.000000000 1.000000000,0.000000000 1.000000000,0.000000000 0.000000000))");
}

TEST(Polygon, WithoutAreaIsALineOrAPoint) {
  EXPECT_EQ(PolygonAround(std::vector{Place(1.0, 2.0)}).kind, Geometry::Kind::kPoint);
  EXPECT_EQ(PolygonAround(std::vector{Place(1.0, 2.0), Place(1.0, 2.0)}).kind, Geometry::Kind::kPoint);
  EXPECT_EQ(PolygonAround(std::vector{Place(1.0, 2.0), Place(2.0, 2.0)}).kind, Geometry::Kind::kLine);
  EXPECT_EQ(PolygonAround(std::vector{Place(1.0, 2.0), Place(2.0, 2.0), Place(3.0, 2.0)}).kind, Geometry::Kind::kLine);
}

TEST(Polygon, IsCutAtTheHundredAndEightiethMeridian) {
  const auto polygon = PolygonAround(std::vector{Place(179.0, 0.0), Place(-179.0, 0.0), Place(-179.0, 1.0), Place(179.0, 1.0)});
  ASSERT_EQ(polygon.parts.size(), 2U);
  for (const auto& ring : polygon.parts) {
    EXPECT_DOUBLE_EQ(AreaDeg2(ring), 1.0);
    EXPECT_EQ(ring.front(), ring.back());
    for (std::size_t i = 1; i < ring.size(); ++i) EXPECT_LE(std::abs(ring[i].longitude_ndeg - ring[i - 1].longitude_ndeg), 1'000'000'000);
  }
  EXPECT_TRUE(Wkt(polygon).starts_with("MULTIPOLYGON(((")) << Wkt(polygon);
  EXPECT_TRUE(Json(polygon).starts_with(R"({"type":"MultiPolygon","coordinates":[[[[)")) << Json(polygon);
}

// A U that lies on its side has two arms in the west: three parts.
TEST(Polygon, OfAConcaveShapeIsCutIntoAsManyPartsAsItHas) {
  const auto polygon = PolygonAround(std::vector{Place(179.0, 0.0), Place(-179.0, 0.0), Place(-179.0, 1.0), Place(179.5, 1.0), Place(179.5, 2.0),
                                                 Place(-179.0, 2.0), Place(-179.0, 3.0), Place(179.0, 3.0)});
  ASSERT_EQ(polygon.parts.size(), 3U);
  double area_deg2 = 0.0;
  for (const auto& ring : polygon.parts) {
    EXPECT_GT(AreaDeg2(ring), 0.0);
    area_deg2 += AreaDeg2(ring);
  }
  EXPECT_DOUBLE_EQ(area_deg2, 6.0 - 1.5);
}

TEST(Polygon, ThatOnlyTouchesTheMeridianIsNotCut) {
  for (const double side_deg : {180.0, -180.0}) {
    for (std::size_t first = 0; first < 3; ++first) {
      std::vector corners{Place(179.0, 0.0), Place(side_deg, 0.5), Place(179.0, 1.0)};
      std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(first), corners.end());
      const auto east = PolygonAround(corners);
      ASSERT_EQ(east.parts.size(), 1U) << side_deg << " " << first;
      EXPECT_DOUBLE_EQ(AreaDeg2(east.parts[0]), 0.5);
      std::vector western{Place(-179.0, 0.0), Place(side_deg, 0.0), Place(side_deg, 1.0)};
      std::rotate(western.begin(), western.begin() + static_cast<std::ptrdiff_t>(first), western.end());
      const auto west = PolygonAround(western);
      ASSERT_EQ(west.parts.size(), 1U) << side_deg << " " << first;
      EXPECT_DOUBLE_EQ(AreaDeg2(west.parts[0]), 0.5);
    }
  }
}

TEST(Polygon, AroundAPoleHoldsThePole) {
  for (const double pole_deg : {90.0, -90.0}) {
    const double latitude_deg = pole_deg * (89.0 / 90.0);
    const auto polygon =
        PolygonAround(std::vector{Place(10.0, latitude_deg), Place(100.0, latitude_deg), Place(-170.0, latitude_deg), Place(-80.0, latitude_deg)});
    ASSERT_EQ(polygon.parts.size(), 1U);
    EXPECT_NEAR(AreaDeg2(polygon.parts[0]), 360.0, 1e-9);
    EXPECT_NE(std::ranges::find(polygon.parts[0], Place(180.0, pole_deg)), polygon.parts[0].end());
    EXPECT_NE(std::ranges::find(polygon.parts[0], MapPlace{-180'000'000'000, Place(0.0, pole_deg).latitude_ndeg}), polygon.parts[0].end());
  }
}

TEST(Line, IsCutAtTheMeridianWithATimeBetweenThoseOfItsNeighbours) {
  const std::vector places{Place(179.0, 10.0), Place(-179.0, 12.0), Place(-178.0, 12.0)};
  const std::vector<std::int64_t> utimes_us{1000, 3000, 4000};
  const auto line = LineAlong(places, utimes_us);
  ASSERT_EQ(line.parts.size(), 2U);
  EXPECT_EQ(line.parts[0], (std::vector{Place(179.0, 10.0), MapPlace{180'000'000'000, 11'000'000'000}}));
  EXPECT_EQ(line.parts[1], (std::vector{MapPlace{-180'000'000'000, 11'000'000'000}, Place(-179.0, 12.0), Place(-178.0, 12.0)}));
  EXPECT_EQ(line.utimes_us, (std::vector<std::vector<std::int64_t>>{{1000, 2000}, {2000, 3000, 4000}}));
  EXPECT_TRUE(Wkt(line).starts_with("MULTILINESTRING((179.")) << Wkt(line);
}

TEST(Line, OfOnePlaceIsAPoint) {
  EXPECT_EQ(LineAlong(std::vector{Place(1.0, 1.0), Place(1.0, 1.0)}).kind, Geometry::Kind::kPoint);
  const auto stays = LineAlong(std::vector{Place(1.0, 1.0), Place(1.0, 1.0)}, std::vector<std::int64_t>{1, 2});
  EXPECT_EQ(stays.kind, Geometry::Kind::kLine);  // at two times
  EXPECT_EQ(LinesAlong(std::vector<std::vector<MapPlace>>{{Place(1.0, 1.0)}, {Place(1.0, 1.0), Place(2.0, 1.0)}}).parts.size(), 1U);
}

TEST(MapOfDatum, FollowsTheCurveOfTheEarth) {
  const GeodeticPlace datum{54.0, 10.0, 45.0};
  const MapOfDatum map(datum);
  for (const auto& [latitude_deg, longitude_deg] : {std::pair(54.0, 10.0), {54.001, 10.002}, {54.6, 11.3}, {53.5, 8.9}}) {
    const auto p_map_m = LocalFrame(datum).Forward({latitude_deg, longitude_deg, 45.0});
    const auto place = map.PlaceAt(p_map_m.head<2>());
    EXPECT_LE(std::abs(place.latitude_ndeg - Place(longitude_deg, latitude_deg).latitude_ndeg), 90);  // 1 cm
    EXPECT_LE(std::abs(place.longitude_ndeg - Place(longitude_deg, latitude_deg).longitude_ndeg), 150);
  }
}

// Straight sides beside a pole are no straight lines between longitudes.
TEST(MapOfDatum, AddsCornersWhereMeridiansFanOut) {
  const MapOfDatum map({90.0, 0.0, 0.0});
  const std::array<Eigen::Vector2d, 4> beside{Eigen::Vector2d(-5.0, 1.0), {5.0, 1.0}, {5.0, 3.0}, {-5.0, 3.0}};
  const auto polygon = PolygonAround(map.Outline(beside));
  for (const auto& ring : polygon.parts) {
    EXPECT_GT(ring.size(), 30U);
    for (const auto& place : ring) {
      const double radius_m = LocalFrame({90.0, 0.0, 0.0})
                                  .Forward({1e-9 * static_cast<double>(place.latitude_ndeg), 1e-9 * static_cast<double>(place.longitude_ndeg), 0.0})
                                  .norm();
      EXPECT_GT(radius_m, 0.99);
    }
  }
  const std::array<Eigen::Vector2d, 4> around{Eigen::Vector2d(-5.0, -1.0), {5.0, -1.0}, {5.0, 3.0}, {-5.0, 3.0}};
  const auto holding = PolygonAround(map.Outline(around));
  ASSERT_EQ(holding.parts.size(), 1U);
  EXPECT_TRUE(std::ranges::any_of(holding.parts[0], [](const MapPlace& place) { return place.latitude_ndeg == 90'000'000'000; }));
}

TEST(MapOfDatum, EllipseHoldsNinetyFivePercent) {
  const MapOfDatum map({0.0, 0.0, 0.0});
  const auto circle = map.Ellipse({0.0, 0.0}, {4.0, 0.0, 4.0});
  ASSERT_EQ(circle.size(), 37U);
  const LocalFrame frame({0.0, 0.0, 0.0});
  for (const auto& place : circle) {
    const auto p_m = frame.Forward({1e-9 * static_cast<double>(place.latitude_ndeg), 1e-9 * static_cast<double>(place.longitude_ndeg), 0.0});
    EXPECT_NEAR(p_m.head<2>().norm(), 2.0 * 2.447746831, 1e-3);
  }
  // Along the diagonal: errors to the east go with such to the north.
  double reach = 0.0;
  double across = 0.0;
  for (const auto& place : map.Ellipse({0.0, 0.0}, {1.0, 0.96, 1.0})) {
    const auto p_m = frame.Forward({1e-9 * static_cast<double>(place.latitude_ndeg), 1e-9 * static_cast<double>(place.longitude_ndeg), 0.0});
    reach = std::max(reach, (p_m.x() + p_m.y()) / std::sqrt(2.0));
    across = std::max(across, (p_m.y() - p_m.x()) / std::sqrt(2.0));
  }
  EXPECT_NEAR(reach, 2.4477 * 1.4, 0.05);
  EXPECT_NEAR(across, 2.4477 * 0.2, 0.02);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(map.Ellipse({0.0, 0.0}, {kNone, 0.0, 1.0}).empty());
  EXPECT_TRUE(map.Ellipse({0.0, 0.0}, {1.0, 1.0, 1.0}).empty());
  EXPECT_TRUE(map.Ellipse({0.0, 0.0}, {1e12, 0.0, 1.0}).empty());
}

TEST(Near, HoldsWhatLiesWithinItsRadius) {
  const Near near({60.0, 180.0, 0.0}, 100.0);
  EXPECT_TRUE(near.Holds(Place(-179.999, 60.0)));  // 56 m
  EXPECT_FALSE(near.Holds(Place(-179.998, 60.0)));
  // A line that passes, though its ends are far; an area around.
  EXPECT_TRUE(near.Holds(LineAlong(std::vector{Place(179.9, 60.0005), Place(-179.9, 60.0005)})));
  EXPECT_FALSE(near.Holds(LineAlong(std::vector{Place(179.9, 60.003), Place(-179.9, 60.003)})));
  const Near ashore({60.0, 10.0, 0.0}, 100.0);
  EXPECT_TRUE(ashore.Holds(PolygonAround(std::vector{Place(9.0, 59.5), Place(11.0, 59.5), Place(11.0, 60.5), Place(9.0, 60.5)})));
  EXPECT_FALSE(ashore.Holds(PolygonAround(std::vector{Place(9.0, 59.5), Place(9.9, 59.5), Place(9.9, 60.5), Place(9.0, 60.5)})));
  // On the other side of the earth.
  EXPECT_FALSE(ashore.Holds(PolygonAround(std::vector{Place(-171.0, -60.5), Place(-169.0, -60.5), Place(-169.0, -59.5), Place(-171.0, -59.5)})));
}

TEST(JsonText, IsEscaped) {
  std::string json;
  AppendJsonString("a \"b\" \\ \x1b[2J \xff\nc \xc3\xa9", json);
  EXPECT_EQ(json, "\"a \\\"b\\\" \\\\ ?[2J ?\\n  c \xc3\xa9\"");
  json.clear();
  AppendJsonValue(Fixed{std::numeric_limits<double>::quiet_NaN(), 2}, json);
  EXPECT_EQ(json, "null");
}

}  // namespace
}  // namespace lookout::exporter
