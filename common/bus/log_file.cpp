#include "common/bus/log_file.hpp"

#include <array>
#include <cstdio>
#include <lcm/eventlog.h>
#include <stdexcept>
#include <system_error>

#include "common/bus/log_event.hpp"

namespace lookout::bus {

namespace {

constexpr std::uint32_t kSyncWord = kLogSyncWord;
constexpr std::size_t kHeaderBytes = kLogEventHeaderBytes;
// LCM channel names have at most 63 characters; its logs allow more.
constexpr std::int64_t kMaxChannelBytes = 1000;
// Far above any message that LCM carries; a greater length is damage.
constexpr std::int64_t kMaxDataBytes = 16 * 1024 * 1024;

std::uint64_t ReadBigEndian(Bytes bytes, std::size_t offset, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[offset + i];
  return value;
}

std::int64_t ReadI32(Bytes bytes, std::size_t offset) { return static_cast<std::int32_t>(ReadBigEndian(bytes, offset, 4)); }

}  // namespace

struct LogReader::Implementation {
  struct Closer {
    void operator()(std::FILE* open_file) const { std::fclose(open_file); }
  };
  std::unique_ptr<std::FILE, Closer> file;
  std::int64_t size_bytes = 0;
  std::int64_t position = 0;  // of the next event
  std::int64_t cursor = 0;    // of the file: a seek throws the read-ahead away, so there is none while events follow each other

  // @return how many bytes were read
  std::size_t ReadAt(std::int64_t offset, void* target, std::size_t size) {
    if (offset != cursor && fseeko(file.get(), offset, SEEK_SET) != 0) return 0;
    const std::size_t size_read = std::fread(target, 1, size, file.get());
    cursor = offset + static_cast<std::int64_t>(size_read);
    return size_read;
  }

  // Whether the event from `start` to `end` is one event. A damaged length that fits in the file would swallow events behind it: then no
  // sync word stands at `end`, but some stand inside.
  bool IsWhole(std::int64_t start, std::int64_t end) {
    std::array<std::uint8_t, 4> word{};
    if (end == size_bytes || (ReadAt(end, word.data(), word.size()) == word.size() && ReadBigEndian(word, 0, 4) == kSyncWord)) return true;
    return FindSync(start + 4) >= end;
  }

  // The first sync word at or after `offset`; size_bytes when there is none.
  std::int64_t FindSync(std::int64_t offset) {
    std::array<std::uint8_t, 65536> block{};
    while (offset + 4 <= size_bytes) {
      const std::size_t size = ReadAt(offset, block.data(), block.size());
      if (size < 4) break;
      for (std::size_t i = 0; i + 4 <= size; ++i) {
        if (ReadBigEndian(block, i, 4) == kSyncWord) return offset + static_cast<std::int64_t>(i);
      }
      offset += static_cast<std::int64_t>(size) - 3;
    }
    return size_bytes;
  }
};

LogReader::LogReader(const std::filesystem::path& file) : implementation_(std::make_unique<Implementation>()) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw std::runtime_error(file.string() + ": no such file");
  implementation_->size_bytes = static_cast<std::int64_t>(std::filesystem::file_size(file, error));
  implementation_->file.reset(std::fopen(file.c_str(), "rbe"));
  if (error || !implementation_->file) throw std::runtime_error(file.string() + ": cannot be opened");
}

LogReader::~LogReader() = default;

std::int64_t LogReader::position_bytes() const { return implementation_->position; }

std::int64_t LogReader::size_bytes() const { return implementation_->size_bytes; }

void LogReader::Seek(std::int64_t position_bytes) { implementation_->position = position_bytes; }

std::optional<LogEvent> LogReader::Next() {
  auto& in = *implementation_;
  bool is_resynchronising = false;
  while (in.position < in.size_bytes) {
    std::array<std::uint8_t, kHeaderBytes> header{};
    const std::int64_t start = in.position;
    const bool has_header = in.ReadAt(start, header.data(), header.size()) == header.size();
    if (has_header && ReadBigEndian(header, 0, 4) == kSyncWord) {
      const auto time = UtimeFromWire(static_cast<std::int64_t>(ReadBigEndian(header, 12, 8)));
      const std::int64_t channel_size = ReadI32(header, 20);
      const std::int64_t data_size = ReadI32(header, 24);
      const std::int64_t body = start + static_cast<std::int64_t>(kHeaderBytes);
      if (time && channel_size > 0 && channel_size <= kMaxChannelBytes && data_size >= 0 && data_size <= kMaxDataBytes &&
          channel_size + data_size <= in.size_bytes - body) {
        LogEvent event{*time, std::string(static_cast<std::size_t>(channel_size), '\0'),
                       std::vector<std::uint8_t>(static_cast<std::size_t>(data_size))};
        if (in.ReadAt(body, event.channel.data(), event.channel.size()) == event.channel.size() &&
            in.ReadAt(body + channel_size, event.bytes.data(), event.bytes.size()) == event.bytes.size() &&
            in.IsWhole(start, body + channel_size + data_size)) {
          in.position = body + channel_size + data_size;
          return event;
        }
      }
    }
    if (!is_resynchronising) ++num_damaged_;
    is_resynchronising = true;
    in.position = in.FindSync(start + 1);
  }
  return std::nullopt;
}

struct LogWriter::Implementation {
  lcm_eventlog_t* log = nullptr;
  std::filesystem::path file;
};

LogWriter::LogWriter(const std::filesystem::path& file, bool overwrite) : implementation_(std::make_unique<Implementation>()) {
  std::error_code error;
  if (!overwrite && std::filesystem::exists(file, error)) throw std::runtime_error(file.string() + ": exists already");
  implementation_->file = file;
  implementation_->log = lcm_eventlog_create(file.c_str(), "w");
  if (implementation_->log == nullptr) throw std::runtime_error(file.string() + ": cannot be written");
}

LogWriter::~LogWriter() { lcm_eventlog_destroy(implementation_->log); }

void LogWriter::Write(Utime time, std::string_view channel, Bytes bytes) {
  std::string name(channel);
  std::vector<std::uint8_t> data(bytes.begin(), bytes.end());  // LCM's writer wants memory it may write to
  lcm_eventlog_event_t event{};
  event.timestamp = ToUtimeUs(time);
  event.channellen = static_cast<std::int32_t>(name.size());
  event.datalen = static_cast<std::int32_t>(data.size());
  event.channel = name.data();
  event.data = data.data();
  if (lcm_eventlog_write_event(implementation_->log, &event) != 0) {
    throw std::runtime_error(implementation_->file.string() + ": write failed: " + std::system_category().message(errno));
  }
  num_bytes_ += static_cast<std::int64_t>(kHeaderBytes + name.size() + data.size());
}

void LogWriter::Flush() {
  if (std::fflush(implementation_->log->f) != 0) {
    throw std::runtime_error(implementation_->file.string() + ": write failed: " + std::system_category().message(errno));
  }
}

}  // namespace lookout::bus
