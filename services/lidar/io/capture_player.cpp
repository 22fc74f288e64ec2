#include "services/lidar/io/capture_player.hpp"

#include <algorithm>
#include <utility>

namespace lookout::lidar {

CapturePlayer::CapturePlayer(const std::vector<std::filesystem::path>& files, double speed) : files_(files), speed_(speed) {
  readers_.reserve(files.size());
  for (const auto& file : files) readers_.emplace_back(file);
  ReadNext();
}

void CapturePlayer::ReadNext() {
  while (!next_ && reader_index_ < readers_.size()) {
    auto& reader = readers_[reader_index_];
    next_ = reader.Next(kMaxFramesPerCall);
    if (!next_ && !reader.is_at_end()) return;
    if (!next_) ++reader_index_;
  }
  if (!next_) return;
  if (!std::exchange(has_begun_, true)) last_stamp_ = next_->host_time;
  const auto step = next_->host_time - last_stamp_;
  num_stamp_jumps_ += step < std::chrono::microseconds(0) || step > kMaxPause ? 1 : 0;
  // Steps back count too: frames of one moment that changed places must not make the playing longer.
  if (step >= -kMaxPause && step <= kMaxPause) next_due_ += step;
}

std::chrono::microseconds CapturePlayer::ToRecorded(std::chrono::microseconds elapsed) const {
  return std::chrono::duration_cast<std::chrono::microseconds>(elapsed * speed_);
}

std::optional<Datagram> CapturePlayer::NextDue(std::chrono::microseconds elapsed) {
  if (!next_) ReadNext();
  if (!next_ || (speed_ > 0.0 && next_due_ > ToRecorded(elapsed))) return std::nullopt;
  auto datagram = std::exchange(next_, std::nullopt);
  last_stamp_ = datagram->host_time;
  last_due_ = next_due_;
  ReadNext();
  return datagram;
}

Utime CapturePlayer::CaptureTime(std::chrono::microseconds elapsed) const {
  if (!next_ && !is_finished()) return last_stamp_;
  auto recorded = ToRecorded(elapsed);
  if (next_) recorded = std::min(recorded, next_due_);
  return last_stamp_ + std::max(recorded - last_due_, std::chrono::microseconds(0));
}

std::vector<Counter> CapturePlayer::counters() const {
  std::vector<Counter> sum;
  for (const auto& reader : readers_) {
    const auto counters = reader.counters();
    if (sum.empty()) {
      sum = counters;
      continue;
    }
    for (std::size_t i = 0; i < counters.size(); ++i) sum[i].count += counters[i].count;
  }
  sum.push_back({"captures_read", static_cast<std::int64_t>(reader_index_)});
  sum.push_back({"capture_stamp_jumps", num_stamp_jumps_});
  return sum;
}

std::vector<std::string> CapturePlayer::Warnings() const {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    const auto& reader = readers_[i];
    if (reader.num_damaged() > 0) warnings.push_back(files_[i].string() + ": " + reader.damage());
    if (i < reader_index_ && reader.num_datagrams() == 0) {
      warnings.push_back(files_[i].string() + ": no datagram in " + std::to_string(reader.num_frames()) + " frames");
    }
  }
  return warnings;
}

}  // namespace lookout::lidar
