// lcm-log files. Written and read by code of our own: LCM's writer does not tell errors of the disk, its reader takes a damaged length at its word
// and then reads over the rest of the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::bus {

/// Bytes of an event in front of its channel's name. All numbers big-endian: sync word u32, event number i64, time i64 (us), length of the channel
/// i32, length of the data i32 (LCM: lcm/eventlog.c).
inline constexpr std::size_t kLogEventHeaderBytes = 28;
inline constexpr std::uint32_t kLogSyncWord = 0xEDA1DA01;

/// LCM's own channels have at most 63 characters and never none: its reader stops at an event without name.
inline constexpr std::size_t kMaxLogChannelBytes = 63;

/// Greatest part of an event that is held at a time, and greatest event that the recorder writes. A log of others may have larger events (a camera on
/// the same bus), up to the 2 GB of LCM's format: of these the reader gives this much as the beginning, and the rest by ReadData.
inline constexpr std::size_t kMaxLogDataBytes = 16U * 1024 * 1024;

struct LogEvent {
  Utime time;  // as logged: receive time, or in a replayed log the host time of the raw event
  std::string channel;
  std::vector<std::uint8_t> bytes;  // the first kMaxLogDataBytes
  std::int64_t number = 0;          // as its writer counted
  std::int64_t position_bytes = 0;  // of the event in the file
  std::size_t num_data_bytes = 0;   // of the whole message
};

/// A LogEvent without a copy, in the memory of the reader: it holds until the next call.
struct LogEventView {
  Utime time;
  std::string_view channel;
  Bytes bytes;
  std::int64_t position_bytes = 0;  // of the event in the file
  std::size_t num_data_bytes = 0;   // of the whole message; `bytes` may be its beginning
  std::int64_t number = 0;          // as its writer counted: a log may begin anew at 0, or have the same number throughout
};

class LogReader {
 public:
  /// @param on_search  called for each block while an event is looked for in damage, which may be gigabytes; what it throws comes through
  /// @throws std::runtime_error when the file cannot be opened, or is plainly another kind of file (io::WhyNot): the text says what to do
  explicit LogReader(const std::filesystem::path& file, std::function<void()> on_search = {});
  ~LogReader();
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// @return the next whole event; nullopt at the end. Damaged stretches are skipped to the next event and counted.
  std::optional<LogEvent> Next();

  /// Next without a copy. An event on a channel that is not wanted comes without its bytes, which are not read. Of an event larger than
  /// kMaxLogDataBytes only the beginning comes.
  std::optional<LogEventView> NextView(const std::function<bool(std::string_view channel)>& is_wanted);

  /// NextView, with the beginning of each event alone.
  /// @param num_wanted  how many of an event's bytes are wanted, by its channel
  std::optional<LogEventView> NextHead(const std::function<std::size_t(std::string_view channel)>& num_wanted);

  /// For a log that is being written.
  /// @return the next event; nullopt where the file ends, or ends in an event that is not whole yet: that is no damage, and is asked for again
  std::optional<LogEventView> NextHeadSoFar(const std::function<std::size_t(std::string_view channel)>& num_wanted);

  /// The data of an event that was given, from `offset` on: as many as `out` holds.
  /// @throws std::runtime_error when the file no longer holds them
  void ReadData(std::int64_t event_position_bytes, std::size_t channel_bytes, std::size_t offset, std::span<std::uint8_t> out) const;

  /// Damaged stretches, and a torn event at the end.
  std::int64_t num_damaged() const { return num_damaged_; }

  /// Where in the file the next event is looked for: behind the last one. Between two events bytes that belong to none are damage.
  std::int64_t position_bytes() const;
  std::int64_t size_bytes() const;

  /// Looks how long the file is now: it may have grown.
  void UpdateSize();

  /// Goes on at a place that position_bytes() gave in front of an event.
  void Seek(std::int64_t position_bytes);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
  std::int64_t num_damaged_ = 0;
};

/// Appends an event to `log`.
///
/// @param number   of the event in its file, from 0
/// @param channel  not empty: LCM's reader stops at an event without name
void AppendLogEvent(std::vector<std::uint8_t>& log, std::int64_t number, Utime time, std::string_view channel, Bytes bytes);

/// Appends an event of which `bytes` are only the beginning.
void AppendLogEventHead(std::vector<std::uint8_t>& log, std::int64_t number, Utime time, std::string_view channel, Bytes bytes,
                        std::size_t num_data_bytes);

/// Makes the bytes of a log out of events.
class LogWriter {
 public:
  /// Takes a piece of the log, say into an io::OutputFile; its exceptions come through.
  using Take = std::function<void(Bytes)>;

  explicit LogWriter(Take take) : take_(std::move(take)) {}

  /// Events are numbered from 0, or on from the number that was given last.
  void Write(Utime time, std::string_view channel, Bytes bytes);

  /// An event with a number of its own, of which more data follow by Append where `num_data_bytes` are more than `bytes`.
  void WriteNumbered(std::int64_t number, Utime time, std::string_view channel, Bytes bytes, std::size_t num_data_bytes);
  void Append(Bytes bytes);

  /// Hands on the written bytes: else the last of them stay behind.
  void Flush();

  std::int64_t num_bytes() const { return num_bytes_; }
  std::int64_t next_number() const { return next_number_; }

 private:
  Take take_;
  std::vector<std::uint8_t> block_;
  std::int64_t next_number_ = 0;
  std::int64_t num_bytes_ = 0;
};

}  // namespace lookout::bus
