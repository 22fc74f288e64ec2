// Picks one turn, with all its parts, out of a stream of parts.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "lookout/lidar_scan_t.hpp"

namespace lookout::exporter {

/// Where a part belongs, as scans, segments and obstacles say it.
struct TurnPlace {
  std::int64_t utime_us = 0;
  std::int64_t seq = 0;
  std::int32_t part_index = 0;
  std::int32_t num_parts = 1;
  std::int32_t scan_flags = 0;
};

template <typename Part>
class TurnPicker {
 public:
  /// @param seq  number of the wanted turn (the first of that number); nullopt = the last whole turn, or the last at all where none is whole
  explicit TurnPicker(std::optional<std::int64_t> seq) : seq_(seq) {}

  /// Takes the parts in the order in which they were sent.
  void Add(const TurnPlace& place, Part part) {
    if (IsDone()) return;
    const auto& last = current_.place;
    const bool is_same_turn = last.seq == place.seq && last.utime_us == place.utime_us && last.part_index < place.part_index;
    if (!current_.parts.empty() && !is_same_turn) {
      Close();
      if (IsDone()) return;
    }
    current_.place = place;
    current_.scan_flags |= place.scan_flags;
    current_.parts.push_back(std::move(part));
  }

  /// End of the input.
  void Finish() {
    if (!current_.parts.empty()) Close();
  }

  /// Whether the wanted turn is complete; never so for the last.
  bool IsDone() const { return seq_ && !chosen_.parts.empty(); }

  /// Parts of the chosen turn; empty when there is none (yet).
  const std::vector<Part>& parts() const { return chosen_.parts; }

  /// Precondition: parts() is not empty.
  const TurnPlace& place() const { return chosen_.place; }

 private:
  struct Turn {
    std::vector<Part> parts;
    TurnPlace place;              // of its last part
    std::int32_t scan_flags = 0;  // of all its parts
  };

  static bool IsWhole(const Turn& turn) {
    const bool is_cut = (turn.scan_flags & lidar_scan_t::FLAG_PARTIAL_START) != 0 || (turn.scan_flags & lidar_scan_t::FLAG_PARTIAL_END) != 0;
    return !is_cut && static_cast<std::int64_t>(turn.parts.size()) == turn.place.num_parts;
  }

  void Close() {
    auto turn = std::exchange(current_, Turn{});
    const bool is_whole = IsWhole(turn);
    if (seq_ ? turn.place.seq != *seq_ : (has_whole_ && !is_whole)) return;
    has_whole_ = is_whole;
    chosen_ = std::move(turn);
  }

  std::optional<std::int64_t> seq_;
  Turn current_;
  Turn chosen_;
  bool has_whole_ = false;
};

}  // namespace lookout::exporter
