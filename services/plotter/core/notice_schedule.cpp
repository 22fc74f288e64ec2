#include "services/plotter/core/notice_schedule.hpp"

#include <algorithm>
#include <limits>
#include <set>

namespace lookout::plotter {

namespace {

using namespace std::chrono_literals;

constexpr int kMostRevision = 99;
// After it was told as cleared.
constexpr int kRepeats = 2;
constexpr auto kRepeatAfter = 3s;

bool HasChanged(const Notice& one, const Notice& other) {
  return one.level != other.level || one.state != other.state || one.sound != other.sound || one.escalation != other.escalation ||
         one.raised != other.raised;
}

int Next(int revision) { return revision % kMostRevision + 1; }

}  // namespace

std::int64_t KeyOf(const Notice& notice) {
  return notice.id != 0 ? notice.id : std::numeric_limits<std::int64_t>::min() + static_cast<std::int64_t>(notice.cause);
}

RaisedKey RaisedKeyOf(const Notice& notice) { return {KeyOf(notice), notice.raised}; }

int EscalationOf(const Notice& notice) {
  constexpr int kMost = 9;
  if (notice.level != Level::kWarning || notice.state != NoticeState::kActive) return 0;
  const auto count = notice.unchanged_for / std::chrono::microseconds(kEscalateAfter);
  return count <= 0 ? 0 : static_cast<int>((count - 1) % kMost + 1);
}

std::string SubjectOf(const Notice& notice) { return std::to_string(KeyOf(notice)) + " " + std::to_string(ToUtimeUs(notice.raised)); }

RaisedKey NoticeSchedule::KeyFor(const Notice& notice) const {
  return identity_ == Identity::kId ? RaisedKey{KeyOf(notice), Utime{}} : RaisedKeyOf(notice);
}

void NoticeSchedule::End(Sent sent, std::chrono::microseconds now, std::vector<Due>& due) {
  sent.notice.state = NoticeState::kCleared;
  sent.notice.sound = Sound::kQuiet;
  sent.revision = Next(sent.revision);
  sent.next = now + kRepeatAfter;
  due.push_back({sent.notice, sent.revision, false});
  ended_.push_back({std::move(sent), now, 0});
  if (ended_.size() > kMostEnded) ended_.erase(ended_.begin());
}

void NoticeSchedule::RepeatEnded(std::chrono::microseconds now, std::vector<Due>& due) {
  std::erase_if(ended_, [now](const Ended& one) { return now - one.ended >= kEndedFor; });
  for (auto& one : ended_) {
    if (one.num_repeats >= kRepeats || now < one.sent.next) continue;
    ++one.num_repeats;
    due.push_back({one.sent.notice, one.sent.revision, one.sent.next != 0s});
    one.sent.next = now + kRepeatAfter;
  }
}

// An alert that is raised again after its end is the same alert with the next revision: its end is repeated no more.
int NoticeSchedule::FirstRevision(const RaisedKey& key, const Notice& notice) {
  const auto ended = std::ranges::find(ended_, key, [this](const Ended& one) { return KeyFor(one.sent.notice); });
  if (ended != ended_.end()) {
    const int revision = Next(ended->sent.revision);
    ended_.erase(ended);
    return revision;
  }
  const auto recalled = recalled_.find(key);
  if (recalled == recalled_.end()) return 1;
  const auto before = recalled->second;
  recalled_.erase(recalled);
  return HasChanged(before.notice, notice) ? Next(before.revision) : before.revision;
}

std::vector<NoticeSchedule::Due> NoticeSchedule::Take(std::span<const Notice> notices, std::chrono::microseconds now) {
  std::vector<Due> due;
  std::set<RaisedKey> keys;
  if (!first_take_) first_take_ = now;
  if (now - *first_take_ >= kEndedFor) recalled_.clear();
  for (const auto& notice : notices) {
    const auto key = KeyFor(notice);
    keys.insert(key);
    if (notice.is_old) continue;
    const auto found = sent_.find(key);
    if (found == sent_.end()) {
      if (notice.state == NoticeState::kCleared) continue;  // nobody was told of the alert, or its end was told already
      const int revision = FirstRevision(key, notice);
      due.push_back({notice, revision, false});
      sent_.emplace(key, Sent{notice, revision, now + kPeriod});
      continue;
    }
    Sent& sent = found->second;
    const bool has_changed = HasChanged(sent.notice, notice);
    if (!has_changed && now < sent.next) continue;
    sent.notice = notice;
    if (notice.state == NoticeState::kCleared) {
      End(std::move(sent), now, due);
      sent_.erase(found);
      continue;
    }
    if (has_changed) sent.revision = Next(sent.revision);
    const bool is_repeat = !has_changed && sent.next != 0s;
    sent.next = now + kPeriod;
    due.push_back({notice, sent.revision, is_repeat});
  }
  for (auto sent = sent_.begin(); sent != sent_.end();) {
    if (keys.contains(sent->first)) {
      ++sent;
      continue;
    }
    End(std::move(sent->second), now, due);
    sent = sent_.erase(sent);
  }
  RepeatEnded(now, due);
  return due;
}

void NoticeSchedule::SendAnew() {
  for (auto& [key, sent] : sent_) sent.next = {};
  for (auto& one : ended_) {
    one.sent.next = {};
    one.num_repeats = kRepeats - 1;
  }
}

std::vector<ToldNotice> NoticeSchedule::Standing() const {
  std::vector<ToldNotice> standing;
  standing.reserve(sent_.size());
  for (const auto& [key, sent] : sent_) standing.push_back({sent.notice, sent.revision});
  return standing;
}

std::vector<ToldNotice> NoticeSchedule::Kept() const {
  auto kept = Standing();
  for (const auto& one : ended_) kept.push_back({one.sent.notice, one.sent.revision});
  for (const auto& [key, told] : recalled_) kept.push_back(told);
  return kept;
}

void NoticeSchedule::TellAgain(const Notice& notice) {
  if (const auto found = sent_.find(KeyFor(notice)); found != sent_.end()) found->second.next = {};
}

void NoticeSchedule::Recall(std::span<const ToldNotice> notices) {
  for (const auto& told : notices) recalled_.emplace(KeyFor(told.notice), told);
}

}  // namespace lookout::plotter
