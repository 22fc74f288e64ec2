// The frame of its own where the earth is not known.
#include "services/navigator/core/relative_frame.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

constexpr double kTiltSdRad = 0.09;
const Utime kStart{std::chrono::microseconds(1'700'000'000'000'000)};

Pose Unknown(Utime time) {
  Pose pose;
  pose.time = time;
  return pose;
}

Pose OnEarth(Utime time) {
  Pose pose;
  pose.time = time;
  pose.status = PoseStatus::kOk;
  pose.datum = {54.0, 10.0, 0.0};
  return pose;
}

OdometryMotion Straight(Utime end, double forward_m, double turn_rad = 0.0) {
  OdometryMotion motion{end - 100ms, end, true, {forward_m, 0.0}, turn_rad, {}};
  motion.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-6).asDiagonal();
  return motion;
}

TEST(Odometry, IsTheSameAfterItsSentence) {
  auto motion = Straight(kStart, 0.123456, -0.012345678);
  motion.displacement_m.y() = -0.05;
  motion.covariance(0, 2) = motion.covariance(2, 0) = -5e-6;
  const auto line = ToSentence(motion);
  EXPECT_LT(line.size(), 256U);
  const auto again = ParseOdometry(line);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->begin, motion.begin);
  EXPECT_EQ(again->end, motion.end);
  EXPECT_NEAR(again->displacement_m.x(), 0.123456, 1e-9);
  EXPECT_NEAR(again->turn_rad, -0.012345678, 1e-12);
  EXPECT_NEAR(again->covariance(2, 0), -5e-6, 1e-11);
  EXPECT_EQ(ToSentence(*again), line);
  const auto unknown = ParseOdometry(ToSentence({kStart - 100ms, kStart}));
  ASSERT_TRUE(unknown);
  EXPECT_FALSE(unknown->is_known);
}

TEST(Odometry, RefusesOtherLines) {
  EXPECT_FALSE(ParseOdometry(""));
  EXPECT_FALSE(ParseOdometry("$GPRMC,,V,,,,,,,,,,N*53"));
  EXPECT_FALSE(ParseOdometry("$PLKODO,1,2,K*61"));
  auto motion = Straight(kStart, 0.1);
  motion.covariance(0, 0) = -1.0;
  EXPECT_FALSE(ParseOdometry(ToSentence(motion)));
  // Each pair may be correlated so, not all three.
  motion = Straight(kStart, 0.1);
  motion.covariance = Eigen::Vector3d(1e-2, 1e-2, 1e-2).asDiagonal();
  for (const auto& [row, column] : {std::pair{0, 1}, {0, 2}, {1, 2}}) motion.covariance(row, column) = motion.covariance(column, row) = -0.8e-2;
  EXPECT_FALSE(ParseOdometry(ToSentence(motion)));
  motion = Straight(kStart, 200.0);
  EXPECT_FALSE(ParseOdometry(ToSentence(motion)));
  auto line = ToSentence(Straight(kStart, 0.1));
  line[20] = line[20] == '1' ? '2' : '1';
  EXPECT_FALSE(ParseOdometry(line));
}

TEST(RelativeFrame, BeginsWhereTheBoatIsAndGoesWithIt) {
  RelativeFrame frame;
  frame.Begin(kStart);
  Pose pose;
  for (int i = 1; i <= 30; ++i) {
    const Utime time = kStart + i * 100ms;
    frame.Add(Straight(time, 0.2));
    pose = frame.At(Unknown(time), kTiltSdRad);
    if (i < 5) {
      EXPECT_EQ(pose.status, PoseStatus::kUnknown) << i;
    }
    if (i == 5) {
      EXPECT_EQ(pose.status, PoseStatus::kRelative);
      EXPECT_EQ(pose.p_map_m.head<2>().norm(), 0.0);
    }
  }
  // The bow lay along y.
  EXPECT_NEAR(pose.p_map_m.x(), 0.0, 1e-9);
  EXPECT_NEAR(pose.p_map_m.y(), 25 * 0.2, 1e-9);
  EXPECT_NEAR(pose.velocity_map_mps.y(), 2.0, 1e-9);
  EXPECT_NEAR(pose.heading_rad, 0.0, 1e-9);
  EXPECT_TRUE(std::isnan(pose.latitude_deg) && std::isnan(pose.datum.latitude_deg));
  EXPECT_EQ(pose.datum.ellipsoid_height_m, 1'700'000'000'500.0) << "when it began";
  EXPECT_GT(pose.covariance(1, 1), 24e-4);
  EXPECT_NEAR(pose.covariance(6, 6), kTiltSdRad * kTiltSdRad, 1e-12);
}

TEST(RelativeFrame, ATurnIsClockwise) {
  RelativeFrame frame;
  frame.Begin(kStart);
  frame.At(Unknown(kStart), kTiltSdRad);
  frame.Add({kStart + 400ms, kStart + 500ms});
  frame.At(Unknown(kStart + 500ms), kTiltSdRad);
  frame.Add(Straight(kStart + 600ms, 1.0, kPi / 2.0));
  frame.Add(Straight(kStart + 700ms, 1.0));
  const auto pose = frame.At(Unknown(kStart + 700ms), kTiltSdRad);
  EXPECT_NEAR(pose.heading_rad, kPi / 2.0, 1e-9);
  EXPECT_NEAR(pose.p_map_m.x(), 1.0, 1e-9);  // to starboard of where the bow was
  EXPECT_NEAR(pose.p_map_m.y(), 1.0, 1e-9);
}

TEST(RelativeFrame, WithoutAKnownMotionTheBoatGoesOnForThreeSecondsAndThenStands) {
  RelativeFrame frame;
  frame.Begin(kStart);
  for (int i = 1; i <= 10; ++i) frame.Add(Straight(kStart + i * 100ms, 0.1));
  const Utime last = kStart + 1s;
  EXPECT_EQ(frame.At(Unknown(last), kTiltSdRad).status, PoseStatus::kRelative);
  frame.Add({last, last + 100ms});
  const auto coasting = frame.At(Unknown(last + 1s), kTiltSdRad);
  EXPECT_EQ(coasting.status, PoseStatus::kRelativeCoasting);
  EXPECT_NEAR(coasting.p_map_m.y(), 1.0, 1e-6);
  const auto still = frame.At(Unknown(last + 10s), kTiltSdRad);
  EXPECT_EQ(still.status, PoseStatus::kRelativeToBoat);
  EXPECT_NEAR(still.p_map_m.y(), 3.0, 1e-6);
  // Not 0: a boat that lies still would be told less.
  EXPECT_TRUE(still.velocity_map_mps.array().isNaN().all());
  EXPECT_TRUE(still.covariance.middleRows<3>(3).array().isNaN().all() && still.covariance.middleCols<3>(3).array().isNaN().all());
  EXPECT_TRUE(coasting.velocity_map_mps.allFinite());
  // It goes on from there, in the same frame.
  frame.Add(Straight(last + 10s + 100ms, 0.5));
  const auto again = frame.At(Unknown(last + 10s + 100ms), kTiltSdRad);
  EXPECT_EQ(again.status, PoseStatus::kRelative);
  EXPECT_NEAR(again.p_map_m.y(), 3.5, 1e-6);
  EXPECT_EQ(again.datum.ellipsoid_height_m, still.datum.ellipsoid_height_m);
}

// In open water from the start.
TEST(RelativeFrame, NothingThatStandsMeansRelativeToTheBoat) {
  RelativeFrame frame;
  frame.Begin(kStart);
  frame.Add({kStart, kStart + 100ms});
  EXPECT_EQ(frame.At(Unknown(kStart + 400ms), kTiltSdRad).status, PoseStatus::kUnknown);
  const auto pose = frame.At(Unknown(kStart + 500ms), kTiltSdRad);
  EXPECT_EQ(pose.status, PoseStatus::kRelativeToBoat);
  EXPECT_EQ(pose.p_map_m.norm(), 0.0);
  EXPECT_TRUE(pose.velocity_map_mps.array().isNaN().all());
}

// Georeferencer adds it to the place of each obstacle, and an error that all share is no noise.
TEST(RelativeFrame, TheVarianceOfHeadingIsShortTerm) {
  RelativeFrame frame;
  frame.Begin(kStart);
  Utime time = kStart;
  const auto go = [&](std::chrono::milliseconds duration) {
    for (const Utime end = time + duration; time < end;) {
      time += 100ms;
      frame.Add(Straight(time, 0.2));
      frame.At(Unknown(time), kTiltSdRad);
    }
    return frame.At(Unknown(time), kTiltSdRad).covariance(8, 8);
  };
  go(5s);
  EXPECT_NEAR(go(60s), 30e-6, 1e-9) << "30 motions, each of 1e-6";
  double greatest = 0.0;
  for (const Utime end = time + 20s; time < end; time += 20ms) greatest = std::max(greatest, frame.At(Unknown(time), kTiltSdRad).covariance(8, 8));
  EXPECT_GT(greatest, DegToRad(1.0) * DegToRad(1.0));
  EXPECT_LE(greatest, DegToRad(3.0) * DegToRad(3.0) * (1.0 + 1e-12));
  const auto still = frame.At(Unknown(time), kTiltSdRad);
  EXPECT_EQ(still.status, PoseStatus::kRelativeToBoat);
  EXPECT_LT(still.covariance(8, 8), 1e-6);
  EXPECT_NEAR(go(4s), 30e-6, 1e-9) << "not what was lost in the gap";
}

TEST(RelativeFrame, TheEarthComesFirst) {
  RelativeFrame frame;
  frame.Begin(kStart);
  for (int i = 1; i <= 10; ++i) frame.Add(Straight(kStart + i * 100ms, 0.1));
  EXPECT_EQ(frame.At(Unknown(kStart + 1s), kTiltSdRad).status, PoseStatus::kRelative);
  EXPECT_EQ(frame.At(OnEarth(kStart + 2s - 40s), kTiltSdRad).datum.latitude_deg, 54.0);
  EXPECT_EQ(frame.At(OnEarth(kStart + 2s), kTiltSdRad).datum.latitude_deg, 54.0);
  // A gap is a gap: tracks of the earth live on in it.
  EXPECT_FALSE(frame.Wants(kStart + 20s));
  EXPECT_EQ(frame.At(Unknown(kStart + 20s), kTiltSdRad).status, PoseStatus::kUnknown);
  EXPECT_TRUE(frame.Wants(kStart + 32s));
  const auto second = frame.At(Unknown(kStart + 32s), kTiltSdRad);
  EXPECT_EQ(second.datum.ellipsoid_height_m, 1'700'000'032'000.0);
  EXPECT_NEAR(second.p_map_m.norm(), 0.0, 1e-12);
  // Nothing of the first frame goes on in it.
  EXPECT_EQ(second.status, PoseStatus::kRelativeToBoat);
  frame.Add(Straight(kStart + 32s + 100ms, 0.3));
  const auto after = frame.At(Unknown(kStart + 32s + 100ms), kTiltSdRad);
  EXPECT_NEAR(after.p_map_m.y(), 0.3, 1e-9);
  EXPECT_LT(after.covariance(1, 1), 2e-4);
}

// One fix that is lost again does not take the look-out away for half a minute.
TEST(RelativeFrame, AMomentOnTheEarthIsSoonOver) {
  RelativeFrame frame;
  frame.Begin(kStart);
  frame.NoteSentence();
  frame.Add(Straight(kStart + 4s, 0.1));
  EXPECT_EQ(frame.At(Unknown(kStart + 4s), kTiltSdRad).status, PoseStatus::kRelative);
  frame.At(OnEarth(kStart + 5s), kTiltSdRad);
  frame.At(OnEarth(kStart + 6s), kTiltSdRad);
  EXPECT_EQ(frame.At(Unknown(kStart + 8s), kTiltSdRad).status, PoseStatus::kUnknown);
  EXPECT_NE(frame.At(Unknown(kStart + 9s), kTiltSdRad).status, PoseStatus::kUnknown);
  // As long as it had been there: gaps within do not count.
  frame.At(OnEarth(kStart + 20s), kTiltSdRad);
  frame.At(Unknown(kStart + 22s), kTiltSdRad);
  frame.At(OnEarth(kStart + 30s), kTiltSdRad);
  EXPECT_EQ(frame.At(Unknown(kStart + 39s), kTiltSdRad).status, PoseStatus::kUnknown);
  EXPECT_NE(frame.At(Unknown(kStart + 40s), kTiltSdRad).status, PoseStatus::kUnknown);
}

// A compass without a receiver: the frame is north up, and its heading stays that of the compass.
TEST(RelativeFrame, ACompassTellsTheHeadingAllTheTime) {
  RelativeFrame frame;
  frame.Begin(kStart);
  Pose pose;
  for (int i = 1; i <= 30; ++i) {
    auto compass = Unknown(kStart + i * 100ms);
    compass.status = PoseStatus::kNoPosition;
    compass.heading_source = HeadingSource::kHdt;
    compass.heading_rad = i < 20 ? 0.0 : kPi / 2.0;
    compass.covariance(8, 8) = 1e-4;
    frame.Add(Straight(compass.time, 0.2));
    pose = frame.At(compass, kTiltSdRad);
  }
  EXPECT_NEAR(pose.heading_rad, kPi / 2.0, 1e-9);
  EXPECT_NEAR(pose.p_map_m.x(), 10 * 0.2, 1e-9) << "to the east since the bow points there";
  EXPECT_NEAR(pose.p_map_m.y(), 15 * 0.2, 1e-9);
}

// Both would count as one map, and acknowledgements be taken over by places in it.
TEST(RelativeFrame, HasAnotherNumberAfterANewStart) {
  const auto number_of = [](Utime start) {
    RelativeFrame frame;
    frame.Begin(start);
    frame.Add({start, start + 100ms});
    return frame.At(Unknown(start + 500ms), kTiltSdRad).datum.ellipsoid_height_m;
  };
  EXPECT_NE(number_of(kStart), number_of(kStart + 200ms));
  EXPECT_EQ(number_of(kStart), number_of(kStart));
}

TEST(RelativeFrame, WaitsForSentencesThatCome) {
  RelativeFrame frame;
  frame.Begin(kStart);
  frame.NoteSentence();
  frame.Add({kStart, kStart + 100ms});
  EXPECT_EQ(frame.At(Unknown(kStart + 2s), kTiltSdRad).status, PoseStatus::kUnknown);
  EXPECT_EQ(frame.At(Unknown(kStart + 3s), kTiltSdRad).status, PoseStatus::kRelativeToBoat);
}

TEST(RelativeFrame, BetweenTwoMotionsThePoseLiesBetween) {
  RelativeFrame frame;
  frame.Begin(kStart);
  for (int i = 1; i <= 10; ++i) frame.Add(Straight(kStart + i * 100ms, 0.1));
  frame.At(Unknown(kStart + 600ms), kTiltSdRad);
  EXPECT_NEAR(frame.At(Unknown(kStart + 760ms), kTiltSdRad).p_map_m.y(), 0.16, 1e-9);
}

Pose OfCompass(Utime time, double heading_deg) {
  Pose pose = Unknown(time);
  pose.status = PoseStatus::kNoPosition;
  pose.heading_source = HeadingSource::kHdt;
  pose.heading_rad = WrapTo2Pi(DegToRad(heading_deg));
  pose.covariance = PoseCovariance::Zero();
  pose.covariance(8, 8) = DegToRad(2.0) * DegToRad(2.0);
  return pose;
}

TEST(RelativeFrame, WithoutAnyMotionTheFrameIsThatOfTheBoat) {
  RelativeFrame frame;
  frame.Begin(kStart);
  EXPECT_EQ(frame.At(Unknown(kStart + 2s), kTiltSdRad).status, PoseStatus::kUnknown) << "a receiver may send once a second";
  const auto pose = frame.At(Unknown(kStart + 3s), kTiltSdRad);
  EXPECT_EQ(pose.status, PoseStatus::kRelativeToBoat);
  EXPECT_EQ(pose.p_map_m.head<2>().norm(), 0.0);
}

TEST(RelativeFrame, StatesWhatACompassErrs) {
  RelativeFrame frame;
  frame.Begin(kStart);
  frame.NoteSentence();
  Pose pose;
  for (int i = 1; i <= 50; ++i) {
    frame.Add(Straight(kStart + i * 100ms, 0.1));
    pose = frame.At(OfCompass(kStart + i * 100ms, 10.0), kTiltSdRad);
  }
  EXPECT_EQ(pose.status, PoseStatus::kRelative);
  EXPECT_NEAR(RadToDeg(std::sqrt(pose.covariance(8, 8))), 2.0, 1e-6);
}

// In open water the frame turned with the boat until then.
TEST(RelativeFrame, ACompassThatComesLaterBeginsAFrameAlongNorth) {
  RelativeFrame frame;
  frame.Begin(kStart);
  for (int i = 1; i <= 50; ++i) frame.At(Unknown(kStart + i * 100ms), kTiltSdRad);
  EXPECT_EQ(frame.num_frames(), 1);
  Pose pose;
  for (int i = 51; i <= 100; ++i) pose = frame.At(OfCompass(kStart + i * 100ms, 70.0), kTiltSdRad);
  EXPECT_EQ(frame.num_frames(), 2);
  EXPECT_NEAR(RadToDeg(pose.heading_rad), 70.0, 1e-9);
  EXPECT_EQ(pose.heading_source, HeadingSource::kHdt);
}

// What stands must not swing around the boat in one pose.
TEST(RelativeFrame, TurnsBackToNorthSlowlyWhenTheCompassComesBack) {
  RelativeFrame frame;
  frame.Begin(kStart);
  frame.NoteSentence();
  double last_deg = 10.0;
  for (int i = 1; i <= 3000; ++i) {
    const Utime time = kStart + i * 100ms;
    frame.Add(Straight(time, 0.1));
    const bool has_compass = i < 100 || i > 500;
    const auto pose = frame.At(has_compass ? OfCompass(time, i < 100 ? 10.0 : 20.0) : Unknown(time), kTiltSdRad);
    if (i > 30) {
      EXPECT_NEAR(RadToDeg(pose.heading_rad), last_deg, 0.1) << i;
      last_deg = RadToDeg(pose.heading_rad);
    }
  }
  EXPECT_NEAR(last_deg, 20.0, 0.1);
}

TEST(RelativeFrame, AClockThatIsSetForwardBeginsNone) {
  RelativeFrame frame;
  frame.Begin(kStart);
  frame.At(OnEarth(kStart + 20ms), kTiltSdRad);
  for (int i = 2; i <= 3000; ++i) frame.At(OnEarth(kStart + i * 20ms), kTiltSdRad);
  const Utime after = kStart + 60s + 3600s;
  frame.Skip(3600s);
  for (int i = 0; i < 1500; ++i) EXPECT_EQ(frame.At(Unknown(after + i * 20ms), kTiltSdRad).status, PoseStatus::kUnknown) << i;
  EXPECT_EQ(frame.At(Unknown(after + 30s), kTiltSdRad).status, PoseStatus::kRelativeToBoat);
}

}  // namespace
}  // namespace lookout::navigator
