#include "lab/eval/tracks/track_gospa.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/core/assignment.hpp"

namespace lookout::eval {
namespace {

double RootOfMean(double sum, std::int64_t count) { return std::sqrt(sum / static_cast<double>(count)); }

}  // namespace

void Gospa::Add(const Gospa& other) {
  localisation_m2 += other.localisation_m2;
  num_pairs += other.num_pairs;
  num_missed += other.num_missed;
  num_false += other.num_false;
  num_scans += other.num_scans;
}

double Gospa::Rms(double cut_off_m) const {
  return RootOfMean(localisation_m2 + cut_off_m * cut_off_m / 2.0 * static_cast<double>(num_missed + num_false), num_scans);
}
double Gospa::LocalisationRms() const { return RootOfMean(localisation_m2, num_scans); }
double Gospa::MissedRms(double cut_off_m) const { return RootOfMean(cut_off_m * cut_off_m / 2.0 * static_cast<double>(num_missed), num_scans); }
double Gospa::FalseRms(double cut_off_m) const { return RootOfMean(cut_off_m * cut_off_m / 2.0 * static_cast<double>(num_false), num_scans); }

Gospa GospaOf(std::span<const Eigen::Vector2d> truths_m, std::span<const Eigen::Vector2d> estimates_m, double cut_off_m) {
  const double greatest_m2 = cut_off_m * cut_off_m;
  Eigen::MatrixXd cost_m2(static_cast<Eigen::Index>(truths_m.size()), static_cast<Eigen::Index>(estimates_m.size()));
  for (std::size_t i = 0; i < truths_m.size(); ++i) {
    for (std::size_t k = 0; k < estimates_m.size(); ++k) {
      const double squared_m2 = (truths_m[i] - estimates_m[k]).squaredNorm();
      cost_m2(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = std::min(squared_m2, greatest_m2);
    }
  }
  Gospa gospa;
  const auto assigned = CheapestAssignment(cost_m2);
  for (std::size_t i = 0; i < assigned.size(); ++i) {
    if (assigned[i] < 0) continue;
    const double squared_m2 = cost_m2(static_cast<Eigen::Index>(i), assigned[i]);
    if (squared_m2 >= greatest_m2) continue;
    gospa.localisation_m2 += squared_m2;
    ++gospa.num_pairs;
  }
  gospa.num_missed = static_cast<std::int64_t>(truths_m.size()) - gospa.num_pairs;
  gospa.num_false = static_cast<std::int64_t>(estimates_m.size()) - gospa.num_pairs;
  return gospa;
}

}  // namespace lookout::eval
