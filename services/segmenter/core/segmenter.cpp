#include "services/segmenter/core/segmenter.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace lookout::segmenter {

namespace {

constexpr std::int32_t kMaxSegments = std::numeric_limits<std::int16_t>::max();
constexpr std::int32_t kMaxPieces = std::numeric_limits<std::int16_t>::max();
static_assert(TightPieces::kMostPieces <= kMaxPieces);

// In the simulator's heavy rain, 1 of 4000 segments of drops has so many returns.
constexpr float kEnoughReturns = 4.0F;
// Foam and spray fill a tenth to a half of the beams between their ends, hulls nearly all.
constexpr float kSolidFill = 0.6F;
// One return is never sure: in a single scan a buoy's and a drop's are alike.
constexpr std::int32_t kLeastSure = 2;
// From a lidar at 1 m over calm water, beams of 5 degrees and more below the horizon meet it within 11 m; flatter ones glance off. A thing that rises
// so high over it is more than a ripple.
constexpr float kSurfaceRangeM = 10.0F;
constexpr float kSurfaceTopM = 0.25F;

// The ground that a feature speaks of; 0 = none.
std::int32_t GroundOf(PieceFeature feature) {
  switch (feature) {
    case PieceFeature::kFill:
    case PieceFeature::kBoxFill:
    case PieceFeature::kGaps:
    case PieceFeature::kBackdrop:
    case PieceFeature::kCovered:
    case PieceFeature::kCrowd:
    case PieceFeature::kRough:
    case PieceFeature::kLone:
      return kScattered;
    case PieceFeature::kTop:
    case PieceFeature::kBottom:
    case PieceFeature::kMiddle:
    case PieceFeature::kSlope:
    case PieceFeature::kWaterBefore:
    case PieceFeature::kBottomRings:
      return kAtSurface;
    case PieceFeature::kReturns:
    case PieceFeature::kAngle:
    case PieceFeature::kRise:
    case PieceFeature::kWidth:
    case PieceFeature::kDepth:
    case PieceFeature::kLength:
    case PieceFeature::kOff:
      return kFewReturns;
    case PieceFeature::kRange:
    case PieceFeature::kNum:
      break;
  }
  return 0;
}

// Why the measurements of a group leave doubt whether it is a thing: at least one bit of Ground. Where no ground holds, the one that speaks most
// against a thing.
std::int32_t GroundsOf(const PieceFeatures& features, const Evidence& thing) {
  const auto of = [&features](PieceFeature feature) { return features[static_cast<std::size_t>(feature)]; };
  std::int32_t grounds = 0;
  if (of(PieceFeature::kReturns) < kEnoughReturns) grounds |= kFewReturns;
  if (of(PieceFeature::kFill) < kSolidFill) grounds |= kScattered;
  if (of(PieceFeature::kRange) < kSurfaceRangeM && of(PieceFeature::kTop) < kSurfaceTopM) grounds |= kAtSurface;
  if (grounds != 0) return grounds;
  PieceFeatures terms{};
  thing.Terms(features, terms);
  grounds = kFewReturns;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const std::int32_t ground = GroundOf(static_cast<PieceFeature>(i));
    if (ground == 0 || terms[i] >= least) continue;
    least = terms[i];
    grounds = ground;
  }
  return grounds;
}

// The one place that decides land and sure, by the probabilities as they are published.
void Decide(const LookoutParams& params, Segment& segment) {
  const bool is_sure = segment.num_points >= kLeastSure && double{segment.thing_probability} > params.sure_probability;
  const bool is_land = is_sure && double{segment.land_probability} > params.land_probability;
  segment.kind = is_land ? SegmentKind::kLand : SegmentKind::kObstacle;
  segment.confidence = is_sure ? Confidence::kSure : Confidence::kTentative;
}

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
  NumberPieces();
  result_.num_repeats = static_cast<std::int64_t>(classified.repeats.size());
  result_.num_too_small = numbering_.num_too_small();
  result_.num_over_limit = numbering_.num_over_limit();
  if (params_.method == Method::kLookout) result_.num_over_limit += method_.num_left_out();
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
    segment.land_probability = facts.land_probability;
    segment.thing_probability = facts.thing_probability;
    segment.seen_share = facts.seen_share;
    Decide(params_.lookout, segment);
    if (segment.confidence == Confidence::kTentative) {
      segment.grounds = GroundsOf(method_.FeaturesOf(root), params_.lookout.evidence[kThingSum]);
    }
    if (segment.kind == SegmentKind::kLand) measurer_.MeasureWaterline(scan, classifier_.result().returns, method_.NearestOf(root), segment);
  }
}

// Labels of the returns that are not looked at, completed.
void Segmenter::LabelReturns() {
  const auto& classified = classifier_.result();
  const auto& returns = classified.returns;
  const auto& segments = numbering_.groups();
  auto& label = result_.label;
  label = classified.label;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::int32_t segment = segments.of_return[i];
    const bool is_shadowed = params_.method == Method::kPaper && components_.of_return[i] == Groups::kNone;
    const Reason reason = is_shadowed ? Reason::kShadowed : Reason::kTooSmall;
    label[static_cast<std::size_t>(returns[i].cell)] = segment == Groups::kNone ? ToLabel(reason) : static_cast<std::int16_t>(segment + 1);
  }
  for (const auto& repeat : classified.repeats) {
    label[static_cast<std::size_t>(repeat.cell)] = label[static_cast<std::size_t>(returns[static_cast<std::size_t>(repeat.of_return)].cell)];
  }
}

void Segmenter::NumberPieces() {
  const auto& classified = classifier_.result();
  const auto& returns = classified.returns;
  const auto& label = result_.label;
  auto& piece = result_.piece;
  const bool is_paper = params_.method == Method::kPaper;
  const auto& piece_of_return = is_paper ? components_.of_return : method_.tight_pieces().of_return();
  const bool is_numbered = !is_paper || components_.count <= kMaxPieces;
  piece.assign(label.size(), 0);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const auto cell = static_cast<std::size_t>(returns[i].cell);
    if (label[cell] > 0) piece[cell] = is_numbered ? static_cast<std::int16_t>(piece_of_return[i] + 1) : label[cell];
  }
  for (const auto& repeat : classified.repeats) {
    piece[static_cast<std::size_t>(repeat.cell)] = piece[static_cast<std::size_t>(returns[static_cast<std::size_t>(repeat.of_return)].cell)];
  }
}

Segments SegmentScan(const Scan& scan, const Params& params) { return Segmenter(params).Segment(scan); }

}  // namespace lookout::segmenter
