// T-GOSPA by hand, and against the least cost of all assignments of small cases.
#include "lab/eval/tracks/trajectory_gospa.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

namespace lookout::eval {
namespace {

using Eigen::Vector2d;
using Scans = std::vector<TrajectoryScan>;

constexpr double kSwitchM2 = kSwitchCostM * kSwitchCostM;

double SquareOf(const TrajectoryGospa& gospa) { return gospa.Rms() * gospa.Rms() * static_cast<double>(gospa.scans.num_scans); }

TEST(TrajectoryGospa, ASwitchCostsAsMuchAsAMiss) { EXPECT_NEAR(kSwitchM2, kGospaCutOffM * kGospaCutOffM / 2.0, 1e-9); }

TEST(TrajectoryGospa, OfOnePairIsItsDistance) {
  Scans scans;
  for (int n = 0; n < 10; ++n) scans.push_back({{{1, {0.0, 0.0}}}, {{5, {3.0, 4.0}}}});
  const auto gospa = TrajectoryGospaOf(scans);
  EXPECT_NEAR(gospa.Rms(), 5.0, 1e-12);
  EXPECT_DOUBLE_EQ(gospa.num_switches, 0.0);
  EXPECT_EQ(gospa.scans.num_missed, 0);
}

TEST(TrajectoryGospa, ATrajectoryThatBeginsLateAndEndsEarlyCostsNoSwitch) {
  Scans scans;
  for (int n = 0; n < 10; ++n) {
    scans.push_back({{{1, {0.0, 0.0}}}, {}});
    if (n >= 3 && n < 8 && n != 5) scans.back().estimates_m.push_back({5, {0.0, 0.0}});  // away for a scan: it keeps its partner
  }
  const auto gospa = TrajectoryGospaOf(scans);
  EXPECT_EQ(gospa.scans.num_missed, 6);
  EXPECT_DOUBLE_EQ(gospa.num_switches, 0.0);
}

TEST(TrajectoryGospa, ANewNumberIsOneSwitch) {
  Scans scans;
  for (int n = 0; n < 10; ++n) scans.push_back({{{1, {0.0, 0.0}}}, {{n < 5 ? 5 : 6, {0.0, 0.0}}}});
  const auto gospa = TrajectoryGospaOf(scans);
  EXPECT_DOUBLE_EQ(gospa.num_switches, 1.0);
  EXPECT_NEAR(SquareOf(gospa), kSwitchM2, 1e-9);
  EXPECT_NEAR(gospa.SwitchRms(), std::sqrt(kSwitchM2 / 10.0), 1e-12);
}

TEST(TrajectoryGospa, TwoThatExchangeNumbersAreTwoSwitches) {
  Scans scans;
  for (int n = 0; n < 40; ++n) {
    scans.push_back({{{1, {0.0, 0.0}}, {2, {10.0, 0.0}}}, {{5, {n < 20 ? 0.0 : 10.0, 0.0}}, {6, {n < 20 ? 10.0 : 0.0, 0.0}}}});
  }
  const auto gospa = TrajectoryGospaOf(scans);
  EXPECT_DOUBLE_EQ(gospa.num_switches, 2.0);
  EXPECT_DOUBLE_EQ(gospa.scans.localisation_m2, 0.0);
}

// For one scan only: to stay costs 2 x 25, to change and back 4 switches.
TEST(TrajectoryGospa, AShortExchangeIsALargeDistance) {
  Scans scans;
  for (int n = 0; n < 40; ++n) {
    scans.push_back({{{1, {0.0, 0.0}}, {2, {5.0, 0.0}}}, {{5, {n != 20 ? 0.0 : 5.0, 0.0}}, {6, {n != 20 ? 5.0 : 0.0, 0.0}}}});
  }
  const auto gospa = TrajectoryGospaOf(scans);
  EXPECT_DOUBLE_EQ(gospa.num_switches, 0.0);
  EXPECT_DOUBLE_EQ(gospa.scans.localisation_m2, 50.0);
}

TEST(TrajectoryGospa, BeyondTheCutOffAreAMissAndAFalseOne) {
  const auto gospa = TrajectoryGospaOf(Scans{{{{1, {0.0, 0.0}}}, {{5, {21.0, 0.0}}}}});
  EXPECT_EQ(gospa.scans.num_missed, 1);
  EXPECT_EQ(gospa.scans.num_false, 1);
}

TEST(TrajectoryGospa, OfNothingIsNothing) {
  EXPECT_DOUBLE_EQ(TrajectoryGospaOf(Scans{{}, {}}).Rms(), 0.0);
  EXPECT_TRUE(std::isnan(TrajectoryGospaOf(Scans{}).Rms()));
}

TEST(TrajectoryGospa, RunsAddInSquares) {
  auto sum = TrajectoryGospaOf(Scans{{{{1, {0.0, 0.0}}}, {{5, {4.0, 0.0}}}}});
  sum.Add(TrajectoryGospaOf(Scans{{}}));
  EXPECT_NEAR(sum.Rms(), std::sqrt(16.0 / 2.0), 1e-12);
}

// All partial assignments of some truths to some estimates: by truth the estimate, or -1.
std::vector<std::vector<int>> AllAssignments(int num_truths, int num_estimates) {
  std::vector<std::vector<int>> all{{}};
  for (int i = 0; i < num_truths; ++i) {
    std::vector<std::vector<int>> longer;
    for (const auto& one : all) {
      for (int k = -1; k < num_estimates; ++k) {
        if (k >= 0 && std::ranges::find(one, k) != one.end()) continue;
        longer.push_back(one);
        longer.back().push_back(k);
      }
    }
    all = longer;
  }
  return all;
}

// NaN: it is not there.
struct Trajectories {
  std::vector<std::vector<Vector2d>> truths_m;     // [scans][truths]
  std::vector<std::vector<Vector2d>> estimates_m;  // [scans][estimates]
};

// The definition, by dynamic programming over all assignments.
double LeastSquare(const Trajectories& run) {
  constexpr double kAloneM2 = kGospaCutOffM * kGospaCutOffM / 2.0;
  const auto all = AllAssignments(static_cast<int>(run.truths_m[0].size()), static_cast<int>(run.estimates_m[0].size()));
  const auto cost_at = [&](std::size_t n, const std::vector<int>& assignment) {
    double cost = 0.0;
    std::vector<bool> is_taken(run.estimates_m[n].size());
    for (std::size_t i = 0; i < assignment.size(); ++i) {
      const auto& p_m = run.truths_m[n][i];
      if (assignment[i] < 0) {
        cost += p_m.hasNaN() ? 0.0 : kAloneM2;
        continue;
      }
      const auto& q_m = run.estimates_m[n][static_cast<std::size_t>(assignment[i])];
      is_taken[static_cast<std::size_t>(assignment[i])] = true;
      if (p_m.hasNaN() || q_m.hasNaN()) {
        cost += p_m.hasNaN() && q_m.hasNaN() ? 0.0 : kAloneM2;
      } else {
        cost += std::min((p_m - q_m).squaredNorm(), 2.0 * kAloneM2);
      }
    }
    for (std::size_t k = 0; k < is_taken.size(); ++k) cost += is_taken[k] || run.estimates_m[n][k].hasNaN() ? 0.0 : kAloneM2;
    return cost;
  };
  const auto change = [](const std::vector<int>& before, const std::vector<int>& now) {
    double switches = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (before[i] != now[i]) switches += before[i] < 0 || now[i] < 0 ? 0.5 : 1.0;
    }
    return switches * kSwitchM2;
  };
  std::vector<double> least(all.size());
  for (std::size_t a = 0; a < all.size(); ++a) least[a] = cost_at(0, all[a]);
  for (std::size_t n = 1; n < run.truths_m.size(); ++n) {
    std::vector<double> next(all.size(), std::numeric_limits<double>::infinity());
    for (std::size_t a = 0; a < all.size(); ++a) {
      for (std::size_t b = 0; b < all.size(); ++b) next[a] = std::min(next[a], least[b] + change(all[b], all[a]));
      next[a] += cost_at(n, all[a]);
    }
    least = next;
  }
  return *std::ranges::min_element(least);
}

TEST(TrajectoryGospa, IsHardlyEverAboveTheLeastCost) {
  constexpr unsigned kSeed = 17;
  constexpr int kNumCases = 500;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int> count(1, 3);
  std::uniform_int_distribution<int> num_scans(1, 6);
  std::uniform_real_distribution<double> place_m(0.0, 35.0);
  std::bernoulli_distribution is_there(0.8);
  int num_above = 0;
  for (int c = 0; c < kNumCases; ++c) {
    const auto num_truths = static_cast<std::size_t>(count(random));
    const auto num_estimates = static_cast<std::size_t>(count(random));
    Trajectories run;
    Scans scans(static_cast<std::size_t>(num_scans(random)));
    Gospa by_scan{.num_scans = 0};
    for (auto& scan : scans) {
      const auto make = [&](std::size_t number, auto& of_scan) {
        std::vector<Vector2d> places_m(number, Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
        for (std::size_t i = 0; i < number; ++i) {
          if (!is_there(random)) continue;
          places_m[i] = {place_m(random), place_m(random)};
          of_scan.emplace_back(static_cast<std::int64_t>(i) + 1, places_m[i]);
        }
        return places_m;
      };
      run.truths_m.push_back(make(num_truths, scan.truths_m));
      run.estimates_m.push_back(make(num_estimates, scan.estimates_m));
      std::vector<Vector2d> truths_m;
      std::vector<Vector2d> estimates_m;
      for (const auto& [id, p_m] : scan.truths_m) truths_m.push_back(p_m);
      for (const auto& [id, p_m] : scan.estimates_m) estimates_m.push_back(p_m);
      by_scan.Add(GospaOf(truths_m, estimates_m));
    }
    const auto gospa = TrajectoryGospaOf(scans);
    const double least = LeastSquare(run);
    EXPECT_GE(SquareOf(gospa), least - 1e-6) << "case " << c;
    EXPECT_LE(SquareOf(gospa), 1.1 * least + 1e-6) << "case " << c;
    EXPECT_GE(gospa.Rms(), by_scan.Rms() - 1e-9);
    if (SquareOf(gospa) > least + 1e-6) ++num_above;
  }
  std::printf("%d of %d cases are above the least cost\n", num_above, kNumCases);
  EXPECT_LE(num_above, kNumCases / 100);
}

}  // namespace
}  // namespace lookout::eval
