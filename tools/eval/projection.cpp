#include "tools/eval/projection.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "common/core/angles.hpp"
#include "tools/eval/methods.hpp"
#include "tools/eval/scoring.hpp"

namespace lookout::eval {
namespace {

// Exact search for the nearest of some points: from the place in the order of x both ways, until x alone is farther.
class NearestPoint {
 public:
  explicit NearestPoint(const std::vector<segmenter::Return>& returns) {
    points_.reserve(returns.size());
    for (const auto& one : returns) points_.push_back(one.point);
    std::ranges::sort(points_, {}, &segmenter::Point::x_m);
  }

  double DistanceM(const segmenter::Point& from) const {
    const auto middle = std::ranges::lower_bound(points_, from.x_m, {}, &segmenter::Point::x_m);
    double least_m2 = std::numeric_limits<double>::infinity();
    const auto take = [&](const segmenter::Point& point) {
      const double x_m = static_cast<double>(point.x_m) - from.x_m;
      if (x_m * x_m >= least_m2) return false;
      least_m2 = std::min(least_m2, segmenter::SquaredDistance(from, point));
      return true;
    };
    for (auto it = middle; it != points_.end() && take(*it); ++it) {
    }
    for (auto it = middle; it != points_.begin() && take(*std::prev(it)); --it) {
    }
    return std::sqrt(least_m2);
  }

 private:
  std::vector<segmenter::Point> points_;
};

}  // namespace

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
  const NearestPoint nearest(returns);
  auto labelling = SegmenterMethod("", PaperParams(boat_, image_columns)).Segment(scan);
  std::vector<bool> is_kept(scan.num_cells(), false);
  ++sums.num_scans;
  sums.num_points += static_cast<std::int64_t>(returns.size());
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (!image.IsInImage(static_cast<std::int32_t>(i))) continue;
    const auto& one = returns[i];
    is_kept[static_cast<std::size_t>(one.cell)] = true;
    ++sums.num_kept;
    const auto& ring = scan.head.rings[static_cast<std::size_t>(one.ring)];
    const double azimuth_rad = (image.place_of[i].column + 0.5) * kTwoPi / image_columns;
    const double level_m = one.range_m * std::cos(double{ring.elevation_rad});
    const segmenter::Point pixel{static_cast<float>(level_m * std::cos(azimuth_rad)), static_cast<float>(-level_m * std::sin(azimuth_rad)),
                                 one.point.z_m};
    const double distance_m = nearest.DistanceM(pixel);
    sums.distance_m += distance_m;
    sums.squared_distance_m2 += distance_m * distance_m;
  }
  for (std::size_t cell = 0; cell < is_kept.size(); ++cell) {
    if (!is_kept[cell]) labelling.label[cell] = kNotScored;
  }
  const auto score = ScoreScan(truth, labelling);
  sums.true_positives.Add(score.true_positives);
}

std::vector<Results::Projection> ProjectionTable::Rows() const {
  std::vector<Results::Projection> rows;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sums& sums = sums_[i];
    if (sums.num_kept == 0) continue;
    const auto num_scans = static_cast<double>(sums.num_scans);
    const auto num_kept = static_cast<double>(sums.num_kept);
    Results::Projection row;
    row.image_columns = kPaperColumns[i];
    row.true_positive_ratio = sums.true_positives.value();
    row.num_ground_points = num_kept / num_scans;
    row.num_points = static_cast<double>(sums.num_points) / num_scans;
    row.nearest_mean_m = sums.distance_m / num_kept;
    row.nearest_sd_m = std::sqrt(std::max(0.0, sums.squared_distance_m2 / num_kept - row.nearest_mean_m * row.nearest_mean_m));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace lookout::eval
