// The rows on which a sum is fitted: features with the truth of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::fit {

struct Feature {
  std::string_view name;  // outlives the rows
  int sign = 0;           // +1: the greater the feature, the more likely true; -1: the less likely; 0: no rule
};

struct Rows {
  std::vector<Feature> features;
  std::vector<float> values;            // [rows x features]
  std::vector<std::uint8_t> is_true;    // [rows]
  std::vector<float> weight;            // [rows]
  std::vector<std::int32_t> scan;       // [rows] numbered from 0; rows of a scan follow each other
  std::vector<std::int32_t> family_of;  // [scans]
  std::vector<std::string> families;    // names

  std::size_t size() const { return is_true.size(); }
  std::span<const float> Of(std::size_t row) const { return std::span(values).subspan(row * features.size(), features.size()); }
  std::size_t FamilyOf(std::size_t row) const { return static_cast<std::size_t>(family_of[static_cast<std::size_t>(scan[row])]); }
  void Add(std::span<const float> row, bool is_so, float row_weight, std::int32_t row_scan);
};

/// Scales the weights: each scan of a family counts the same, however many rows it has, each family the same, and all are kTotalWeight.
void BalanceWeights(Rows& rows);

/// Gives each row the same weight, in sum ten times kTotalWeight. For probabilities: each segment counts once, as it does on the boat. Ten times,
/// as most rows are single drops, and the rest must still reach leaves of its own.
void WeighAlike(Rows& rows);

/// Regularisation is in these units: a fit does not change when there are more scans of the same.
inline constexpr double kTotalWeight = 10'000.0;

/// SHA-256 of all that a fit depends on, as hexadecimal digits.
std::string DigestOf(const Rows& rows);

}  // namespace lookout::fit
