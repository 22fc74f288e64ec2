// Fixes that no boat can have reached: alone, and in the filter.
#include "services/navigator/core/filter/believed_place.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

#include "tests/unit/navigator/filter_measurements.hpp"

namespace lookout::navigator {
namespace {

using Verdict = BelievedPlace::Verdict;

constexpr double kMetresPerDeg = 111'100.0;
constexpr double kSdM = 2.0;

class BelievedPlaceTest : public ::testing::Test {
 protected:
  Verdict At(double time_s, double north_m) { return place_.Judge(NoonPlus(time_s), {54.5 + north_m / kMetresPerDeg, 10.2}, kSdM); }

  BelievedPlace place_;
};

TEST_F(BelievedPlaceTest, IsTheFirstAndWhatABoatGetsTo) {
  EXPECT_EQ(At(0.0, 0.0), Verdict::kBelieved);
  EXPECT_EQ(At(1.0, 200.0), Verdict::kBelieved) << "142 m/s, 50 m, and 7 deviations of both: the filter decides";
  EXPECT_EQ(At(2.0, 500.0), Verdict::kHeld);
  ASSERT_TRUE(place_.held());
  EXPECT_NEAR(place_.held()->distance_m, 300.0, 1.0);
  EXPECT_EQ(place_.held()->since_s, 1.0);
  EXPECT_EQ(At(3.0, 200.0), Verdict::kBelieved);
  EXPECT_TRUE(place_.held()) << "HEALTH names the last that was held for some seconds";
}

TEST_F(BelievedPlaceTest, GrowsWithTheTimeWithoutAFix) {
  At(0.0, 0.0);
  EXPECT_EQ(At(6.0 * 3600.0, 500'000.0), Verdict::kBelieved) << "a boat on a trailer";
}

TEST_F(BelievedPlaceTest, MovesWhereItStaysForAsLongAsTheOneBefore) {
  struct Case {
    int known_s;
    int hold_s;
  };
  for (const auto& [known_s, hold_s] : {Case{0, 10}, Case{5, 10}, Case{25, 25}, Case{60, 60}, Case{300, 60}}) {
    place_ = {};
    for (int i = 0; i <= known_s; ++i) EXPECT_EQ(At(i, 2.0 * i), Verdict::kBelieved);
    for (int i = 1; i <= hold_s; ++i) EXPECT_EQ(At(known_s + i, 6e6), Verdict::kHeld) << i << " s, known for " << known_s;
    EXPECT_EQ(At(known_s + hold_s + 1, 6e6), Verdict::kNewPlace) << "known for " << known_s;
    EXPECT_EQ(At(known_s + hold_s + 2, 6e6), Verdict::kBelieved);
    EXPECT_EQ(At(known_s + hold_s + 3, 0.0), Verdict::kHeld);
  }
}

// A receiver told one place for 15 s under way and then the true one, 300 m on: that is no other place.
TEST_F(BelievedPlaceTest, ComesBackWithinSecondsAfterAReceiverStoodStill) {
  for (int i = 0; i < 100; ++i) EXPECT_EQ(At(i, 20.0 * i), Verdict::kBelieved);
  for (int i = 100; i < 115; ++i) EXPECT_EQ(At(i, 20.0 * 99), Verdict::kBelieved);
  EXPECT_EQ(At(115.0, 20.0 * 115), Verdict::kHeld);
  for (int i = 117; i < 140; ++i) EXPECT_EQ(At(i, 20.0 * i), Verdict::kBelieved) << i;
}

// A plotter tells places of up to 6 s ago: on a fast boat they are 80 to 120 m behind those of the receiver.
TEST_F(BelievedPlaceTest, OfAReceiverIsUsedBesideALatePlotter) {
  int num_held = 0;
  for (int i = 0; i < 600; ++i) {
    const double speed_mps = std::min(20.0, 0.2 * i);
    const double way_m = speed_mps < 20.0 ? 0.01 * i * i : 100.0 + 2.0 * (i - 100);
    num_held += At(0.1 * i, way_m) == Verdict::kHeld ? 1 : 0;
    if (i % 20 == 10) At(0.1 * i + 0.05, way_m - 5.0 * speed_mps);
  }
  EXPECT_LT(num_held, 60);
}

// Of two receivers that disagree the one that was believed first is, for as long as it is heard.
TEST_F(BelievedPlaceTest, StaysWhileOneIsThere) {
  for (int i = 0; i < 600; ++i) {
    EXPECT_EQ(At(i, 0.0), Verdict::kBelieved);
    EXPECT_EQ(At(i + 0.5, 6e6), Verdict::kHeld);
  }
}

TEST_F(BelievedPlaceTest, IsNotToldByFixesThatDisagree) {
  At(0.0, 0.0);
  for (int i = 1; i < 100; ++i) EXPECT_EQ(At(i, (i % 2 == 0 ? 1e6 : 3e6) + 1e4 * i), Verdict::kHeld);
}

TEST_F(BelievedPlaceTest, IsNotToldByTwoFixesFarApart) {
  At(0.0, 0.0);
  EXPECT_EQ(At(1.0, 6e6), Verdict::kHeld);
  EXPECT_EQ(At(30.0, 6e6), Verdict::kHeld);
}

// The filter.

GnssFix FixAt(double time_s, double north_m, double east_m, const std::string& source = "udp") {
  auto fix = MovingFix(time_s, 2.0, 90.0);
  fix.source = source;
  fix.position->latitude_deg += north_m / kMetresPerDeg;
  fix.position->longitude_deg += (2.0 * time_s + east_m) / 80'630.0;
  return fix;
}

class Reach : public ::testing::Test {
 protected:
  // A boat that makes 2 m/s to the east, and from `from_s` to `to_s` a receiver that says another place. @return how far POSE is at most away from
  // both while it has a place
  void Sail(double begin_s, double end_s, double north_m = 0.0) {
    for (double time_s = begin_s; time_s < end_s; time_s += 1.0) {
      filter_.Add(HeadingSample(time_s, 90.0));
      filter_.Add(FixAt(time_s, north_m, 0.0));
      for (double pose_s = time_s; pose_s < time_s + 0.99; pose_s += 0.2) {
        last_ = filter_.At(NoonPlus(pose_s));
        if (std::isnan(last_.latitude_deg)) continue;
        most_m_ = std::max(most_m_, std::abs((last_.latitude_deg - kLatitudeDeg) * kMetresPerDeg - north_m_));
      }
    }
  }

  PoseFilter filter_{TestFilterParams()};
  Pose last_;
  double north_m_ = 0.0;  // where POSE should be
  double most_m_ = 0.0;
};

// After 3 s POSE was 6000 km away, status ok.
TEST_F(Reach, AJumpThatNoBoatMakesIsNotBelievedForSeconds) {
  for (const double jump_m : {1852.0, 111'120.0, 6e6, -6e6}) {
    SCOPED_TRACE(jump_m);
    filter_.Reset();
    most_m_ = 0.0;
    Sail(0.0, 30.0);
    Sail(30.0, 45.0, jump_m);
    EXPECT_EQ(last_.status, PoseStatus::kNoPosition) << "it coasts, then the place is lost";
    EXPECT_NE(filter_.doubted().find("no boat gets so far"), std::string::npos) << filter_.doubted();
    Sail(45.0, 50.0);
    EXPECT_EQ(last_.status, PoseStatus::kOk);
    EXPECT_EQ(filter_.doubted(), "");
    EXPECT_LT(most_m_, 5.0);
  }
  EXPECT_EQ(filter_.counts()["unreachable_fix"], 4 * 15);
  EXPECT_EQ(filter_.counts()["new_place"], 0);
}

TEST_F(Reach, ThatOfASingleFixIsNotNoticed) {
  Sail(0.0, 10.0);
  Sail(10.0, 11.0, 1852.0);
  Sail(11.0, 20.0);
  EXPECT_EQ(last_.status, PoseStatus::kOk);
  EXPECT_LT(most_m_, 5.0);
}

// A receiver that begins with its place of yesterday spoiled the datum of the whole run.
TEST_F(Reach, TheDatumIsGivenAnewWhereTheFirstFixesWereWrong) {
  for (const double wrong_m : {20'000.0, 6e6}) {
    SCOPED_TRACE(wrong_m);
    filter_.Reset();
    Sail(0.0, 4.0, wrong_m);
    most_m_ = 0.0;
    Sail(4.0, 7.0);
    EXPECT_GT(most_m_, 1000.0) << "not known yet: it coasts where it was";
    EXPECT_EQ(last_.status, PoseStatus::kNoPosition);
    Sail(7.0, 14.0);
    most_m_ = 0.0;
    Sail(14.0, 30.0);
    EXPECT_LT(most_m_, 5.0);
    EXPECT_EQ(last_.status, PoseStatus::kOk);
    EXPECT_NEAR(last_.datum.latitude_deg, kLatitudeDeg, 1e-9);
    EXPECT_LT(last_.p_map_m.norm(), 60.0);
    EXPECT_NEAR(last_.velocity_map_mps.x(), 2.0, 0.1);
    EXPECT_NEAR(last_.heading_rad, DegToRad(90.0), DegToRad(1.0));
  }
  EXPECT_EQ(filter_.counts()["new_place"], 2);
}

TEST_F(Reach, TheDatumOfConfigStays) {
  auto params = TestFilterParams();
  params.datum = GeodeticPlace{kLatitudeDeg, kLongitudeDeg, 10.0};
  filter_ = PoseFilter(params);
  Sail(0.0, 4.0, 6e6);
  EXPECT_NE(filter_.datum_complaint(), "");
  Sail(4.0, 20.0);
  EXPECT_EQ(last_.datum.latitude_deg, kLatitudeDeg);
  EXPECT_EQ(last_.datum.ellipsoid_height_m, 10.0);
  EXPECT_EQ(filter_.datum_complaint(), "");
  EXPECT_EQ(last_.status, PoseStatus::kOk);
}

TEST_F(Reach, OfTwoReceiversThatDisagreeTheFirstIsUsedAndTheOtherNamed) {
  for (double time_s = 0.0; time_s < 100.0; time_s += 1.0) {
    filter_.Add(HeadingSample(time_s, 90.0));
    filter_.Add(FixAt(time_s, 0.0, 0.0, "a"));
    filter_.Add(FixAt(time_s + 0.5, 3e5, 0.0, "b"));
    last_ = filter_.At(NoonPlus(time_s + 0.9));
    EXPECT_NEAR(last_.latitude_deg, kLatitudeDeg, 1e-4) << time_s;
    EXPECT_EQ(filter_.doubted().find("fixes of input 'b' are 300 km from the last that was believed, 1 s before"), 0U) << filter_.doubted();
  }
  // The one that was believed is silent.
  for (double time_s = 100.0; time_s < 170.0; time_s += 1.0) {
    filter_.Add(FixAt(time_s, 3e5, 0.0, "b"));
    last_ = filter_.At(NoonPlus(time_s));
  }
  EXPECT_NEAR(last_.latitude_deg, kLatitudeDeg + 3e5 / kMetresPerDeg, 1e-4);
}

// An RMC of which only the latitude is wrong, each second, beside a GGA that is right.
TEST_F(Reach, GgaDecidesThePlaceOfItsEpoch) {
  for (double time_s = 0.0; time_s < 20.0; time_s += 1.0) {
    filter_.Add(HeadingSample(time_s, 90.0));
    filter_.Add(FixAt(time_s, 1e5, 0.0));
    auto gga = FixAt(time_s, 0.0, 0.0);
    gga.sentence_type = "GGA";
    filter_.Add(gga);
    last_ = filter_.At(NoonPlus(time_s + 0.5));
    EXPECT_NEAR(last_.latitude_deg, kLatitudeDeg, 1e-5) << time_s;
    EXPECT_EQ(last_.status, PoseStatus::kOk) << time_s;
    EXPECT_NEAR(last_.datum.latitude_deg, kLatitudeDeg, 1e-5);
  }
}

TEST_F(Reach, ABoatOnATrailerComesBackAtOnce) {
  Sail(0.0, 100.0);
  Sail(4.0 * 3600.0, 4.0 * 3600.0 + 5.0, 200'000.0);
  EXPECT_EQ(last_.status, PoseStatus::kOk);
  EXPECT_NEAR((last_.latitude_deg - kLatitudeDeg) * kMetresPerDeg, 200'000.0, 10.0);
}

}  // namespace
}  // namespace lookout::navigator
