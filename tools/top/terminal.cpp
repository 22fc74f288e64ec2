// Functions instead of macros: theirs cast in the old style.
#define NCURSES_NOMACROS 1
#include "tools/top/terminal.hpp"

#include <ncurses.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace lookout::top {

namespace {

// Colour pairs; 0 is the terminal's own.
constexpr short kWarningPair = 1;
constexpr short kFaultPair = 2;
constexpr short kAlarmPair = 3;

// Bold and reverse say the same as the colour, for terminals without.
attr_t AttributesOf(Style style) {
  const auto colour = [](short pair) { return has_colors() ? static_cast<attr_t>(COLOR_PAIR(pair)) : attr_t{0}; };
  switch (style) {
    case Style::kHeader:
      return A_REVERSE;
    case Style::kFaint:
      return A_DIM;
    case Style::kWarning:
      return colour(kWarningPair);
    case Style::kFault:
      return colour(kFaultPair) | A_BOLD;
    case Style::kAlarm:
      return has_colors() ? colour(kAlarmPair) | A_BOLD : A_REVERSE | A_BOLD;
    case Style::kPlain:
      break;
  }
  return A_NORMAL;
}

}  // namespace

Terminal::Terminal() {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0) throw std::runtime_error("this is no terminal; --once prints one screen as text");
  if (newterm(nullptr, stdout, stdin) == nullptr) {
    const char* kind = std::getenv("TERM");
    throw std::runtime_error("the terminal '" + std::string(kind == nullptr ? "" : kind) +
                             "' (TERM) is not known here; --once prints one screen as text");
  }
  cbreak();
  noecho();
  nodelay(stdscr, true);
  keypad(stdscr, true);
  curs_set(0);
  if (has_colors()) {
    start_color();
    use_default_colors();
    init_pair(kWarningPair, COLOR_YELLOW, -1);
    init_pair(kFaultPair, COLOR_RED, -1);
    init_pair(kAlarmPair, COLOR_WHITE, COLOR_RED);
  }
}

Terminal::~Terminal() { endwin(); }

int Terminal::width() const { return getmaxx(stdscr); }

int Terminal::height() const { return getmaxy(stdscr); }

void Terminal::Show(const std::vector<Row>& rows) {
  erase();
  for (std::size_t y = 0; y < rows.size(); ++y) {
    move(static_cast<int>(y), 0);
    for (const auto& span : rows[y]) {
      attrset(static_cast<int>(AttributesOf(span.style)));
      addnstr(span.text.c_str(), static_cast<int>(span.text.size()));
    }
  }
  attrset(A_NORMAL);
  refresh();
}

int Terminal::Key() {
  const int key = getch();
  return key == ERR || key == KEY_RESIZE ? 0 : key;
}

}  // namespace lookout::top
