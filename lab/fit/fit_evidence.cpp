#include "lab/fit/fit_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "lab/eval/metrics.hpp"

namespace lookout::fit {
namespace {

segmenter::Evidence ToEvidence(const SumReport& report) {
  const auto& layout = segmenter::kEvidenceLayouts.at(report.sum);
  return {report.fitted.Named(layout.name, layout.features), layout};
}

// Log odds of a segment must be right on waters that nothing was fitted on: a sum fitted on two thirds of the families judges the other third.
Calibration CalibrationByFamilies(std::size_t sum, const Rows& rows, const BoostingParams& boosting) {
  constexpr std::size_t kNumParts = 3;
  const auto& layout = segmenter::kEvidenceLayouts.at(sum);
  std::vector<float> log_odds(rows.size(), 0.0F);
  for (std::size_t part = 0; part < kNumParts; ++part) {
    Rows others = rows;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows.FamilyOf(i) % kNumParts == part) others.weight[i] = 0.0F;
    }
    const segmenter::Evidence of_others(Fit(others, boosting).Named(layout.name, layout.features), layout);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows.FamilyOf(i) % kNumParts == part) log_odds[i] = of_others.Of(rows.Of(i));
    }
  }
  return CalibrationOf(rows, log_odds);
}

SumReport FitOne(std::size_t sum, Rows& rows, BoostingParams boosting) {
  // In most scenes the own crew and gear alone are within 3 m. A quay that the boat lies at must not become clutter by that (DECISIONS).
  if (sum == segmenter::kThingSum) boosting.dropped.emplace_back("range_m");
  if (sum == segmenter::kThingSum) {
    WeighAlike(rows);
  } else {
    BalanceWeights(rows);
  }
  SumReport report{sum, Fit(rows, boosting), rows.families, {}, {}, DigestOf(rows)};
  if (sum >= segmenter::kNumMerges) Apply(CalibrationByFamilies(sum, rows, boosting), report.fitted);
  const auto log_odds = LogOddsOf(rows, ToEvidence(report));
  report.of_all = ScoreOf(rows, log_odds, -1);
  for (std::size_t i = 0; i < rows.families.size(); ++i) report.of_family.push_back(ScoreOf(rows, log_odds, static_cast<int>(i)));
  return report;
}

}  // namespace

segmenter::Params FittedEvidence::In(segmenter::Params params) const {
  for (const auto& report : sums) params.lookout.evidence[report.sum] = ToEvidence(report);
  return params;
}

FittedEvidence FitEvidence(std::span<const TrainingScan> scans, const segmenter::Params& params, const BoostingParams& boosting,
                           const std::set<std::string>& without, const std::function<void(const std::string&)>& tell) {
  FittedEvidence evidence;
  for (std::size_t sum = 0; sum < segmenter::kNumSums; ++sum) {
    Rows rows;
    RowMaker maker(evidence.In(params));
    for (const auto& scan : scans) {
      if (!without.contains(scan.family)) maker.Add(sum, scan, rows);
    }
    tell(fmt::format("{}: {} rows of {} scans", segmenter::kEvidenceLayouts.at(sum).name, rows.size(), rows.family_of.size()));
    evidence.sums.push_back(FitOne(sum, rows, boosting));
  }
  evidence.miou = MeanIou(scans, evidence.In(params));
  evidence.without = without;
  return evidence;
}

std::map<std::string, double> MeanIou(std::span<const TrainingScan> scans, const segmenter::Params& params) {
  segmenter::Segmenter segmenter(params);
  std::map<std::string, eval::Mean> means;
  for (const auto& [family, truth] : scans) {
    const auto& segments = segmenter.Segment(truth.scan);
    eval::Confusion confusion;
    for (std::size_t cell = 0; cell < segments.label.size(); ++cell) {
      if (truth.scan.columns.range[cell] != 0) confusion.Add(truth.object[cell], segments.label[cell]);
    }
    eval::Mean iou;
    for (const auto& [id, object] : confusion.Match().objects) iou.Add(object.iou);
    if (iou.count > 0) means[family].Add(iou.value());
  }
  std::map<std::string, double> values;
  for (const auto& [family, mean] : means) values[family] = mean.value();
  return values;
}

std::string TextOf(const FittedEvidence& evidence, const std::vector<std::string>& comments) {
  std::string text = "# proto-file: config/schema/evidence.proto\n# proto-message: lookout.config.Evidence\n";
  for (const auto& comment : comments) text += "# " + comment + "\n";
  for (const auto& report : evidence.sums) {
    const auto& layout = segmenter::kEvidenceLayouts.at(report.sum);
    text +=
        fmt::format("\n# {} rows, SHA-256 {}.\n# What the splits of each feature lowered the loss by, %:\n", report.of_all.num_rows, report.digest);
    for (std::size_t i = 0; i < layout.features.size(); ++i)
      text += fmt::format("#   {} {:.1f}\n", layout.features[i], 100.0 * report.fitted.gain[i]);
    text += fmt::format("sum {{\n  name: \"{}\"\n", layout.name);
    for (const auto& feature : layout.features) text += fmt::format("  feature: \"{}\"\n", feature);
    text += fmt::format("  bias: {:.3g}\n", report.fitted.bias);
    for (const auto& tree : report.fitted.trees) {
      text += "  tree {\n";
      std::size_t num_leaves = 1;
      for (const auto& split : tree.splits) {
        if (split.feature.empty()) break;
        text += fmt::format("    split {{ feature: \"{}\" above: {:.3g} }}\n", split.feature, split.above);
        num_leaves *= 2;
      }
      std::vector<std::string> leaves;
      for (std::size_t i = 0; i < num_leaves; ++i) leaves.push_back(fmt::format("{:.3g}", tree.log_odds[i]));
      text += fmt::format("    log_odds: [{}]\n  }}\n", fmt::join(leaves, ", "));
    }
    text += "}\n";
  }
  return text;
}

std::string TablesOf(const FittedEvidence& evidence) {
  std::string text;
  for (const auto& report : evidence.sums) {
    const auto& layout = segmenter::kEvidenceLayouts.at(report.sum);
    text += fmt::format("\n{}, {} trees\n{:24} {:>10} {:>8} {:>8} {:>8}\n", layout.name, report.fitted.trees.size(), "family", "rows", "true, %",
                        "loss", "AUC");
    const auto add = [&text](const std::string& name, const Score& score) {
      if (score.num_rows == 0) return;
      text += fmt::format("{:24} {:>10} {:8.1f} {:8.4f} {:8.4f}\n", name, score.num_rows, 100.0 * score.true_share, score.loss, score.auc);
    };
    for (std::size_t i = 0; i < report.families.size(); ++i) add(report.families[i], report.of_family[i]);
    add("all", report.of_all);
    std::vector<std::size_t> order(layout.features.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::ranges::greater(), [&](std::size_t i) { return report.fitted.gain[i]; });
    text += "gain, %:";
    for (const auto i : order) text += fmt::format(" {} {:.1f}", layout.features[i], 100.0 * report.fitted.gain[i]);
    text += "\n";
  }
  text += fmt::format("\n{:24} {:>8}\n", "family", "mIoU, %");
  for (const auto& [family, miou] : evidence.miou) {
    text += fmt::format("{:24} {:8.1f}{}\n", family, 100.0 * miou, evidence.without.contains(family) ? "  left out" : "");
  }
  return text;
}

}  // namespace lookout::fit
