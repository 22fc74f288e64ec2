// The events of a log, and the stretches between them that belong to none.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"

namespace lookout::log {

/// Bytes of a log that are no event.
struct DamagedStretch {
  std::int64_t offset_bytes = 0;
  std::int64_t size_bytes = 0;
  std::int64_t num_events_before = 0;
};

/// How far the reading of several files is.
class ReadProgress {
 public:
  ReadProgress(std::FILE* out, const std::vector<std::filesystem::path>& files) : shown_("lookout-log", out) {
    for (const auto& file : files) {
      std::error_code error;
      const auto size_bytes = std::filesystem::file_size(file, error);
      if (!error) total_bytes_ += static_cast<std::int64_t>(size_bytes);
    }
  }

  /// @param position_bytes  in the file that is read
  void Show(std::int64_t position_bytes) {
    shown_.Update(static_cast<double>(done_bytes_ + position_bytes) / static_cast<double>(std::max<std::int64_t>(1, total_bytes_)));
  }
  /// Before lines are written.
  void Clear() { shown_.Clear(); }
  void EndFile(std::int64_t size_bytes) {
    Clear();
    done_bytes_ += size_bytes;
  }

 private:
  runtime::Progress shown_;
  std::int64_t total_bytes_ = 0;
  std::int64_t done_bytes_ = 0;
};

class EventReader {
 public:
  /// @throws std::runtime_error when the file cannot be opened
  explicit EventReader(const std::filesystem::path& file) : reader_(file, io::ThrowIfStopAsked) {}

  /// @return the next whole event; nullopt at the end
  /// @throws io::Stopped
  std::optional<bus::LogEvent> Next() {
    io::ThrowIfStopAsked();
    const auto expected_bytes = reader_.position_bytes();
    auto event = reader_.Next();
    const auto start_bytes = event ? event->position_bytes : reader_.position_bytes();  // at the end: of the file
    if (start_bytes > expected_bytes) damage_.push_back({expected_bytes, start_bytes - expected_bytes, num_events_});
    if (event) ++num_events_;
    return event;
  }

  /// Hands on, piece by piece, the bytes of an event beyond bus::kMaxLogDataBytes, which Next did not give.
  template <typename Take>
  void ReadRest(const bus::LogEvent& event, const Take& take) const {
    constexpr std::size_t kPieceBytes = 1024UL * 1024;
    std::vector<std::uint8_t> piece;
    for (auto offset = event.bytes.size(); offset < event.num_data_bytes; offset += piece.size()) {
      io::ThrowIfStopAsked();
      piece.resize(std::min(kPieceBytes, event.num_data_bytes - offset));
      reader_.ReadData(event.position_bytes, event.channel.size(), offset, piece);
      take(Bytes(piece));
    }
  }

  std::int64_t position_bytes() const { return reader_.position_bytes(); }
  std::int64_t size_bytes() const { return reader_.size_bytes(); }
  std::int64_t num_events() const { return num_events_; }
  const std::vector<DamagedStretch>& damage() const { return damage_; }

  std::int64_t num_damaged_bytes() const {
    std::int64_t sum = 0;
    for (const auto& stretch : damage_) sum += stretch.size_bytes;
    return sum;
  }

 private:
  bus::LogReader reader_;
  std::int64_t num_events_ = 0;
  std::vector<DamagedStretch> damage_;
};

}  // namespace lookout::log
