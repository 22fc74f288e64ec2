// Assignment: the pairs of rows and columns that cost least together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lookout::tracker {

struct Candidate {
  std::int32_t row = 0;
  std::int32_t column = 0;
  double cost = 0.0;  // finite
};

/// Assigns rows to columns, one to one, so that as few as possible of a penalty and the costs add up to the least: a pair is made where its cost is
/// below `most` and it lowers the sum. Of equal sums the pair of the lower row, then the lower column counts.
///
/// @return [rows] column of each; -1: none
/// Cost: n^3 of each group of rows and columns that candidates join; groups of more than 64 rows and columns are assigned greedily, the least cost
/// first. Source: H. Kuhn, "The Hungarian method for the assignment problem", 1955, with shortest augmenting paths.
std::vector<std::int32_t> Assign(std::int32_t num_rows, std::int32_t num_columns, std::span<const Candidate> candidates, double most);

}  // namespace lookout::tracker
