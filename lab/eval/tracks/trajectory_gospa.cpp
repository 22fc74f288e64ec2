#include "lab/eval/tracks/trajectory_gospa.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "common/core/assignment.hpp"

namespace lookout::eval {
namespace {

constexpr double kBlocked = std::numeric_limits<double>::infinity();
constexpr double kCutOffM2 = kGospaCutOffM * kGospaCutOffM;
constexpr double kHalfSwitchM2 = kSwitchCostM * kSwitchCostM / 2.0;
constexpr int kNoPartner = -1;

// An estimate that is within the cut-off of a truth in some scan.
struct Candidate {
  int estimate = kNoPartner;
  std::size_t first = 0;        // scan
  std::vector<double> gain_m2;  // from that scan on: gain of the pair over a miss and a false one

  double GainAt(std::size_t scan) const { return scan >= first && scan - first < gain_m2.size() ? gain_m2[scan - first] : 0.0; }
};

struct Trajectory {
  std::vector<Candidate> candidates;  // by estimate
  std::vector<int> partner;           // [scans] estimate or kNoPartner

  double GainAt(std::size_t scan, int estimate) const {
    const auto found = std::ranges::lower_bound(candidates, estimate, {}, &Candidate::estimate);
    return found != candidates.end() && found->estimate == estimate ? found->GainAt(scan) : 0.0;
  }
};

double SwitchCost(int before, int now) {
  if (before == now) return 0.0;
  return before == kNoPartner || now == kNoPartner ? kHalfSwitchM2 : 2.0 * kHalfSwitchM2;
}

double CostOf(const Trajectory& truth) {
  double cost = 0.0;
  for (std::size_t n = 0; n < truth.partner.size(); ++n) {
    cost -= truth.GainAt(n, truth.partner[n]);
    if (n > 0) cost += SwitchCost(truth.partner[n - 1], truth.partner[n]);
  }
  return cost;
}

// It has one partner all the time, and in each scan none is better: nothing can be gained.
bool IsSettled(const Trajectory& truth) {
  for (std::size_t n = 0; n < truth.partner.size(); ++n) {
    if (truth.partner[n] != truth.partner.front()) return false;
    const double gain_m2 = truth.GainAt(n, truth.partner[n]);
    if (std::ranges::any_of(truth.candidates, [&](const Candidate& one) { return one.GainAt(n) > gain_m2; })) return false;
  }
  return true;
}

// Choices of a trajectory: none, then its candidates.
class Choices {
 public:
  Choices(const Trajectory* truth, std::size_t num_scans) : truth_(truth) { is_blocked_.assign(num_scans, std::vector<bool>(size())); }
  std::size_t size() const { return truth_ == nullptr ? 1 : truth_->candidates.size() + 1; }
  int EstimateOf(std::size_t choice) const { return choice == 0 ? kNoPartner : truth_->candidates[choice - 1].estimate; }
  // Infinite: another trajectory has it.
  double CostAt(std::size_t scan, std::size_t choice) const {
    if (choice == 0) return 0.0;
    return is_blocked_[scan][choice] ? kBlocked : -truth_->candidates[choice - 1].GainAt(scan);
  }
  void BlockAllOf(const Trajectory& other) {
    for (std::size_t choice = 1; choice < size(); ++choice) {
      const int estimate = EstimateOf(choice);
      if (!std::ranges::binary_search(other.candidates, estimate, {}, &Candidate::estimate)) continue;
      for (std::size_t n = 0; n < other.partner.size(); ++n) {
        if (other.partner[n] == estimate) is_blocked_[n][choice] = true;
      }
    }
  }

 private:
  const Trajectory* truth_;
  std::vector<std::vector<bool>> is_blocked_;  // [scans x choices]
};

// Least costs after a step from scan to scan, of some states in a row of which the first is none: values[k x stride], from where each came.
void Step(std::vector<double>& values, std::vector<std::int32_t>& from, std::size_t begin, std::size_t stride, std::size_t count) {
  const double none = values[begin];
  std::size_t best = 0;
  for (std::size_t k = 1; k < count; ++k) {
    if (values[begin + k * stride] < values[begin + best * stride]) best = k;
  }
  const double least = values[begin + best * stride];
  for (std::size_t k = 0; k < count; ++k) {
    auto& value = values[begin + k * stride];
    std::size_t came_from = k;
    const auto take = [&](double cost, std::size_t origin) {
      if (cost >= value) return;
      value = cost;
      came_from = origin;
    };
    if (k > 0) take(none + kHalfSwitchM2, 0);
    take(least + (k == 0 || best == 0 ? kHalfSwitchM2 : 2.0 * kHalfSwitchM2), best);
    from[begin + k * stride] = static_cast<std::int32_t>(came_from);
  }
}

// The cheapest partners of two trajectories, or of one, over all scans, while all others keep theirs.
class PairSearch {
 public:
  PairSearch(const Choices& rows, const Choices& columns, std::size_t num_scans) : rows_(rows), columns_(columns), num_scans_(num_scans) {
    for (std::size_t row = 1; row < rows.size(); ++row) {
      for (std::size_t column = 1; column < columns.size(); ++column) {
        if (rows.EstimateOf(row) == columns.EstimateOf(column)) same_.push_back(row * columns.size() + column);
      }
    }
  }

  // [scans] of the one and of the other.
  std::array<std::vector<int>, 2> Solve() {
    const std::size_t num_states = rows_.size() * columns_.size();
    std::vector<double> cost(num_states);
    std::vector<std::int32_t> from_row(num_states);
    std::vector<std::int32_t> from_column(num_states);
    origin_.assign(num_states * num_scans_, 0);
    AddCosts(0, cost);
    for (std::size_t n = 1; n < num_scans_; ++n) {
      for (std::size_t column = 0; column < columns_.size(); ++column) Step(cost, from_row, column, columns_.size(), rows_.size());
      for (std::size_t row = 0; row < rows_.size(); ++row) Step(cost, from_column, row * columns_.size(), 1, columns_.size());
      for (std::size_t row = 0, state = 0; row < rows_.size(); ++row) {
        const auto* const row_before = &from_row[row * columns_.size()];
        for (std::size_t column = 0; column < columns_.size(); ++column, ++state) {
          const auto column_before = from_column[state];
          origin_[n * num_states + state] = row_before[column_before] * static_cast<std::int32_t>(columns_.size()) + column_before;
        }
      }
      AddCosts(n, cost);
    }
    auto state = static_cast<std::size_t>(std::ranges::min_element(cost) - cost.begin());
    std::array<std::vector<int>, 2> partners{std::vector<int>(num_scans_), std::vector<int>(num_scans_)};
    for (std::size_t n = num_scans_; n-- > 0; state = static_cast<std::size_t>(origin_[n * num_states + state])) {
      partners[0][n] = rows_.EstimateOf(state / columns_.size());
      partners[1][n] = columns_.EstimateOf(state % columns_.size());
    }
    return partners;
  }

 private:
  void AddCosts(std::size_t scan, std::vector<double>& cost) const {
    std::vector<double> of_column(columns_.size());
    for (std::size_t column = 0; column < columns_.size(); ++column) of_column[column] = columns_.CostAt(scan, column);
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      const double of_row = rows_.CostAt(scan, row);
      double* const of_state = &cost[row * columns_.size()];
      for (std::size_t column = 0; column < columns_.size(); ++column) of_state[column] += of_row + of_column[column];
    }
    for (const auto state : same_) cost[state] = kBlocked;
  }

  const Choices& rows_;
  const Choices& columns_;
  std::size_t num_scans_;
  std::vector<std::size_t> same_;     // states in which both have one estimate
  std::vector<std::int32_t> origin_;  // [scans x states] state before
};

class TrajectoryAssignment {
 public:
  explicit TrajectoryAssignment(std::span<const TrajectoryScan> scans) : num_scans_(scans.size()) {
    std::map<std::int64_t, int> estimate_of;
    std::map<std::int64_t, std::map<int, Candidate>> candidates_of;
    for (std::size_t n = 0; n < scans.size(); ++n) {
      for (const auto& [id, p_m] : scans[n].estimates_m) estimate_of.try_emplace(id, static_cast<int>(estimate_of.size()));
      for (const auto& [truth, p_m] : scans[n].truths_m) {
        auto& candidates = candidates_of[truth];
        for (const auto& [estimate, q_m] : scans[n].estimates_m) {
          const double gain_m2 = kCutOffM2 - (p_m - q_m).squaredNorm();
          if (gain_m2 <= 0.0) continue;
          const int index = estimate_of.at(estimate);
          auto& candidate = candidates.try_emplace(index, Candidate{index, n, {}}).first->second;
          candidate.gain_m2.resize(n - candidate.first + 1);
          candidate.gain_m2.back() = gain_m2;
        }
      }
    }
    changed_at_.assign(candidates_of.size(), 0);
    truths_.reserve(candidates_of.size());
    for (auto& [id, candidates] : candidates_of) {
      auto& truth = truths_.emplace_back();
      truth.partner.assign(num_scans_, kNoPartner);
      truth.candidates.reserve(candidates.size());
      for (auto& [index, candidate] : candidates) truth.candidates.push_back(std::move(candidate));
    }
  }

  // The cheapest assignment from scan to scan.
  void BeginByScan() {
    std::vector<int> held(truths_.size(), kNoPartner);
    std::vector<bool> had_one(truths_.size());
    for (std::size_t n = 0; n < num_scans_; ++n) {
      AssignScan(n, had_one, held);
      for (std::size_t i = 0; i < truths_.size(); ++i) {
        truths_[i].partner[n] = held[i];
        had_one[i] = had_one[i] || held[i] != kNoPartner;
      }
    }
  }

  // One partner for the whole run.
  void BeginByRun() {
    std::set<int> near;
    for (const auto& truth : truths_) {
      for (const auto& candidate : truth.candidates) near.insert(candidate.estimate);
    }
    const std::vector<int> columns(near.begin(), near.end());
    Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(truths_.size()), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      for (const auto& candidate : truths_[i].candidates) {
        const auto column = std::ranges::lower_bound(columns, candidate.estimate) - columns.begin();
        cost(static_cast<Eigen::Index>(i), column) = -std::accumulate(candidate.gain_m2.begin(), candidate.gain_m2.end(), 0.0);
      }
    }
    const auto assigned = CheapestAssignment(cost);
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      const bool is_paired = assigned[i] >= 0 && cost(static_cast<Eigen::Index>(i), assigned[i]) < 0.0;
      truths_[i].partner.assign(num_scans_, is_paired ? columns[static_cast<std::size_t>(assigned[i])] : kNoPartner);
    }
  }

  double Cost() const {
    double cost = 0.0;
    for (const auto& truth : truths_) cost += CostOf(truth);
    return cost;
  }

  void Improve() {
    for (bool is_better = true; is_better && num_states_ < kMaxTrajectoryWork;) {
      is_better = false;
      for (std::size_t i = 0; i < truths_.size(); ++i) is_better = ImprovePair(i, std::nullopt) || is_better;
      for (std::size_t i = 0; i < truths_.size(); ++i) {
        for (std::size_t k = i + 1; k < truths_.size(); ++k) is_better = (ShareCandidates(i, k) && ImprovePair(i, k)) || is_better;
      }
    }
  }

  TrajectoryGospa Result(std::span<const TrajectoryScan> scans) const {
    TrajectoryGospa result;
    result.scans.num_scans = static_cast<std::int64_t>(num_scans_);
    std::int64_t num_truths = 0;
    std::int64_t num_estimates = 0;
    for (const auto& scan : scans) {
      num_truths += std::ssize(scan.truths_m);
      num_estimates += std::ssize(scan.estimates_m);
    }
    for (const auto& truth : truths_) {
      for (std::size_t n = 0; n < num_scans_; ++n) {
        const double gain_m2 = truth.GainAt(n, truth.partner[n]);
        if (gain_m2 > 0.0) {
          result.scans.localisation_m2 += kCutOffM2 - gain_m2;
          ++result.scans.num_pairs;
        }
        if (n > 0) result.num_switches += SwitchCost(truth.partner[n - 1], truth.partner[n]) / (2.0 * kHalfSwitchM2);
      }
    }
    result.scans.num_missed = num_truths - result.scans.num_pairs;
    result.scans.num_false = num_estimates - result.scans.num_pairs;
    return result;
  }

 private:
  void AssignScan(std::size_t scan, const std::vector<bool>& had_one, std::vector<int>& held) const {
    std::vector<std::size_t> rows;
    std::set<int> near;
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      bool has_choice = held[i] != kNoPartner;
      if (has_choice) near.insert(held[i]);
      for (const auto& candidate : truths_[i].candidates) {
        if (candidate.GainAt(scan) <= 0.0) continue;
        near.insert(candidate.estimate);
        has_choice = true;
      }
      if (has_choice) rows.push_back(i);
    }
    const std::vector<int> columns(near.begin(), near.end());
    // A column of none for each row.
    Eigen::MatrixXd cost(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size() + rows.size()));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const std::size_t i = rows[row];
      const auto switch_to = [&](int estimate) { return had_one[i] ? SwitchCost(held[i], estimate) : 0.0; };
      for (std::size_t k = 0; k < columns.size() + rows.size(); ++k) {
        const int estimate = k < columns.size() ? columns[k] : kNoPartner;
        cost(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) = switch_to(estimate) - truths_[i].GainAt(scan, estimate);
      }
    }
    const auto assigned = CheapestAssignment(cost);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const auto k = static_cast<std::size_t>(assigned[row]);
      // A pair that saves nothing and was not held is no candidate, or none now.
      const int estimate = k < columns.size() ? columns[k] : kNoPartner;
      held[rows[row]] = estimate == held[rows[row]] || truths_[rows[row]].GainAt(scan, estimate) > 0.0 ? estimate : kNoPartner;
    }
  }

  bool ShareCandidates(std::size_t one, std::size_t other) const {
    return std::ranges::any_of(truths_[one].candidates, [&](const Candidate& candidate) {
      return std::ranges::binary_search(truths_[other].candidates, candidate.estimate, {}, &Candidate::estimate);
    });
  }

  // Whether the partners of a trajectory, or of one that competes with it, have changed since this pair was tried.
  bool IsToBeTried(std::size_t one, std::optional<std::size_t> other) {
    auto& tried = tried_at_[{one, other.value_or(one)}];
    const auto is_newer = [&](std::size_t i) { return changed_at_[i] > tried && (ShareCandidates(i, one) || (other && ShareCandidates(i, *other))); };
    bool is_to_be_tried = tried == 0;
    for (std::size_t i = 0; i < truths_.size() && !is_to_be_tried; ++i) is_to_be_tried = is_newer(i);
    tried = ++clock_;
    return is_to_be_tried;
  }

  bool ImprovePair(std::size_t one, std::optional<std::size_t> other) {
    if (IsSettled(truths_[one]) && (!other || IsSettled(truths_[*other]))) return false;
    const std::size_t num_columns = other ? truths_[*other].candidates.size() + 1 : 1;
    const std::size_t num_states = (truths_[one].candidates.size() + 1) * num_columns * num_scans_;
    if (num_states_ + num_states > kMaxTrajectoryWork || !IsToBeTried(one, other)) return false;
    num_states_ += num_states;
    Choices rows(&truths_[one], num_scans_);
    Choices columns(other ? &truths_[*other] : nullptr, num_scans_);
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      if (i == one || i == other) continue;
      rows.BlockAllOf(truths_[i]);
      columns.BlockAllOf(truths_[i]);
    }
    auto partners = PairSearch(rows, columns, num_scans_).Solve();
    const auto cost = [&] { return CostOf(truths_[one]) + (other ? CostOf(truths_[*other]) : 0.0); };
    const double before = cost();
    const auto exchange = [&] {
      truths_[one].partner.swap(partners[0]);
      if (other) truths_[*other].partner.swap(partners[1]);
    };
    exchange();
    constexpr double kRounding = 1e-9;
    if (cost() < before - kRounding * (1.0 + std::abs(before))) {
      changed_at_[one] = clock_;
      if (other) changed_at_[*other] = clock_;
      return true;
    }
    exchange();
    return false;
  }

  std::size_t num_scans_;
  std::vector<Trajectory> truths_;  // by id
  // When the partners of each changed last, and when each pair was tried: 0 = never. In tries.
  std::vector<std::size_t> changed_at_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> tried_at_;
  std::size_t clock_ = 0;
  std::size_t num_states_ = 0;  // of all tries
};

}  // namespace

void TrajectoryGospa::Add(const TrajectoryGospa& other) {
  scans.Add(other.scans);
  num_switches += other.num_switches;
}

double TrajectoryGospa::Rms() const {
  const double without_m = scans.Rms();
  return std::sqrt(without_m * without_m + kSwitchCostM * kSwitchCostM * num_switches / static_cast<double>(scans.num_scans));
}

double TrajectoryGospa::SwitchRms() const { return kSwitchCostM * std::sqrt(num_switches / static_cast<double>(scans.num_scans)); }

TrajectoryGospa TrajectoryGospaOf(std::span<const TrajectoryScan> scans) {
  TrajectoryAssignment by_scan(scans);
  auto by_run = by_scan;
  by_scan.BeginByScan();
  by_scan.Improve();
  by_run.BeginByRun();
  by_run.Improve();
  return (by_run.Cost() < by_scan.Cost() ? by_run : by_scan).Result(scans);
}

}  // namespace lookout::eval
