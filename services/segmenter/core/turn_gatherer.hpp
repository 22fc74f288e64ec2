// Puts the parts of a turn together again.
#pragma once

#include <map>
#include <optional>
#include <string_view>

#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter {

class TurnGatherer {
 public:
  struct Counts {
    std::int64_t incomplete_turns = 0;    // dropped because the next turn began before all of their parts had come
    std::int64_t inconsistent_turns = 0;  // dropped because the columns of their parts overlap or leave gaps
    std::int64_t duplicate_parts = 0;     // refused
    std::int64_t inconsistent_parts = 0;  // refused: of the same turn as the parts before, but they disagree about it
  };

  /// Takes a part. Parts of one turn share seq and time; they may come in any order. A part of another turn begins that turn and ends the
  /// one before. Nothing is kept of a turn that is complete, so that the same parts give the same turns at any time.
  ///
  /// @return the turn, when this part completes it
  std::optional<Scan> Add(ScanPart part);

  const Counts& counts() const { return counts_; }

 private:
  std::map<int, ScanPart> parts_;  // of one turn, by part_index
  Counts counts_;
};

}  // namespace lookout::segmenter
