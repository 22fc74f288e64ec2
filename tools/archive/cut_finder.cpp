#include "tools/archive/cut_finder.hpp"

#include <algorithm>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/nav_raw_t.hpp"

namespace lookout::archive {

Mark MarkOf(std::string_view channel, Bytes bytes) {
  constexpr std::size_t kMarkOffset = 24;  // behind fingerprint, utime_us and seq; 32 bits
  if (bytes.size() < kMarkOffset + 8) return Mark::kNone;
  const auto value = static_cast<std::int32_t>(bus::ReadU64BigEndian(bytes, kMarkOffset) >> 32U);
  if (channel != bus::kNavRaw.name) {
    if ((value & lidar_packets_t::MARK_END) != 0) return Mark::kEnd;
    return (value & lidar_packets_t::MARK_START) != 0 ? Mark::kStart : Mark::kNone;
  }
  if (value == nav_raw_t::KIND_START) return Mark::kStart;
  return value == nav_raw_t::KIND_END ? Mark::kEnd : Mark::kNone;
}

void CutFinder::NoteTime(std::int64_t time_us) {
  // An event behind a cut with a time before it would fall into the part before.
  while (!cuts_us_.empty() && time_us < cuts_us_.back()) cuts_us_.pop_back();
  if (pending_us_ && time_us < *pending_us_) pending_us_.reset();
  latest_us_ = std::max(latest_us_, time_us);
}

void CutFinder::AddRaw(std::string_view channel, std::int64_t time_us, Mark mark) {
  auto& stream = streams_[channel == bus::kLidarPackets.name ? 0 : channel == bus::kNavRaw.name ? 1 : 2];
  const auto latest_us = latest_us_;
  NoteTime(time_us);
  if (mark == Mark::kStart && stream.is_there && !pending_us_) {
    const bool have_all_ended = std::ranges::all_of(streams_, [](const Stream& one) { return !one.is_there || one.has_ended; });
    if (have_all_ended && tracker_ && latest_us < time_us) {
      pending_us_ = time_us;
      is_new_tracker_ = false;
      for (auto& one : streams_) one.has_begun_again = false;
    }
  }
  if (pending_us_ && mark == Mark::kStart) stream.has_begun_again = true;
  if (pending_us_ && !stream.has_begun_again) pending_us_.reset();  // this stream went on without a start mark, or is new
  stream.is_there = true;
  stream.has_ended = mark == Mark::kEnd;
  Confirm();
}

void CutFinder::AddAlerts(std::int64_t time_us, Bytes bytes) {
  const auto message = bus::Decode<alerts_t>(bytes);
  if (!message || message->is_watch) {
    NoteTime(time_us);
    return;
  }
  NoteTime(time_us);
  const std::pair begin{message->begin_utime_us, message->begin_seq};
  if (pending_us_ && tracker_ == begin) pending_us_.reset();  // the tracker went on
  if (pending_us_) is_new_tracker_ = true;
  tracker_ = begin;
  Confirm();
}

void CutFinder::Confirm() {
  if (!pending_us_ || !is_new_tracker_) return;
  if (!std::ranges::all_of(streams_, [](const Stream& one) { return !one.is_there || one.has_begun_again; })) return;
  cuts_us_.push_back(*pending_us_);
  pending_us_.reset();
}

}  // namespace lookout::archive
