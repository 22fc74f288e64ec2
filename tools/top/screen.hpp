// The screen as rows of text: a pure function of the board, the time and the size of the terminal.
#pragma once

#include <string>
#include <vector>

#include "tools/top/board.hpp"

namespace lookout::top {

enum class Style { kPlain, kHeader, kFaint, kWarning, kFault, kAlarm };

struct Span {
  std::string text;  // printable ASCII
  Style style = Style::kPlain;
};
using Row = std::vector<Span>;

struct View {
  int width = 80;
  int height = 0;          // 0 = as many rows as needed
  bool sure_only = false;  // obstacles that the segmenter is sure of; else all
  bool has_tracks = true;  // tracks in place of obstacles, where there is a tracker
};

/// Alerts that nobody has acknowledged, and that nobody looks, stand on top while there are any, then the own ship. Below are channels (left)
/// and processes (right), then tracks or the nearest obstacles: ten in text, as many as there is room for on a terminal. Keys stand in the free
/// corner below the processes, or last. Where rows are scarce obstacles beyond the tenth go first, then the title, the ninth and tenth obstacle, the
/// head of the tables, the farthest obstacles but three, and the last channels. Columns that do not fit whole are left out.
///
/// @param title  printable; time, bus, version
/// @return at most view.height rows of at most view.width letters
std::vector<Row> DrawScreen(const Board& board, const std::string& title, TimePoint now, View view);

/// Without styles; no spaces at the end of a line.
std::string PlainText(const std::vector<Row>& rows);

}  // namespace lookout::top
