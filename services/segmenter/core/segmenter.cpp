#include "services/segmenter/core/segmenter.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace lookout::segmenter {

namespace {

constexpr std::int32_t kMaxSegments = std::numeric_limits<std::int16_t>::max();

}  // namespace

Segmenter::Segmenter(const Params& params)
    : params_(params),
      classifier_(params.filter),
      method_(params.lookout, params.filter.T_vessel_lidar.linear()),
      measurer_(params.filter.T_vessel_lidar.linear().row(2)) {}

const Segments& Segmenter::Segment(const Scan& scan) {
  const auto& classified = classifier_.Classify(scan);
  if (params_.method == Method::kLookout) {
    method_.Group(scan, classified.returns);
    numbering_.Number(method_.groups(), {}, params_.min_segment_points, kMaxSegments);
  } else {
    GroupAsThePaper(scan);
    numbering_.Number(components_, cluster_of_component_, params_.min_segment_points, kMaxSegments);
  }
  measurer_.Measure(scan, classified.returns, numbering_.groups(), result_.segments);
  if (params_.method == Method::kLookout) DescribeSegments(scan);
  LabelReturns();
  result_.num_repeats = static_cast<std::int64_t>(classified.repeats.size());
  result_.num_too_small = numbering_.num_too_small();
  result_.num_over_limit = numbering_.num_over_limit();
  return result_;
}

void Segmenter::GroupAsThePaper(const Scan& scan) {
  const auto& returns = classifier_.result().returns;
  components_ = LabelComponents(scan, returns, params_.labelling);
  if (params_.component_clustering) {
    cluster_of_component_ = ClusterComponents(Centroids(returns, components_), params_.clustering);
  } else {
    cluster_of_component_.resize(static_cast<std::size_t>(components_.count));
    std::iota(cluster_of_component_.begin(), cluster_of_component_.end(), 0);
  }
}

void Segmenter::DescribeSegments(const Scan& scan) {
  for (auto& segment : result_.segments) {
    const std::int32_t root = numbering_.ClusterOf(segment.id - 1);
    const GroupFacts& facts = method_.FactsOf(root);
    segment.kind = facts.is_land ? SegmentKind::kLand : SegmentKind::kObstacle;
    segment.confidence = facts.is_land || facts.thing_log_odds > params_.lookout.sure_log_odds ? Confidence::kSure : Confidence::kTentative;
    segment.grounds = segment.confidence == Confidence::kSure ? 0 : kFewReturns;
    segment.seen_share = facts.seen_share;
    if (facts.is_land) measurer_.MeasureWaterline(scan, classifier_.result().returns, method_.NearestOf(root), segment);
  }
}

// Labels of the returns that are not looked at, completed.
void Segmenter::LabelReturns() {
  const auto& classified = classifier_.result();
  const auto& returns = classified.returns;
  const auto& segments = numbering_.groups();
  const auto& groups = params_.method == Method::kLookout ? method_.groups() : components_;
  auto& label = result_.label;
  label = classified.label;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::int32_t segment = segments.of_return[i];
    const Reason reason = groups.of_return[i] == Groups::kNone ? Reason::kShadowed : Reason::kTooSmall;
    label[static_cast<std::size_t>(returns[i].cell)] = segment == Groups::kNone ? ToLabel(reason) : static_cast<std::int16_t>(segment + 1);
  }
  for (const auto& repeat : classified.repeats) {
    label[static_cast<std::size_t>(repeat.cell)] = label[static_cast<std::size_t>(returns[static_cast<std::size_t>(repeat.of_return)].cell)];
  }
}

Segments SegmentScan(const Scan& scan, const Params& params) { return Segmenter(params).Segment(scan); }

}  // namespace lookout::segmenter
