#include "tools/export/merge_rounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/messages/part_assembler.hpp"
#include "services/segmenter/wire.hpp"

namespace lookout::exporter {

namespace {

using segmenter::Evidence;

Eigen::Vector3d ToVector(const segmenter::Point& point) { return {point.x_m, point.y_m, point.z_m}; }

std::optional<segmenter::Scan> ToScan(const ScanMessages& messages) {
  messages::PartAssembler<lidar_scan_t> assembler;
  for (const auto& [part_index, part] : messages.scans) {
    if (messages::FaultOf(part, bus::kMaxMessageBytes)) return std::nullopt;
    if (const auto whole = assembler.Add(part).whole; !whole.empty()) return segmenter::ToScan(whole);
  }
  return std::nullopt;
}

// "gap_m +1.2, hidden +0.4": at most three, the greatest first.
std::string Greatest(std::span<const std::string_view> names, std::span<const float> terms, float sign) {
  constexpr std::size_t kMost = 3;
  constexpr float kLeast = 0.05F;  // a smaller number would be printed as 0.0
  std::vector<std::size_t> order(terms.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater(), [&](std::size_t feature) { return sign * terms[feature]; });
  std::string text;
  for (const std::size_t feature : std::span(order).first(kMost)) {
    if (sign * terms[feature] >= kLeast) text += fmt::format("{}{} {:+.1f}", text.empty() ? "" : ", ", names[feature], terms[feature]);
  }
  return text.empty() ? "nothing" : text;
}

// "base +0.5; for: gap_m +1.2; against: nothing"
std::string TermsText(const Evidence& evidence, std::span<const std::string_view> names, std::span<const float> features) {
  std::vector<float> terms(features.size());
  evidence.Terms(features, terms);
  return fmt::format("base {:+.1f}; for: {}; against: {}", evidence.Base(), Greatest(names, terms, 1.0F), Greatest(names, terms, -1.0F));
}

std::string Why(const MergeRound& round, const MergingPair& pair, const Evidence& evidence) {
  const auto& one = round[pair.one];
  const auto& other = round[pair.other];
  const auto gap_m = pair.features[static_cast<std::size_t>(segmenter::PairFeature::kGap)];
  return fmt::format("pieces {} ({} returns, segment {}) and {} ({} returns, segment {}): {}, log odds {:+.1f}, gap {:.2f} m; {}", pair.one,
                     one.num_returns, one.segment_id, pair.other, other.num_returns, other.segment_id, round.IsMerged(pair) ? "one" : "two",
                     pair.log_odds, gap_m, TermsText(evidence, segmenter::kPairFeatureNames, pair.features));
}

// The two returns of two pieces that are closest, seen from above.
std::array<Eigen::Vector3d, 2> Closest(const std::vector<Eigen::Vector3d>& one, const std::vector<Eigen::Vector3d>& other) {
  std::array<Eigen::Vector3d, 2> closest{one.front(), other.front()};
  double least_m2 = std::numeric_limits<double>::infinity();
  for (const auto& a_m : one) {
    for (const auto& b_m : other) {
      const double distance_m2 = (a_m - b_m).head<2>().squaredNorm();
      if (distance_m2 >= least_m2) continue;
      least_m2 = distance_m2;
      closest = {a_m, b_m};
    }
  }
  return closest;
}

}  // namespace

MergeRecorder::MergeRecorder(const segmenter::Params& params)
    : params_(params), classifier_(params.filter), method_(params.lookout, params.filter.T_vessel_lidar.linear()), segmenter_(params) {}

std::optional<MergedScan> MergeRecorder::Merge(const ScanMessages& messages) {
  const auto scan = ToScan(messages);
  if (!scan) return std::nullopt;
  MergedScan merged;
  const auto& segments = segmenter_.Segment(*scan);
  for (auto& part : segmenter::ToMessages(*scan, segments, bus::kMaxMessageBytes)) merged.segments.emplace(part.part_index, std::move(part));
  const auto& returns = classifier_.Classify(*scan).returns;
  for (const auto& one : returns) merged.returns_m.push_back(ToVector(one.point));
  method_.FindPieces(*scan, returns);
  for (std::size_t round = 0; round < segmenter::kNumMerges; ++round) merged.rounds[round] = MergeOnce(round, returns, segments.label);
  const auto features = method_.MeasureGroups();
  for (const auto& piece : merged.rounds.back().pieces) {
    if (piece.segment_id > 0) merged.features_of_segment[piece.segment_id] = features[static_cast<std::size_t>(piece.becomes)];
  }
  return merged;
}

MergedScan MergeRecorder::MergeChosen(const ScanMessages& messages) {
  if (auto merged = Merge(messages)) return std::move(*merged);
  throw std::runtime_error("scan " + std::to_string(messages.seq) + " lacks a part, or is such as the segmenter refuses");
}

MergeRound MergeRecorder::MergeOnce(std::size_t round, const std::vector<segmenter::Return>& returns, const std::vector<std::int16_t>& label) {
  MergeRound result;
  result.threshold = params_.lookout.merges[round].log_odds;
  result.piece_of_return.assign(method_.pieces().of_returns().begin(), method_.pieces().of_returns().end());
  const auto pairs = method_.FindPairs(round);
  for (const auto& pair : pairs) result.pairs.push_back({pair.one, pair.other, pair.features, evidence(round).Of(pair.features)});
  result.pieces.resize(static_cast<std::size_t>(method_.pieces().size()));
  method_.Merge(round, pairs);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (result.piece_of_return[i] < 0) continue;  // left out
    auto& piece = result.pieces[static_cast<std::size_t>(result.piece_of_return[i])];
    ++piece.num_returns;
    piece.mean_m += ToVector(returns[i].point).head<2>();
    piece.becomes = method_.pieces().of_returns()[i];
    piece.segment_id = std::max<std::int32_t>(0, label[static_cast<std::size_t>(returns[i].cell)]);
  }
  for (auto& piece : result.pieces) piece.mean_m /= piece.num_returns;
  return result;
}

MergeReasons ReasonsOf(const MergedScan& scan, const MergeRecorder& recorder) {
  const MergeRound& round = scan.rounds.back();
  std::vector<std::vector<Eigen::Vector3d>> returns_m(round.pieces.size());
  for (std::size_t i = 0; i < scan.returns_m.size(); ++i) {
    if (round.piece_of_return[i] < 0) continue;  // left out
    returns_m[static_cast<std::size_t>(round.piece_of_return[i])].push_back(scan.returns_m[i]);
  }
  MergeReasons reasons;
  for (const auto& pair : round.pairs) {
    reasons.links.push_back({Closest(returns_m[static_cast<std::size_t>(pair.one)], returns_m[static_cast<std::size_t>(pair.other)]),
                             round.IsMerged(pair), pair.log_odds, Why(round, pair, recorder.evidence(scan.rounds.size() - 1))});
  }
  for (const auto& [part_index, part] : scan.segments) {
    for (const auto& segment : part.segments) {
      const auto because = [&scan, &recorder, id = segment.id](std::size_t sum) {
        return TermsText(recorder.evidence(sum), segmenter::kPieceFeatureNames, scan.features_of_segment.at(id));
      };
      reasons.why_of_segment[segment.id] =
          fmt::format("segment {}: land {:.1f} % ({}), a thing {:.1f} % ({})", segment.id, 100.0 * double{segment.land_probability},
                      because(segmenter::kLandSum), 100.0 * double{segment.thing_probability}, because(segmenter::kThingSum));
    }
  }
  return reasons;
}

}  // namespace lookout::exporter
