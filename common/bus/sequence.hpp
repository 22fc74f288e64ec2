// Counts messages that did not come, from gaps in their sequence numbers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace lookout::bus {

class SequenceWatch {
 public:
  /// Takes the number of the next message. A number that is not greater than the last is a new start of the publisher, no loss.
  ///
  /// @param part_index, num_parts  place within a scan that goes in parts; parts of one scan share `seq`
  /// @return how many messages are missing between the last and this one (at least: parts of scans that are missing whole count once)
  std::int64_t NumLostBefore(std::int64_t seq, std::int64_t part_index = 0, std::int64_t num_parts = 1) {
    std::int64_t num_lost = 0;
    // A first message may be in the middle of a run: nothing was lost before it that we asked for.
    if (last_ && seq == last_->seq && part_index > last_->part_index) {
      num_lost = part_index - last_->part_index - 1;
    } else if (last_ && seq > last_->seq) {
      // Numbers come from outside: subtract as unsigned, so that no pair of them overflows.
      const std::uint64_t distance = static_cast<std::uint64_t>(seq) - static_cast<std::uint64_t>(last_->seq);
      if (distance <= kMaxDistance) {
        num_lost = static_cast<std::int64_t>(distance) - 1 + (last_->num_parts - last_->part_index - 1) + part_index;
      }
    }
    last_ = Place{seq, part_index, num_parts};
    return num_lost > 0 ? num_lost : 0;
  }

 private:
  // A greater jump is a corrupt number, not a loss.
  static constexpr std::uint64_t kMaxDistance = 1'000'000'000;

  struct Place {
    std::int64_t seq;
    std::int64_t part_index;
    std::int64_t num_parts;
  };
  std::optional<Place> last_;
};

/// Counts scans that came whole, and such of which something or all was lost, from the places of their messages in order. A message of a channel
/// without parts counts as a scan.
class WholeCount {
 public:
  /// @param part_index  -1 = not known: then only scans that are lost whole show
  /// @param num_lost    messages that are missing before this one, by who knows the stream
  void Note(std::int64_t seq, std::int64_t part_index, std::int64_t num_parts, std::int64_t num_lost) {
    if (part_index < 0) {
      if (last_ && seq == last_->seq && num_lost == 0) return;  // of the same scan
      part_index = 0;
      num_parts = 1;
    }
    if (last_ && seq == last_->seq) {
      if (num_lost > 0) Tear();
    } else {
      if (last_ && num_lost > 0 && seq > last_->seq) {
        if (last_->part_index < last_->num_parts - 1) Tear();
        // Whole scans between; never more than messages.
        const std::uint64_t distance = static_cast<std::uint64_t>(seq) - static_cast<std::uint64_t>(last_->seq);
        num_lost_ += static_cast<std::int64_t>(std::min(distance - 1, static_cast<std::uint64_t>(num_lost)));
        is_torn_ = false;
        if (part_index > 0) Tear();
      } else {
        is_torn_ = part_index > 0;  // the first that is heard of it: nothing was lost that we asked for
      }
    }
    last_ = Place{seq, part_index, num_parts};
    if (!is_torn_ && part_index >= num_parts - 1) ++num_whole_;
  }

  std::int64_t num_whole() const { return num_whole_; }
  std::int64_t num_lost() const { return num_lost_; }

 private:
  void Tear() {
    if (!is_torn_) ++num_lost_;
    is_torn_ = true;
  }

  struct Place {
    std::int64_t seq;
    std::int64_t part_index;
    std::int64_t num_parts;
  };
  std::optional<Place> last_;
  bool is_torn_ = false;  // the scan of `last_`
  std::int64_t num_whole_ = 0;
  std::int64_t num_lost_ = 0;
};

}  // namespace lookout::bus
