#include "services/tracker/core/assignment.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "common/core/assignment.hpp"

namespace lookout::tracker {

namespace {

constexpr std::size_t kMostExact = 64;

std::size_t At(std::int32_t index) { return static_cast<std::size_t>(index); }
Eigen::Index Index(std::size_t index) { return static_cast<Eigen::Index>(index); }

}  // namespace

std::vector<std::int32_t> Assign(std::int32_t num_rows, std::int32_t num_columns, std::span<const Candidate> candidates, double most) {
  std::vector<std::int32_t> column_of(At(num_rows), -1);
  // Groups: rows and columns that candidates join.
  std::vector<std::int32_t> parent(At(num_rows + num_columns));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&parent](std::int32_t node) {
    while (parent[At(node)] != node) node = parent[At(node)] = parent[At(parent[At(node)])];
    return node;
  };
  std::vector<Candidate> sorted;
  for (const auto& candidate : candidates) {
    if (candidate.cost >= most) continue;
    sorted.push_back(candidate);
    const std::int32_t row_root = root(candidate.row);
    const std::int32_t column_root = root(num_rows + candidate.column);
    parent[At(std::max(row_root, column_root))] = std::min(row_root, column_root);
  }
  std::ranges::sort(sorted, {}, [&root](const Candidate& one) { return std::tuple(root(one.row), one.row, one.column, one.cost); });
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin;
    const std::int32_t group = root(sorted[begin].row);
    while (end < sorted.size() && root(sorted[end].row) == group) ++end;
    const std::span some(sorted.data() + begin, end - begin);
    begin = end;
    std::vector<std::int32_t> rows;
    std::vector<std::int32_t> columns;
    for (const auto& one : some) {
      rows.push_back(one.row);
      columns.push_back(one.column);
    }
    for (auto* list : {&rows, &columns}) {
      std::ranges::sort(*list);
      list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    if (rows.size() + columns.size() > kMostExact) {
      std::vector<Candidate> by_cost(some.begin(), some.end());
      std::ranges::sort(by_cost, {}, [](const Candidate& one) { return std::tuple(one.cost, one.row, one.column); });
      std::vector<bool> is_taken(At(num_columns), false);
      for (const auto& one : by_cost) {
        if (column_of[At(one.row)] >= 0 || is_taken[At(one.column)]) continue;
        column_of[At(one.row)] = one.column;
        is_taken[At(one.column)] = true;
      }
      continue;
    }
    // To have none costs `most`.
    const std::size_t n = std::max(rows.size(), columns.size());
    CostMatrix cost = CostMatrix::Constant(Index(n), Index(n), most);
    for (const auto& one : some) {
      double& least = cost(std::ranges::lower_bound(rows, one.row) - rows.begin(), std::ranges::lower_bound(columns, one.column) - columns.begin());
      least = std::min(least, one.cost);
    }
    const auto column_of_row = CheapestAssignment(cost);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const std::size_t column = At(column_of_row[row]);
      if (column < columns.size() && cost(Index(row), Index(column)) < most) column_of[At(rows[row])] = columns[column];
    }
  }
  return column_of;
}

}  // namespace lookout::tracker
