// The terminal, by way of ncurses.
#pragma once

#include <vector>

#include "tools/top/screen.hpp"

namespace lookout::top {

/// One at a time. The terminal is as it was again when this ends, also by an exception.
class Terminal {
 public:
  /// @throws std::runtime_error when standard input or output is no terminal, or ncurses does not know its kind ($TERM)
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  int width() const;
  int height() const;
  void Show(const std::vector<Row>& rows);

  /// @return a key that was pressed; 0 = none waits. A change of the terminal's size is taken care of here.
  int Key();
};

}  // namespace lookout::top
