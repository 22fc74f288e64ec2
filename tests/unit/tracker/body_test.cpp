#include "services/tracker/core/body.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <optional>
#include <random>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout::tracker {
namespace {

using Outline = std::vector<Eigen::Vector2d>;

constexpr double kScanS = 0.1;
constexpr double kMoving = 0.95;

// A box as a lidar sees it: the corners that its visible sides have, between the two that lie farthest left and right, moved by noise.
struct Box {
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  double course_rad = 0.0;  // of its length, counter-clockwise from east
  double length_m = 5.0;
  double width_m = 2.0;

  Outline Corners() const {
    const Eigen::Vector2d along(std::cos(course_rad), std::sin(course_rad));
    const Eigen::Vector2d across(-along.y(), along.x());
    Outline corners;
    for (const auto& [a, b] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
      corners.emplace_back(middle_m + 0.5 * a * length_m * along + 0.5 * b * width_m * across);
    }
    return corners;
  }

  /// Counter-clockwise.
  Outline SeenFrom(const Eigen::Vector2d& from_m) const {
    const Outline corners = Corners();
    Outline seen;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto is_side_seen = [&](std::size_t first) {
        const Eigen::Vector2d edge = corners[(first + 1) % 4] - corners[first % 4];
        return Cross(edge, from_m - corners[first % 4]) < 0.0;
      };
      if (is_side_seen(i) || is_side_seen(i + 3)) seen.push_back(corners[i]);
    }
    return seen;
  }
};

Outline Shaken(Outline outline, double sd_m, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, sd_m);
  for (auto& corner : outline) corner += Eigen::Vector2d(noise(random), noise(random));
  return outline;
}

Outline Turned(Outline outline, const Eigen::Vector2d& about_m, double angle_rad) {
  const Eigen::Rotation2Dd turn(angle_rad);
  for (auto& corner : outline) corner = about_m + turn * (corner - about_m);
  return outline;
}

// Of position and of velocity, divided by their two degrees of freedom: 1 in the mean.
double Nees(const Eigen::Vector2d& error, const Eigen::Matrix2d& covariance) { return 0.5 * error.dot(covariance.inverse() * error); }

double DegreesOf(const Eigen::Vector2d& velocity_mps) { return RadToDeg(std::atan2(velocity_mps.y(), velocity_mps.x())); }

const Eigen::Matrix2d kNoise = Eigen::Matrix2d::Identity() * 0.03 * 0.03;

TEST(Body, StandsWhileTheOwnBoatTurns) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (const double range_m : {10.0, 30.0, 60.0}) {
    const Box box{{range_m, 0.0}, 1.0};
    double heading_error_rad = 0.0;
    Body body(box.SeenFrom({0.0, 0.0}), {}, kNoise, range_m);
    for (int scan = 0; scan < 3000; ++scan) {
      // At 30 deg/s, 5 ms late or early by turns of 2 s, and 0.2 deg of what the compass wanders over seconds.
      heading_error_rad += -0.02 * heading_error_rad + 0.2 * DegToRad(0.2) * normal(random);
      const double late_rad = DegToRad(30.0) * 0.005 * std::sin(scan * kScanS * kPi / 2.0);
      const Outline seen = Turned(Shaken(box.SeenFrom({0.0, 0.0}), 0.03, random), {0.0, 0.0}, heading_error_rad + late_rad);
      body.Predict(kScanS);
      body.Update(seen, {}, kNoise, range_m, true);
      ASSERT_FALSE(body.IsMoving(kMoving)) << range_m << " m, scan " << scan << ", " << body.velocity_mps().norm() << " m/s";
    }
    EXPECT_LT((body.center_m() - box.middle_m).norm(), 1.0) << range_m;
  }
}

TEST(Body, ThatComesIntoSightSlowlyStands) {
  std::mt19937_64 random(2);
  // From behind another at the left: half a metre a second more of its 8 m.
  Body body({{20.0, 3.0}, {20.0, 4.0}}, {{0.0, 0.0}, false, true}, kNoise, 20.0);
  for (int scan = 0; scan < 200; ++scan) {
    const double to_m = std::max(-4.0, 3.0 - 0.05 * scan);
    const bool is_hidden = to_m > -4.0;
    body.Predict(kScanS);
    body.Update(Shaken({{20.0, to_m}, {20.5, 4.0}, {20.0, 4.0}}, 0.03, random), {{0.0, 0.0}, false, is_hidden}, kNoise, 20.0, true);
    ASSERT_FALSE(body.IsMoving(kMoving)) << scan;
  }
  EXPECT_NEAR(body.center_m().y(), 0.0, 0.2);
}

// Only the stern is seen for a while, behind a wave or another boat: nothing has moved, and the bow is still there. If it stays so, the stern is all.
TEST(Body, OfWhichAPartIsSeenStands) {
  std::mt19937_64 random(5);
  const Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
  const Eigen::Matrix2d noise_m2 = Eigen::Matrix2d::Identity() * 1e-4;
  const Box boat{.middle_m = {0.0, 20.0}, .length_m = 6.0};
  const Box stern{.middle_m = {-2.5, 20.0}, .length_m = 1.0};
  Body body(boat.SeenFrom(from_m), {.from_m = from_m}, noise_m2, 20.0);
  const auto length_of = [](const Body& of) { return RectangleAround(of.Outline()).length_m; };
  const auto look = [&](const Box& box) {
    body.Predict(kScanS);
    body.Update(Shaken(box.SeenFrom(from_m), 0.02, random), {.from_m = from_m}, noise_m2, 20.0, true);
    EXPECT_FALSE(body.IsMoving(kMoving));
  };
  for (int scan = 0; scan < 40; ++scan) look(boat);
  const Eigen::Vector2d center_m = body.center_m();
  for (int scan = 0; scan < 20; ++scan) look(stern);
  EXPECT_GT(length_of(body), 5.0);
  EXPECT_LT((body.center_m() - center_m).norm(), 1.0);
  for (int scan = 0; scan < 60; ++scan) look(stern);
  EXPECT_LT(length_of(body), 3.0);
}

// Bow and paddler of a kayak, each for a second.
TEST(Body, OfWhichTwoPartsAreSeenByTurnsStandsOrMovesAndKeepsBoth) {
  for (const double speed_mps : {0.0, 1.5}) {
    SCOPED_TRACE(speed_mps);
    std::mt19937_64 random(6);
    const Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
    const Eigen::Matrix2d noise_m2 = Eigen::Matrix2d::Identity() * 1e-4;
    Box bow{.middle_m = {-8.0, 20.0}, .length_m = 1.2, .width_m = 0.5};
    Box paddler{.middle_m = {-10.0, 20.0}, .length_m = 0.5, .width_m = 0.5};
    Body body(bow.SeenFrom(from_m), {.from_m = from_m}, noise_m2, 20.0);
    const auto look = [&](int scan, bool is_bow) {
      bow.middle_m.x() += speed_mps * kScanS;
      paddler.middle_m.x() += speed_mps * kScanS;
      const auto seen_m = Shaken((is_bow ? bow : paddler).SeenFrom(from_m), 0.02, random);
      body.Predict(kScanS);
      if (scan == 20) body.AddPart(seen_m, {.from_m = from_m}, 20.0, true);
      if (scan != 20) body.Update(seen_m, {.from_m = from_m}, noise_m2, 20.0, true);
    };
    for (int scan = 0; scan < 100; ++scan) {
      look(scan, scan < 20 || (scan / 10) % 2 == 1);
      EXPECT_TRUE(speed_mps > 0.0 || !body.IsMoving(kMoving)) << scan;
      if (speed_mps == 0.0 || scan < 40) continue;
      EXPECT_LT((body.velocity_mps() - Eigen::Vector2d(speed_mps, 0.0)).norm(), 0.4) << scan;
    }
    EXPECT_TRUE(Contains(body.Outline(), bow.middle_m));
    EXPECT_TRUE(Contains(body.Outline(), paddler.middle_m));
    // What is not seen for long while the other is was no part of it.
    for (int scan = 100; scan < 170; ++scan) look(scan, true);
    EXPECT_FALSE(Contains(body.Outline(), paddler.middle_m));
  }
}

TEST(Body, ThatPassesByKeepsItsCentre) {
  std::mt19937_64 random(3);
  Box box{{-25.0, 12.0}, 0.0};
  const Eigen::Vector2d velocity(3.0, 0.0);
  Body body(box.SeenFrom({0.0, 0.0}), {}, kNoise, box.middle_m.norm());
  for (int scan = 0; scan < 160; ++scan) {
    box.middle_m += velocity * kScanS;
    body.Predict(kScanS);
    body.Update(Shaken(box.SeenFrom({0.0, 0.0}), 0.03, random), {}, kNoise, box.middle_m.norm(), true);
    if (scan < 30) continue;
    ASSERT_TRUE(body.IsMoving(kMoving)) << scan;
    EXPECT_LT((body.center_m() - box.middle_m).norm(), 0.5) << scan;
    EXPECT_NEAR(body.velocity_mps().norm(), 3.0, 0.3) << scan;
    EXPECT_NEAR(DegreesOf(body.velocity_mps()), 0.0, 8.0) << scan;
  }
}

TEST(Body, TakesItsOutlineAlongInATurn) {
  std::mt19937_64 random(4);
  const double rate_radps = DegToRad(10.0);
  const double speed_mps = 4.0;
  Box box{{0.0, 20.0}, 0.0};
  Body body(box.SeenFrom({0.0, 0.0}), {}, kNoise, 20.0);
  for (int scan = 0; scan < 150; ++scan) {
    box.course_rad += rate_radps * kScanS;
    box.middle_m += speed_mps * kScanS * Eigen::Vector2d(std::cos(box.course_rad), std::sin(box.course_rad));
    body.Predict(kScanS);
    body.Update(Shaken(box.SeenFrom({0.0, 0.0}), 0.03, random), {}, kNoise, box.middle_m.norm(), true);
    if (scan < 80) continue;
    EXPECT_LT((body.center_m() - box.middle_m).norm(), 1.0) << scan;
    EXPECT_NEAR(body.velocity_mps().norm(), speed_mps, 0.4) << scan;
    EXPECT_NEAR(WrapToPi(DegToRad(DegreesOf(body.velocity_mps())) - box.course_rad), 0.0, DegToRad(10.0)) << scan;
    ASSERT_FALSE(std::isnan(body.turn_rate_radps())) << scan;
    EXPECT_NEAR(body.turn_rate_radps(), -rate_radps, DegToRad(4.0)) << scan << ": clockwise";
  }
}

TEST(Body, FrameMovesWithIt) {
  std::mt19937_64 random(6);
  Box box{{-10.0, 20.0}, 0.3};
  Body body(box.SeenFrom({0.0, 0.0}), {}, kNoise, 20.0);
  const auto bow_m = [&box] { return box.Corners()[1]; };
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  for (int scan = 0; scan < 120; ++scan) {
    box.middle_m += 3.0 * kScanS * Eigen::Vector2d(std::cos(box.course_rad), std::sin(box.course_rad));
    body.Predict(kScanS);
    body.Update(Shaken(box.SeenFrom({0.0, 0.0}), 0.03, random), {}, kNoise, box.middle_m.norm(), true);
    if (scan == 50) place_m = body.Frame().inverse() * bow_m();
    if (scan < 50) continue;
    EXPECT_LT((body.Frame() * place_m - bow_m()).norm(), 0.3) << scan;
  }
}

// At first its bow only: the middle of what is known of it goes aft, the boat does not.
TEST(Body, FrameStaysWhereMoreOfItComesIntoSight) {
  Box box{{-20.0, 15.0}, 0.0, 8.0};
  const auto seen_m = [&box](double length_m) {
    return Box{box.middle_m + Eigen::Vector2d(4.0 - 0.5 * length_m, 0.0), 0.0, length_m}.SeenFrom({0.0, 0.0});
  };
  Body body(seen_m(3.0), {}, kNoise, 15.0);
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  double middle_m = 0.0;
  for (int scan = 0; scan < 120; ++scan) {
    box.middle_m.x() += 3.0 * kScanS;
    body.Predict(kScanS);
    if (scan == 60) {
      place_m = body.Frame().inverse() * box.middle_m;
      middle_m = body.center_m().x() - box.middle_m.x();
      body.Include(seen_m(8.0));
      EXPECT_LT((body.Frame() * place_m - box.middle_m).norm(), 1e-9);
    }
    body.Update(seen_m(scan < 60 ? 3.0 : 8.0), {}, kNoise, 15.0, true);
    if (scan < 60) continue;
    EXPECT_LT((body.Frame() * place_m - box.middle_m).norm(), 0.3) << scan;
  }
  EXPECT_LT(body.center_m().x() - box.middle_m.x(), middle_m - 1.5);
}

TEST(Body, HasMovedByItsWayWhereItMovesAndByNothingWhereItStands) {
  for (const double speed_mps : {0.0, 3.0}) {
    std::mt19937_64 random(7);
    Box box{{-15.0, 20.0}, 0.0};
    Body body(box.SeenFrom({0.0, 0.0}), {}, kNoise, 20.0);
    EXPECT_EQ(body.moved_m(), 0.0);
    for (int scan = 0; scan < 100; ++scan) {
      box.middle_m.x() += speed_mps * kScanS;
      body.Predict(kScanS);
      body.Update(Shaken(box.SeenFrom({0.0, 0.0}), 0.03, random), {}, kNoise, box.middle_m.norm(), true);
    }
    EXPECT_NEAR(body.moved_m(), speed_mps * 10.0, 0.5);
    // Where all of the map was elsewhere nothing has moved.
    const double moved_m = body.moved_m();
    const Eigen::Vector2d at_m = body.Frame().translation();
    body.Translate({7.0, -5.0});
    EXPECT_NEAR(body.moved_m(), moved_m, 1e-9);
    EXPECT_NEAR((body.Frame().translation() - at_m - Eigen::Vector2d(7.0, -5.0)).norm(), 0.0, 1e-9);
  }
}

TEST(Body, FrameStaysWhereTheOutlineIsAnother) {
  Box box{{-10.0, 20.0}, 0.0};
  Body body(box.SeenFrom({0.0, 0.0}), {}, kNoise, 20.0);
  for (int scan = 0; scan < 40; ++scan) {
    box.middle_m.x() += 3.0 * kScanS;
    body.Predict(kScanS);
    body.Update(box.SeenFrom({0.0, 0.0}), {}, kNoise, box.middle_m.norm(), true);
  }
  const Eigen::Isometry2d before = body.Frame();
  const double moved_m = body.moved_m();
  box.length_m = 9.0;
  body.AddPart(box.SeenFrom({0.0, 0.0}), {}, 20.0, false);
  EXPECT_NEAR(body.moved_m(), moved_m, 1e-9);
  EXPECT_LT((body.Frame().translation() - before.translation()).norm(), 1e-9);
}

TEST(Body, TurnRateOfWhatStandsIsNotKnown) {
  const Box box{{20.0, 0.0}, 0.5};
  Body body(box.SeenFrom({0.0, 0.0}), {}, kNoise, 20.0);
  for (int scan = 0; scan < 100; ++scan) {
    body.Predict(kScanS);
    body.Update(box.SeenFrom({0.0, 0.0}), {}, kNoise, 20.0, true);
    ASSERT_TRUE(std::isnan(body.turn_rate_radps())) << scan;
  }
}

TEST(Body, IsPlacedForTheEndOfTheScan) {
  // Seen 80 ms before the end of each scan, at 6 m/s: half a metre behind.
  const Eigen::Vector2d velocity(6.0, 0.0);
  Box box{{-30.0, 15.0}, 0.0};
  Body body(box.SeenFrom({0.0, 0.0}), {}, kNoise, 30.0);
  for (int scan = 0; scan < 100; ++scan) {
    box.middle_m += velocity * kScanS;
    const Box earlier{box.middle_m - 0.08 * velocity, box.course_rad};
    body.Predict(kScanS);
    body.Update(earlier.SeenFrom({0.0, 0.0}), {.before_s = 0.08}, kNoise, 30.0, true);
  }
  EXPECT_NEAR(body.center_m().x(), box.middle_m.x(), 0.15);
}

// What is stated as covariance is what the error is, over aspects, ranges and speeds. A band, as the outline's errors are not drawn from a normal.
TEST(Body, CovarianceIsHonest) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  double position_sum = 0.0;
  double velocity_sum = 0.0;
  int num_moving = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    const double course_rad = kTwoPi * share(random);
    Box box{{30.0 + 20.0 * share(random), 20.0 * share(random) - 10.0}, course_rad, 2.0 + 6.0 * share(random)};
    box.width_m = box.length_m / (2.3 + 1.2 * share(random));
    const Eigen::Vector2d velocity = (1.0 + 4.0 * share(random)) * Eigen::Vector2d(std::cos(course_rad), std::sin(course_rad));
    box.middle_m -= 2.5 * velocity;
    // Its bow lies low, or overhangs: a tenth of it is never seen. Of the rest, what is seen changes over a second.
    std::vector<Eigen::Vector2d> wander(4, Eigen::Vector2d::Zero());
    const double wander_m = 0.05 + 0.04 * box.length_m;
    std::optional<Body> body;
    for (int scan = 0; scan < 50; ++scan) {
      box.middle_m += velocity * kScanS;
      for (auto& off : wander) off = 0.9 * off + 0.44 * wander_m * Eigen::Vector2d(normal(random), normal(random));
      const Box shown{box.middle_m - 0.05 * box.length_m * velocity.normalized(), course_rad, 0.9 * box.length_m, box.width_m};
      Outline seen = Shaken(shown.SeenFrom({0.0, 0.0}), 0.03, random);
      for (std::size_t i = 0; i < seen.size(); ++i) seen[i] += wander[i];
      if (!body) {
        body.emplace(seen, Sides{}, kNoise, box.middle_m.norm());
        continue;
      }
      body->Predict(kScanS);
      body->Update(seen, {}, kNoise, box.middle_m.norm(), true);
    }
    const Eigen::Matrix4d covariance = body->covariance();
    position_sum += Nees(body->center_m() - box.middle_m, covariance.topLeftCorner<2, 2>());
    if (!body->IsMoving(kMoving)) continue;
    ++num_moving;
    velocity_sum += Nees(body->velocity_mps() - velocity, covariance.bottomRightCorner<2, 2>());
  }
  EXPECT_GT(num_moving, kRuns * 95 / 100);
  EXPECT_GT(position_sum / kRuns, 0.1);
  EXPECT_LT(position_sum / kRuns, 1.5);
  EXPECT_GT(velocity_sum / num_moving, 0.05);
  EXPECT_LT(velocity_sum / num_moving, 1.5);
}

// A part of what is known, in each scan the same: nothing is known of where in the thing it lies, and the thing does not move.
TEST(Body, OfWhichAPartIsSeenInPlaceStands) {
  std::mt19937_64 random(11);
  for (const double north_m : {30.0, -30.0}) {
    const Box boat{.middle_m = {0.0, north_m}, .length_m = 6.0};
    const Box part{.middle_m = {0.8, north_m}, .length_m = 1.5};
    Body body(boat.SeenFrom({0.0, 0.0}), {}, kNoise, 30.0);
    for (int scan = 1; scan < 40; ++scan) {
      body.Predict(kScanS);
      body.Update(Shaken((scan < 5 ? boat : part).SeenFrom({0.0, 0.0}), 0.02, random), {}, kNoise, 30.0, true);
      EXPECT_FALSE(body.IsMoving(kMoving)) << "scan " << scan;
    }
    EXPECT_LT((body.center_m() - boat.middle_m).norm(), 1.0);
  }
}

// A quay comes into sight: one end of what is seen goes on by 6 m/s for a second, the other stays.
TEST(Body, OfWhichOneEndGrowsForASecondStands) {
  std::mt19937_64 random(12);
  Body body(Box{.middle_m = {-1.0, 20.0}, .length_m = 2.0}.SeenFrom({0.0, 0.0}), {}, kNoise, 20.0);
  for (int scan = 1; scan < 30; ++scan) {
    const double length_m = 2.0 + 0.6 * std::min(scan, 10);
    body.Predict(kScanS);
    body.Update(Shaken(Box{.middle_m = {-0.5 * length_m, 20.0}, .length_m = length_m}.SeenFrom({0.0, 0.0}), 0.02, random), {}, kNoise, 20.0, true);
    EXPECT_FALSE(body.IsMoving(kMoving)) << "scan " << scan;
  }
}

TEST(Body, FrameKeepsItsTurnWhereTheOutlineIsAnother) {
  std::mt19937_64 random(8);
  Box box{{-10.0, 20.0}, 0.0};
  Body body(box.SeenFrom({0.0, 0.0}), {}, kNoise, 20.0);
  for (int scan = 0; scan < 60; ++scan) {
    box.course_rad += DegToRad(10.0) * kScanS;
    box.middle_m += 3.0 * kScanS * Eigen::Vector2d(std::cos(box.course_rad), std::sin(box.course_rad));
    body.Predict(kScanS);
    body.Update(Shaken(box.SeenFrom({0.0, 0.0}), 0.03, random), {}, kNoise, box.middle_m.norm(), true);
  }
  const Eigen::Isometry2d before = body.Frame();
  const double moved_m = body.moved_m();
  box.length_m = 9.0;
  body.AddPart(box.SeenFrom({0.0, 0.0}), {}, 20.0, false);
  EXPECT_NEAR(body.moved_m(), moved_m, 1e-9);
  EXPECT_TRUE(body.Frame().translation().isApprox(before.translation(), 1e-9));
  EXPECT_TRUE(body.Frame().linear().isApprox(before.linear(), 1e-9)) << body.Frame().linear() << "\n" << before.linear();
}

}  // namespace
}  // namespace lookout::tracker
