#include "lab/fit/boosting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>

#include "lab/fit/isotonic.hpp"

namespace lookout::fit {
namespace {

using segmenter::kTreeDepth;
using segmenter::kTreeLeaves;

// First and second derivative of the loss by the log odds.
struct Slope {
  double gradient = 0.0;
  double hessian = 0.0;

  Slope& operator+=(const Slope& other) {
    gradient += other.gradient;
    hessian += other.hessian;
    return *this;
  }
  Slope operator-(const Slope& other) const { return {gradient - other.gradient, hessian - other.hessian}; }
};

std::vector<float> ThresholdsOf(std::vector<float> values, int num_bins) {
  std::vector<float> thresholds;
  if (values.empty()) return thresholds;
  std::ranges::sort(values);
  for (int i = 1; i < num_bins; ++i) {
    const auto place = values.size() * static_cast<std::size_t>(i) / static_cast<std::size_t>(num_bins);
    const float threshold = Rounded(values[place]);
    if (threshold < values.back() && threshold >= values.front()) thresholds.push_back(threshold);
  }
  std::ranges::sort(thresholds);
  thresholds.erase(std::unique(thresholds.begin(), thresholds.end()), thresholds.end());
  return thresholds;
}

// Rows as they are fitted: values as numbers of bins, bin k of a feature holding values above its threshold k - 1 and not above threshold k.
class Boosting {
 public:
  Boosting(const Rows& rows, const BoostingParams& params) : rows_(rows), params_(params), num_features_(rows.features.size()) {
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const bool is_held = std::ranges::count(params.held_out, rows.families[rows.FamilyOf(row)]) > 0;
      (is_held ? held_ : fitted_).push_back(row);
      if (is_held) weight_of_held_ += rows.weight[row];
    }
    Bin();
  }

  FittedSum Run() {
    FittedSum sum;
    sum.gain.assign(num_features_, 0.0);
    sum.bias = Rounded(PriorLogOdds());
    log_odds_.assign(fitted_.size(), sum.bias);
    std::vector<float> held_log_odds(held_.size(), sum.bias);
    for (int i = 0; i < params_.num_trees; ++i) {
      const auto tree = NextTree(sum.gain);
      if (tree.num_splits == 0) break;
      sum.trees.push_back(Named(tree));
      if (weight_of_held_ > 0.0) sum.held_out_loss.push_back(AddToHeld(tree, held_log_odds));
    }
    if (!sum.held_out_loss.empty()) {
      const auto best = std::ranges::min_element(sum.held_out_loss);
      sum.trees.resize(static_cast<std::size_t>(best - sum.held_out_loss.begin()) + 1);
    }
    const double all = std::accumulate(sum.gain.begin(), sum.gain.end(), 0.0);
    if (all > 0.0) std::ranges::transform(sum.gain, sum.gain.begin(), [all](double gain) { return gain / all; });
    return sum;
  }

 private:
  struct Split {
    std::size_t feature = 0;
    std::size_t threshold = 0;
    double gain = 0.0;
  };
  struct Tree {
    std::array<Split, kTreeDepth> splits{};
    std::size_t num_splits = 0;
    std::array<float, kTreeLeaves> log_odds{};
  };

  void Bin() {
    bins_.resize(fitted_.size() * num_features_);
    begin_of_feature_.assign(1, 0);
    std::vector<float> column(fitted_.size());
    for (std::size_t f = 0; f < num_features_; ++f) {
      for (std::size_t i = 0; i < fitted_.size(); ++i) column[i] = rows_.Of(fitted_[i])[f];
      thresholds_.push_back(ThresholdsOf(column, params_.num_bins));
      const auto& thresholds = thresholds_.back();
      for (std::size_t i = 0; i < fitted_.size(); ++i) {
        bins_[i * num_features_ + f] = static_cast<std::uint8_t>(std::ranges::lower_bound(thresholds, column[i]) - thresholds.begin());
      }
      begin_of_feature_.push_back(begin_of_feature_.back() + thresholds.size() + 1);
    }
    slopes_.resize(fitted_.size());
    leaf_.resize(fitted_.size());
  }

  double PriorLogOdds() const {
    std::array<double, 2> weight{};
    for (const auto row : fitted_) weight[rows_.is_true[row]] += rows_.weight[row];
    // A unit more of each: rows that are all alike are no proof.
    return std::log((weight[1] + 1.0) / (weight[0] + 1.0));
  }

  Tree NextTree(std::vector<double>& gain) {
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      const double weight = rows_.weight[fitted_[i]];
      const double p = 1.0 / (1.0 + std::exp(-static_cast<double>(log_odds_[i])));
      slopes_[i] = {weight * (p - rows_.is_true[fitted_[i]]), weight * p * (1.0 - p)};
    }
    std::ranges::fill(leaf_, std::uint8_t{0});
    histograms_.assign(1, Histogram(begin_of_feature_.back()));
    for (std::size_t i = 0; i < fitted_.size(); ++i) AddTo(histograms_[0], i);
    Tree tree;
    while (tree.num_splits < kTreeDepth) {
      const auto split = BestSplit();
      if (split.gain <= 0.0) break;
      gain[split.feature] += split.gain;
      tree.splits[tree.num_splits++] = split;
      Divide(split, tree.num_splits < kTreeDepth);
    }
    SetLeaves(tree);
    for (std::size_t i = 0; i < fitted_.size(); ++i) log_odds_[i] += tree.log_odds[leaf_[i]];
    return tree;
  }

  using Histogram = std::vector<Slope>;  // [bins of all features]

  void AddTo(Histogram& histogram, std::size_t i) const {
    const auto* bins = bins_.data() + i * num_features_;
    for (std::size_t f = 0; f < num_features_; ++f) histogram[begin_of_feature_[f] + bins[f]] += slopes_[i];
  }

  // The fall of the loss by a leaf with the best value, twice.
  double Gain(const Slope& slope) const {
    return slope.hessian < params_.min_leaf ? 0.0 : slope.gradient * slope.gradient / (slope.hessian + params_.l2);
  }
  double Value(const Slope& slope) const { return slope.hessian < params_.min_leaf ? 0.0 : -slope.gradient / (slope.hessian + params_.l2); }

  // The best split; among equal splits the first feature and the lowest threshold.
  Split BestSplit() const {
    Split best;
    best.gain = 1e-9 * kTotalWeight;
    bool is_found = false;
    for (std::size_t f = 0; f < num_features_; ++f) {
      if (std::ranges::count(params_.dropped, rows_.features[f].name) > 0) continue;
      const auto num_thresholds = thresholds_[f].size();
      std::vector<double> gain(num_thresholds, 0.0);
      for (const auto& histogram : histograms_) {
        const auto bins = std::span(histogram).subspan(begin_of_feature_[f], num_thresholds + 1);
        const Slope all = std::accumulate(bins.begin(), bins.end(), Slope{}, [](Slope sum, const Slope& bin) { return sum += bin; });
        Slope below;
        for (std::size_t k = 0; k < num_thresholds; ++k) {
          below += bins[k];
          const Slope above = all - below;
          // Leaves that would go against the sign of the feature are one leaf.
          const bool is_against = rows_.features[f].sign * (Value(above) - Value(below)) < 0.0;
          if (!is_against) gain[k] += Gain(below) + Gain(above) - Gain(all);
        }
      }
      for (std::size_t k = 0; k < num_thresholds; ++k) {
        if (gain[k] <= best.gain) continue;
        best = {f, k, gain[k]};
        is_found = true;
      }
    }
    return is_found ? best : Split{};
  }

  // The rows above a threshold become leaves of their own. Histograms are summed over the fewer rows; the rest of their parent's is the others'.
  void Divide(const Split& split, bool are_histograms_needed) {
    const auto num_leaves = histograms_.size();
    std::size_t num_above = 0;
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      if (bins_[i * num_features_ + split.feature] <= split.threshold) continue;
      leaf_[i] = static_cast<std::uint8_t>(leaf_[i] + num_leaves);
      ++num_above;
    }
    histograms_.resize(2 * num_leaves, Histogram(begin_of_feature_.back()));
    if (!are_histograms_needed) return;
    const bool are_above_fewer = 2 * num_above < fitted_.size();
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      if ((leaf_[i] >= num_leaves) == are_above_fewer) AddTo(histograms_[num_leaves + leaf_[i] % num_leaves], i);
    }
    for (std::size_t leaf = 0; leaf < num_leaves; ++leaf) {
      auto& parent = histograms_[leaf];
      auto& part = histograms_[num_leaves + leaf];
      for (std::size_t k = 0; k < parent.size(); ++k) parent[k] = parent[k] - part[k];
      if (!are_above_fewer) std::swap(parent, part);
    }
  }

  void SetLeaves(Tree& tree) const {
    std::array<Slope, kTreeLeaves> slopes{};
    for (std::size_t i = 0; i < fitted_.size(); ++i) slopes[leaf_[i]] += slopes_[i];
    std::array<double, kTreeLeaves> values{};
    std::array<double, kTreeLeaves> weights{};
    std::array<int, kTreeDepth> signs{};
    const std::size_t num_leaves = std::size_t{1} << tree.num_splits;
    for (std::size_t leaf = 0; leaf < num_leaves; ++leaf) {
      values[leaf] = params_.shrinkage * Value(slopes[leaf]);
      weights[leaf] = slopes[leaf].hessian + kLeastWeight;
    }
    for (std::size_t i = 0; i < tree.num_splits; ++i) signs[i] = rows_.features[tree.splits[i].feature].sign;
    ProjectOnSigns(std::span(signs).first(tree.num_splits), std::span(weights).first(num_leaves), std::span(values).first(num_leaves));
    for (std::size_t leaf = 0; leaf < num_leaves; ++leaf) tree.log_odds[leaf] = Rounded(values[leaf]);
  }

  segmenter::NamedTree Named(const Tree& tree) const {
    segmenter::NamedTree named;
    for (std::size_t i = 0; i < tree.num_splits; ++i) {
      named.splits[i] = {rows_.features[tree.splits[i].feature].name, thresholds_[tree.splits[i].feature][tree.splits[i].threshold]};
    }
    named.log_odds = tree.log_odds;
    return named;
  }

  double AddToHeld(const Tree& tree, std::vector<float>& log_odds) const {
    double loss = 0.0;
    for (std::size_t i = 0; i < held_.size(); ++i) {
      const auto values = rows_.Of(held_[i]);
      std::size_t leaf = 0;
      for (std::size_t k = 0; k < tree.num_splits; ++k) {
        const auto& split = tree.splits[k];
        leaf |= static_cast<std::size_t>(values[split.feature] > thresholds_[split.feature][split.threshold]) << k;
      }
      log_odds[i] += tree.log_odds[leaf];
      const double signed_odds = rows_.is_true[held_[i]] != 0 ? log_odds[i] : -log_odds[i];
      loss += rows_.weight[held_[i]] * std::log1p(std::exp(-signed_odds));
    }
    return loss / weight_of_held_;
  }

  // Weight of a leaf that no row reaches.
  static constexpr double kLeastWeight = 1e-6;

  const Rows& rows_;
  const BoostingParams& params_;
  std::size_t num_features_;
  std::vector<std::size_t> fitted_;  // rows
  std::vector<std::size_t> held_;    // rows
  double weight_of_held_ = 0.0;
  std::vector<std::vector<float>> thresholds_;  // [features]
  std::vector<std::size_t> begin_of_feature_;   // [features + 1] in a histogram
  std::vector<std::uint8_t> bins_;              // [fitted x features]
  std::vector<float> log_odds_;                 // [fitted]
  std::vector<Slope> slopes_;                   // [fitted]
  std::vector<std::uint8_t> leaf_;              // [fitted]
  std::vector<Histogram> histograms_;           // [leaves]
};

}  // namespace

float Rounded(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return std::strtof(text.data(), nullptr);
}

namespace {

double LossOf(const Rows& rows, std::span<const float> log_odds, const Calibration& calibration) {
  double loss = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double calibrated = calibration.Of(log_odds[i]);
    const double against = rows.is_true[i] != 0 ? -calibrated : calibrated;
    loss += rows.weight[i] * (std::max(against, 0.0) + std::log1p(std::exp(-std::abs(against))));
  }
  return loss;
}

}  // namespace

FittedSum Fit(const Rows& rows, const BoostingParams& params) { return Boosting(rows, params).Run(); }

Calibration CalibrationOf(const Rows& rows, std::span<const float> log_odds) {
  constexpr int kSteps = 50;
  constexpr double kSlack = 1e-6;       // added to the Hessian, so that it has an inverse
  constexpr double kLeastShare = 1e-9;  // of a step: less is rounding
  Calibration best;
  const auto num_true = std::ranges::count(rows.is_true, 1);
  if (num_true == 0 || num_true == std::ssize(rows.is_true)) return best;
  if (const auto [least, most] = std::ranges::minmax(log_odds); least == most) return best;
  double loss = LossOf(rows, log_odds, best);
  for (int step = 0; step < kSteps; ++step) {
    std::array<double, 2> gradient{};
    std::array<double, 3> hessian{kSlack, 0.0, kSlack};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double x = log_odds[i];
      const double p = 1.0 / (1.0 + std::exp(-best.Of(x)));
      const double weight = rows.weight[i] * p * (1.0 - p);
      gradient[0] += rows.weight[i] * (p - rows.is_true[i]) * x;
      gradient[1] += rows.weight[i] * (p - rows.is_true[i]);
      hessian[0] += weight * x * x;
      hessian[1] += weight * x;
      hessian[2] += weight;
    }
    const double determinant = hessian[0] * hessian[2] - hessian[1] * hessian[1];
    const double factor_step = (hessian[2] * gradient[0] - hessian[1] * gradient[1]) / determinant;
    const double offset_step = (hessian[0] * gradient[1] - hessian[1] * gradient[0]) / determinant;
    // Where probabilities are near 0 and 1 a whole step goes too far.
    bool is_less = false;
    for (double share = 1.0; !is_less && share >= kLeastShare; share /= 2.0) {
      const Calibration next{best.factor - share * factor_step, best.offset - share * offset_step};
      const double next_loss = LossOf(rows, log_odds, next);
      if (!(next_loss < loss)) continue;
      is_less = true;
      best = next;
      loss = next_loss;
    }
    if (!is_less) break;
  }
  return best.factor > 0.0 ? best : Calibration{};
}

void Apply(const Calibration& calibration, FittedSum& sum) {
  sum.bias = Rounded(calibration.Of(sum.bias));
  for (auto& tree : sum.trees) {
    for (float& leaf : tree.log_odds) leaf = Rounded(calibration.factor * leaf);
  }
}

Score ScoreOf(const Rows& rows, std::span<const float> log_odds, int family) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (family < 0 || rows.FamilyOf(i) == static_cast<std::size_t>(family)) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return log_odds[i]; });
  Score score;
  score.num_rows = order.size();
  std::array<double, 2> weight{};
  double num_above = 0.0;  // weight of pairs with the true row above the other
  for (std::size_t i = 0; i < order.size();) {
    std::array<double, 2> of_equals{};
    const float value = log_odds[order[i]];
    for (; i < order.size() && log_odds[order[i]] == value; ++i) {
      const bool is_true = rows.is_true[order[i]] != 0;
      of_equals[is_true ? 1 : 0] += rows.weight[order[i]];
      score.loss += rows.weight[order[i]] * std::log1p(std::exp(is_true ? -value : value));
    }
    num_above += of_equals[1] * (weight[0] + of_equals[0] / 2.0);
    weight[0] += of_equals[0];
    weight[1] += of_equals[1];
  }
  const double all = weight[0] + weight[1];
  score.loss /= all;
  score.true_share = weight[1] / all;
  score.auc = weight[0] > 0.0 && weight[1] > 0.0 ? num_above / (weight[0] * weight[1]) : std::numeric_limits<double>::quiet_NaN();
  return score;
}

std::vector<float> LogOddsOf(const Rows& rows, const segmenter::Evidence& evidence) {
  std::vector<float> log_odds(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) log_odds[i] = evidence.Of(rows.Of(i));
  return log_odds;
}

}  // namespace lookout::fit
