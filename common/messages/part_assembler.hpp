// Merges the parts of one scan that come over one channel.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "common/messages/checks.hpp"

namespace lookout::messages {

/// A message that holds more than a number of parts has an overload of its own (checks.hpp).
template <typename Part>
bool AgreeAboutScan(const Part& one, const Part& other) {
  return one.num_parts == other.num_parts;
}

/// Parts of one scan share utime_us and seq; they may come in any order. A part of another scan begins that scan and ends the one before. Nothing is
/// kept of a complete scan, so that the same parts make the same scans at any time.
///
/// @tparam Part  a message in parts, or the part of one that a process keeps: with utime_us, seq, part_index and num_parts
template <typename Part>
class PartAssembler {
 public:
  struct Counts {
    std::int64_t incomplete_scans = 0;    // ended by the next scan before all of their parts had come
    std::int64_t duplicate_parts = 0;     // refused
    std::int64_t inconsistent_parts = 0;  // refused: they disagree with the parts before about their scan
  };

  /// The scan that ended with a part, by part_index; both may be empty.
  struct Ended {
    std::vector<Part> incomplete;  // the scan before, which lacks parts
    std::vector<Part> whole;       // the scan that this part completes
  };

  /// Precondition: part_index lies between 0 and num_parts - 1.
  Ended Add(Part part) {
    Ended ended;
    if (!parts_.empty()) {
      const Part& first = parts_.begin()->second;
      if (first.utime_us != part.utime_us || first.seq != part.seq) {
        ++counts_.incomplete_scans;
        ended.incomplete = TakeParts();
      } else if (!AgreeAboutScan(first, part)) {
        ++counts_.inconsistent_parts;
        return ended;
      } else if (parts_.contains(part.part_index)) {
        ++counts_.duplicate_parts;
        return ended;
      }
    }
    const auto num_parts = static_cast<std::size_t>(part.num_parts);
    const auto part_index = part.part_index;
    parts_.emplace(part_index, std::move(part));
    if (parts_.size() == num_parts) ended.whole = TakeParts();
    return ended;
  }

  /// Whether no part waits for others: then a scan of one part is whole by itself, and need not be copied to here.
  bool is_empty() const { return parts_.empty(); }

  const Counts& counts() const { return counts_; }

 private:
  std::vector<Part> TakeParts() {
    std::vector<Part> parts;
    for (auto& [part_index, part] : parts_) parts.push_back(std::move(part));
    parts_.clear();
    return parts;
  }

  std::map<std::int32_t, Part> parts_;  // of one scan, by part_index
  Counts counts_;
};

}  // namespace lookout::messages
