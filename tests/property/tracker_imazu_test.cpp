// The 22 encounter problems of H. Imazu ("Research on collision avoidance manoeuvre", Tokyo University of Mercantile Marine, 1987, in Japanese), on
// which ways of keeping clear are tried since. Courses as R. Sawada, K. Sato and T. Majima list them ("Automatic ship collision avoidance using deep
// reinforcement learning with LSTM in continuous action spaces", J. Mar. Sci. Technol. 26, 2021): the own ship goes north; one to three others, each
// on a course of its own, would all be where it is at the same time. Slow ships, which it overtakes, go at 0.39 of its speed. The eighth is not told
// from the fifth by courses alone; here its second ship comes from port.
//
// Scaled to boats of 4 to 5 m at 2 m/s (4 kn) that see each other from 100 m on.
#include <cmath>
#include <gtest/gtest.h>
#include <optional>
#include <random>
#include <vector>

#include "common/core/angles.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/dangers.hpp"
#include "services/tracker/core/encounter.hpp"

namespace lookout::tracker {
namespace {

using Courses = std::vector<double>;  // degrees; 0: the slow one

const std::vector<Courses> kProblems{{180},
                                     {-90},
                                     {0},
                                     {45},
                                     {180, -90},
                                     {-10, -45},
                                     {0, -45},
                                     {180, 90},
                                     {-30, -90},
                                     {-90, 15},
                                     {90, -30},
                                     {180, -45, -10},
                                     {180, 10, 45},
                                     {-10, -45, -90},
                                     {0, -45, -90},
                                     {45, 90, -90},
                                     {0, 10, -45},
                                     {-135, -15, -30},
                                     {15, -15, -135},
                                     {0, -15, -90},
                                     {-15, 15, -90},
                                     {0, -45, -90}};

constexpr double kSpeedMps = 2.0;
constexpr double kSlow = 0.39;
constexpr double kSeenM = 100.0;
constexpr double kMeetS = 60.0;
constexpr double kEndS = 150.0;
constexpr double kScanS = 0.1;
constexpr double kSd = 0.1;  // of position, m, and of velocity, m/s
// Small craft: a boat's length of room, and the time in which it can be stopped or turned away twice over.
constexpr EncounterParams kLimits{.limit_m = 5.0, .look_ahead_s = 30.0};
constexpr AlertParams kAlerting{};

std::vector<Eigen::Vector2d> Boat(double length_m, double width_m, const Eigen::Vector2d& center_m, double course_rad) {
  const Eigen::Vector2d ahead(std::sin(course_rad), std::cos(course_rad));
  const Eigen::Vector2d port(-ahead.y(), ahead.x());
  std::vector<Eigen::Vector2d> hull;
  for (const auto& [along, across] : {std::pair(0.5, 0.0), std::pair(0.2, 0.5), std::pair(-0.5, 0.4), std::pair(-0.5, -0.4), std::pair(0.2, -0.5)}) {
    hull.emplace_back(center_m + along * length_m * ahead + across * width_m * port);
  }
  return hull;
}

// An error that comes and goes within some seconds, as that of a filter.
class Wander {
 public:
  Eigen::Vector4d Next(std::mt19937_64& random) {
    constexpr double kKeep = 0.9;
    for (double& value : value_) value = kKeep * value + std::sqrt(1.0 - kKeep * kKeep) * kSd * normal_(random);
    return value_;
  }

 private:
  std::normal_distribution<double> normal_;
  Eigen::Vector4d value_ = Eigen::Vector4d::Zero();
};

struct Outcome {
  std::optional<double> raised_s;          // first alert
  std::optional<double> warning_s;         // first warning
  std::optional<double> touched_s;         // true hulls
  double last_inside_s = 0.0;              // true distance below the limit
  double last_held_s = 0.0;                // the alert
  Encounter encounter = Encounter::kNone;  // 10 s before
};

std::vector<Outcome> Simulate(const Courses& courses, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Wander> wanders(courses.size());
  std::vector<Outcome> outcomes(courses.size());
  Alerts alerts(kAlerting);
  const Utime start{std::chrono::seconds(1'700'000'000)};
  const RelativeCovariance covariance = kSd * kSd * RelativeCovariance::Identity();
  for (int scan = 0; scan * kScanS < kEndS; ++scan) {
    const double time_s = scan * kScanS;
    Pose own;
    own.is_placed = true;
    own.velocity_map_mps = {0.0, kSpeedMps};
    own.position_map_m = {0.0, kSpeedMps * (time_s - kMeetS), 0.0};
    const Moving own_boat{Boat(5.0, 2.0, own.position_map_m.head<2>(), 0.0), own.velocity_map_mps};
    Picture picture;
    for (std::size_t i = 0; i < courses.size(); ++i) {
      const double course_rad = DegToRad(courses[i]);
      const Eigen::Vector2d velocity = kSpeedMps * (courses[i] == 0.0 ? kSlow : 1.0) * Eigen::Vector2d(std::sin(course_rad), std::cos(course_rad));
      const Eigen::Vector2d position = (time_s - kMeetS) * velocity;
      if ((position - own_boat.hull_m.front()).norm() > kSeenM) continue;
      const Eigen::Vector4d error = wanders[i].Next(random);
      const double distance_m = GapOf(own_boat.hull_m, Boat(4.0, 1.6, position, course_rad)).distance_m;
      if (distance_m == 0.0 && !outcomes[i].touched_s) outcomes[i].touched_s = time_s;
      if (distance_m < kLimits.limit_m) outcomes[i].last_inside_s = time_s;
      const Moving other{Boat(4.0, 1.6, position + error.head<2>(), course_rad), velocity + error.tail<2>()};
      Track track;
      track.existence_probability = 1.0;
      track.id = static_cast<std::int64_t>(i) + 1;
      track.status = TrackStatus::kConfirmed;
      track.velocity_mps = other.velocity_mps;
      track.approach = ClosestApproachOf(own_boat, other, covariance, kLimits);
      track.encounter = EncounterOf(own_boat, 0.0, other, track.approach, kLimits);
      if (!outcomes[i].touched_s && track.approach.tcpa_s > 9.0 && track.approach.tcpa_s < 11.0) outcomes[i].encounter = track.encounter;
      picture.tracks.push_back(track);
    }
    const auto time = start + std::chrono::milliseconds(100 * scan);
    for (const auto& alert : alerts.Update(time, true, ClosestApproachDangers({kLimits.limit_m}, picture, own, false))) {
      if (!alert.Holds()) continue;
      auto& outcome = outcomes[static_cast<std::size_t>(alert.thing - 1)];
      if (!outcome.raised_s) outcome.raised_s = time_s;
      if (alert.level == AlertLevel::kWarning && !outcome.warning_s) outcome.warning_s = time_s;
      outcome.last_held_s = time_s;
    }
  }
  return outcomes;
}

TEST(ImazuProblems, AreWarnedOfEightSecondsAheadAndSilentAfterPassing) {
  ASSERT_EQ(kProblems.size(), 22U);
  double least_ahead_s = 1e9;
  double longest_after_s = 0.0;
  for (std::size_t problem = 0; problem < kProblems.size(); ++problem) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      for (const auto& outcome : Simulate(kProblems[problem], seed)) {
        ASSERT_TRUE(outcome.touched_s) << "problem " << problem + 1;
        ASSERT_TRUE(outcome.raised_s) << "problem " << problem + 1;
        ASSERT_TRUE(outcome.warning_s) << "problem " << problem + 1;
        EXPECT_LE(*outcome.raised_s, *outcome.touched_s - 8.0) << "problem " << problem + 1;
        EXPECT_LE(outcome.last_held_s, outcome.last_inside_s + 5.0) << "problem " << problem + 1;
        least_ahead_s = std::min(least_ahead_s, *outcome.touched_s - *outcome.raised_s);
        longest_after_s = std::max(longest_after_s, outcome.last_held_s - outcome.last_inside_s);
      }
    }
  }
  std::printf("alerts came at least %.1f s before the hulls touched, and ended at most %.1f s after they were farther apart than the limit\n",
              least_ahead_s, longest_after_s);
}

TEST(ImazuProblems, AreTheEncountersThatTheyShow) {
  const auto encounter = [](std::size_t problem) { return Simulate(kProblems[problem - 1], 1)[0].encounter; };
  EXPECT_EQ(encounter(1), Encounter::kHeadOn);
  EXPECT_EQ(encounter(2), Encounter::kCrossingGiveWay);
  EXPECT_EQ(encounter(3), Encounter::kOvertaking);
  EXPECT_EQ(encounter(4), Encounter::kCrossingStandOn);
}

}  // namespace
}  // namespace lookout::tracker
