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

// Tables of one world each; TablesOf contains them as well.

/// The tables by which anything is chosen: ours on families that its evidence was not fitted on. Without rows where nothing was left out.
std::vector<NamedTable> LeaveOutTablesOf(const Results& results);
/// Outcomes of things, of land and of clutter: how a method fails, and at which operating point. Tables whose rows name a scene stand below each
/// other for several worlds, others side by side.
std::vector<NamedTable> FailureTablesOf(const Results& results);

}  // namespace lookout::eval
