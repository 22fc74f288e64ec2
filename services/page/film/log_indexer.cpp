#include "services/page/film/log_indexer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/bus/decode.hpp"
#include "common/bus/schema.hpp"
#include "common/core/printable.hpp"
#include "common/messages/checks.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/nav_raw_t.hpp"

namespace lookout::page {

namespace {

using std::chrono::microseconds;

// Offsets, in the wire types, of the members that an index needs. The types never change: tests/golden/fingerprints.txt.
constexpr std::size_t kMarkOffset = 24;       // of LIDAR_PACKETS marks, of NAV_RAW kind
constexpr std::size_t kEndUtimeOffset = 32;   // of the messages of a scan
constexpr std::size_t kScanPartOffset = 40;   // of LIDAR_SCAN, LIDAR_SCAN_2; part_index and num_parts
constexpr std::size_t kPartOffset = 44;       // of SEGMENTS, SEGMENTS_2, OBSTACLES and TRACKS: behind scan_flags
constexpr std::size_t kNumTracksOffset = 96;  // of TRACKS: num_scan_tracks
constexpr std::size_t kHeadBytes = 104;

constexpr microseconds kMaxScan = std::chrono::seconds(60);
constexpr microseconds kDisorder = std::chrono::seconds(1);      // of events that several threads wrote: no clock was set
constexpr microseconds kPause = std::chrono::seconds(10);        // told as a gap
constexpr microseconds kDoubtfulJump = std::chrono::minutes(1);  // is believed only if the next event agrees
constexpr microseconds kHealthHolds = std::chrono::seconds(3);   // reports come once a second
constexpr std::size_t kMaxAlerts = 4096;
constexpr Utime kLatest{microseconds(kMaxUtimeUs)};  // a clock that is set on and back again and again goes no further

std::int64_t ReadI32(Bytes bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | bytes[offset + i];
  return static_cast<std::int32_t>(value);
}

std::optional<std::size_t> IndexOf(std::string_view name) {
  const auto* const channel = bus::FindChannel(name);
  if (channel == nullptr) return std::nullopt;
  return static_cast<std::size_t>(channel - bus::kChannels.data());
}

std::size_t NumWanted(std::string_view name) {
  if (name == bus::kAlerts.name || name == bus::kHealth.name) return bus::kMaxMessageBytes;
  return bus::FindChannel(name) == nullptr ? 0 : kHeadBytes;
}

const std::vector<std::uint64_t>& FingerprintsOfChannels() {
  static const std::vector<std::uint64_t> kFingerprints = [] {
    std::vector<std::uint64_t> fingerprints;
    for (const auto& channel : bus::kChannels) {
      const auto row = std::ranges::find(bus::TypeFingerprints(), channel.type, &bus::TypeFingerprint::type);
      fingerprints.push_back(row == bus::TypeFingerprints().end() ? 0 : row->fingerprint);
    }
    return fingerprints;
  }();
  return kFingerprints;
}

// Where part_index stands; 0: the messages of the channel have no parts.
std::size_t PartOffset(std::string_view name) {
  if (name == bus::kLidarScan.name || name == bus::kLidarScan2.name) return kScanPartOffset;
  if (name == bus::kSegments.name || name == bus::kSegments2.name || name == bus::kObstacles.name || name == bus::kTracks.name) return kPartOffset;
  return 0;
}

bool HasEnd(std::string_view name) { return name == bus::kAlerts.name || PartOffset(name) != 0; }

std::string Seconds(microseconds duration) { return fmt::format("{:.1f} s", ToSeconds(duration)); }

std::string ShortText(const std::string& text) {
  std::string line = PrintableLines(text);
  std::ranges::replace(line, '\n', ' ');
  if (line.size() <= kMaxFilmTextBytes) return line;
  std::size_t end = kMaxFilmTextBytes - 3;
  while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xC0U) == 0x80U) --end;  // no half of a character
  return line.substr(0, end) + "...";
}

std::string_view StateWord(std::int32_t state) {
  if (state == health_t::STATE_OK) return "OK";
  return state == health_t::STATE_FAILED ? "failed" : "degraded";
}

}  // namespace

bool HasEntries(std::string_view channel) {
  return bus::FindChannel(channel) != nullptr && channel != bus::kLidarPackets.name && channel != bus::kNavRaw.name &&
         channel != bus::kLidarNmea.name && channel != bus::kSimTruth.name;
}

LogIndexer::LogIndexer(const std::filesystem::path& file, bool is_growing) : is_growing_(is_growing), reader_(file) {}

bool LogIndexer::Read(std::int64_t max_bytes, LogPart& part) {
  if (is_growing_) reader_.UpdateSize();
  const auto stop_bytes = reader_.position_bytes() + max_bytes;
  bool goes_on = true;
  while (goes_on && reader_.position_bytes() < stop_bytes) {
    auto event = is_growing_ ? reader_.NextHeadSoFar(NumWanted) : reader_.NextHead(NumWanted);
    goes_on = event.has_value();
    const auto num_damaged = reader_.num_damaged() - num_damaged_told_;
    num_damaged_told_ += num_damaged;
    if (event) {
      const Utime time = FilmTime(*event, part);
      BeginSecond(time, part);
      if (num_damaged > 0) Tell(time, FilmEventKind::kGap, 1, "damaged stretch of the log before this: skipped", part);
      OnEvent(*event, time, part);
    } else if (num_damaged > 0 && last_) {
      Tell(*last_, FilmEventKind::kGap, 1, "the log ends in a torn event or in other bytes", part);
    }
  }
  EndSecond(part);
  part.processes = processes_;
  return goes_on;
}

// May look at the next event: then `event` shows copies.
Utime LogIndexer::FilmTime(bus::LogEventView& event, LogPart& part) {
  Utime time = std::min(event.time + shift_, kLatest);
  if (!last_) {
    last_ = time;
    return time;
  }
  if (time + kDisorder < *last_) {
    shift_ += *last_ - time;
    Tell(*last_, FilmEventKind::kGap, 1,
         fmt::format("the host's clock was set back by {}: what follows is shown so much later", Seconds(*last_ - time)), part);
  } else if (time - *last_ > kPause) {
    bool is_believed = true;
    if (time - *last_ > kDoubtfulJump) {
      kept_.assign(event.bytes.begin(), event.bytes.end());
      kept_channel_ = event.channel;
      event.bytes = kept_;
      event.channel = kept_channel_;
      const auto place = reader_.position_bytes();
      const auto next = reader_.NextHead([](std::string_view) { return 0; });
      is_believed = !next || next->time + shift_ + kDoubtfulJump > time;
      reader_.Seek(place);
      num_damaged_told_ = reader_.num_damaged();  // is met again
    }
    if (is_believed) {
      Tell(time, FilmEventKind::kGap, 1, fmt::format("nothing in the log for {} before this", Seconds(time - *last_)), part);
    } else {
      time = *last_;
      Tell(time, FilmEventKind::kGap, 1, "an event with a time far ahead of the next: its time is not believed", part);
    }
  }
  last_ = std::max(*last_, time);
  return *last_;
}

void LogIndexer::OnEvent(const bus::LogEventView& event, Utime time, LogPart& part) {
  const auto channel = IndexOf(event.channel);
  if (!channel) return;
  const auto header = bus::ReadHeader(event.bytes);
  const auto part_offset = PartOffset(event.channel);
  const bool is_tracks = event.channel == bus::kTracks.name;
  const bool has_end = HasEnd(event.channel);
  const std::size_t least_bytes = is_tracks ? kHeadBytes - 4 : part_offset > 0 ? part_offset + 8 : has_end ? kEndUtimeOffset + 8 : 24;
  if (!header || header->fingerprint != FingerprintsOfChannels()[*channel] || event.bytes.size() < least_bytes ||
      event.num_data_bytes > bus::kMaxLogDataBytes || !UtimeFromWire(header->utime_us)) {
    return Refuse(*channel, time, part);
  }
  Parts parts;
  if (part_offset > 0) parts = {ReadI32(event.bytes, part_offset), ReadI32(event.bytes, part_offset + 4)};
  if (parts.index < 0 || parts.index >= parts.count || parts.count > messages::kMaxObstaclesParts) return Refuse(*channel, time, part);

  LogEntry entry{.time = time,
                 .utime_us = header->utime_us,
                 .offset_bytes = event.position_bytes,
                 .size_bytes = static_cast<std::uint32_t>(event.num_data_bytes),
                 .channel = static_cast<std::uint16_t>(*channel),
                 .part = static_cast<std::uint16_t>(parts.index)};
  if (has_end) {
    const auto end = UtimeFromWire(static_cast<std::int64_t>(bus::ReadU64BigEndian(event.bytes, kEndUtimeOffset)));
    if (!end) return Refuse(*channel, time, part);
    const auto begin = *UtimeFromWire(header->utime_us);
    entry.duration_us = static_cast<std::uint32_t>(std::clamp(*end - begin, microseconds(0), kMaxScan).count());
  }
  if (event.channel == bus::kHealth.name) {
    const auto process = OnHealth(event.bytes, time, part);
    if (!process) return Refuse(*channel, time, part);
    entry.part = *process;
    CountLoss(*channel, process_sequences_[*process].NumLostBefore(header->seq));
  } else if (!bus::HasSeveralPublishers(bus::kChannels[*channel])) {
    CountLoss(*channel, sequences_[*channel].NumLostBefore(header->seq, parts.index, parts.count));
  }
  if (is_tracks) cell_->num_tracks = std::max(cell_->num_tracks, static_cast<std::int32_t>(ReadI32(event.bytes, kNumTracksOffset)));
  if (event.channel == bus::kAlerts.name) OnAlerts(event.bytes, time, part);
  OnMark(event.channel, event.bytes, time, part);
  if (HasEntries(event.channel)) part.entries.push_back(entry);
}

void LogIndexer::OnAlerts(Bytes bytes, Utime time, LogPart& part) {
  const auto message = bus::Decode<alerts_t>(bytes);
  if (!message) return Refuse(*IndexOf(bus::kAlerts.name), time, part);
  for (const auto& alert : message->alerts) {
    if (alert.level < alert_t::LEVEL_CAUTION || alert.level > alert_t::LEVEL_WARNING) continue;
    const std::pair key(alert.id, alert.raised_utime_us);
    if (alert.state == alert_t::STATE_CLEARED) {
      alert_levels_.erase(key);
      continue;
    }
    if (alert.state == alert_t::STATE_ACTIVE || alert.state == alert_t::STATE_ACKNOWLEDGED) {
      cell_->alert_level = std::max(cell_->alert_level, static_cast<std::int8_t>(alert.level));
    }
    const auto told = alert_levels_.find(key);
    if (told != alert_levels_.end() && told->second >= alert.level) continue;
    if (told == alert_levels_.end() && alert_levels_.size() >= kMaxAlerts) alert_levels_.erase(alert_levels_.begin());
    alert_levels_[key] = alert.level;
    Tell(time, FilmEventKind::kAlert, alert.level, alert.text, part);
  }
}

std::optional<std::uint16_t> LogIndexer::OnHealth(Bytes bytes, Utime time, LogPart& part) {
  const auto message = bus::Decode<health_t>(bytes);
  if (!message || message->process.size() > bus::kMaxLogChannelBytes) return std::nullopt;
  auto place = std::ranges::find(processes_, message->process);
  if (place == processes_.end()) {
    if (processes_.size() >= kMaxFilmProcesses) return std::nullopt;
    processes_.push_back(message->process);
    reports_.emplace_back();
    process_sequences_.emplace_back();
    place = processes_.end() - 1;
  }
  const auto process = static_cast<std::uint16_t>(place - processes_.begin());
  auto& report = reports_[process];
  if (message->state < health_t::STATE_OK || message->state > health_t::STATE_STARTING) return process;
  const auto state = static_cast<std::int8_t>(message->state == health_t::STATE_STARTING ? health_t::STATE_OK : message->state);
  if (state != std::max<std::int8_t>(report.state, health_t::STATE_OK)) {
    const std::string reason = message->reason.empty() ? "" : ": " + message->reason;
    Tell(time, FilmEventKind::kHealth, state, fmt::format("{}: {}{}", message->process, StateWord(state), reason), part);
  }
  report = {time, state};
  cell_->health = std::max(cell_->health, state);
  return process;
}

void LogIndexer::OnMark(std::string_view channel, Bytes bytes, Utime time, LogPart& part) {
  if (bytes.size() < kMarkOffset + 4) return;
  const auto mark = ReadI32(bytes, kMarkOffset);
  if (channel == bus::kLidarPackets.name) {
    if ((mark & lidar_packets_t::MARK_START) != 0) Tell(time, FilmEventKind::kStart, 0, "start mark of the lidar", part);
    if ((mark & lidar_packets_t::MARK_END) != 0) Tell(time, FilmEventKind::kEnd, 0, "end mark of the lidar", part);
  } else if (channel == bus::kNavRaw.name) {
    if (mark == nav_raw_t::KIND_START) Tell(time, FilmEventKind::kStart, 0, "start mark of the navigator", part);
    if (mark == nav_raw_t::KIND_END) Tell(time, FilmEventKind::kEnd, 0, "end mark of the navigator", part);
  }
}

void LogIndexer::CountLoss(std::size_t channel, std::int64_t num_lost) {
  num_lost_in_second_[channel] += num_lost;
  SecondCell lost;
  lost.num_lost = static_cast<std::int32_t>(std::min<std::int64_t>(num_lost, INT32_MAX));
  cell_->Add(lost);
}

void LogIndexer::Refuse(std::size_t channel, Utime time, LogPart& part) {
  ++num_refused_;
  if (std::exchange(is_refusal_told_[channel], true)) return;
  Tell(time, FilmEventKind::kGap, 1, fmt::format("{}: from here on messages that are none of its type: skipped", bus::kChannels[channel].name), part);
}

void LogIndexer::BeginSecond(Utime time, LogPart& part) {
  const auto second = std::chrono::floor<std::chrono::seconds>(time).time_since_epoch().count();
  if (cell_ && cell_->second == second) return;
  EndSecond(part);
  cell_ = SecondCell{};
  cell_->second = second;
  for (const auto& report : reports_) {
    if (time - report.time <= kHealthHolds) cell_->health = std::max(cell_->health, report.state);
  }
}

void LogIndexer::EndSecond(LogPart& part) {
  if (!cell_) return;
  for (std::size_t i = 0; i < num_lost_in_second_.size(); ++i) {
    const auto num_lost = std::exchange(num_lost_in_second_[i], 0);
    if (num_lost == 0) continue;
    Tell(*last_, FilmEventKind::kLoss, 1, fmt::format("{}: {} message{} lost", bus::kChannels[i].name, num_lost, num_lost == 1 ? "" : "s"), part);
  }
  part.cells.push_back(*cell_);
  cell_.reset();
}

void LogIndexer::Tell(Utime time, FilmEventKind kind, int level, const std::string& text, LogPart& part) {
  if (num_events_ >= kMaxFilmEvents) return;
  ++num_events_;
  part.events.push_back({time, kind, static_cast<std::uint8_t>(level), ShortText(text)});
}

}  // namespace lookout::page
