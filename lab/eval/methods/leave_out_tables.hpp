// The tables by which anything is chosen: ours on families that its evidence was not fitted on.
#pragma once

#include <vector>

#include "lab/eval/methods/result_tables.hpp"

namespace lookout::eval {

/// Of one world; without rows where nothing was left out.
std::vector<NamedTable> LeaveOutTablesOf(const Results& results);

}  // namespace lookout::eval
