// GOSPA: how far a set of estimates is from the set of truths, in parts.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace lookout::eval {

/// Distances beyond the cut-off c count as one missed and one false; p is 2 and alpha is 2, as the measure is mostly used.
inline constexpr double kGospaCutOffM = 20.0;

/// GOSPA of one scan, in squares, so that scans can be added: metric^2 = localisation + c^2 / 2 x (missed + false).
struct Gospa {
  double localisation_m2 = 0.0;  // sum of the squared distances of pairs
  std::int64_t num_pairs = 0;
  std::int64_t num_missed = 0;
  std::int64_t num_false = 0;
  std::int64_t num_scans = 1;

  void Add(const Gospa& other);
  /// Root of the mean over the scans of metric^2; NaN without a scan.
  double Rms(double cut_off_m = kGospaCutOffM) const;
  /// Roots of the same mean of one part alone.
  double LocalisationRms() const;
  double MissedRms(double cut_off_m = kGospaCutOffM) const;
  double FalseRms(double cut_off_m = kGospaCutOffM) const;
};

/// Source: A. S. Rahmathullah, A. F. Garcia-Fernandez, L. Svensson, "Generalized optimal sub-pattern assignment metric", FUSION 2017, definition 1
/// and proposition 1. Cost: as CheapestAssignment.
Gospa GospaOf(std::span<const Eigen::Vector2d> truths_m, std::span<const Eigen::Vector2d> estimates_m, double cut_off_m = kGospaCutOffM);

}  // namespace lookout::eval
