// The report as one HTML page that stands alone: no script, no other file, nothing out of the network.
#pragma once

#include <ostream>

#include "tools/eval/results.hpp"

namespace lookout::eval {

/// Writes the whole page; the same results give the same bytes. Sections for which there are no results are left out. Every text is escaped;
/// what is not a number is a dash.
void WriteHtml(const Results& results, std::ostream& out);

}  // namespace lookout::eval
