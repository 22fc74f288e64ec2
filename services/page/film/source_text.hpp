// An element of `sources` (PROTOCOL.md).
#pragma once

#include <string>

#include "services/page/film/timeline.hpp"

namespace lookout::page {

struct SourceFacts {
  int id = 0;
  std::string name;
  bool is_growing = false;
  bool is_indexed = true;
  std::string boat_text = "null";  // BoatText
};

/// JSON text of the array.
std::string SourcesTextOf(const std::vector<std::pair<SourceFacts, const Timeline*>>& sources);

}  // namespace lookout::page
