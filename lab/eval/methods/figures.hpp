// Figures that README files show: made by a comparison of methods and put into marked blocks.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lab/eval/methods/results.hpp"
#include "lab/eval/table.hpp"

namespace lookout::eval {

struct ReadmeFigure {
  std::string name;                   // of its blocks
  std::vector<std::string> captions;  // lines of text: the count, over which scans, when and how it was made
  Table table;
};

/// Figures of a run for README files. A figure whose tables the run has not made is left out.
///
/// @param date  of the run, for the captions: "2026-11-22"
std::vector<ReadmeFigure> FiguresOf(const Results& results, const std::string& date);

/// Puts figures into a text. A block begins with a line "<!-- figures: NAME -->" and ends with a line "<!-- end -->"; the lines between become the
/// figure's table and captions, as Markdown. Blocks of figures that are not given, and all else, stay as they are.
///
/// @param file  name of the text, for errors
/// @throws std::runtime_error "file:line: reason" for a block without end, an end without block, or a name that no figure has
std::string FillBlocks(std::string_view text, const std::vector<ReadmeFigure>& figures, const std::string& file);

/// FillBlocks for files; prints what it did. @throws as FillBlocks, and for files that cannot be read or written
void FillBlocksOf(const std::vector<std::filesystem::path>& files, const std::vector<ReadmeFigure>& figures);

/// Tables of runs as figures of the same names. @param scope  of the run, in words
std::vector<ReadmeFigure> FiguresOf(const std::vector<NamedTable>& tables, const std::string& scope);

/// The present date: "2026-11-22", UTC.
std::string Today();
/// "Measured 2026-11-22 by ...": for captions of today's figures (UTC).
std::string MeasuredToday();

}  // namespace lookout::eval
