// The results as tables, for the terminal and for CSV files.
#pragma once

#include <ostream>
#include <vector>

#include "lab/eval/methods/results.hpp"
#include "lab/eval/table.hpp"

namespace lookout::eval {

/// All that the results hold, other worlds in columns beside ours (where the rows are of scenes: in rows below); tables without rows are left out.
/// Figures of the paper's kind are in per cent; "-" = there is none.
std::vector<NamedTable> TablesOf(const Results& results);

void PrintTables(const Results& results, std::ostream& out);

}  // namespace lookout::eval
