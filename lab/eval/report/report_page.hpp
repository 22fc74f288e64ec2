// The results as one JSON, and the page that shows it.
#pragma once

#include <ostream>
#include <string>

#include "lab/eval/methods/results.hpp"

namespace lookout::eval {

/// Every number that the page shows, as JSON in one line; lab/eval/page/README.md describes its fields.
///
/// Control characters and bytes that are not UTF-8 are "?", a value that is no number is null. It holds no "<", so no text can end the <script> in
/// which it stands.
std::string JsonOf(const Results& results);

/// Writes the page: one HTML file with its data, style and script; it needs nothing from the network. Equal results give equal bytes.
void WriteHtml(const Results& results, std::ostream& out);

}  // namespace lookout::eval
