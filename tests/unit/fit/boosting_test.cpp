#include "lab/fit/boosting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "lab/fit/isotonic.hpp"

namespace lookout::fit {
namespace {

constexpr std::array<std::string_view, 4> kNames{"gap", "range_m", "width_m", "noise"};
constexpr segmenter::EvidenceLayout kLayout{"merge", kNames};

// What is true is drawn by known log odds: less with the gap, more where what is wide is near, whatever the noise.
double TrueLogOdds(std::span<const float> row) { return 2.0 - 1.5 * row[0] + (row[1] < 0.0F && row[2] > 0.5F ? 3.0 : 0.0); }

Rows DrawRows(std::size_t count, unsigned seed, int sign_of_gap = -1) {
  std::mt19937 random(seed);
  Rows rows;
  rows.features = {{"gap", sign_of_gap}, {"range_m", 0}, {"width_m", +1}, {"noise", 0}};
  rows.families = {"course", "canal"};
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 4> row{};
    for (auto& value : row) value = static_cast<float>(random() % 4001) / 1000.0F - 2.0F;
    const double p = 1.0 / (1.0 + std::exp(-TrueLogOdds(row)));
    const auto scan = static_cast<std::int32_t>(i / 100);
    if (i % 100 == 0) rows.family_of.push_back(scan % 2);
    rows.Add(row, static_cast<double>(random() % 100'000) < 100'000 * p, 1.0F, scan);
  }
  BalanceWeights(rows);
  return rows;
}

segmenter::Evidence ToEvidence(const FittedSum& sum) { return {sum.Named("merge", kNames), kLayout}; }

TEST(Boosting, FindsAKnownFunction) {
  const auto sum = Fit(DrawRows(40'000, 1), {});
  const auto fresh = DrawRows(20'000, 2);
  const auto log_odds = LogOddsOf(fresh, ToEvidence(sum));
  std::vector<float> best(fresh.size());
  for (std::size_t i = 0; i < fresh.size(); ++i) best[i] = static_cast<float>(TrueLogOdds(fresh.Of(i)));
  EXPECT_LT(ScoreOf(fresh, log_odds, -1).loss, ScoreOf(fresh, best, -1).loss + 0.01);
  EXPECT_GT(ScoreOf(fresh, log_odds, -1).auc, ScoreOf(fresh, best, -1).auc - 0.005);
  EXPECT_GT(sum.gain[0], 0.4);
  EXPECT_LT(sum.gain[3], 0.01);
}

TEST(Boosting, NeverGoesAgainstTheSignOfAFeature) {
  // Truth falls with the gap; the sign says that it must not.
  for (const int sign : {-1, +1}) {
    const auto sum = Fit(DrawRows(20'000, 3, sign), {.num_trees = 40});
    const auto evidence = ToEvidence(sum);
    const auto rows = DrawRows(500, 4);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      std::array<float, 4> row{};
      std::ranges::copy(rows.Of(i), row.begin());
      float last = sign > 0 ? -1e9F : 1e9F;
      for (row[0] = -2.5F; row[0] < 2.5F; row[0] += 0.05F) {
        const float log_odds = evidence.Of(row);
        EXPECT_GE(sign * (log_odds - last), -1e-5F);
        last = log_odds;
      }
    }
  }
}

TEST(Boosting, SameRowsGiveTheSameTrees) {
  const auto one = Fit(DrawRows(5000, 5), {.num_trees = 20});
  const auto other = Fit(DrawRows(5000, 5), {.num_trees = 20});
  EXPECT_EQ(ToEvidence(one), ToEvidence(other));
  EXPECT_EQ(DigestOf(DrawRows(5000, 5)), DigestOf(DrawRows(5000, 5)));
  EXPECT_NE(DigestOf(DrawRows(5000, 5)), DigestOf(DrawRows(5000, 6)));
}

TEST(Boosting, NumbersHaveThreeSignificantDigits) {
  const auto sum = Fit(DrawRows(5000, 5), {.num_trees = 20});
  for (const auto& tree : sum.trees) {
    for (const auto& split : tree.splits) EXPECT_EQ(split.above, Rounded(split.above));
    for (const float leaf : tree.log_odds) EXPECT_EQ(leaf, Rounded(leaf));
  }
  EXPECT_EQ(Rounded(1.23456), 1.23F);
  EXPECT_EQ(Rounded(-0.00123456), -0.00123F);
}

TEST(Boosting, StopsWhereAFamilyThatItDoesNotSeeIsBest) {
  auto rows = DrawRows(4000, 7);
  // In canals the gap says nothing.
  std::mt19937 random(1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.FamilyOf(i) == 1) rows.is_true[i] = random() % 2;
  }
  const auto sum = Fit(rows, {.held_out = {"canal"}});
  EXPECT_EQ(sum.held_out_loss.size(), 100U);
  EXPECT_LT(sum.trees.size(), 10U);
}

// As in the fits that a calibration is made from: what is held out may be what they leave out.
TEST(Boosting, RowsWithoutWeightDoNotSayWhenTreesAreEnough) {
  auto rows = DrawRows(2000, 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.families[rows.FamilyOf(i)] == "canal") rows.weight[i] = 0.0F;
  }
  const auto sum = Fit(rows, {.num_trees = 20, .held_out = {"canal"}});
  EXPECT_EQ(sum.trees.size(), 20U);
  EXPECT_TRUE(sum.held_out_loss.empty());
}

TEST(Calibration, MakesLogOddsThoseOfWhatIsTrue) {
  const auto rows = DrawRows(40'000, 3);
  std::vector<float> log_odds(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) log_odds[i] = static_cast<float>(4.0 * TrueLogOdds(rows.Of(i)) - 2.0);
  const auto calibration = CalibrationOf(rows, log_odds);
  EXPECT_NEAR(calibration.factor, 0.25, 0.01);
  EXPECT_NEAR(calibration.offset, 0.5, 0.04);
  FittedSum sum;
  sum.bias = 2.0F;
  sum.trees = {segmenter::NamedTree{{{{"gap", 1.0F}}}, {4.0F, -4.0F}}};
  Apply({0.25, 0.5}, sum);
  EXPECT_EQ(sum.bias, 1.0F);
  EXPECT_EQ(sum.trees[0].log_odds[0], 1.0F);
  EXPECT_EQ(sum.trees[0].log_odds[1], -1.0F);
}

TEST(Calibration, LeavesWhatSaysNothingOrTheContrary) {
  const auto rows = DrawRows(2000, 3);
  std::vector<float> log_odds(rows.size(), 0.0F);
  const auto is_none = [](const Calibration& calibration) { return calibration.factor == 1.0 && calibration.offset == 0.0; };
  EXPECT_TRUE(is_none(CalibrationOf(rows, log_odds)));
  for (std::size_t i = 0; i < rows.size(); ++i) log_odds[i] = static_cast<float>(-TrueLogOdds(rows.Of(i)));
  EXPECT_TRUE(is_none(CalibrationOf(rows, log_odds)));
}

TEST(Boosting, OfRowsThatAreAllAlikeIsABias) {
  auto rows = DrawRows(100, 1);
  std::ranges::fill(rows.is_true, std::uint8_t{1});
  const auto sum = Fit(rows, {});
  EXPECT_EQ(sum.bias, Rounded(std::log(kTotalWeight + 1.0)));
  EXPECT_TRUE(sum.trees.empty());
  Rows none;
  none.features = rows.features;
  EXPECT_EQ(Fit(none, {}).bias, 0.0F);
}

TEST(Rows, WeightsOfEachFamilyAndOfEachOfItsScansAreTheSame) {
  Rows rows;
  rows.features = {{"gap", 0}};
  rows.families = {"course", "canal", "empty"};
  rows.family_of = {0, 0, 1};
  for (const std::int32_t scan : {0, 0, 0, 1, 2, 2}) rows.Add(std::array{1.0F}, true, 3.0F, scan);
  BalanceWeights(rows);
  std::array<double, 3> of_scan{};
  for (std::size_t i = 0; i < rows.size(); ++i) of_scan[static_cast<std::size_t>(rows.scan[i])] += rows.weight[i];
  EXPECT_NEAR(of_scan[0], kTotalWeight / 4, 0.01);
  EXPECT_NEAR(of_scan[1], kTotalWeight / 4, 0.01);
  EXPECT_NEAR(of_scan[2], kTotalWeight / 2, 0.01);
}

TEST(Score, OfEqualLogOddsIsThatOfChance) {
  const auto rows = DrawRows(1000, 1);
  const std::vector<float> log_odds(rows.size(), 0.0F);
  EXPECT_NEAR(ScoreOf(rows, log_odds, -1).loss, std::log(2.0), 1e-7);
  EXPECT_NEAR(ScoreOf(rows, log_odds, 1).auc, 0.5, 1e-7);
}

TEST(Isotonic, LeavesWhatIsInOrder) {
  std::array values{1.0, 2.0, 3.0, 4.0};
  ProjectOnSigns(std::array{+1, +1}, std::array{1.0, 1.0, 1.0, 1.0}, values);
  EXPECT_EQ(values, (std::array{1.0, 2.0, 3.0, 4.0}));
}

TEST(Isotonic, PoolsWhatIsNotByItsWeight) {
  std::array values{4.0, 1.0, 0.0, 5.0};
  ProjectOnSigns(std::array{+1, 0}, std::array{1.0, 2.0, 1.0, 1.0}, values);
  EXPECT_EQ(values, (std::array{2.0, 2.0, 0.0, 5.0}));
  ProjectOnSigns(std::array{-1, 0}, std::array{1.0, 1.0, 1.0, 3.0}, values);
  EXPECT_EQ(values, (std::array{2.0, 2.0, 3.75, 3.75}));
}

// Against projection onto one edge after the other, with its corrections (Dykstra's algorithm).
TEST(Isotonic, IsTheNearestInOrder) {
  std::mt19937 random(2);
  for (int k = 0; k < 200; ++k) {
    std::array<double, 8> values{};
    std::array<double, 8> weights{};
    const std::array signs{static_cast<int>(random() % 3) - 1, static_cast<int>(random() % 3) - 1, static_cast<int>(random() % 3) - 1};
    for (auto& value : values) value = static_cast<double>(random() % 1000) / 100.0;
    for (auto& weight : weights) weight = 0.1 + static_cast<double>(random() % 100) / 10.0;
    auto nearest = values;
    std::array<std::array<std::array<double, 2>, 3>, 8> correction{};
    for (int round = 0; round < 3000; ++round) {
      for (std::size_t corner = 0; corner < 8; ++corner) {
        for (std::size_t bit = 0; bit < 3; ++bit) {
          const std::size_t other = corner | (std::size_t{1} << bit);
          if (other == corner || signs[bit] == 0) continue;
          auto& [of_one, of_other] = correction[corner][bit];
          const double one = nearest[corner] + of_one;
          const double two = nearest[other] + of_other;
          const double mean = (weights[corner] * one + weights[other] * two) / (weights[corner] + weights[other]);
          const bool is_against = signs[bit] * (two - one) < 0.0;
          nearest[corner] = is_against ? mean : one;
          nearest[other] = is_against ? mean : two;
          of_one = one - nearest[corner];
          of_other = two - nearest[other];
        }
      }
    }
    ProjectOnSigns(signs, weights, values);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(values[i], nearest[i], 1e-6) << k;
  }
}

}  // namespace
}  // namespace lookout::fit
