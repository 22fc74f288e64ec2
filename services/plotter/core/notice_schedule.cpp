#include "services/plotter/core/notice_schedule.hpp"

#include <limits>
#include <set>

namespace lookout::plotter {

namespace {

constexpr int kMostRevision = 99;

bool HasChanged(const Notice& one, const Notice& other) { return one.level != other.level || one.state != other.state || one.raised != other.raised; }

}  // namespace

std::int64_t KeyOf(const Notice& notice) {
  return notice.id != 0 ? notice.id : std::numeric_limits<std::int64_t>::min() + static_cast<std::int64_t>(notice.cause);
}

std::vector<NoticeSchedule::Due> NoticeSchedule::Take(std::span<const Notice> notices, std::chrono::microseconds now) {
  std::vector<Due> due;
  std::set<std::int64_t> keys;
  for (const auto& notice : notices) {
    const auto key = KeyOf(notice);
    if (!keys.insert(key).second || notice.is_old) continue;  // a key twice: the first counts
    const auto found = sent_.find(key);
    if (notice.state == NoticeState::kCleared && found == sent_.end()) continue;  // nobody was told of it
    int revision = 1;
    if (found != sent_.end()) {
      auto& [last, last_revision, time] = found->second;
      const bool has_changed = HasChanged(last, notice);
      if (!has_changed && time && now - *time < kPeriod) continue;
      revision = has_changed ? last_revision % kMostRevision + 1 : last_revision;
    }
    due.push_back({notice, revision});
    if (notice.state == NoticeState::kCleared) {
      sent_.erase(key);
    } else {
      sent_.insert_or_assign(key, Sent{notice, revision, now});
    }
  }
  for (auto sent = sent_.begin(); sent != sent_.end();) {
    if (keys.contains(sent->first)) {
      ++sent;
      continue;
    }
    due.push_back({sent->second.notice, sent->second.revision % kMostRevision + 1});
    due.back().notice.state = NoticeState::kCleared;
    sent = sent_.erase(sent);
  }
  return due;
}

void NoticeSchedule::SendAnew() {
  for (auto& [key, sent] : sent_) sent.time.reset();
}

}  // namespace lookout::plotter
