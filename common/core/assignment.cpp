#include "common/core/assignment.hpp"

#include <cstddef>
#include <limits>

namespace lookout {

namespace {

// [columns] the row that each belongs to; rows and columns from 1, 0 = none. Rows are not more than columns. Potentials stay such that no pair costs
// less than its two together, and pairs that are assigned cost just these; a row is added by the cheapest path of exchanges to a free column.
std::vector<std::size_t> RowOfColumn(const CostMatrix& cost) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto num_rows = static_cast<std::size_t>(cost.rows());
  const auto num_columns = static_cast<std::size_t>(cost.cols());
  std::vector<double> row_potential(num_rows + 1, 0.0);
  std::vector<double> column_potential(num_columns + 1, 0.0);
  std::vector<std::size_t> row_of_column(num_columns + 1, 0);
  std::vector<std::size_t> previous(num_columns + 1, 0);  // column before this one on the path
  for (std::size_t row = 1; row <= num_rows; ++row) {
    row_of_column[0] = row;
    std::size_t at = 0;
    std::vector<double> least(num_columns + 1, kInfinity);
    std::vector<bool> is_used(num_columns + 1, false);
    do {
      is_used[at] = true;
      const std::size_t of = row_of_column[at];
      double step = kInfinity;
      std::size_t next = 0;
      for (std::size_t column = 1; column <= num_columns; ++column) {
        if (is_used[column]) continue;
        const double reduced =
            cost(static_cast<Eigen::Index>(of - 1), static_cast<Eigen::Index>(column - 1)) - row_potential[of] - column_potential[column];
        if (reduced < least[column]) {
          least[column] = reduced;
          previous[column] = at;
        }
        if (least[column] < step) {
          step = least[column];
          next = column;
        }
      }
      for (std::size_t column = 0; column <= num_columns; ++column) {
        if (is_used[column]) {
          row_potential[row_of_column[column]] += step;
          column_potential[column] -= step;
        } else {
          least[column] -= step;
        }
      }
      at = next;
    } while (row_of_column[at] != 0);
    for (; at != 0; at = previous[at]) row_of_column[at] = row_of_column[previous[at]];
  }
  return row_of_column;
}

}  // namespace

std::vector<std::int32_t> CheapestAssignment(const CostMatrix& cost) {
  std::vector<std::int32_t> column_of(static_cast<std::size_t>(cost.rows()), -1);
  if (cost.size() == 0) return column_of;
  const bool is_wide = cost.rows() <= cost.cols();
  const auto row_of_column = RowOfColumn(is_wide ? cost : CostMatrix(cost.transpose()));
  for (std::size_t column = 1; column < row_of_column.size(); ++column) {
    const std::size_t row = row_of_column[column];
    if (row == 0) continue;
    (is_wide ? column_of[row - 1] : column_of[column - 1]) = static_cast<std::int32_t>(is_wide ? column - 1 : row - 1);
  }
  return column_of;
}

}  // namespace lookout
