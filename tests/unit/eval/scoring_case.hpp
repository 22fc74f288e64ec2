// Turns that are made of a list of cells.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "lab/eval/methods/scoring.hpp"

namespace lookout::eval {

inline constexpr double kRangeUnitM = 0.002;

struct Cell {
  std::int32_t object;
  std::int32_t label;
  double range_m = 20.0;
};

struct Case {
  LabelledScan truth;
  Labelling labelling;
};

// Objects 1, 2, ... are kayaks (odd) and docks (even).
inline Case MakeCase(const std::vector<Cell>& cells) {
  Case one;
  one.truth.scan.head.range_unit_m = kRangeUnitM;
  for (const auto& cell : cells) {
    one.truth.scan.columns.range.push_back(static_cast<std::uint16_t>(std::lround(cell.range_m / kRangeUnitM)));
    one.truth.object.push_back(cell.object);
    one.labelling.label.push_back(cell.label);
    if (cell.object <= 0) continue;
    const bool is_kayak = cell.object % 2 == 1;
    one.truth.objects[cell.object] = {"object", is_kayak ? "kayak" : "dock", is_kayak};
  }
  return one;
}

inline Score ScoreOf(const std::vector<Cell>& cells) {
  const auto one = MakeCase(cells);
  return ScoreScan(one.truth, one.labelling);
}

inline void AddCells(std::vector<Cell>& cells, int count, Cell cell) { cells.insert(cells.end(), static_cast<std::size_t>(count), cell); }

}  // namespace lookout::eval
