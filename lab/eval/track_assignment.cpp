#include "lab/eval/track_assignment.hpp"

#include <cstddef>
#include <limits>
#include <optional>

namespace lookout::eval {
namespace {

// Rows are not more than columns. Prices of rows and columns stay such that no pair costs less than its two prices together, and pairs that are
// assigned cost just these; a row is added by the cheapest path of exchanges to a free column.
class Assignment {
 public:
  explicit Assignment(const Eigen::MatrixXd& cost)
      : cost_(cost), row_price_(Count(cost.rows())), column_price_(Count(cost.cols())), row_of_(Count(cost.cols())) {}

  void AddRow(std::size_t row) {
    std::vector<double> distance(row_of_.size(), std::numeric_limits<double>::infinity());
    std::vector<std::optional<std::size_t>> from(row_of_.size());  // column before this one on the path; none: the new row itself
    std::vector<bool> is_reached(row_of_.size());
    std::optional<std::size_t> here;  // column whose row is looked at
    double path = 0.0;
    for (std::size_t at = row;; at = *row_of_[*here]) {
      std::optional<std::size_t> nearest;
      for (std::size_t k = 0; k < row_of_.size(); ++k) {
        if (is_reached[k]) continue;
        const double through = path + cost_(Index(at), Index(k)) - row_price_[at] - column_price_[k];
        if (through < distance[k]) {
          distance[k] = through;
          from[k] = here;
        }
        if (!nearest || distance[k] < distance[*nearest]) nearest = k;
      }
      path = distance[*nearest];
      is_reached[*nearest] = true;
      here = nearest;
      if (!row_of_[*here]) break;
    }
    for (std::size_t k = 0; k < row_of_.size(); ++k) {
      if (!is_reached[k] || k == *here) continue;
      column_price_[k] -= path - distance[k];
      row_price_[*row_of_[k]] += path - distance[k];
    }
    row_price_[row] += path;
    for (; from[*here]; here = from[*here]) row_of_[*here] = row_of_[*from[*here]];
    row_of_[*here] = row;
  }

  const std::vector<std::optional<std::size_t>>& row_of() const { return row_of_; }

 private:
  static std::size_t Count(Eigen::Index index) { return static_cast<std::size_t>(index); }
  static Eigen::Index Index(std::size_t count) { return static_cast<Eigen::Index>(count); }

  const Eigen::MatrixXd& cost_;
  std::vector<double> row_price_;
  std::vector<double> column_price_;
  std::vector<std::optional<std::size_t>> row_of_;  // by column
};

}  // namespace

std::vector<int> CheapestAssignment(const Eigen::MatrixXd& cost) {
  std::vector<int> column_of(static_cast<std::size_t>(cost.rows()), -1);
  if (cost.size() == 0) return column_of;
  const bool is_wide = cost.rows() <= cost.cols();
  const Eigen::MatrixXd wide = is_wide ? cost : Eigen::MatrixXd(cost.transpose());
  Assignment assignment(wide);
  for (Eigen::Index row = 0; row < wide.rows(); ++row) assignment.AddRow(static_cast<std::size_t>(row));
  for (std::size_t k = 0; k < assignment.row_of().size(); ++k) {
    const auto& row = assignment.row_of()[k];
    if (!row) continue;
    if (is_wide) {
      column_of[*row] = static_cast<int>(k);
    } else {
      column_of[k] = static_cast<int>(*row);
    }
  }
  return column_of;
}

}  // namespace lookout::eval
