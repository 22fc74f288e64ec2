#include "common/core/assignment.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <vector>

namespace lookout {
namespace {

double CostOf(const Eigen::MatrixXd& cost, const std::vector<int>& columns) {
  double sum = 0.0;
  for (std::size_t row = 0; row < columns.size(); ++row) sum += columns[row] < 0 ? 0.0 : cost(static_cast<Eigen::Index>(row), columns[row]);
  return sum;
}

// Every permutation.
double LeastCost(const Eigen::MatrixXd& matrix) {
  const Eigen::MatrixXd cost = matrix.rows() <= matrix.cols() ? matrix : Eigen::MatrixXd(matrix.transpose());
  std::vector<int> columns(static_cast<std::size_t>(cost.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  double least = 1e300;
  do {
    least = std::min(least, CostOf(cost, {columns.begin(), columns.begin() + cost.rows()}));
  } while (std::next_permutation(columns.begin(), columns.end()));
  return least;
}

TEST(CheapestAssignment, IsTheCheapestOfAll) {
  constexpr unsigned kSeed = 3;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> value(-10.0, 10.0);
  for (int rows = 1; rows <= 5; ++rows) {
    for (int columns = 1; columns <= 6; ++columns) {
      for (int i = 0; i < 10; ++i) {
        const Eigen::MatrixXd cost = Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return value(random); });
        const auto assigned = CheapestAssignment(cost);
        EXPECT_NEAR(CostOf(cost, assigned), LeastCost(cost), 1e-9) << cost;
        EXPECT_EQ(std::ranges::count_if(assigned, [](int column) { return column >= 0; }), std::min(rows, columns));
      }
    }
  }
}

TEST(CheapestAssignment, OfNothing) {
  EXPECT_TRUE(CheapestAssignment(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(CheapestAssignment(Eigen::MatrixXd(2, 0)), (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace lookout
