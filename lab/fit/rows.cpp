#include "lab/fit/rows.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "common/bus/schema.hpp"

namespace lookout::fit {
namespace {

template <typename T>
void Add(const std::vector<T>& values, bus::Sha256& digest) {
  digest.Add(values.data(), values.size() * sizeof(T));
}

}  // namespace

void Rows::Add(std::span<const float> row, bool is_so, float row_weight, std::int32_t row_scan) {
  if (row.size() != features.size())
    throw std::logic_error("a row of " + std::to_string(row.size()) + " values for " + std::to_string(features.size()) + " features");
  values.insert(values.end(), row.begin(), row.end());
  is_true.push_back(is_so ? 1 : 0);
  weight.push_back(row_weight);
  scan.push_back(row_scan);
}

void BalanceWeights(Rows& rows) {
  std::vector<double> of_scan(rows.family_of.size(), 0.0);
  for (std::size_t i = 0; i < rows.size(); ++i) of_scan[static_cast<std::size_t>(rows.scan[i])] += rows.weight[i];
  std::vector<double> num_scans(rows.families.size(), 0.0);
  for (std::size_t i = 0; i < of_scan.size(); ++i) num_scans[static_cast<std::size_t>(rows.family_of[i])] += of_scan[i] > 0.0 ? 1.0 : 0.0;
  const auto num_families = static_cast<double>(std::ranges::count_if(num_scans, [](double count) { return count > 0.0; }));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double share = rows.weight[i] / of_scan[static_cast<std::size_t>(rows.scan[i])] / num_scans[rows.FamilyOf(i)] / num_families;
    rows.weight[i] = static_cast<float>(kTotalWeight * share);
  }
}

void WeighAlike(Rows& rows) {
  std::ranges::fill(rows.weight, static_cast<float>(10.0 * kTotalWeight / static_cast<double>(std::max<std::size_t>(1, rows.size()))));
}

std::string DigestOf(const Rows& rows) {
  bus::Sha256 digest;
  for (const auto& feature : rows.features) digest.Add(feature.name.data(), feature.name.size());
  Add(rows.values, digest);
  Add(rows.is_true, digest);
  Add(rows.weight, digest);
  Add(rows.scan, digest);
  Add(rows.family_of, digest);
  return digest.Finish();
}

}  // namespace lookout::fit
