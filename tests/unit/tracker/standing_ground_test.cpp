#include "services/tracker/core/standing_ground.hpp"

#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace lookout::tracker::ground {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Utime kBegin{seconds(1'700'000'000)};
const Eigen::Vector2d kPlace_m(-20.2, 7.3);

// Scans ten times a second, of which each has a return at each place.
class StandingGroundTest : public ::testing::Test {
 protected:
  void Scans(int num, const std::vector<Eigen::Vector2d>& places_m) {
    for (int i = 0; i < num; ++i) {
      time_ += milliseconds(100);
      ground_.Begin(time_);
      ground_.Add(places_m, heights_m_);
    }
  }
  int TimesMet(const Eigen::Vector2d& place_m) const { return ground_.TimesMet(place_m, 1.0, time_); }

  StandingGround ground_;
  std::vector<double> heights_m_;  // of each place
  Utime time_ = kBegin - milliseconds(100);
};

TEST_F(StandingGroundTest, CountsHalfSecondsBeforeThePresentOne) {
  Scans(5, {kPlace_m});
  EXPECT_EQ(TimesMet(kPlace_m), 0) << "the present one may be the thing itself";
  Scans(1, {kPlace_m});
  EXPECT_EQ(TimesMet(kPlace_m), 1);
  Scans(20, {kPlace_m});
  EXPECT_EQ(TimesMet(kPlace_m), 5);
  EXPECT_EQ(ground_.TimesMet(kPlace_m, 1.0, time_ - seconds(1)), 3);
  EXPECT_EQ(ground_.TimesMet(kPlace_m, 1.0, time_ + seconds(1)), 5) << "what is to come counts as now";
}

TEST_F(StandingGroundTest, KnowsWhatWasSeenNowAndThen) {
  for (int i = 0; i < 4; ++i) {
    Scans(1, {kPlace_m});
    Scans(29, {});
  }
  EXPECT_EQ(TimesMet(kPlace_m), 4);
}

TEST_F(StandingGroundTest, ReachesHalfAMetreToAMetre) {
  Scans(11, {kPlace_m});
  for (const double angle_deg : {0.0, 45.0, 90.0, 180.0, 270.0}) {
    SCOPED_TRACE(angle_deg);
    const double angle_rad = angle_deg / 57.3;
    const Eigen::Vector2d ahead(std::cos(angle_rad), std::sin(angle_rad));
    EXPECT_EQ(TimesMet(kPlace_m + 0.5 * ahead), 2);
    EXPECT_EQ(TimesMet(kPlace_m + 1.5 * ahead), 0);
  }
}

// Of two cells that are met by turns each half second counts once.
TEST_F(StandingGroundTest, JoinsTheCellsAroundAPlace) {
  const Eigen::Vector2d beside_m = kPlace_m + Eigen::Vector2d(0.5, 0.0);
  for (int i = 0; i < 3; ++i) {
    Scans(5, {kPlace_m});
    Scans(5, {beside_m, kPlace_m});
  }
  EXPECT_EQ(TimesMet(kPlace_m), 5);
}

TEST_F(StandingGroundTest, ForgetsAfterHalfAMinute) {
  Scans(10, {kPlace_m});
  Scans(290, {});
  EXPECT_EQ(TimesMet(kPlace_m), 2);
  Scans(40, {});
  EXPECT_EQ(TimesMet(kPlace_m), 0);
  Scans(100, {});
  EXPECT_EQ(ground_.num_cells(), 0U);
}

TEST_F(StandingGroundTest, KeepsABridgeApartFromWhatIsBelow) {
  heights_m_ = {3.0};
  Scans(11, {kPlace_m});
  EXPECT_EQ(TimesMet(kPlace_m), 0);
  EXPECT_EQ(ground_.TimesMet(kPlace_m, 4.0, time_), 2);
  heights_m_ = {0.5};
  Scans(10, {kPlace_m});
  EXPECT_EQ(TimesMet(kPlace_m), 2);
}

TEST_F(StandingGroundTest, TakesAnyPlaceAndTime) {
  constexpr double kMost = std::numeric_limits<double>::max();
  Scans(11, {{kMost, -kMost}, {0.0, 0.0}});
  EXPECT_EQ(TimesMet({kMost, -kMost}), 2);
  EXPECT_EQ(TimesMet({-kMost, kMost}), 2) << "too far to be told apart";
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Scans(1, {{kNan, kNan}});
  TimesMet({kNan, 0.0});
  ground_.Begin(kBegin - seconds(100));
  ground_.Add(std::vector<Eigen::Vector2d>{{5.0, 5.0}}, {});
  ground_.Begin(time_);
  EXPECT_EQ(ground_.TimesMet({0.0, 0.0}, 0.0, Utime::min()), 0);
  EXPECT_EQ(ground_.TimesMet({0.0, 0.0}, 0.0, Utime::max()), 2);
}

TEST_F(StandingGroundTest, HoldsNoMoreThanItsMost) {
  std::vector<Eigen::Vector2d> places_m;
  for (int x = 0; x < 600; ++x) {
    for (int y = 0; y < 600; ++y) places_m.emplace_back(0.5 * x + 0.2, 0.5 * y + 0.2);
  }
  Scans(1, {kPlace_m});
  Scans(1, places_m);
  EXPECT_LE(ground_.num_cells(), 200'000U);
  Scans(10, {kPlace_m});
  EXPECT_EQ(TimesMet(kPlace_m), 2) << "what is there stays";
}

}  // namespace
}  // namespace lookout::tracker::ground
