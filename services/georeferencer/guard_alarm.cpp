#include "services/georeferencer/guard_alarm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lookout::georeferencer {

namespace {

using std::chrono::microseconds;

// Above the longest scan (0.2 s at 300 rpm), and with it below the time to unwatched: one step of the clock alone says nothing.
constexpr std::chrono::milliseconds kGreatestStep(250);

}  // namespace

void GuardAlarm::Add(const ScanHead& head, const std::optional<NearestPoint>& nearest) {
  const ScanKey key{ToUtimeUs(head.time), head.seq};
  if (key == last_whole_) return;  // came twice
  const auto ended = assembler_.Add({key.first, key.second, head.part_index, head.num_parts, head.scan_flags, nearest});
  if (!ended.incomplete.empty()) Evaluate(ended.incomplete, false);
  if (ended.whole.empty()) return;
  const bool is_one_scan = std::ranges::all_of(ended.whole, [&head](const ZonePart& part) { return part.num_parts == head.num_parts; });
  if (is_one_scan) last_whole_ = key;
  Evaluate(ended.whole, is_one_scan);
}

void GuardAlarm::Evaluate(const std::vector<ZonePart>& parts, bool has_all_parts) {
  Seen scan{Utime(microseconds(parts.front().utime_us)), has_all_parts, std::nullopt};
  for (const auto& part : parts) {
    if (part.scan_flags != 0) scan.is_whole = false;
    KeepNearer(scan.nearest, part.nearest);
  }
  Evaluate(scan);
}

void GuardAlarm::Evaluate(const Seen& scan) {
  ++(scan.is_whole ? num_whole_ : num_partial_);
  if (newest_ && std::chrono::abs(scan.time - *newest_) > kTimeToClear) {
    // Another run, or a gap: nobody looked meanwhile, so an alarm that stands is not cleared by it.
    window_.clear();
    last_seen_ = scan.time;
    num_clear_ = 0;
  }
  newest_ = scan.time;
  std::erase_if(window_, [&scan](const Seen& seen) { return std::chrono::abs(scan.time - seen.time) > kTimeToClear; });
  if (scan.is_whole || scan.nearest) window_.push_back(scan);
  if (window_.size() > kWindowScans) window_.pop_front();

  if (scan.nearest) {
    last_nearest_ = *scan.nearest;
    last_seen_ = scan.time;
    num_clear_ = 0;
  } else if (scan.is_whole) {
    ++num_clear_;
  }
  if (!is_raised_ && std::ranges::count_if(window_, [](const Seen& seen) { return seen.nearest.has_value(); }) >= kScansToRaise) {
    is_raised_ = true;
    ++num_alarms_;
  } else if (is_raised_ && num_clear_ >= static_cast<std::int64_t>(kWindowScans) && scan.time - last_seen_ >= kTimeToClear) {
    is_raised_ = false;
  }

  if (!scan.is_whole) {
    ++num_partial_since_;
    return;
  }
  unseen_ = microseconds(0);
  num_partial_since_ = 0;
  if (std::ranges::count_if(window_, &Seen::is_whole) >= kScansToRaise) {
    is_watched_ = true;
    unwatched_ = microseconds(0);
  }
}

void GuardAlarm::AdvanceTo(Utime host_time) {
  const auto step = host_time_ ? std::clamp(host_time - *host_time_, microseconds(0), microseconds(kGreatestStep)) : microseconds(0);
  host_time_ = host_time;
  unseen_ += step;
  unwatched_ += step;
  if (is_watched_ && unwatched_ >= kTimeToUnwatched) {
    is_watched_ = false;
    ++num_times_unwatched_;
  }
}

std::optional<NearestPoint> GuardAlarm::nearest() const {
  if (!is_raised_) return std::nullopt;
  std::optional<NearestPoint> nearest;
  for (const auto& seen : window_) KeepNearer(nearest, seen.nearest);
  return nearest ? nearest : last_nearest_;
}

std::string GuardAlarm::UnwatchedText() const {
  if (!is_unwatched()) return {};
  std::string text = "guard zone not watched: no whole scan yet";
  if (num_whole_ > 0 && unseen_ >= kTimeToUnwatched) {
    text = fmt::format("guard zone not watched: no whole scan for {:.1f} s", ToSeconds(unseen_));
  } else if (num_whole_ > 0) {
    text = fmt::format("guard zone not watched: less than {} whole scans within {:.1f} s", kScansToRaise, ToSeconds(kTimeToClear));
  }
  if (num_partial_since_ > 0) {
    text += fmt::format(", {} that were not whole: lost packets or a second sender, see HEALTH of vlp16 and segmenter", num_partial_since_);
  }
  return text;
}

std::vector<Counter> GuardAlarm::counters() const {
  std::vector<Counter> counters{{"alarm_active", is_active() ? 1 : 0}, {"alarms", num_alarms_}};
  if (const auto point = nearest()) counters.push_back({"nearest_cm", std::llround(100.0 * point->range_m)});
  counters.push_back({"zone_unwatched", is_unwatched() ? 1 : 0});
  counters.push_back({"zone_times_unwatched", num_times_unwatched_});
  counters.push_back({"scans_whole", num_whole_});
  counters.push_back({"scans_partial", num_partial_});
  return counters;
}

}  // namespace lookout::georeferencer
