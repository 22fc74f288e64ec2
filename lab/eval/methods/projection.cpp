#include "lab/eval/methods/projection.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"
#include "lab/eval/baselines/point_tree.hpp"
#include "lab/eval/methods/methods.hpp"
#include "lab/eval/methods/scoring.hpp"

namespace lookout::eval {

ProjectionTable::ProjectionTable(const segmenter::Params& boat) : boat_(boat), sums_(std::size(kPaperColumns)) {}

void ProjectionTable::Add(const LabelledScan& truth) {
  for (std::size_t i = 0; i < sums_.size(); ++i) AddTo(sums_[i], kPaperColumns[i], truth);
}

void ProjectionTable::AddTo(Sums& sums, int image_columns, const LabelledScan& truth) const {
  const auto& scan = truth.scan;
  const auto returns = segmenter::ClassifyReturns(scan, boat_.filter).returns;
  std::vector<std::int32_t> indices(returns.size());
  std::iota(indices.begin(), indices.end(), 0);
  const auto image = segmenter::ProjectToAzimuths(scan, returns, indices, image_columns);
  std::vector<segmenter::Point> points;
  points.reserve(returns.size());
  for (const auto& one : returns) points.push_back(one.point);
  const PointTree tree(std::move(points));
  auto labelling = SegmenterMethod("", PaperParams(boat_, image_columns)).Segment(scan);
  std::vector<bool> is_kept(scan.num_cells(), false);
  sums.points.Add(static_cast<double>(returns.size()));
  double num_kept = 0.0;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (!image.IsInImage(static_cast<std::int32_t>(i))) continue;
    const auto& one = returns[i];
    is_kept[static_cast<std::size_t>(one.cell)] = true;
    ++num_kept;
    const auto& ring = scan.head.rings[static_cast<std::size_t>(one.ring)];
    const double azimuth_rad = (image.place_of[i].column + 0.5) * kTwoPi / image_columns;
    const double level_m = one.range_m * std::cos(double{ring.elevation_rad});
    const segmenter::Point pixel{static_cast<float>(level_m * std::cos(azimuth_rad)), static_cast<float>(-level_m * std::sin(azimuth_rad)),
                                 one.point.z_m};
    const double distance_m = tree.FindNearest(pixel)->distance_m;
    sums.distance_m.Add(distance_m);
    sums.squared_distance_m2 += distance_m * distance_m;
  }
  sums.kept.Add(num_kept);
  for (std::size_t cell = 0; cell < is_kept.size(); ++cell) {
    if (!is_kept[cell]) labelling.label[cell] = kNotScored;
  }
  sums.true_positives.Add(ScoreScan(truth, labelling).true_positives);
}

std::vector<Results::Projection> ProjectionTable::Rows() const {
  std::vector<Results::Projection> rows;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sums& sums = sums_[i];
    if (sums.distance_m.count == 0) continue;
    const double mean_m = sums.distance_m.value();
    const double mean_square_m2 = sums.squared_distance_m2 / static_cast<double>(sums.distance_m.count);
    rows.push_back({kPaperColumns[i], sums.true_positives.value(), sums.kept.value(), sums.points.value(), mean_m,
                    std::sqrt(std::max(0.0, mean_square_m2 - mean_m * mean_m))});
  }
  return rows;
}

}  // namespace lookout::eval
