// Frames that wait to be sent to one client: of each slot the newest only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "services/page/core/frame.hpp"
#include "services/page/core/request.hpp"

namespace lookout::page {

/// A slot holds a group of parts. The next group takes the place of one that waits; a group of which a part is gone is sent to its end first, as a
/// client that is always too slow would else never see a whole one. Slots take turns in the order in which they became ready, a group at a time.
class Slots {
 public:
  static constexpr std::size_t kMaxSlots = 128;
  static constexpr std::size_t kMaxBytes = std::size_t{16} * 1024 * 1024;

  /// @param slot   within the channel: messages of one slot replace each other
  /// @param group  messages of one group stand beside each other
  /// @param part   within the group: a part that comes again replaces the waiting one
  /// @param frame  not null
  void Put(ChannelIndex channel, std::string_view slot, std::int64_t group, int part, SharedBytes frame);

  /// @return the next frame to send; nullptr when nothing waits
  SharedBytes Take();

  /// Forgets waiting frames of other channels than these.
  void KeepOnly(const std::vector<ChannelIndex>& channels);

  bool is_empty() const { return ready_.empty(); }
  std::size_t num_bytes() const { return num_bytes_; }
  /// Frames that were not sent since newer ones came.
  std::int64_t num_replaced() const { return num_replaced_; }
  /// Frames for which there was no room.
  std::int64_t num_dropped() const { return num_dropped_; }

 private:
  using Key = std::pair<ChannelIndex, std::string>;
  using Parts = std::map<int, SharedBytes>;
  struct Slot {
    bool has_begun = false;
    std::int64_t begun_group = 0;  // the group of which a part was sent last
    Parts begun;                   // unsent parts of begun_group
    std::int64_t next_group = 0;
    Parts next;

    bool is_ready() const { return !begun.empty() || !next.empty(); }
  };

  void Forget(Parts& parts);
  // Forgets a slot without waiting frames, as of a process that has ended. @return false when all slots have frames that wait
  bool ForgetAnIdleOne();

  std::map<Key, Slot> slots_;
  std::deque<Key> ready_;  // each slot that is_ready, once
  std::size_t num_bytes_ = 0;
  std::int64_t num_replaced_ = 0;
  std::int64_t num_dropped_ = 0;
};

}  // namespace lookout::page
