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

/// Key of a notice as long as it lives: the id of the alert; one of its own for each that is the plotter's own.
std::int64_t KeyOf(const Notice& notice);

/// One raising of it: a tracker that began anew gives the same ids to other alerts.
using RaisedKey = std::pair<std::int64_t, Utime>;
RaisedKey RaisedKeyOf(const Notice& notice);
/// The same as a text.
std::string SubjectOf(const Notice& notice);

/// A warning that nobody has acknowledged is told anew after each so long.
inline constexpr std::chrono::minutes kEscalateAfter{5};

/// How often a warning has been told anew: 0 to 9, and after 9 comes 1. 0 of what wants no acknowledgement.
int EscalationOf(const Notice& notice);

/// A notice as it was told last.
struct ToldNotice {
  Notice notice;
  int revision = 1;  // 1 to 99: goes up with each change
};

/// A notice is due when it is new, when its level, its state, its sound or its escalation has changed, and every kPeriod while it is not cleared. A
/// notice that is gone is told as cleared; an old one (is_old) is left as it was told. A clearing is told twice more, and to each new receiver for
/// kEndedFor: else one lost message leaves an alarm standing. Time is host time passed.
class NoticeSchedule {
 public:
  /// kRaising: each raising of an alert is told by itself. kId: a receiver knows them by their ids alone, so what is raised anew under the id of
  /// another is that one, changed.
  enum class Identity { kRaising, kId };
  explicit NoticeSchedule(Identity identity = Identity::kRaising) : identity_(identity) {}

  static constexpr std::chrono::seconds kPeriod{10};
  static constexpr std::chrono::minutes kEndedFor{10};
  static constexpr std::size_t kMostEnded = 200;

  struct Due {
    Notice notice;
    int revision = 1;        // 1 to 99: goes up with each change
    bool is_repeat = false;  // of a notice that was told before: it can wait
  };

  /// @param notices  all that are there now; where the output has no words for sound, without it
  std::vector<Due> Take(std::span<const Notice> notices, std::chrono::microseconds now);

  /// A new receiver knows of none.
  void SendAnew();

  /// Those that were told and are not over, by KeyOf.
  std::vector<ToldNotice> Standing() const;
  /// With the next Take.
  void TellAgain(const Notice& notice);

  /// Those whose revisions the next process needs: standing ones, those that ended within kEndedFor, and those of the process before that were not
  /// told yet.
  std::vector<ToldNotice> Kept() const;

  /// Of the process before: its notices keep their revisions, and one that changed meanwhile has the next. No notice is made of them. After kEndedFor
  /// they are forgotten.
  void Recall(std::span<const ToldNotice> notices);

 private:
  struct Sent {
    Notice notice;
    int revision = 1;
    std::chrono::microseconds next{0};  // when it is told again
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
