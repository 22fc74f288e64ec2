// The pieces of SEGMENTS, cell by cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lookout/segments_t.hpp"

namespace lookout::messages {

/// [cells] piece of each cell of a part, 0 where its label is not above 0. Where a scan goes without pieces, each segment is one, of its own number.
///
/// @param part  well-formed
inline std::vector<std::int16_t> PiecesOf(const segments_t& part) {
  std::vector<std::int16_t> piece(part.label.size(), 0);
  std::size_t next = 0;
  for (std::size_t cell = 0; cell < piece.size(); ++cell) {
    if (part.label[cell] > 0) piece[cell] = part.piece.empty() ? part.label[cell] : part.piece[next++];
  }
  return piece;
}

}  // namespace lookout::messages
