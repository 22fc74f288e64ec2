// Small scenes whose pieces are given, for tests of what is measured of them.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "services/segmenter/core/lookout/pieces.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter::test {

/// 360 columns of a degree; the middle one of three rings is level. The grid looks at the returns: not to be copied.
class PieceScene {
 public:
  static constexpr int kColumns = 360;

  explicit PieceScene(int num_rings = 3) : scan(EmptyScan({.num_columns = kColumns, .num_rings = num_rings})) {}
  PieceScene(const PieceScene&) = delete;
  PieceScene& operator=(const PieceScene&) = delete;

  void Add(std::int32_t piece, int column, int ring, double range_m) {
    const int at = (column + kColumns) % kColumns;
    SetReturn(scan, at, ring, range_m);
    piece_of_cell_[CellOf(scan, at, ring)] = piece;
  }
  /// Columns [first, first + num) of a ring.
  void AddRow(std::int32_t piece, int first, int num, int ring, double range_m) {
    for (int column = first; column < first + num; ++column) Add(piece, column, ring, range_m);
  }
  void Build() {
    returns = ClassifyReturns(scan, {}).returns;
    grid.Fill(scan, returns, Eigen::Matrix3d::Identity());
    std::vector<std::int32_t> piece_of_return;
    std::int32_t count = 0;
    for (const auto& one : returns) {
      piece_of_return.push_back(piece_of_cell_.at(static_cast<std::size_t>(one.cell)));
      count = std::max(count, piece_of_return.back() + 1);
    }
    pieces.Build(grid, piece_of_return, count);
  }

  Scan scan;
  std::vector<Return> returns;
  ScanGrid grid;
  PieceTable pieces;

 private:
  std::map<std::size_t, std::int32_t> piece_of_cell_;
};

}  // namespace lookout::segmenter::test
