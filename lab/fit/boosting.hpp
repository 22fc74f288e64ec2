// Fits a sum of small trees to rows: Newton boosting of oblivious trees with logistic loss (J. Friedman, "Greedy Function Approximation", Annals of
// Statistics 29, 2001; second order and L2 as T. Chen and C. Guestrin, "XGBoost", KDD 2016; oblivious trees as L. Prokhorenkova et al., "CatBoost",
// NeurIPS 2018).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lab/fit/rows.hpp"
#include "services/segmenter/core/lookout/evidence.hpp"

namespace lookout::fit {

/// Chosen by leaving families out (README).
struct BoostingParams {
  int num_trees = 100;
  double shrinkage = 0.2;  // of the step that each tree would make by itself
  double l2 = 5.0;         // in the unit of weights: kTotalWeight is all rows
  double min_leaf = 2.0;   // sum of weight x p (1 - p) in a leaf; leaves with less add nothing
  int num_bins = 64;       // thresholds of a feature are this many quantiles of its values
  /// Families whose rows are not fitted: trees are added up to where their loss is least. None, or without weight: all trees.
  std::vector<std::string> held_out = {};
  /// Features that no split may ask for, to see their worth.
  std::vector<std::string> dropped = {};
};

struct FittedSum {
  float bias = 0.0F;
  std::vector<segmenter::NamedTree> trees;
  std::vector<double> gain;           // [features] share of the fall of the loss by the splits of each; their sum is 1
  std::vector<double> held_out_loss;  // [trees] per weight, after each; empty where no family is held out

  segmenter::NamedSum Named(std::string_view name, std::span<const std::string_view> features) const { return {name, features, bias, trees}; }
};

/// Equal rows give equal trees, to the bit. Leaves along a feature with a sign never go against it. Thresholds, leaves and bias have three
/// significant digits, and are rounded before the next tree is fitted.
///
/// Cost: rows x features x trees, about 1 s for a million rows, 20 features and 10 trees. Memory: a byte for each value besides.
/// Rows that are all true, or all false, give a bias and no tree.
FittedSum Fit(const Rows& rows, const BoostingParams& params);

/// Platt's scaling (J. Platt, "Probabilistic Outputs for Support Vector Machines", 1999): factor and offset with which log odds of rows that were not
/// fitted on fit the truth best. {1, 0} where all rows or all log odds are alike (there was nothing to fit the others on), and where the best factor
/// would turn more into less.
struct Calibration {
  double factor = 1.0;
  double offset = 0.0;

  double Of(double log_odds) const { return factor * log_odds + offset; }
};
Calibration CalibrationOf(const Rows& rows, std::span<const float> log_odds);
void Apply(const Calibration& calibration, FittedSum& sum);

/// Three significant digits.
float Rounded(double value);

/// How well a sum tells rows.
struct Score {
  double loss = 0.0;        // mean of -ln(probability of the true answer), in the balance of the weights
  double auc = 0.0;         // probability that a true row has higher log odds than a false row; NaN where all rows are true, or all false
  double true_share = 0.0;  // of the weight
  std::size_t num_rows = 0;
};

/// @param log_odds  [rows]
/// @param family    of rows.families; -1: all
Score ScoreOf(const Rows& rows, std::span<const float> log_odds, int family);

std::vector<float> LogOddsOf(const Rows& rows, const segmenter::Evidence& evidence);

}  // namespace lookout::fit
