#include "lab/eval/methods/methods.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "common/core/angles.hpp"
#include "lab/eval/baselines/peer.hpp"
#include "lab/eval/baselines/peers.hpp"

namespace lookout::eval {
namespace {

using segmenter::Reason;
using segmenter::ToLabel;

constexpr double kPaperFieldOfViewRad = DegToRad(90.0);

// The steps of the segmenter once more, for their times and the number of components between them.
void MeasureStages(const segmenter::Scan& scan, const segmenter::Params& params, Labelling& labelling_of_scan) {
  StageClock clock;
  const auto classified = segmenter::ClassifyReturns(scan, params.filter);
  const auto& returns = classified.returns;
  constexpr std::int32_t kMaxSegments = std::numeric_limits<std::int16_t>::max();
  segmenter::Numbering numbering;
  if (params.method == segmenter::Method::kLookout) {
    clock.End("project");
    segmenter::LookoutMethod method(params.lookout, params.filter.T_vessel_lidar.linear());
    method.Group(scan, returns);
    numbering.Number(method.groups(), {}, params.min_segment_points, kMaxSegments);
    clock.End("cluster");
    labelling_of_scan.num_components = method.num_tight_pieces();
    auto& probability = labelling_of_scan.probability.emplace();
    for (std::int32_t i = 0; i < numbering.groups().count; ++i) {
      probability.push_back(double{method.FactsOf(numbering.ClusterOf(i)).thing_probability});
    }
  } else {
    segmenter::Groups components;
    const auto& labelling = params.labelling;
    if (labelling.image_columns == 0 || !labelling.label_shadowed_returns) {
      std::vector<std::int32_t> indices(returns.size());
      std::iota(indices.begin(), indices.end(), 0);
      const auto image = labelling.image_columns == 0 ? segmenter::ProjectToOwnColumns(scan, returns)
                                                      : segmenter::ProjectToAzimuths(scan, returns, indices, labelling.image_columns);
      clock.End("project");
      components = segmenter::SearchComponents(image, returns, labelling.search);
    } else {
      // Projection and search take turns here.
      clock.End("project");
      components = segmenter::LabelComponents(scan, returns, labelling);
    }
    clock.End("search");
    std::vector<std::int32_t> clusters(static_cast<std::size_t>(components.count));
    std::iota(clusters.begin(), clusters.end(), 0);
    if (params.component_clustering) clusters = segmenter::ClusterComponents(segmenter::Centroids(returns, components), params.clustering);
    numbering.Number(components, clusters, params.min_segment_points, kMaxSegments);
    clock.End("cluster");
    labelling_of_scan.num_components = components.count;
  }
  segmenter::Measure(scan, returns, numbering.groups(), params.filter.T_vessel_lidar.linear().row(2));
  clock.End("measure");
  labelling_of_scan.stages = clock.stages();
}

bool IsSure(const segmenter::Segment& segment) { return segment.confidence == segmenter::Confidence::kSure; }

Methods MakeAll(const segmenter::Params& boat) {
  Methods methods;
  const auto add = [&methods](std::string name, const segmenter::Params& params) {
    methods.push_back(std::make_unique<SegmenterMethod>(std::move(name), params));
  };
  add("ours", boat);
  auto own_columns = PaperParams(boat, 0);
  own_columns.labelling.label_shadowed_returns = true;
  add("paper, own columns", own_columns);
  own_columns.component_clustering = false;
  add("paper, own columns without clustering", own_columns);
  for (const int columns : kPaperColumns) add("paper W=" + std::to_string(columns), PaperParams(boat, columns));
  for (const int columns : kPaperColumns) add("paper W=" + std::to_string(columns) + " without BFS", WithoutSearch(PaperParams(boat, columns)));
  for (const int columns : kPaperColumns) {
    auto params = PaperParams(boat, columns);
    params.filter.field_of_view = {WrapTo2Pi(-kPaperFieldOfViewRad / 2.0), kPaperFieldOfViewRad};
    add("paper W=" + std::to_string(columns) + " at 90 deg", params);
  }
  for (auto& peer : MakePeers(boat.filter)) methods.push_back(std::move(peer));
  return methods;
}

std::string GroupOf(const std::string& name) { return name.starts_with("ours") ? "ours" : name.starts_with("paper") ? "paper" : "peers"; }

}  // namespace

Labelling SegmenterMethod::Segment(const segmenter::Scan& scan) {
  const auto& segments = segmenter_.Segment(scan);
  Labelling labelling;
  labelling.label.resize(segments.label.size());
  std::ranges::transform(segments.label, labelling.label.begin(), [](std::int16_t label) -> std::int32_t {
    if (label == ToLabel(Reason::kFieldOfView)) return kNotScored;
    return std::max<std::int32_t>(label, 0);
  });
  for (const auto& segment : segments.segments) labelling.is_sure.push_back(IsSure(segment));
  const auto begin = std::chrono::steady_clock::now();
  MeasureStages(scan, params_, labelling);
  labelling.untimed = std::chrono::steady_clock::now() - begin;
  return labelling;
}

segmenter::Params PaperParams(const segmenter::Params& boat, int image_columns) {
  segmenter::Params params;  // thresholds: the defaults are the paper's
  params.filter = boat.filter;
  params.method = segmenter::Method::kPaper;
  params.labelling.image_columns = image_columns;
  params.labelling.label_shadowed_returns = false;
  return params;
}

segmenter::Params WithoutSearch(segmenter::Params params) {
  params.labelling.search.angle_rad = kPi / 2.0;
  params.labelling.search.distance_m = 0.0;
  return params;
}

Methods MakeMethods(const segmenter::Params& boat, std::span<const std::string> selection) {
  auto all = MakeAll(boat);
  std::vector<bool> is_selected(all.size(), false);
  for (const auto& wanted : selection) {
    bool is_known = false;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto name = all[i]->name();
      if (name != wanted && wanted != "all" && GroupOf(name) != wanted) continue;
      is_selected[i] = true;
      is_known = true;
    }
    if (!is_known) {
      std::string reason = "--methods: no such method: " + wanted + " (there are: all, ours, paper, peers";
      for (const auto& method : all) reason += ", " + method->name();
      throw std::invalid_argument(reason + ")");
    }
  }
  Methods methods;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (is_selected[i]) methods.push_back(std::move(all[i]));
  }
  return methods;
}

}  // namespace lookout::eval
