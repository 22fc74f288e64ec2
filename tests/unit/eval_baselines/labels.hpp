// Small turns and what a method says of them.
#pragma once

#include <cstdint>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::eval::test {

using segmenter::test::CellOf;
using segmenter::test::EmptyScan;
using segmenter::test::SetReturn;

/// 360 columns of one degree, column i at i + 0.5 degrees; rings 2 degrees apart around the horizon.
inline segmenter::Scan Turn(int num_rings = 4, int num_returns = 1) {
  return EmptyScan({.num_columns = 360, .num_rings = num_rings, .num_returns = num_returns});
}

/// Returns at one range on columns [first, last] and rings [low, high]; columns wrap.
inline void SetPatch(segmenter::Scan& scan, int first, int last, int low, int high, double range_m, int index = 0) {
  for (int column = first; column <= last; ++column) {
    for (int ring = low; ring <= high; ++ring) SetReturn(scan, (column + 360) % 360, ring, range_m, index);
  }
}

inline std::int32_t LabelAt(const segmenter::Scan& scan, const Labelling& labelling, int column, int ring, int index = 0) {
  return labelling.label[CellOf(scan, column, ring, index)];
}

}  // namespace lookout::eval::test
