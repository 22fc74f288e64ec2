// The first steps of the lookout method on a scan, kept together for tests of single steps; and what a whole scan gives at a place.
#pragma once

#include <Eigen/Core>
#include <set>
#include <vector>

#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/tight_pieces.hpp"
#include "services/segmenter/core/segmenter.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter::test {

/// The grid looks at the returns: not to be copied.
struct Stages {
  explicit Stages(const Scan& scan, const Reach& link = LookoutParams{}.link) : returns(ClassifyReturns(scan, {}).returns) {
    grid.Fill(scan, returns, Eigen::Matrix3d::Identity());
    TightPieces tight;
    tight.Find(grid, link);
    pieces.Build(grid, tight.of_return(), tight.count());
  }
  Stages(const Stages&) = delete;
  Stages& operator=(const Stages&) = delete;

  std::vector<Return> returns;
  ScanGrid grid;
  PieceTable pieces;
};

/// Segments of the default method with a return within `radius_m` of a place seen from above.
inline std::set<int> SegmentsNear(const Scan& scan, const Segments& segments, double x_m, double y_m, double radius_m) {
  std::set<int> ids;
  for (const auto& one : ClassifyReturns(scan, {}).returns) {
    if (std::hypot(one.point.x_m - x_m, one.point.y_m - y_m) <= radius_m) ids.insert(segments.label[static_cast<std::size_t>(one.cell)]);
  }
  return ids;
}

inline Scan See(const std::vector<Wall>& walls, const Shape& shape = {}, std::uint64_t seed = 1) {
  auto scan = EmptyScan(shape);
  Look(scan, walls, 0.02, seed);
  return scan;
}

inline const Segment& SegmentOf(const Segments& segments, int id) { return segments.segments.at(static_cast<std::size_t>(id - 1)); }

}  // namespace lookout::segmenter::test
