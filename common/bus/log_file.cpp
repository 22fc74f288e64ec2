#include "common/bus/log_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/io/file_kind.hpp"

namespace lookout::bus {

namespace {

// LCM channel names have at most 63 characters; its logs allow more. Data have no bound but that of their length, an i32.
constexpr std::int64_t kMaxChannelBytes = 1000;
// Read or written at once: system calls cost more than the copy. A scan's messages are larger: unwanted ones are passed over.
constexpr std::size_t kReadBytes = 64 * 1024;
constexpr std::size_t kJumpBytes = 4 * 1024;
constexpr std::size_t kWorthAJumpBytes = 16 * 1024;
constexpr std::size_t kWriteBytes = 16 * 1024;

std::uint64_t ReadBigEndian(Bytes bytes, std::size_t offset, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[offset + i];
  return value;
}

std::int64_t ReadI32(Bytes bytes, std::size_t offset) { return static_cast<std::int32_t>(ReadBigEndian(bytes, offset, 4)); }

}  // namespace

struct LogReader::Implementation {
  using NumWanted = std::function<std::size_t(std::string_view channel)>;

  ~Implementation() {
    if (descriptor >= 0) close(descriptor);
  }

  int descriptor = -1;
  std::int64_t size_bytes = 0;
  std::int64_t position = 0;  // of the next event
  // A stretch of the file: events follow each other, and the bytes behind an event are looked at twice.
  std::vector<std::uint8_t> block;
  std::int64_t block_offset = 0;
  std::string channel;             // of the event that was given last
  std::vector<std::uint8_t> kept;  // its beginning, where the rest was passed over
  std::function<void()> on_search;

  // @param least_bytes  to be read if any are
  // @return the bytes from `offset` on, `size` of them where the file has so many. They stand until the next call.
  Bytes View(std::int64_t offset, std::size_t size, std::size_t least_bytes = kReadBytes) {
    const auto end = offset + static_cast<std::int64_t>(size);
    if (offset < block_offset || end > block_offset + static_cast<std::int64_t>(block.size())) Load(offset, std::max(size, least_bytes));
    if (offset >= block_offset + static_cast<std::int64_t>(block.size())) return {};
    const auto within = Bytes(block).subspan(static_cast<std::size_t>(offset - block_offset));
    return within.first(std::min(size, within.size()));
  }

  void Load(std::int64_t offset, std::size_t size) {
    block_offset = offset;
    block.resize(size);
    std::size_t size_read = 0;
    while (size_read < size) {
      const auto result = pread(descriptor, block.data() + size_read, size - size_read, offset + static_cast<std::int64_t>(size_read));
      if (result < 0 && errno == EINTR) continue;
      if (result <= 0) break;
      size_read += static_cast<std::size_t>(result);
    }
    block.resize(size_read);
  }

  // The event that begins at `start`, and `position` behind it; nullopt when there is no whole one.
  std::optional<LogEventView> EventAt(std::int64_t start, const NumWanted& num_wanted) {
    const Bytes header = View(start, kLogEventHeaderBytes);
    if (header.size() < kLogEventHeaderBytes || ReadBigEndian(header, 0, 4) != kLogSyncWord) return std::nullopt;
    const auto time = UtimeFromWire(static_cast<std::int64_t>(ReadBigEndian(header, 12, 8)));
    const std::int64_t channel_size = ReadI32(header, 20);
    const std::int64_t data_size = ReadI32(header, 24);
    if (!time || channel_size <= 0 || channel_size > kMaxChannelBytes || data_size < 0) return std::nullopt;
    const std::int64_t end = start + static_cast<std::int64_t>(kLogEventHeaderBytes) + channel_size + data_size;
    if (end > size_bytes) return std::nullopt;
    const auto number = static_cast<std::int64_t>(ReadBigEndian(header, 4, 8));

    const std::size_t head_size = kLogEventHeaderBytes + static_cast<std::size_t>(channel_size);
    const std::size_t size = head_size + static_cast<std::size_t>(data_size);
    const Bytes head = View(start, head_size);
    if (head.size() < head_size) return std::nullopt;
    channel.assign(head.begin() + kLogEventHeaderBytes, head.end());  // the bytes behind the event may be another stretch
    const std::size_t given_size = std::min({num_wanted(channel), static_cast<std::size_t>(data_size), kMaxLogDataBytes});
    const bool is_jump = size - head_size - given_size >= kWorthAJumpBytes;
    const bool is_whole_given = given_size > 0 && !is_jump;
    if (is_whole_given) View(start, size + sizeof(kLogSyncWord));  // one stretch for all
    if (given_size > 0 && is_jump) {
      const Bytes given = View(start, head_size + given_size);
      if (given.size() < head_size + given_size) return std::nullopt;
      kept.assign(given.begin() + static_cast<std::ptrdiff_t>(head_size), given.end());  // the stretch at the end may be another
    }
    if (!IsWhole(start, end, is_whole_given ? kReadBytes : kJumpBytes)) return std::nullopt;
    Bytes data;
    if (is_whole_given) {
      const Bytes whole = View(start, head_size + given_size);
      if (whole.size() < head_size + given_size) return std::nullopt;
      data = whole.subspan(head_size);
    } else if (given_size > 0) {
      data = kept;
    }
    position = end;
    return LogEventView{*time, channel, data, start, static_cast<std::size_t>(data_size), number};
  }

  // Whether an event begins at `start` and the file ends before it does.
  bool IsUnfinishedAt(std::int64_t start) {
    const Bytes header = View(start, kLogEventHeaderBytes);
    if (header.size() < kLogEventHeaderBytes) return header.size() < 4 || ReadBigEndian(header, 0, 4) == kLogSyncWord;
    const std::int64_t channel_size = ReadI32(header, 20);
    const std::int64_t data_size = ReadI32(header, 24);
    if (ReadBigEndian(header, 0, 4) != kLogSyncWord || channel_size <= 0 || channel_size > kMaxChannelBytes) return false;
    if (data_size < 0 || start + static_cast<std::int64_t>(kLogEventHeaderBytes) + channel_size + data_size <= size_bytes) return false;
    // A damaged length is not waited for: events stand behind it.
    return data_size <= static_cast<std::int64_t>(kMaxLogDataBytes) || FindSync(start + 4) >= size_bytes;
  }

  // Whether the event from `start` to `end` is one event. A damaged length that fits in the file would swallow events behind it: then no
  // sync word stands at `end`, but some stand inside.
  bool IsWhole(std::int64_t start, std::int64_t end, std::size_t least_bytes) {
    if (end == size_bytes) return true;
    const Bytes word = View(end, 4, least_bytes);
    if (word.size() == 4 && ReadBigEndian(word, 0, 4) == kLogSyncWord) return true;
    return FindSync(start + 4) >= end;
  }

  // The first sync word at or after `offset`; size_bytes when there is none.
  std::int64_t FindSync(std::int64_t offset) {
    while (offset + 4 <= size_bytes) {
      if (on_search) on_search();
      const Bytes bytes = View(offset, kReadBytes);
      if (bytes.size() < 4) break;
      for (std::size_t i = 0; i + 4 <= bytes.size(); ++i) {
        if (ReadBigEndian(bytes, i, 4) == kLogSyncWord) return offset + static_cast<std::int64_t>(i);
      }
      offset += static_cast<std::int64_t>(bytes.size()) - 3;
    }
    return size_bytes;
  }
};

LogReader::LogReader(const std::filesystem::path& file, std::function<void()> on_search) : implementation_(std::make_unique<Implementation>()) {
  implementation_->on_search = std::move(on_search);
  if (const auto reason = io::WhyNot(file, io::Wanted::kLog); !reason.empty()) throw std::runtime_error(reason);
  std::error_code error;
  implementation_->size_bytes = static_cast<std::int64_t>(std::filesystem::file_size(file, error));
  implementation_->descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (error || implementation_->descriptor < 0) throw std::runtime_error(file.string() + ": cannot be opened");
}

LogReader::~LogReader() = default;

std::int64_t LogReader::position_bytes() const { return implementation_->position; }

std::int64_t LogReader::size_bytes() const { return implementation_->size_bytes; }

void LogReader::UpdateSize() {
  struct stat state {};
  if (fstat(implementation_->descriptor, &state) == 0) implementation_->size_bytes = state.st_size;
}

void LogReader::Seek(std::int64_t position_bytes) { implementation_->position = position_bytes; }

std::optional<LogEvent> LogReader::Next() {
  const auto view = NextView([](std::string_view) { return true; });
  if (!view) return std::nullopt;
  return LogEvent{view->time,   std::string(view->channel), {view->bytes.begin(), view->bytes.end()},
                  view->number, view->position_bytes,       view->num_data_bytes};
}

std::optional<LogEventView> LogReader::NextView(const std::function<bool(std::string_view channel)>& is_wanted) {
  return NextHead([&is_wanted](std::string_view channel) { return is_wanted(channel) ? kMaxLogDataBytes : 0; });
}

std::optional<LogEventView> LogReader::NextHead(const std::function<std::size_t(std::string_view channel)>& num_wanted) {
  auto& in = *implementation_;
  bool is_resynchronising = false;
  while (in.position < in.size_bytes) {
    if (const auto event = in.EventAt(in.position, num_wanted)) return event;
    if (!is_resynchronising) ++num_damaged_;
    is_resynchronising = true;
    in.position = in.FindSync(in.position + 1);
  }
  return std::nullopt;
}

std::optional<LogEventView> LogReader::NextHeadSoFar(const std::function<std::size_t(std::string_view channel)>& num_wanted) {
  auto& in = *implementation_;
  if (in.IsUnfinishedAt(in.position)) return std::nullopt;
  return NextHead(num_wanted);
}

void LogReader::ReadData(std::int64_t event_position_bytes, std::size_t channel_bytes, std::size_t offset, std::span<std::uint8_t> out) const {
  auto place = event_position_bytes + static_cast<std::int64_t>(kLogEventHeaderBytes + channel_bytes + offset);
  while (!out.empty()) {
    const auto result = pread(implementation_->descriptor, out.data(), out.size(), place);
    if (result < 0 && errno == EINTR) continue;
    if (result <= 0) throw std::runtime_error("a log has changed while it was read");
    out = out.subspan(static_cast<std::size_t>(result));
    place += result;
  }
}

void AppendLogEvent(std::vector<std::uint8_t>& log, std::int64_t number, Utime time, std::string_view channel, Bytes bytes) {
  AppendLogEventHead(log, number, time, channel, bytes, bytes.size());
}

void AppendLogEventHead(std::vector<std::uint8_t>& log, std::int64_t number, Utime time, std::string_view channel, Bytes bytes,
                        std::size_t num_data_bytes) {
  std::array<std::uint8_t, kLogEventHeaderBytes> header{};
  std::size_t place = 0;
  const auto put = [&](std::uint64_t value, int size) {
    for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) header[place++] = static_cast<std::uint8_t>(value >> shift);
  };
  put(kLogSyncWord, 4);
  put(static_cast<std::uint64_t>(number), 8);
  put(static_cast<std::uint64_t>(ToUtimeUs(time)), 8);
  put(channel.size(), 4);
  put(num_data_bytes, 4);
  log.insert(log.end(), header.begin(), header.end());
  log.insert(log.end(), channel.begin(), channel.end());
  log.insert(log.end(), bytes.begin(), bytes.end());
}

void LogWriter::Write(Utime time, std::string_view channel, Bytes bytes) { WriteNumbered(next_number_, time, channel, bytes, bytes.size()); }

void LogWriter::WriteNumbered(std::int64_t number, Utime time, std::string_view channel, Bytes bytes, std::size_t num_data_bytes) {
  AppendLogEventHead(block_, number, time, channel, bytes, num_data_bytes);
  next_number_ = number == std::numeric_limits<std::int64_t>::max() ? 0 : number + 1;
  num_bytes_ += static_cast<std::int64_t>(kLogEventHeaderBytes + channel.size() + bytes.size());
  if (block_.size() >= kWriteBytes) Flush();
}

void LogWriter::Append(Bytes bytes) {
  block_.insert(block_.end(), bytes.begin(), bytes.end());
  num_bytes_ += static_cast<std::int64_t>(bytes.size());
  if (block_.size() >= kWriteBytes) Flush();
}

void LogWriter::Flush() {
  // Bytes that were not taken are not given again: the log is torn there.
  auto block = std::exchange(block_, {});
  if (!block.empty()) take_(block);
  block.clear();
  block_ = std::move(block);  // its memory is used again
}

}  // namespace lookout::bus
