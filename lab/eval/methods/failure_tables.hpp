// What becomes of things, of land and of clutter, as tables: how a method fails, and at which operating point.
#pragma once

#include <vector>

#include "lab/eval/methods/result_tables.hpp"

namespace lookout::eval {

/// Of one world. Tables whose rows name a scene stand below each other for several worlds, others side by side.
std::vector<NamedTable> FailureTablesOf(const Results& results);

}  // namespace lookout::eval
