// The cheapest pairing of two sets (Hungarian method).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace lookout {

using CostMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Each row gets a column of its own, or, where there are fewer columns than rows, as many rows as there are columns do; the sum of the costs is the
/// least that there is.
///
/// @param cost  [rows x columns] finite
/// @return [rows] column; -1 = none
/// Cost: rows^2 x columns (the shorter side counts as rows).
/// Source: H. Kuhn, "The Hungarian method for the assignment problem", 1955, with shortest augmenting paths: R. Jonker, A. Volgenant, "A shortest
/// augmenting path algorithm for dense and sparse linear assignment problems", Computing 38 (1987), without its start heuristics.
std::vector<std::int32_t> CheapestAssignment(const CostMatrix& cost);

}  // namespace lookout
