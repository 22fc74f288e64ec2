// Which alerts are to be told on one output.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

/// Key of a notice as long as it lives: the id of the alert; each cause of the plotter's own notices has a key of its own.
std::int64_t KeyOf(const Notice& notice);

/// One raising of a notice: a tracker that began anew gives the same ids to other alerts.
using RaisedKey = std::pair<std::int64_t, Utime>;
RaisedKey RaisedKeyOf(const Notice& notice);
/// Key of one raising, as a text.
std::string SubjectOf(const Notice& notice);

/// A warning that nobody acknowledges is raised again each time that this has passed.
inline constexpr std::chrono::minutes kEscalateAfter{5};

/// How often a warning has been raised again: 0 to 9, and after 9 comes 1. 0 for a notice that wants no acknowledgement.
int EscalationOf(const Notice& notice);

/// A notice in the state that was told last.
struct ToldNotice {
  Notice notice;
  int revision = 1;  // 1 to 99: goes up with each change
};

/// A notice is due when it is new, when its level, its state, its sound or its escalation has changed, and every kPeriod while it is not cleared. A
/// notice that is gone is told as cleared; an old one (is_old) is left as it was told. A clearing is told twice more, and to each new receiver for
/// kEndedFor: else one lost message leaves an alarm standing. Time is host time passed.
class NoticeSchedule {
 public:
  /// kRaising: each raising of an alert is told by itself. kId: a receiver knows alerts by their ids alone, so a new alert under the id of an earlier
  /// one is told as a change of that one.
  enum class Identity { kRaising, kId };
  explicit NoticeSchedule(Identity identity = Identity::kRaising) : identity_(identity) {}

  static constexpr std::chrono::seconds kPeriod{10};
  static constexpr std::chrono::minutes kEndedFor{10};
  static constexpr std::size_t kMostEnded = 200;

  struct Due {
    Notice notice;
    int revision = 1;        // 1 to 99: goes up with each change
    bool is_repeat = false;  // the notice was told before, so it can wait
  };

  /// @param notices  all notices that are there now; without sound where the output has no words for sound
  std::vector<Due> Take(std::span<const Notice> notices, std::chrono::microseconds now);

  /// All notices are due again: a new receiver knows none.
  void SendAnew();

  /// Notices that were told and are not over, by KeyOf.
  std::vector<ToldNotice> Standing() const;
  /// Makes this notice due with the next Take.
  void TellAgain(const Notice& notice);

  /// Notices whose revisions the next process needs: standing notices, notices that ended within kEndedFor, and notices of the process before that
  /// were not told yet.
  std::vector<ToldNotice> Kept() const;

  /// Recalls the notices of the process before: an unchanged notice keeps its revision, a notice that changed meanwhile gets the next. None becomes
  /// due by this. After kEndedFor they are forgotten.
  void Recall(std::span<const ToldNotice> notices);

 private:
  struct Sent {
    Notice notice;
    int revision = 1;
    std::chrono::microseconds next{0};  // when the notice is told again
  };
  struct Ended {
    Sent sent;
    std::chrono::microseconds ended{0};
    int num_repeats = 0;
  };
  RaisedKey KeyFor(const Notice& notice) const;
  int FirstRevision(const RaisedKey& key, const Notice& notice);
  void End(Sent sent, std::chrono::microseconds now, std::vector<Due>& due);
  void RepeatEnded(std::chrono::microseconds now, std::vector<Due>& due);

  Identity identity_;
  std::map<RaisedKey, Sent> sent_;
  std::map<RaisedKey, ToldNotice> recalled_;
  std::optional<std::chrono::microseconds> first_take_;
  std::vector<Ended> ended_;  // the oldest first
};

}  // namespace lookout::plotter
