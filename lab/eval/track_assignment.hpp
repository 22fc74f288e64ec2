// Who belongs to whom: the cheapest pairing of two sets.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lookout::eval {

/// Each row gets a column of its own, or, where there are fewer columns than rows, as many rows as there are columns do; the sum of the costs is the
/// least that there is.
///
/// @param cost  [rows x columns] finite
/// @return [rows] column; -1 = none
/// Deterministic. Cost: rows^2 x columns (the shorter side counts as rows).
/// Source: Hungarian method with shortest augmenting paths: R. Jonker, A. Volgenant, "A shortest augmenting path algorithm for dense and sparse
/// linear assignment problems", Computing 38 (1987), without its start heuristics.
std::vector<int> CheapestAssignment(const Eigen::MatrixXd& cost);

}  // namespace lookout::eval
