// The results as tables, for the terminal and for CSV files.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "lab/eval/results.hpp"
#include "lab/eval/table.hpp"

namespace lookout::eval {

struct NamedTable {
  std::string name;  // of its file, without ending
  std::string title;
  Table table;
  bool is_printed = true;  // else in a file alone: too long for a screen, or of interest to few
};

/// All that the results hold, other worlds in columns beside ours (where the rows are of scenes: in rows below); tables without rows are left out.
/// Figures of the paper's kind are in per cent; "-" = there is none.
std::vector<NamedTable> TablesOf(const Results& results);

void PrintTables(const Results& results, std::ostream& out);

/// Writes NAME.csv for each table, and makes the folder.
///
/// @param force  replace what is there
/// @throws std::runtime_error when a file is there, or cannot be written
void WriteCsv(const Results& results, const std::filesystem::path& folder, bool force);

}  // namespace lookout::eval
