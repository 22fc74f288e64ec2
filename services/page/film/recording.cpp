#include "services/page/film/recording.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <system_error>

#include "services/page/film/log_indexer.hpp"

namespace lookout::page {

namespace {

using std::chrono::microseconds;

constexpr std::chrono::seconds kDisorderOfLogs(1);  // of events that several threads wrote: no clock was set
constexpr std::chrono::seconds kPauseOfLogs(10);    // between two logs: told

}  // namespace

std::uint16_t Recording::AddLog(const std::filesystem::path& log) {
  auto reader = std::make_unique<bus::LogReader>(log);
  // Numbers are used again when their log is gone.
  while (logs_.contains(static_cast<std::uint16_t>(num_logs_ % UINT16_MAX))) {
    if (logs_.size() >= UINT16_MAX) throw std::runtime_error("too many logs");
    ++num_logs_;
  }
  const auto number = static_cast<std::uint16_t>(num_logs_++ % UINT16_MAX);
  logs_[number].file = log;
  logs_[number].reader = std::move(reader);
  return number;
}

void Recording::Append(std::uint16_t number, const LogPart& part) {
  auto& log = logs_.at(number);
  if (!log.is_begun && !part.entries.empty()) {
    log.is_begun = true;
    const auto begin = part.entries.front().time;
    const auto lead = timeline_.is_empty() ? microseconds(0) : timeline_.end() - begin;
    LogPart told;
    if (lead > kDisorderOfLogs) {
      log.shift = std::chrono::ceil<std::chrono::seconds>(lead);  // whole: cells are seconds
      told.events.push_back({timeline_.end(), FilmEventKind::kGap, 1,
                             fmt::format("a log begins {:.1f} s before the end of the one before: shown {} s later", ToSeconds(lead),
                                         std::chrono::duration_cast<std::chrono::seconds>(log.shift).count())});
    } else if (-lead > kPauseOfLogs) {
      told.events.push_back({begin, FilmEventKind::kGap, 1, fmt::format("no log for {:.1f} s before this", ToSeconds(-lead))});
    }
    timeline_.Append(told, number, microseconds(0));
  }
  timeline_.Append(part, number, log.shift);
  if (!part.entries.empty()) log.last = part.entries.back().time + log.shift;
}

void Recording::DropBefore(Utime time) {
  timeline_.DropBefore(time);
  while (logs_.size() > 1) {
    const auto oldest = std::ranges::min_element(logs_, {}, [](const auto& item) { return item.second.last; });
    if (!oldest->second.is_begun || oldest->second.last >= time) break;
    logs_.erase(oldest);
  }
}

void Recording::CloseRemoved() {
  for (auto& [number, log] : logs_) {
    std::error_code error;
    if (log.reader && !std::filesystem::exists(log.file, error) && !error) log.reader.reset();
  }
}

std::optional<Utime> Recording::LastOf(std::uint16_t number) const {
  const auto log = logs_.find(number);
  return log == logs_.end() || !log->second.is_begun ? std::nullopt : std::optional(log->second.last);
}

bool Recording::Read(ChannelIndex channel, const Place& place, std::vector<std::uint8_t>& bytes) {
  const auto log = logs_.find(place.file);
  if (log == logs_.end()) return false;
  if (!log->second.reader) {
    ++num_missing_;
    return false;
  }
  auto& reader = *log->second.reader;
  reader.UpdateSize();
  reader.Seek(place.offset_bytes);
  const auto event = reader.NextView([](std::string_view) { return true; });
  if (!event || event->position_bytes != place.offset_bytes || event->channel != bus::kChannels[channel].name ||
      event->bytes.size() != place.size_bytes) {
    ++num_missing_;
    return false;
  }
  bytes.assign(event->bytes.begin(), event->bytes.end());
  return true;
}

Answer Recording::Find(const At& request) {
  Answer answer;
  if (timeline_.is_empty()) {
    answer.refusal = "the recording holds nothing that can be shown";
    return answer;
  }
  const auto moment = timeline_.Find(request);
  answer.time = moment.time;
  answer.num_scans = static_cast<std::int64_t>(timeline_.scans().size());
  if (moment.scan) {
    answer.scan_index = static_cast<std::int64_t>(*moment.scan);
    answer.scan_time = Utime(microseconds(timeline_.scans()[*moment.scan].utime_us));
  }
  std::int64_t num_bytes = 0;
  for (const auto& found : timeline_.Of(moment, request.channels)) {
    for (const auto& place : found.places) {
      num_bytes += place.size_bytes;
      if (num_bytes > kMaxAnswerBytes) return answer;
      RecordedMessage message{.channel = found.channel, .time = place.time, .bytes = {}};
      if (Read(found.channel, place, message.bytes)) answer.messages.push_back(std::move(message));
    }
  }
  return answer;
}

Answer Recording::Find(const Range& request) {
  Answer answer;
  if (timeline_.is_empty()) {
    answer.refusal = "the recording holds nothing that can be shown";
  } else if (request.channel >= bus::kChannels.size() || !HasEntries(bus::kChannels[request.channel].name)) {
    answer.refusal = "no index is kept of the messages of this channel";
  } else if (request.from > request.to) {
    answer.refusal = "the span is empty";
  }
  if (!answer.refusal.empty()) return answer;
  answer.time = request.from;
  answer.num_scans = static_cast<std::int64_t>(timeline_.scans().size());
  for (const auto& place : timeline_.Of(request, kMaxAnswerBytes)) {
    RecordedMessage message{.channel = request.channel, .time = place.time, .bytes = {}};
    if (Read(request.channel, place, message.bytes)) answer.messages.push_back(std::move(message));
  }
  return answer;
}

std::vector<std::uint8_t> Recording::RunInfo() {
  std::vector<std::uint8_t> bytes;
  if (timeline_.is_empty()) return bytes;
  const auto channel = static_cast<ChannelIndex>(bus::FindChannel(bus::kRunInfo.name) - bus::kChannels.data());
  for (const auto& found : timeline_.Of(Moment{.time = timeline_.begin(), .scan = {}}, {channel})) {
    for (const auto& place : found.places) Read(channel, place, bytes);
  }
  return bytes;
}

}  // namespace lookout::page
