// Findings as aligned text.
#pragma once

#include <string>

#include "tools/doctor/finding.hpp"

namespace lookout::doctor {

/// @param has_colours  grades in colour, for a terminal
/// @return a line per finding: grade, subject, words; continued below the words where they are long; the cure behind an arrow; then a line that
///         counts faults and warnings. Ends with a new line.
std::string ToReport(const Findings& findings, bool has_colours);

/// Whether any finding is a fault.
bool HasFault(const Findings& findings);

}  // namespace lookout::doctor
