#include "services/tracker/core/assignment.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace lookout::tracker {

namespace {

constexpr std::size_t kMostExact = 64;

std::size_t At(std::int32_t index) { return static_cast<std::size_t>(index); }

// Square matrix, [n x n] by row: shortest augmenting paths with potentials.
std::vector<std::size_t> ColumnOfRow(const std::vector<double>& cost, std::size_t n) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> row_potential(n + 1, 0.0);
  std::vector<double> column_potential(n + 1, 0.0);
  std::vector<std::size_t> row_of_column(n + 1, 0);  // from 1; 0 = none
  std::vector<std::size_t> way(n + 1, 0);
  for (std::size_t row = 1; row <= n; ++row) {
    row_of_column[0] = row;
    std::size_t at = 0;
    std::vector<double> least(n + 1, kInfinity);
    std::vector<bool> is_used(n + 1, false);
    do {
      is_used[at] = true;
      const std::size_t of = row_of_column[at];
      double step = kInfinity;
      std::size_t next = 0;
      for (std::size_t column = 1; column <= n; ++column) {
        if (is_used[column]) continue;
        const double reduced = cost[(of - 1) * n + column - 1] - row_potential[of] - column_potential[column];
        if (reduced < least[column]) {
          least[column] = reduced;
          way[column] = at;
        }
        if (least[column] < step) {
          step = least[column];
          next = column;
        }
      }
      for (std::size_t column = 0; column <= n; ++column) {
        if (is_used[column]) {
          row_potential[row_of_column[column]] += step;
          column_potential[column] -= step;
        } else {
          least[column] -= step;
        }
      }
      at = next;
    } while (row_of_column[at] != 0);
    for (; at != 0; at = way[at]) row_of_column[at] = row_of_column[way[at]];
  }
  std::vector<std::size_t> column_of_row(n);
  for (std::size_t column = 1; column <= n; ++column) column_of_row[row_of_column[column] - 1] = column - 1;
  return column_of_row;
}

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
    std::vector<double> cost(n * n, most);
    for (const auto& one : some) {
      const auto row = static_cast<std::size_t>(std::ranges::lower_bound(rows, one.row) - rows.begin());
      const auto column = static_cast<std::size_t>(std::ranges::lower_bound(columns, one.column) - columns.begin());
      cost[row * n + column] = std::min(cost[row * n + column], one.cost);
    }
    const auto column_of_row = ColumnOfRow(cost, n);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const std::size_t column = column_of_row[row];
      if (column < columns.size() && cost[row * n + column] < most) column_of[At(rows[row])] = columns[column];
    }
  }
  return column_of;
}

}  // namespace lookout::tracker
