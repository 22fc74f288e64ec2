#include "tools/log/log_span.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "common/bus/log_file.hpp"
#include "common/io/file_kind.hpp"
#include "common/io/stop_signal.hpp"

namespace lookout::log {

namespace {

constexpr std::int64_t kTailBytes = std::int64_t{1} << 20;

std::optional<Utime> TimeOfNext(bus::LogReader& reader) {
  const auto event = reader.NextView([](std::string_view) { return false; });
  return event ? std::optional(event->time) : std::nullopt;
}

// Looks at the end of the file, and at more of it where that holds no event: one is at most 16 MiB long, but there may be damage.
std::optional<Utime> LastTime(bus::LogReader& reader) {
  std::optional<Utime> last;
  for (std::int64_t tail_bytes = kTailBytes; !last; tail_bytes *= 32) {
    const auto begin_bytes = std::max<std::int64_t>(0, reader.size_bytes() - tail_bytes);
    reader.Seek(begin_bytes);
    while (const auto time = TimeOfNext(reader)) {
      io::ThrowIfStopAsked();
      last = time;
    }
    if (begin_bytes == 0) break;
  }
  return last;
}

}  // namespace

LogSpan SpanOf(const std::vector<std::filesystem::path>& files) {
  std::optional<LogSpan> span;
  for (const auto& file : files) {
    bus::LogReader reader(file, io::ThrowIfStopAsked);
    const auto first = TimeOfNext(reader);
    if (!first) continue;
    const auto last = LastTime(reader).value_or(*first);
    if (!span) span = {*first, last};
    span->end = std::max(span->end, last);
  }
  if (!span) throw std::runtime_error(io::NoEventText(files.front()));
  return *span;
}

}  // namespace lookout::log
