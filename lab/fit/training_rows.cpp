#include "lab/fit/training_rows.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "lab/eval/methods/outcome.hpp"

namespace lookout::fit {
namespace {

struct Sign {
  std::string_view feature;
  int sign;
};

// Features of two pieces: the greater the gap, the less likely the pieces are one.
constexpr std::array<Sign, 7> kPairSigns{
    {{"gap_m", -1}, {"free_gap_m", -1}, {"gap_deg", -1}, {"radial_gap_m", -1}, {"rise_gap_deg", -1}, {"seen_through", -1}, {"faced", +1}}};
constexpr std::array<Sign, 1> kLandSigns{{{"length_m", +1}}};
constexpr std::array<Sign, 2> kThingSigns{{{"returns", +1}, {"crowd", -1}}};

std::span<const Sign> SignsOf(std::size_t sum) {
  if (sum < segmenter::kNumMerges) return kPairSigns;
  if (sum == segmenter::kLandSum) return kLandSigns;
  return kThingSigns;
}

// Objects that stand on the ground and are no land: a row of posts or a floating deck may be either.
bool IsDock(const data::ScanObject& object) { return !object.is_in_water && !eval::IsLand(object); }

std::int32_t FamilyNumber(const std::string& family, Rows& rows) {
  const auto found = std::ranges::find(rows.families, family);
  if (found == rows.families.end()) {
    rows.families.push_back(family);
    return static_cast<std::int32_t>(rows.families.size()) - 1;
  }
  return static_cast<std::int32_t>(found - rows.families.begin());
}

}  // namespace

std::vector<Feature> FeaturesOf(std::size_t sum) {
  std::vector<Feature> features;
  for (const auto& name : segmenter::kEvidenceLayouts.at(sum).features) features.push_back({name, 0});
  for (const auto& sign : SignsOf(sum)) {
    const auto feature = std::ranges::find(features, sign.feature, &Feature::name);
    if (feature == features.end()) throw std::logic_error("a sign for a feature that is not there: " + std::string(sign.feature));
    feature->sign = sign.sign;
  }
  return features;
}

float PairWeight(const PieceTruth& one, const PieceTruth& other) {
  const auto& lesser =
      one.num_returns < other.num_returns || (one.num_returns == other.num_returns && one.num_of_object < other.num_of_object) ? one : other;
  const auto& greater = &lesser == &one ? other : one;
  const auto returns = static_cast<float>(lesser.num_returns);
  const auto whole = [](const PieceTruth& piece) { return static_cast<float>(std::max(piece.num_of_object, kLeastObject)); };
  const auto is_clutter = [](const PieceTruth& piece) { return piece.object == data::kNoTrueObject; };
  const float lost = is_clutter(lesser) ? 0.0F : returns / whole(lesser);
  const bool is_diluted = one.object != other.object && !is_clutter(greater);
  const float diluted = is_diluted ? returns / (returns + whole(greater)) : 0.0F;
  return std::clamp(lost + diluted, kLeastWeight, 1.0F);
}

void RowMaker::Add(std::size_t sum, const TrainingScan& scan, Rows& rows) {
  if (rows.features.empty()) rows.features = FeaturesOf(sum);
  const auto scan_number = static_cast<std::int32_t>(rows.family_of.size());
  rows.family_of.push_back(FamilyNumber(scan.family, rows));
  method_.FindPieces(scan.truth.scan, classifier_.Classify(scan.truth.scan).returns);
  for (std::size_t merge = 0; merge < segmenter::kNumMerges; ++merge) {
    if (merge == sum) return AddPairs(merge, scan, scan_number, rows);
    method_.Merge(merge, method_.FindPairs(merge));
  }
  AddGroups(sum, scan, scan_number, rows);
}

std::vector<PieceTruth> RowMaker::TruthOfPieces(const data::LabelledScan& truth) {
  const auto& returns = classifier_.result().returns;
  const auto of_returns = method_.pieces().of_returns();
  std::map<std::int32_t, std::int32_t> num_of_object;
  std::vector<std::map<std::int32_t, std::int32_t>> votes(static_cast<std::size_t>(method_.pieces().size()));
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::int32_t object = std::max(truth.object[static_cast<std::size_t>(returns[i].cell)], data::kNoTrueObject);
    ++num_of_object[object];
    if (of_returns[i] >= 0) ++votes[static_cast<std::size_t>(of_returns[i])][object];
  }
  std::vector<PieceTruth> pieces(votes.size());
  for (std::size_t i = 0; i < votes.size(); ++i) {
    std::int32_t most = 0;
    for (const auto& [object, count] : votes[i]) {
      pieces[i].num_returns += count;
      if (count <= most) continue;
      most = count;
      pieces[i].object = object;
    }
    const bool is_clutter = pieces[i].object == data::kNoTrueObject;
    pieces[i].num_of_object = is_clutter ? pieces[i].num_returns : num_of_object[pieces[i].object];
  }
  return pieces;
}

void RowMaker::AddPairs(std::size_t merge, const TrainingScan& scan, std::int32_t scan_number, Rows& rows) {
  const auto truth = TruthOfPieces(scan.truth);
  for (const auto& pair : method_.FindPairs(merge)) {
    const auto& one = truth[static_cast<std::size_t>(pair.one)];
    const auto& other = truth[static_cast<std::size_t>(pair.other)];
    if (one.object == data::kNoTrueObject && other.object == data::kNoTrueObject) continue;
    rows.Add(pair.features, one.object == other.object, PairWeight(one, other), scan_number);
  }
}

void RowMaker::AddGroups(std::size_t sum, const TrainingScan& scan, std::int32_t scan_number, Rows& rows) {
  const auto truth = TruthOfPieces(scan.truth);
  const auto all_features = method_.MeasureGroups();
  const auto features = [&](std::size_t group) { return std::span(all_features[group]).first(segmenter::kEvidenceLayouts.at(sum).features.size()); };
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool is_thing = truth[i].object != data::kNoTrueObject;
    if (sum == segmenter::kThingSum) {
      rows.Add(features(i), is_thing, 1.0F, scan_number);
      continue;
    }
    if (!is_thing) continue;
    const auto& object = scan.truth.objects.at(truth[i].object);
    if (!IsDock(object)) rows.Add(features(i), eval::IsLand(object), std::sqrt(static_cast<float>(truth[i].num_returns)), scan_number);
  }
}

}  // namespace lookout::fit
