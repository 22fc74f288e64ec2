#include "lab/eval/methods/confidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lookout::eval {
namespace {

constexpr int kSteps = 1000;
constexpr int kNumBins = 10;
constexpr int kStepsOfBin = kSteps / kNumBins;
// In steps.
constexpr std::array kThresholds{0, 1, 2, 5, 10, 20, 50, 100, 200, 300, 400, 500, 600, 700, 800, 900, 950, 980, 990, 995, 998, 999};

int StepOf(double probability) { return std::clamp(static_cast<int>(std::floor(probability * kSteps)), 0, kSteps); }

std::int64_t CountFrom(const std::map<int, std::int64_t>& counts, int first_step) {
  std::int64_t count = 0;
  for (auto entry = counts.lower_bound(first_step); entry != counts.end(); ++entry) count += entry->second;
  return count;
}

double Share(double part, std::int64_t whole) { return whole > 0 ? part / static_cast<double>(whole) : std::numeric_limits<double>::quiet_NaN(); }

}  // namespace

void Confidence::Add(const Confidence& other) {
  for (const auto& [step, stated] : other.segments) {
    segments[step].count += stated.count;
    segments[step].num_things += stated.num_things;
    segments[step].sum += stated.sum;
  }
  for (const auto& [step, count] : other.false_segments) false_segments[step] += count;
  for (const auto& [step, count] : other.things) things[step] += count;
  num_things += other.num_things;
  num_scans += other.num_scans;
}

Confidence ConfidenceOf(const Confusion::Matches& matches, const Labelling& labelling, std::int64_t min_num_returns) {
  Confidence confidence;
  if (!labelling.probability) return confidence;
  confidence.num_scans = 1;
  std::map<int, int> greatest_step;  // by object
  for (const auto& [label, segment] : matches.segments) {
    const double probability = labelling.probability->at(static_cast<std::size_t>(label - 1));
    const int step = StepOf(probability);
    auto& stated = confidence.segments[step];
    ++stated.count;
    stated.sum += probability;
    if (segment.majority_object > 0) ++stated.num_things;
    if (!segment.has_object) ++confidence.false_segments[step];
    if (segment.majority_object > 0 && 2 * segment.num_of_majority > segment.num_returns) {
      auto& greatest = greatest_step.try_emplace(segment.majority_object, step).first->second;
      greatest = std::max(greatest, step);
    }
  }
  for (const auto& [id, object] : matches.objects) {
    if (object.num_returns < min_num_returns) continue;
    ++confidence.num_things;
    if (const auto greatest = greatest_step.find(id); greatest != greatest_step.end()) ++confidence.things[greatest->second];
  }
  return confidence;
}

std::vector<OperatingPoint> OperatingPointsOf(const Confidence& confidence) {
  std::vector<OperatingPoint> points;
  if (confidence.num_scans == 0) return points;
  for (const int step : kThresholds) {
    points.push_back({static_cast<double>(step) / kSteps, Share(static_cast<double>(CountFrom(confidence.things, step)), confidence.num_things),
                      Share(static_cast<double>(CountFrom(confidence.false_segments, step)), confidence.num_scans)});
  }
  return points;
}

std::vector<ReliabilityBin> ReliabilityOf(const Confidence& confidence) {
  std::vector<ReliabilityBin> bins;
  if (confidence.num_scans == 0) return bins;
  for (int bin = 0; bin < kNumBins; ++bin) {
    Confidence::Stated all;
    const bool is_last = bin + 1 == kNumBins;  // the last bin includes 1
    const auto end = is_last ? confidence.segments.end() : confidence.segments.lower_bound((bin + 1) * kStepsOfBin);
    for (auto entry = confidence.segments.lower_bound(bin * kStepsOfBin); entry != end; ++entry) {
      all.count += entry->second.count;
      all.num_things += entry->second.num_things;
      all.sum += entry->second.sum;
    }
    bins.push_back({Share(all.sum, all.count), Share(static_cast<double>(all.num_things), all.count), all.count});
  }
  return bins;
}

}  // namespace lookout::eval
