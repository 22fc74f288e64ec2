// Reads a log once, from its beginning on, and makes its index.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/sequence.hpp"
#include "services/page/film/log_part.hpp"

namespace lookout::page {

/// Whether messages of the channel get an entry: a page shows them. Raw channels and the simulator's truth get none; their losses are counted.
bool HasEntries(std::string_view channel);

/// Only the heads of large messages are read. Times of events never go back: where the host's clock was set back, later events are told as so much
/// later, and a "gap" says so. Bytes that are no message of the channel's type get no entry.
class LogIndexer {
 public:
  /// @param is_growing  an event at the end that is not whole is waited for; else it is damage
  /// @throws std::runtime_error when the file cannot be opened
  LogIndexer(const std::filesystem::path& file, bool is_growing);

  /// Reads on, about `max_bytes` of the file.
  /// @param part  new entries are appended to it
  /// @return whether the log goes on
  bool Read(std::int64_t max_bytes, LogPart& part);

  std::int64_t position_bytes() const { return reader_.position_bytes(); }
  std::int64_t size_bytes() const { return reader_.size_bytes(); }
  std::int64_t num_refused() const { return num_refused_; }

 private:
  struct Report {
    Utime time;
    std::int8_t state = -1;
  };
  // Part index and number of parts in the head of a message.
  struct Parts {
    std::int64_t index = 0;
    std::int64_t count = 1;
  };

  Utime FilmTime(bus::LogEventView& event, LogPart& part);
  void OnEvent(const bus::LogEventView& event, Utime time, LogPart& part);
  void OnAlerts(Bytes bytes, Utime time, LogPart& part);
  std::optional<std::uint16_t> OnHealth(Bytes bytes, Utime time, LogPart& part);
  void OnMark(std::string_view channel, Bytes bytes, Utime time, LogPart& part);
  void CountLoss(std::size_t channel, std::int64_t num_lost);
  void Refuse(std::size_t channel, Utime time, LogPart& part);
  void BeginSecond(Utime time, LogPart& part);
  void EndSecond(LogPart& part);
  void Tell(Utime time, FilmEventKind kind, int level, const std::string& text, LogPart& part);

  bool is_growing_;
  bus::LogReader reader_;
  std::int64_t num_damaged_told_ = 0;
  std::vector<std::uint8_t> kept_;  // bytes of an event while the next is looked at
  std::string kept_channel_;
  std::optional<Utime> last_;
  std::chrono::microseconds shift_{0};  // of entries behind a clock that was set back
  std::array<bus::SequenceWatch, bus::kChannels.size()> sequences_;
  std::array<std::int64_t, bus::kChannels.size()> num_lost_in_second_{};
  std::array<bool, bus::kChannels.size()> is_refusal_told_{};
  std::optional<SecondCell> cell_;
  std::vector<std::string> processes_;
  std::vector<Report> reports_;                                                 // by process
  std::vector<bus::SequenceWatch> process_sequences_;                           // by process
  std::map<std::pair<std::int64_t, std::int64_t>, std::int32_t> alert_levels_;  // told, by id and raised_utime_us
  std::size_t num_events_ = 0;
  std::int64_t num_refused_ = 0;
};

}  // namespace lookout::page
