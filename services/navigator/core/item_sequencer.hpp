// The edge towards the outside: puts sentences, ticks and marks into one sequence whose time never goes back.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/health.hpp"
#include "services/navigator/core/item.hpp"

namespace lookout::navigator {

class ItemSequencer {
 public:
  static constexpr std::chrono::milliseconds kTickPeriod{100};
  /// The host clock was set back when it falls behind its own earlier time by this much: a new start. Less than 1 s, by which the clock is set back
  /// in a leap second.
  static constexpr std::chrono::milliseconds kMaxSetBack{400};
  /// A sentence that came in by a queue and is so far off the last item is refused.
  static constexpr std::chrono::seconds kMaxStepBack{1};
  /// Ticks of a longer silence are left out: the computer slept, or its clock was set forward.
  static constexpr std::chrono::seconds kMaxTickGap{10};

  /// Advances to this host time.
  /// @return START when nothing came before or the clock was set back, else the ticks at whole multiples of kTickPeriod since the last
  std::vector<Item> AdvanceTo(Utime host_time);

  /// Lines of a datagram, or of another piece of input.
  /// @param arrival  less than the last item by up to kMaxStepBack: it waited, and gets the time of the last item
  std::vector<Item> OnLines(Utime arrival, const std::vector<std::string>& lines, const std::string& source = kUdpSource);

  /// OnLines for a sample of an IMU that does not come as a sentence.
  std::vector<Item> OnImu(Utime arrival, const StrapdownSample& sample, const std::string& source);

  /// A sentence out of the lidar. Such a sentence comes late, in a bundle, so it does not move the ticks.
  std::vector<Item> OnLidarSentence(Utime arrival, const std::string& sentence);

  /// A motion of the odometer, at the time of the host clock so far.
  ///
  /// @param end  of the motion: the time where nobody calls AdvanceTo, as in a log
  std::vector<Item> OnOdometry(Utime end, const std::string& sentence);

  /// @return END after the ticks until then; nothing when nothing came before. Later items begin a new sequence.
  std::vector<Item> Finish(Utime host_time);

  std::vector<Counter> counters() const { return {{"clock_set_back", num_clock_set_back_}, {"stale_sentence", num_stale_sentences_}}; }

 private:
  Item Make(Utime time, ItemKind kind, const std::string& source = {}, const std::string& sentence = {});
  Item Start(Utime time);
  std::vector<Item> Advance(Utime host_time);

  std::optional<Utime> last_;  // time of the last item
  Utime last_host_time_{};     // of the host clock itself, since the start; a lidar's sentence may be ahead of it
  Utime next_tick_{};
  bool has_host_clock_ = false;  // AdvanceTo or OnLines told the host's time
  std::int64_t next_seq_ = 0;
  std::int64_t num_clock_set_back_ = 0;
  std::int64_t num_stale_sentences_ = 0;
};

}  // namespace lookout::navigator
