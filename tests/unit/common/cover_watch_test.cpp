// What the lidar shows of its own sight: covered sectors, darkness, and what calm water does not tell.
#include "common/core/cover_watch.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/core/frames.hpp"

namespace lookout {
namespace {

constexpr int kNumColumns = 360;
const std::vector<float> kElevationRad{-0.2F, -0.1F, 0.0F, 0.1F};
const std::vector<float> kNoOffsetRad(4, 0.0F);

CoverParams MakeParams(double yaw_deg = 0.0, double roll_deg = 0.0) {
  CoverParams params;
  params.T_vessel_lidar = TransformVesselSensor({.p_vessel_m = {0.0, 0.0, 1.0}, .roll_rad = DegToRad(roll_deg), .yaw_rad = DegToRad(yaw_deg)});
  params.min_range_m = 0.5;
  params.own_vessel_box_m = {Eigen::Vector3d(-3.0, -3.0, -1.0), Eigen::Vector3d(3.0, 3.0, 2.0)};
  return params;
}

// Range of a beam in degrees and rings; 0 = no return.
using World = std::function<float(int, std::size_t)>;
bool IsWithin(int azimuth_deg, int from_deg, int to_deg) { return (azimuth_deg - from_deg + 720) % 360 < to_deg - from_deg; }

class CoverWatchTest : public ::testing::Test {
 protected:
  void Scans(double duration_s, const World& world, CoverWatch* watch = nullptr) {
    if (watch == nullptr) watch = &watch_;
    for (int i = 0; i < std::lround(10.0 * duration_s); ++i) {
      time_ += std::chrono::milliseconds(100);
      watch->Begin();
      for (int degree = 0; degree < kNumColumns; ++degree) {
        std::vector<float> range_m;
        for (std::size_t ring = 0; ring < kElevationRad.size(); ++ring) range_m.push_back(world(degree, ring));
        watch->AddColumn(DegToRad(degree + 0.5), kNoOffsetRad, kElevationRad, range_m);
      }
      watch->End(time_);
    }
  }
  static std::string InWords(const CoverWatch& watch) {
    std::string text;
    for (const auto& part : watch.parts()) {
      const auto from_deg = std::lround(RadToDeg(part.bearing.start_rad));
      text += (text.empty() ? "" : "; ") + std::to_string(from_deg) + "+" + std::to_string(std::lround(RadToDeg(part.bearing.width_rad))) + " why " +
              std::to_string(static_cast<int>(part.why));
    }
    return text;
  }
  std::string Told() const { return InWords(watch_); }

  // The lowest beam meets the deck all round at 2 m; over it, flat water.
  static float Deck(int /*degree*/, std::size_t ring) { return ring == 0 ? 2.0F : 0.0F; }
  static float Water(int /*degree*/, std::size_t /*ring*/) { return 0.0F; }
  static World Covered(const World& world, int from_deg, int to_deg, float range_m) {
    return [=](int degree, std::size_t ring) { return IsWithin(degree, from_deg, to_deg) ? range_m : world(degree, ring); };
  }

  CoverWatch watch_{MakeParams()};
  Utime time_{std::chrono::seconds(1'800'000'000)};
};

TEST_F(CoverWatchTest, SaysNothingOfADeckOverFlatWater) {
  Scans(120.0, Deck);
  EXPECT_EQ(Told(), "");
  EXPECT_FALSE(watch_.covers_any());
  EXPECT_FALSE(watch_.sees_nothing());
  EXPECT_EQ(watch_.num_told(), 0);
}

TEST_F(CoverWatchTest, NoticesThatTheOwnBoatIsGoneInASector) {
  Scans(30.0, Deck);
  Scans(0.1, Covered(Deck, 100, 150, 0.0F));
  EXPECT_TRUE(watch_.Covers(DegToRad(120.0))) << "at once: a track there is not missing";
  EXPECT_FALSE(watch_.Covers(DegToRad(160.0)));
  EXPECT_TRUE(watch_.covers_anew());
  EXPECT_EQ(watch_.EndOf(DegToRad(120.0), 0.0F), CoverWatch::kAtLidarM);
  EXPECT_EQ(watch_.EndOf(DegToRad(120.0), 7.0F), 7.0F);
  EXPECT_EQ(watch_.EndOf(DegToRad(160.0), 0.0F), 0.0F);
  EXPECT_EQ(Told(), "") << "a person may walk past";
  Scans(3.0, Covered(Deck, 100, 150, 0.0F));
  EXPECT_EQ(Told(), "100+50 why 2");
  EXPECT_EQ(watch_.num_told(), 1);
  Scans(600.0, Covered(Deck, 100, 150, 0.0F));
  EXPECT_EQ(Told(), "100+50 why 2") << "it is not forgotten while nothing is seen there";
  EXPECT_EQ(watch_.num_told(), 1);
  Scans(3.0, Deck);
  EXPECT_EQ(Told(), "");
  EXPECT_FALSE(watch_.covers_any());
}

TEST_F(CoverWatchTest, IsASectorAcrossTheSeam) {
  Scans(30.0, Deck);
  Scans(3.2, Covered(Deck, 340, 385, 0.0F));
  EXPECT_EQ(Told(), "340+45 why 2");
}

TEST_F(CoverWatchTest, TakesAMastAndAPersonForNone) {
  Scans(30.0, Covered(Deck, 200, 217, 0.6F));
  EXPECT_EQ(Told(), "");
  Scans(30.0, Covered(Deck, 100, 125, 0.0F));
  EXPECT_EQ(Told(), "") << "25 deg";
  Scans(2.0, Covered(Deck, 100, 180, 0.7F));
  EXPECT_EQ(Told(), "") << "not long enough";
}

// A cover is often drawn over the lidar, not put on it: 1 deg in a tenth of a second here.
TEST_F(CoverWatchTest, NoticesACoverThatComesSlowly) {
  Scans(30.0, Deck);
  for (int i = 1; i <= 90; ++i) Scans(0.1, Covered(Deck, 90, 90 + i, 0.0F));
  Scans(3.0, Covered(Deck, 90, 180, 0.0F));
  EXPECT_EQ(Told(), "90+90 why 2");
}

TEST_F(CoverWatchTest, IsNoCoverWhereAnythingElseIsSeen) {
  Scans(30.0, Deck);
  // A boom goes over to the other side, and the water before it shows crests.
  const World swung = [](int degree, std::size_t ring) {
    if (!IsWithin(degree, 100, 160)) return Deck(degree, ring);
    return ring == 1 && degree % 2 == 0 ? 12.0F : 0.0F;
  };
  Scans(60.0, swung);
  EXPECT_EQ(Told(), "");
  Scans(10.0, Covered(Deck, 100, 160, 0.0F));
  EXPECT_EQ(Told(), "") << "the boat is not known there any more";
}

TEST_F(CoverWatchTest, NoticesANearCoverFromTheBeginOn) {
  Scans(3.2, Covered(Water, 300, 340, 0.7F));
  EXPECT_EQ(Told(), "300+40 why 1");
  EXPECT_FALSE(watch_.covers_anew()) << "nothing was seen there that could be missing";
  EXPECT_EQ(watch_.EndOf(DegToRad(320.0), 0.7F), 0.7F);
}

// What is no own boat is an obstacle, however near: a quay 0.8 m from a lidar at the stem.
TEST_F(CoverWatchTest, TakesNoObstacleForACover) {
  auto params = MakeParams();
  params.own_vessel_box_m = {Eigen::Vector3d(-8.0, -3.0, -1.0), Eigen::Vector3d(0.2, 3.0, 2.0)};
  CoverWatch watch(params);
  Scans(10.0, Covered(Water, 320, 400, 0.8F), &watch);
  EXPECT_EQ(InWords(watch), "");
}

TEST_F(CoverWatchTest, BridgesWhatShowsNothingBetweenCoveredSectors) {
  const World creased = [](int degree, std::size_t /*ring*/) { return IsWithin(degree, 40, 60) || IsWithin(degree, 75, 95) ? 0.6F : 0.0F; };
  Scans(3.2, creased);
  EXPECT_EQ(Told(), "40+55 why 1");
  const World apart = [](int degree, std::size_t /*ring*/) { return IsWithin(degree, 40, 60) || IsWithin(degree, 100, 120) ? 0.6F : 0.0F; };
  CoverWatch watch(MakeParams());
  Scans(3.2, apart, &watch);
  EXPECT_EQ(InWords(watch), "");
}

TEST_F(CoverWatchTest, TellsBearingsFromTheBow) {
  CoverWatch turned(MakeParams(90.0));
  Scans(3.2, Covered(Water, 120, 160, 0.7F), &turned);
  EXPECT_EQ(InWords(turned), "30+40 why 1") << "x of the lidar points to port";
  CoverWatch upside_down(MakeParams(0.0, 180.0));
  Scans(3.2, Covered(Water, 120, 160, 0.7F), &upside_down);
  EXPECT_EQ(InWords(upside_down), "200+40 why 1");
}

TEST_F(CoverWatchTest, LeavesOutWhatTheSegmenterDoesNotTake) {
  auto params = MakeParams();
  params.field_of_view = {DegToRad(270.0), DegToRad(180.0)};
  CoverWatch watch(params);
  Scans(10.0, Covered(Deck, 120, 200, 0.7F), &watch);
  EXPECT_EQ(InWords(watch), "") << "a cabin";
  Scans(20.0, Deck, &watch);
  Scans(3.2, Covered(Water, 0, 0, 0.0F), &watch);
  EXPECT_TRUE(watch.is_all_round()) << "of what it takes";
}

// Lasers off: the packets go on.
TEST_F(CoverWatchTest, IsDarkWhereMuchWasSeenAndNothingIsNow) {
  const World quay = [](int degree, std::size_t ring) { return ring == 2 && IsWithin(degree, 0, 120) ? 30.0F : 0.0F; };
  Scans(10.0, quay);
  Scans(0.1, Water);
  EXPECT_TRUE(watch_.Covers(DegToRad(200.0)));
  Scans(3.0, Water);
  EXPECT_EQ(Told(), "0+360 why 3");
  EXPECT_TRUE(watch_.is_all_round());
  EXPECT_FALSE(watch_.sees_nothing()) << "one fault, one alert";
  Scans(300.0, Water);
  EXPECT_EQ(Told(), "0+360 why 3");
  Scans(3.0, quay);
  EXPECT_EQ(Told(), "");
  EXPECT_FALSE(watch_.is_all_round());
}

// Strays, of the sun or of another lidar, must not end it.
TEST_F(CoverWatchTest, StaysDarkWithStrays) {
  const World quay = [](int degree, std::size_t ring) { return ring == 2 && IsWithin(degree, 0, 120) ? 30.0F : 0.0F; };
  const World stray = [](int degree, std::size_t ring) { return ring == 2 && degree == 77 ? 30.0F : 0.0F; };
  const World strays = [](int degree, std::size_t ring) { return ring == 2 && degree < 5 ? 30.0F : 0.0F; };
  Scans(10.0, quay);
  for (int i = 0; i < 300; ++i) {
    Scans(0.3, stray);
    Scans(0.2, strays);
  }
  EXPECT_EQ(Told(), "0+360 why 3");
  EXPECT_EQ(watch_.num_told(), 1);
  // Returns in each scan: it sees.
  Scans(3.0, strays);
  EXPECT_EQ(Told(), "");
}

// A VLP-16 that leaves a harbour loses more with each scan; the boat does not see itself.
TEST_F(CoverWatchTest, IsNotDarkWhereTheHarbourGoesOutOfReach) {
  for (const int scans : {20, 40, 100}) {
    CoverWatch watch(MakeParams());
    Scans(
        5.0, [](int, std::size_t) { return 80.0F; }, &watch);
    for (int i = scans; i >= 0; --i) {
      Scans(
          0.1, [=](int degree, std::size_t) { return degree < 360 * i / scans ? 90.0F : 0.0F; }, &watch);
    }
    Scans(5.0, Water, &watch);
    EXPECT_FALSE(watch.covers_any()) << scans;
  }
}

// The own field of view of the lidar is narrowed: what does not fire is not covered.
TEST_F(CoverWatchTest, EndsWhereTheLidarFiresNoMore) {
  Scans(5.0, Covered(Deck, 120, 200, 0.7F));
  EXPECT_EQ(Told(), "120+80 why 1");
  for (int i = 0; i < 40; ++i) {
    time_ += std::chrono::milliseconds(100);
    watch_.Begin();
    for (int degree = 0; degree < 100; ++degree)
      watch_.AddColumn(DegToRad(degree + 0.5), kNoOffsetRad, kElevationRad, std::vector<float>{2.0F, 0.0F, 0.0F, 0.0F});
    watch_.End(time_);
  }
  EXPECT_EQ(Told(), "");
}

TEST_F(CoverWatchTest, TellsNothingWhereNoScanComesAnyMore) {
  Scans(5.0, Covered(Deck, 120, 200, 0.7F));
  watch_.Skip(time_ + std::chrono::seconds(1));
  EXPECT_FALSE(watch_.covers_any());
  EXPECT_EQ(Told(), "120+80 why 1");
  watch_.Skip(time_ + std::chrono::seconds(6));
  EXPECT_EQ(Told(), "");
  EXPECT_EQ(watch_.num_lasting(), 0);
}

// A helmsman who steps aside and comes back is told once.
TEST_F(CoverWatchTest, TellsOnceWhatComesBack) {
  Scans(5.0, Covered(Deck, 120, 200, 0.7F));
  for (int i = 0; i < 5; ++i) {
    Scans(5.0, Deck);
    Scans(5.0, Covered(Deck, 120, 200, 0.7F));
  }
  EXPECT_EQ(watch_.num_told(), 1);
  Scans(15.0, Deck);
  Scans(5.0, Covered(Deck, 120, 200, 0.7F));
  EXPECT_EQ(watch_.num_told(), 2);
}

// Later scans count as whole again: what was seen in the sector is not waited for any more.
TEST_F(CoverWatchTest, ACoverThatStaysHidesNothingNew) {
  Scans(5.0, Deck);
  Scans(10.0, Covered(Deck, 120, 200, 0.7F));
  EXPECT_TRUE(watch_.covers_anew());
  Scans(25.0, Covered(Deck, 120, 200, 0.7F));
  EXPECT_FALSE(watch_.covers_anew());
  EXPECT_TRUE(watch_.covers_any());
}

// A last buoy that goes out of reach, or shore that fades, is no darkness.
TEST_F(CoverWatchTest, IsNotDarkWhereThingsGoOutOfReach) {
  for (int width_deg = 300; width_deg >= 0; width_deg -= 2) {
    Scans(0.1, [width_deg](int degree, std::size_t ring) { return ring == 2 && degree < width_deg ? 90.0F : 0.0F; });
    EXPECT_FALSE(watch_.covers_any());
  }
  Scans(20.0, Water);
  EXPECT_EQ(Told(), "");
}

TEST_F(CoverWatchTest, SaysAfterHalfAMinuteThatItSeesNothing) {
  Scans(29.0, Water);
  EXPECT_FALSE(watch_.sees_nothing());
  Scans(2.0, Water);
  EXPECT_TRUE(watch_.sees_nothing());
  EXPECT_EQ(Told(), "") << "flat water looks so, too";
  EXPECT_FALSE(watch_.covers_any()) << "and it is looked at, if it is that";
  // Few returns, as of a bird, are not enough: else it would come up twice a minute.
  const World bird = [](int degree, std::size_t ring) { return ring == 2 && degree >= 50 && degree < 53 ? 20.0F : 0.0F; };
  for (int i = 0; i < 10; ++i) {
    Scans(0.2, bird);
    Scans(5.0, Water);
    EXPECT_TRUE(watch_.sees_nothing());
  }
  Scans(5.2, bird);
  EXPECT_FALSE(watch_.sees_nothing());
  Scans(20.0, Water);
  Scans(0.1, bird);
  Scans(20.0, Water);
  EXPECT_FALSE(watch_.sees_nothing()) << "not half a minute";
}

TEST_F(CoverWatchTest, CountsNoTimeInWhichNoScanCame) {
  Scans(1.0, Water);
  time_ += std::chrono::seconds(100);
  Scans(1.0, Water);
  EXPECT_FALSE(watch_.sees_nothing());
}

TEST_F(CoverWatchTest, TellsAnewWhatWasNotTold) {
  Scans(30.0, Deck);
  Scans(10.0, Covered(Deck, 100, 150, 0.0F));
  EXPECT_EQ(watch_.num_told(), 1);
  Scans(10.0, Covered(Deck, 100, 160, 0.0F));
  EXPECT_EQ(watch_.num_told(), 1) << "a little more is the same";
  Scans(10.0, Covered(Deck, 100, 200, 0.0F));
  EXPECT_EQ(watch_.num_told(), 2);
}

}  // namespace
}  // namespace lookout
