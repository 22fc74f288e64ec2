// Figures that README files show: made by a comparison of methods, kept as small CSV files, and put into marked blocks from there.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tools/eval/results.hpp"
#include "tools/eval/table.hpp"

namespace lookout::eval {

struct ReadmeFigure {
  std::string name;                   // of its file, without ending, and of its blocks
  std::vector<std::string> captions;  // lines of text: what is counted, over what, when and how it was made
  Table table;
};

/// What README files show of a run. A figure whose tables the run has not made is left out.
///
/// @param date  of the run, for the captions: "2026-11-22"
std::vector<ReadmeFigure> FiguresOf(const Results& results, const std::string& date);

/// Writes NAME.csv for each: its captions as lines that begin with "# ", then the table. Makes the folder.
///
/// @param force  replace what is there
/// @throws std::runtime_error when a file is there, or cannot be written
void WriteFigures(const std::vector<ReadmeFigure>& figures, const std::filesystem::path& folder, bool force);

/// A figure as Markdown: its table, then its captions.
///
/// @param csv   text of its file
/// @param file  its name, for faults
/// @throws std::runtime_error "file:line: reason" when it is not what WriteFigures writes
std::string ToMarkdown(std::string_view csv, const std::string& file);

/// Puts figures into a text. A block begins with a line "<!-- figures: NAME -->" and ends with a line "<!-- end -->"; what stands between becomes
/// ToMarkdown of NAME.csv. All else stays as it is.
///
/// @param file  name of the text, for faults
/// @throws std::runtime_error "file:line: reason" for a block without end, an end without block, a name of which there is no file, or a wrong file
std::string FillBlocks(std::string_view text, const std::filesystem::path& figures_folder, const std::string& file);

}  // namespace lookout::eval
