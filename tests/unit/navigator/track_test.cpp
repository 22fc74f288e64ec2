#include "services/navigator/core/track.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

constexpr TrackParams kAngle{true, kPi, 1s, 0.1};

TEST(Track, HasNothingBeforeItsFirstSample) { EXPECT_FALSE(Track(kAngle).At(NoonPlus(0), 10s)); }

TEST(Track, HoldsASingleSample) {
  Track track(kAngle);
  track.Add(NoonPlus(0), 1.0, 0.0);
  for (const double time_s : {-0.5, 0.0, 0.5}) {
    const auto value = track.At(NoonPlus(time_s), 1s);
    ASSERT_TRUE(value);
    EXPECT_EQ(value->value, 1.0);
    EXPECT_EQ(value->rate, 0.0);
    EXPECT_NEAR(value->sd, 0.1 * std::abs(time_s), 1e-12);
  }
}

TEST(Track, ForgetsAfterTheGreatestAge) {
  Track track(kAngle);
  track.Add(NoonPlus(0), 1.0, 0.0);
  EXPECT_TRUE(track.At(NoonPlus(1.0), 1s));
  EXPECT_FALSE(track.At(NoonPlus(1.000001), 1s));
  EXPECT_FALSE(track.At(NoonPlus(-1.1), 1s));
}

TEST(Track, InterpolatesAndCarriesOnAcrossTheSeam) {
  Track track(kAngle);
  track.Add(NoonPlus(0.0), DegToRad(359.0), 0.0);
  track.Add(NoonPlus(0.1), DegToRad(1.0), 0.0);
  const auto at = [&](double time_s) { return RadToDeg(WrapTo2Pi(track.At(NoonPlus(time_s), 1s)->value)); };
  EXPECT_NEAR(at(0.0), 359.0, 1e-9);
  EXPECT_NEAR(at(0.025), 359.5, 1e-9);
  EXPECT_NEAR(at(0.075), 0.5, 1e-9);
  EXPECT_NEAR(at(0.2), 3.0, 1e-9);
  EXPECT_NEAR(track.At(NoonPlus(0.05), 1s)->sd, 0.0, 1e-12) << "known between its samples";
  EXPECT_NEAR(track.At(NoonPlus(0.3), 1s)->sd, 0.02, 1e-12);
  EXPECT_NEAR(track.At(NoonPlus(0.05), 1s)->rate, DegToRad(20.0), 1e-9);
}

TEST(Track, CarriesOnForALimitedTimeAndThenHolds) {
  Track track({false, 100.0, 250ms, 0.0});
  track.Add(NoonPlus(0.0), 0.0, 0.0);
  track.Add(NoonPlus(0.1), 1.0, 0.0);
  EXPECT_NEAR(track.At(NoonPlus(0.3), 1s)->value, 3.0, 1e-9);
  EXPECT_NEAR(track.At(NoonPlus(0.9), 1s)->value, 3.5, 1e-9);
  EXPECT_EQ(track.At(NoonPlus(0.9), 1s)->rate, 0.0);
  EXPECT_NEAR(track.At(NoonPlus(-0.5), 1s)->value, 0.0, 1e-9) << "held before the older sample";
}

TEST(Track, DoesNotCarryOnWhatIsFarApartOrJumps) {
  Track apart(kAngle);
  apart.Add(NoonPlus(0.0), 0.0, 0.0);
  apart.Add(NoonPlus(1.0), 1.0, 0.0);
  EXPECT_EQ(apart.At(NoonPlus(1.5), 1s)->value, 1.0);
  Track jump(kAngle);
  jump.Add(NoonPlus(0.0), 0.0, 0.0);
  jump.Add(NoonPlus(0.1), 3.0, 0.0);
  EXPECT_EQ(jump.At(NoonPlus(0.2), 1s)->value, 3.0);
}

TEST(Track, RefusesSamplesThatAreNotNewer) {
  Track track(kAngle);
  EXPECT_TRUE(track.Add(NoonPlus(0.1), 1.0, 0.0));
  EXPECT_FALSE(track.Add(NoonPlus(0.1), 2.0, 0.0));
  EXPECT_FALSE(track.Add(NoonPlus(0.0), 2.0, 0.0));
  EXPECT_EQ(track.At(NoonPlus(0.1), 1s)->value, 1.0);
}

TEST(Track, TakesItsRateFromSamplesThatAreNotTooClose) {
  Track track(kAngle);
  for (int i = 0; i < 50; ++i) track.Add(NoonPlus(0.004 * i), 0.5 * 0.004 * i, 0.0);  // 250 Hz
  const auto value = track.At(NoonPlus(0.3), 1s);
  EXPECT_NEAR(value->rate, 0.5, 1e-9);
  EXPECT_NEAR(value->value, 0.15, 1e-9);
}

TEST(Track, SurvivesTheBoundsOfTime) {
  Track track(kAngle);
  track.Add(Utime(std::chrono::microseconds(kMinUtimeUs)), 1.0, 0.0);
  track.Add(Utime(std::chrono::microseconds(kMaxUtimeUs)), 2.0, 0.0);
  EXPECT_TRUE(track.At(Utime(std::chrono::microseconds(kMaxUtimeUs)), 1s));
  EXPECT_FALSE(track.At(Utime(std::chrono::microseconds(kMinUtimeUs)), 1s));
}

}  // namespace
}  // namespace lookout::navigator
