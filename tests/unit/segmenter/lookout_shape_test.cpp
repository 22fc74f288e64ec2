// Shapes: fast hulls and rectangles against obvious ones, boxes of what shows two sides, and lines of few points.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <span>
#include <tuple>
#include <vector>

#include "common/core/angles.hpp"
#include "services/segmenter/core/footprint.hpp"
#include "services/segmenter/core/line_simplifier.hpp"

namespace lookout::segmenter {
namespace {

using Points = std::vector<FootprintPoint>;

double Turn(const FootprintPoint& a, const FootprintPoint& b, const FootprintPoint& c) {
  return (double{b.x_m} - a.x_m) * (double{c.y_m} - a.y_m) - (double{b.y_m} - a.y_m) * (double{c.x_m} - a.x_m);
}

// Of all points, none dropped before: gift wrapping from the point of least x, then y. Points at one place are one.
Points WrappedHull(Points points) {
  const auto key = [](const FootprintPoint& point) { return std::tuple(point.x_m, point.y_m, point.return_index); };
  std::ranges::sort(points, {}, key);
  const auto at_one_place = [](const auto& a, const auto& b) { return a.x_m == b.x_m && a.y_m == b.y_m; };
  points.erase(std::unique(points.begin(), points.end(), at_one_place), points.end());
  Points hull{points.front()};
  while (points.size() > 1) {
    const auto& from = hull.back();
    const FootprintPoint* next = nullptr;
    for (const auto& point : points) {
      if (at_one_place(point, from)) continue;
      const double turn_m2 = next == nullptr ? -1.0 : Turn(from, *next, point);
      const auto squared_m2 = [&](const FootprintPoint& to) {
        return std::pow(double{to.x_m} - from.x_m, 2) + std::pow(double{to.y_m} - from.y_m, 2);
      };
      if (turn_m2 < 0.0 || (turn_m2 == 0.0 && squared_m2(point) > squared_m2(*next))) next = &point;
    }
    if (at_one_place(*next, hull.front())) break;
    hull.push_back(*next);
  }
  return hull;
}

// A cloud of one of several forms, some places doubled.
Points Cloud(std::mt19937_64& random) {
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  const auto form = random() % 5;
  const auto count = 1 + random() % (form == 4 ? 2000 : 300);
  const double far_x_m = uniform(-80.0, 80.0);
  const double far_y_m = uniform(-80.0, 80.0);
  Points points;
  for (std::uint64_t i = 0; i < count; ++i) {
    double x_m = uniform(-3.0, 3.0);
    double y_m = uniform(-1.0, 1.0);
    if (form == 1) y_m = 0.3 * x_m + uniform(-0.01, 0.01);                                         // a wall
    if (form == 2) x_m = std::round(x_m), y_m = std::round(y_m);                                   // many in line, many at one place
    if (form == 3) y_m = random() % 2 == 0 ? -1.0 : uniform(-1, 1), x_m = y_m > -1.0 ? 3.0 : x_m;  // two sides
    if (form == 4) {
      const double angle_rad = uniform(0.0, kTwoPi);
      x_m = 20.0 * std::cos(angle_rad);
      y_m = 20.0 * std::sin(angle_rad);
    }
    points.push_back({static_cast<float>(x_m + far_x_m), static_cast<float>(y_m + far_y_m), static_cast<std::int32_t>(i)});
  }
  std::ranges::shuffle(points, random);
  return points;
}

TEST(ConvexHullReference, IsThatOfAllPointsNoneDropped) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 400; ++round) {
    const auto points = Cloud(random);
    const auto expected = WrappedHull(points);
    const auto hull = ConvexHull(points);
    ASSERT_EQ(hull.size(), expected.size()) << "round " << round;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      ASSERT_EQ(hull[i].x_m, expected[i].x_m) << "round " << round;
      ASSERT_EQ(hull[i].y_m, expected[i].y_m) << "round " << round;
      ASSERT_EQ(hull[i].return_index, expected[i].return_index) << "round " << round;
    }
  }
}

double AreaM2(const Rectangle& rectangle) { return double{rectangle.length_m} * rectangle.width_m; }

TEST(LeastAreaRectangleReference, HasTheAreaOfTheBestEdgeOverAllCorners) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 400; ++round) {
    const auto hull = ConvexHull(Cloud(random));
    if (hull.size() < 3) continue;
    double least_m2 = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const auto& from = hull[i];
      const auto& to = hull[(i + 1) % hull.size()];
      const double edge_m = std::hypot(double{to.x_m} - from.x_m, double{to.y_m} - from.y_m);
      const double x = (double{to.x_m} - from.x_m) / edge_m;
      const double y = (double{to.y_m} - from.y_m) / edge_m;
      double least_along_m = 0.0;
      double greatest_along_m = 0.0;
      double greatest_across_m = 0.0;
      for (const auto& corner : hull) {
        const double along_m = x * (double{corner.x_m} - from.x_m) + y * (double{corner.y_m} - from.y_m);
        least_along_m = std::min(least_along_m, along_m);
        greatest_along_m = std::max(greatest_along_m, along_m);
        greatest_across_m = std::max(greatest_across_m, x * (double{corner.y_m} - from.y_m) - y * (double{corner.x_m} - from.x_m));
      }
      least_m2 = std::min(least_m2, (greatest_along_m - least_along_m) * greatest_across_m);
    }
    ASSERT_NEAR(AreaM2(LeastAreaRectangle(hull)), least_m2, 1e-4 * (1.0 + least_m2)) << "round " << round;
  }
}

TEST(Box, HoldsEveryPointAndIsAtMostAThirdLargerThanTheLeast) {
  std::mt19937_64 random(5);
  Footprint footprint;
  for (int round = 0; round < 400; ++round) {
    const auto points = Cloud(random);
    footprint.Measure(points);
    const auto& box = footprint.box();
    const double along_x = std::cos(box.length_azimuth_rad);
    const double along_y = -std::sin(box.length_azimuth_rad);  // azimuth goes clockwise
    // Where the hull was simplified, what was cut off sticks out: 0.62 % of an edge.
    const double slack_m = 1e-4 + (ConvexHull(points).size() > kMaxHullCorners ? 0.0062 * box.length_m : 0.0);
    for (const auto& point : points) {
      const double x_m = double{point.x_m} - box.center_x_m;
      const double y_m = double{point.y_m} - box.center_y_m;
      ASSERT_LE(std::abs(x_m * along_x + y_m * along_y), box.length_m / 2 + slack_m) << "round " << round;
      ASSERT_LE(std::abs(x_m * along_y - y_m * along_x), box.width_m / 2 + slack_m) << "round " << round;
    }
    const double least_m2 = AreaM2(LeastAreaRectangle(footprint.hull()));
    ASSERT_LE(AreaM2(box), kBoxArea * least_m2 * (1.0 + 1e-5) + 1e-6) << "round " << round;
    ASSERT_GE(box.length_m, box.width_m);
  }
}

// Two sides of a boat of 6 m by 2.2 m, as a lidar sees them: evenly in angle, with 3 cm of noise along the beam.
Points TwoSides(double heading_rad, double bearing_rad, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise_m(0.0, 0.03);
  constexpr double kBoatRangeM = 14.0;
  const double middle_x_m = kBoatRangeM * std::cos(bearing_rad);
  const double middle_y_m = kBoatRangeM * std::sin(bearing_rad);
  Points points;
  for (double azimuth_rad = bearing_rad - 0.4; azimuth_rad < bearing_rad + 0.4; azimuth_rad += 0.0035) {
    // In the boat's own frame: where the beam enters its box.
    const auto turn_x = [&](double x, double y) { return x * std::cos(heading_rad) + y * std::sin(heading_rad); };
    const auto turn_y = [&](double x, double y) { return -x * std::sin(heading_rad) + y * std::cos(heading_rad); };
    const double beam_x = turn_x(std::cos(azimuth_rad), std::sin(azimuth_rad));
    const double beam_y = turn_y(std::cos(azimuth_rad), std::sin(azimuth_rad));
    const double from_x_m = turn_x(-middle_x_m, -middle_y_m);
    const double from_y_m = turn_y(-middle_x_m, -middle_y_m);
    const double enters_x_m = (-std::copysign(3.0, beam_x) - from_x_m) / beam_x;
    const double leaves_x_m = (std::copysign(3.0, beam_x) - from_x_m) / beam_x;
    const double enters_y_m = (-std::copysign(1.1, beam_y) - from_y_m) / beam_y;
    const double leaves_y_m = (std::copysign(1.1, beam_y) - from_y_m) / beam_y;
    const double enters_m = std::max(enters_x_m, enters_y_m);
    if (enters_m > std::min(leaves_x_m, leaves_y_m)) continue;
    const double seen_m = enters_m + noise_m(random);
    points.push_back({static_cast<float>(seen_m * std::cos(azimuth_rad)), static_cast<float>(seen_m * std::sin(azimuth_rad)),
                      static_cast<std::int32_t>(points.size())});
  }
  return points;
}

TEST(Box, OfTwoSidesHasTheirDirectionAndSize) {
  Footprint footprint;
  for (const double bearing_rad : {0.0, 1.3, 3.1, 4.4}) {
    // Both sides show at least 1 m of width: 30 to 60 degrees, and the same on the other bow.
    for (int degrees = 30; degrees <= 150; degrees += 5) {
      if (degrees > 60 && degrees < 120) continue;
      const double heading_rad = bearing_rad + DegToRad(degrees);
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        footprint.Measure(TwoSides(heading_rad, bearing_rad, seed));
        const auto& box = footprint.box();
        const double off_rad = std::abs(std::remainder(-double{box.length_azimuth_rad} - heading_rad, kPi));
        EXPECT_LT(RadToDeg(off_rad), 3.0) << "bearing " << bearing_rad << ", " << degrees << " degrees, seed " << seed;
        EXPECT_NEAR(box.length_m, 6.0, 0.35) << "bearing " << bearing_rad << ", " << degrees << " degrees, seed " << seed;
        EXPECT_NEAR(box.width_m, 2.2, 0.35) << "bearing " << bearing_rad << ", " << degrees << " degrees, seed " << seed;
      }
    }
  }
}

TEST(Box, DoesNotDependOnWhatWasMeasuredBefore) {
  std::mt19937_64 random(6);
  Footprint used;
  for (int round = 0; round < 50; ++round) {
    const auto points = Cloud(random);
    used.Measure(points);
    Footprint fresh;
    fresh.Measure(points);
    ASSERT_EQ(used.hull().size(), fresh.hull().size());
    ASSERT_EQ(used.box().length_m, fresh.box().length_m);
    ASSERT_EQ(used.box().center_x_m, fresh.box().center_x_m);
    ASSERT_EQ(used.box().length_azimuth_rad, fresh.box().length_azimuth_rad);
  }
}

double OffM(const FootprintPoint& point, const FootprintPoint& a, const FootprintPoint& b) {
  const double x_m = double{b.x_m} - a.x_m;
  const double y_m = double{b.y_m} - a.y_m;
  const double length_m2 = x_m * x_m + y_m * y_m;
  const double along_m2 = (double{point.x_m} - a.x_m) * x_m + (double{point.y_m} - a.y_m) * y_m;
  const double share = length_m2 > 0.0 ? std::clamp(along_m2 / length_m2, 0.0, 1.0) : 0.0;
  return std::hypot(point.x_m - a.x_m - share * x_m, point.y_m - a.y_m - share * y_m);
}

Points Shoreline(std::uint64_t seed, int count, double ragged_m) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> off_m(-ragged_m, ragged_m);
  Points line;
  for (int i = 0; i < count; ++i) {
    line.push_back({0.1F * static_cast<float>(i), static_cast<float>(20.0 + std::sin(i / 30.0) + off_m(random)), i});
  }
  return line;
}

TEST(LineSimplifier, LeavesLinesOfUpToTwoPointsAlone) {
  LineSimplifier simplifier;
  EXPECT_TRUE(simplifier.Simplify({}, 0.1, 2).empty());
  const auto line = Shoreline(1, 2, 0.0);
  EXPECT_EQ(simplifier.Simplify(std::span(line).first(1), 0.1, 2).size(), 1U);
  EXPECT_EQ(simplifier.Simplify(line, 0.1, 2).size(), 2U);
}

TEST(LineSimplifier, OfAStraightLineKeepsTheEnds) {
  Points line;
  for (int i = 0; i < 100; ++i) line.push_back({static_cast<float>(i), 2.0F * static_cast<float>(i), i});
  LineSimplifier simplifier;
  const auto kept = simplifier.Simplify(line, 0.1, 256);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept.front().return_index, 0);
  EXPECT_EQ(kept.back().return_index, 99);
}

TEST(LineSimplifier, KeepsOrderAndEndsAndLeavesNothingFartherOffThanItMay) {
  LineSimplifier simplifier;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto line = Shoreline(seed, 400, 0.15);
    const auto kept = simplifier.Simplify(line, 0.2, 256);
    ASSERT_LT(kept.size(), line.size());
    ASSERT_EQ(kept.front().return_index, 0);
    ASSERT_EQ(kept.back().return_index, 399);
    for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
      ASSERT_LT(kept[i].return_index, kept[i + 1].return_index);
      for (std::int32_t point = kept[i].return_index; point <= kept[i + 1].return_index; ++point) {
        ASSERT_LE(OffM(line[static_cast<std::size_t>(point)], kept[i], kept[i + 1]), 0.2 + 1e-9) << "seed " << seed;
      }
    }
  }
}

TEST(LineSimplifier, GoesFartherOffWhereThereAreTooManyPoints) {
  LineSimplifier simplifier;
  for (const std::size_t max_points : {2U, 16U, 256U}) {
    const auto line = Shoreline(7, 2000, 2.0);
    EXPECT_LE(simplifier.Simplify(line, 0.1, max_points).size(), max_points);
  }
}

TEST(LineSimplifier, OfManyPointsAtOnePlaceKeepsTwo) {
  const Points line(500, FootprintPoint{3.0F, 4.0F, 1});
  LineSimplifier simplifier;
  EXPECT_EQ(simplifier.Simplify(line, 0.1, 256).size(), 2U);
}

}  // namespace
}  // namespace lookout::segmenter
