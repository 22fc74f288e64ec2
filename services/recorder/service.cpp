#include "services/recorder/service.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/core/printable.hpp"
#include "lookout/lidar_beams_t.hpp"

namespace lookout::recorder {

namespace {

// LCM sends this channel to itself when it opens UDP multicast.
constexpr std::string_view kLcmSelfTest = "LCM_SELF_TEST";

constexpr std::chrono::seconds kRunInfoPeriod(10);
// Channels outside of the table that are named in warnings.
constexpr std::size_t kMaxUnknownNames = 20;
// Own RUN_INFO messages that may be on their way through the bus. The bound matters as a message that the bus lost never comes back.
constexpr std::size_t kMaxOwnRunInfos = 8;

// AdvanceTo is called twice a second; a longer step is a stop of the process, which counts neither as time passed nor as silence of a publisher.
constexpr std::chrono::milliseconds kMostPassed(600);
// A busy disk finishes a block of 1 MB in this time.
constexpr std::chrono::seconds kStandingDisk(2);

// "20261121T134501Z"
std::string FileStem(Utime time) {
  const std::time_t seconds = std::chrono::floor<std::chrono::seconds>(time).time_since_epoch().count();
  std::tm date{};
  gmtime_r(&seconds, &date);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &date);
  return text.data();
}

}  // namespace

Service::Service(bus::Bus& bus, const Params& params, run_info_t run_info, std::function<Utime()> clock, Disk disk)
    : bus_(bus),
      params_(params),
      run_info_(std::move(run_info)),
      clock_(std::move(clock)),
      writer_(params_.log_folder, {params_.queue_bytes, params_.reserve_bytes}, std::move(disk)),
      time_(kMostPassed) {
  std::error_code error;
  std::filesystem::create_directories(params_.log_folder, error);
  if (!std::filesystem::is_directory(params_.log_folder)) {
    throw std::runtime_error(params_.log_folder.string() + ": the folder of the logs cannot be made: " + error.message());
  }
  BeginFile(clock_(), true);
  writer_.Flush();
  const auto status = writer_.Status();
  if (!status.is_recording && !status.is_full) throw std::runtime_error(Printable(status.fault));
  WatchDisk();
  bus_.SubscribeAll([this](std::string_view channel, Bytes bytes) { OnEvent(channel, bytes); });
}

void Service::AdvanceTo(Utime now) {
  time_.Advance(now);
  for (auto& [name, guard] : guards_) {
    if (const auto num_missing = guard.Release(time_.passed())) NoteMissing(*bus::FindChannel(name), *num_missing);
  }
  WatchDisk();  // before a new log hides why the old log ended
  const auto status = writer_.Status();
  if (!status.is_recording) {
    if (!status.is_waiting_for_file) BeginFile(now, false);
  } else if (now - file_start_ >= params_.max_file_time || (status.wants_new_file && !status.is_waiting_for_file)) {
    Rotate(now);
  } else if (now - last_run_info_ >= kRunInfoPeriod || now < last_run_info_) {  // the host's clock may be set back
    file_start_ = std::min(file_start_, now);
    auto run_info = EncodeRunInfo(now);
    Write(now, bus::kRunInfo.name, run_info);
    PublishRunInfo(now, std::move(run_info));
  }
}

void Service::Rotate(Utime now) { BeginFile(now, true); }

void Service::OnEvent(std::string_view channel, Bytes bytes) {
  if (!IsRecordable(channel, bytes)) return;
  if (channel == bus::kRunInfo.name && IsOwnRunInfo(bytes)) return;  // was written to the log when it was sent
  const bus::Channel* known = bus::FindChannel(channel);
  if (known != nullptr) {
    WatchGaps(*known, bytes);
  } else if (channel != kLcmSelfTest) {
    WatchUnknown(channel);
  }
  if (channel == bus::kLidarBeams.name) KeepBeams(bytes);
  Write(clock_(), channel, bytes);
}

// Without them the packets of a later file could not be read by itself.
void Service::KeepBeams(Bytes bytes) {
  constexpr std::size_t kMaxLidars = 4;
  const auto message = bus::Decode<lidar_beams_t>(bytes);
  if (!message || (beams_.size() >= kMaxLidars && !beams_.contains(message->packets))) return;
  beams_[message->packets] = {bytes.begin(), bytes.end()};
}

// A log that holds one that is not cannot be read on. Each reason is logged once, and then counted.
bool Service::IsRecordable(std::string_view channel, Bytes bytes) {
  const auto refuse = [&](std::int64_t& count, const std::string& what) {
    if (count++ == 0) warnings_.push_back(what + " cannot be recorded; further ones are counted in HEALTH");
  };
  if (channel.empty()) {
    refuse(num_nameless_, "an event on a channel without name");
  } else if (channel.size() > bus::kMaxLogChannelBytes) {
    refuse(num_name_too_long_, "an event on channel " + Printable(channel.substr(0, bus::kMaxLogChannelBytes)) + "..., a name of " +
                                   std::to_string(channel.size()) + " bytes (" + std::to_string(bus::kMaxLogChannelBytes) + " are allowed),");
  } else if (bytes.size() > bus::kMaxLogDataBytes) {
    refuse(num_too_large_, "an event of " + std::to_string(bytes.size()) + " bytes on channel " + Printable(channel) + " (" +
                               std::to_string(bus::kMaxLogDataBytes) + " are allowed)");
  } else {
    return true;
  }
  return false;
}

void Service::BeginFile(Utime now, bool must_publish) {
  auto run_info = EncodeRunInfo(now);
  std::vector<std::uint8_t> event;
  bus::AppendLogEvent(event, 0, now, bus::kRunInfo.name, run_info);
  num_file_events_ = 1;
  for (const auto& [packets, beams] : beams_) bus::AppendLogEvent(event, num_file_events_++, now, bus::kLidarBeams.name, beams);
  file_start_ = now;
  file_bytes_ = static_cast<std::int64_t>(event.size());
  writer_.BeginFile(FileStem(now), std::move(event));
  if (must_publish) PublishRunInfo(now, std::move(run_info));
}

std::vector<std::uint8_t> Service::EncodeRunInfo(Utime now) {
  run_info_.utime_us = ToUtimeUs(now);
  return bus::Encode(run_info_);
}

void Service::PublishRunInfo(Utime now, std::vector<std::uint8_t> bytes) {
  last_run_info_ = now;
  ++run_info_.seq;
  if (own_run_infos_.size() == kMaxOwnRunInfos) own_run_infos_.pop_front();
  own_run_infos_.push_back(std::move(bytes));
  bus_.Publish(bus::kRunInfo, own_run_infos_.back());
}

bool Service::IsOwnRunInfo(Bytes bytes) {
  const auto found = std::ranges::find_if(own_run_infos_, [&](const auto& own) { return std::ranges::equal(own, bytes); });
  if (found == own_run_infos_.end()) return false;
  own_run_infos_.erase(found);
  return true;
}

void Service::Write(Utime time, std::string_view channel, Bytes bytes) {
  const auto size_bytes = static_cast<std::int64_t>(bus::kLogEventHeaderBytes + channel.size() + bytes.size());
  if (num_file_events_ > 1 && file_bytes_ + size_bytes > params_.max_file_bytes && writer_.Status().is_recording) Rotate(time);
  event_.clear();
  bus::AppendLogEvent(event_, num_file_events_, time, channel, bytes);
  if (!writer_.Append(event_)) return;
  file_bytes_ += size_bytes;
  ++num_file_events_;
}

void Service::WatchGaps(const bus::Channel& channel, Bytes bytes) {
  auto& traffic = bus_.input_traffic()[std::string(channel.name)];
  ++traffic.num_messages;
  if (bus::HasSeveralPublishers(channel)) return;  // each process counts for itself
  const auto place = bus::IsGuarded(channel) ? bus::PlaceOf(channel, bytes) : std::nullopt;
  if (!place) return;  // a message that readers refuse, or whose numbers do not count
  auto found = guards_.find(channel.name);
  if (found == guards_.end()) found = guards_.emplace(std::string(channel.name), bus::StreamGuard(channel)).first;
  const auto num_lost = found->second.Next(*place, time_.Advance(clock_())).num_lost;
  traffic.scans.Note(place->seq, place->part_index, place->num_parts, num_lost);
  NoteMissing(channel, num_lost);
}

void Service::NoteMissing(const bus::Channel& channel, std::int64_t number) {
  if (number == 0) return;
  bus_.input_traffic()[std::string(channel.name)].num_lost += number;
  num_missing_ += number;
  if (channel.is_raw) num_raw_missing_ += number;
  raw_missing_.Note(num_raw_missing_, time_.passed());
}

// Says once when recording stops, and each time when the queue overflowed anew.
void Service::WatchDisk() {
  const auto status = writer_.Status();
  lost_.Note(status.num_lost(), time_.passed());
  disturbed_.Note(status.num_disturbed, time_.passed());
  if (status.is_waiting_for_file) return;
  const auto before = std::exchange(seen_, status);
  const auto num_overflowed = status.num_lost_queue_full - before.num_lost_queue_full;
  if (before.is_recording && !status.is_recording) {
    warnings_.push_back(Printable(status.fault) + "; events are lost until it works again");
  } else if (num_overflowed > 0) {
    warnings_.push_back(std::to_string(num_overflowed) + " events lost: " + Printable(status.fault));
  }
  const bool is_disturbed = status.num_disturbed > before.num_disturbed || (status.wants_new_file && !before.wants_new_file);
  if (status.is_recording && is_disturbed) warnings_.push_back(Printable(status.fault));
}

void Service::WatchUnknown(std::string_view channel) {
  ++num_unknown_;
  if (unknown_channels_.size() >= kMaxUnknownNames || unknown_channels_.contains(channel)) return;
  unknown_channels_.emplace(channel);
  warnings_.push_back("channel " + Printable(channel) + " is not in the channel table; it is recorded" +
                      (unknown_channels_.size() == kMaxUnknownNames ? "; further ones are not named here" : ""));
}

std::vector<std::string> Service::TakeWarnings() {
  WatchDisk();
  return std::exchange(warnings_, {});
}

// "POSE, NAV_RAW: two publishers; ..."; empty while each channel has one.
std::string Service::SecondPublisherText() const {
  std::string channels;
  for (const auto& [name, guard] : guards_) {
    if (guard.HasSecond(time_.passed(), Recently::kToldFor)) channels += (channels.empty() ? "" : ", ") + name;
  }
  if (channels.empty()) return {};
  return channels +
         ": two publishers; all is recorded, but from there on the log cannot be computed again to what ran live; end one of them (lookout-top and "
         "lookout-doctor show all processes by host and pid), or give the other boat another LCM address";
}

HealthReport Service::Report() const {
  const auto status = writer_.Status();
  const auto now = time_.passed();
  std::int64_t num_second = 0;
  for (const auto& entry : guards_) num_second += entry.second.num_refused();
  HealthReport report;
  report.counters = {{"events", status.num_events},
                     {"bytes", status.num_bytes},
                     {"files", status.num_files},
                     {"lost", status.num_lost()},
                     {"lost_queue_full", status.num_lost_queue_full},
                     {"lost_disk_full", status.num_lost_full},
                     {"lost_bytes", status.num_lost_bytes},
                     {"files_disturbed", status.num_disturbed},
                     {"write_faults", status.num_faults},
                     {"unknown_channel", num_unknown_},
                     {"nameless_channel", num_nameless_},
                     {"channel_name_too_long", num_name_too_long_},
                     {"event_too_large", num_too_large_},
                     {"missing", num_missing_},
                     {"raw_missing", num_raw_missing_},
                     {"second_publishers_messages", num_second},
                     {"queue_bytes", status.queue_bytes},
                     {"queue_peak_bytes", status.queue_peak_bytes},
                     {"disk_free_bytes", status.free_bytes}};
  if (!status.is_recording && !(status.is_waiting_for_file && seen_.is_recording)) {
    report.state = HealthState::kFailed;
    report.reason = "not recording: " + Printable(status.fault);
  } else if (status.standing >= kStandingDisk) {
    report.state = HealthState::kFailed;
    report.reason = "not recording: the disk has stood still for " +
                    std::to_string(std::chrono::floor<std::chrono::seconds>(status.standing).count()) + " s; " +
                    std::to_string(status.queue_bytes / 1'000'000) + " MB wait, " + std::to_string(status.num_lost()) + " events are lost";
  } else if (lost_.HasGrown(now)) {
    report.Degrade("recording again; " + std::to_string(status.num_lost()) + " events lost: " + Printable(status.fault));
  } else if (disturbed_.HasGrown(now) || status.wants_new_file) {
    report.Degrade("recording, nothing lost, but " + Printable(status.fault));
  } else if (raw_missing_.HasGrown(now)) {
    report.Degrade(std::to_string(num_raw_missing_) + " raw messages did not arrive: the log cannot be computed again in full");
  }
  if (const auto text = SecondPublisherText(); !text.empty()) report.Degrade(text);
  return report;
}

}  // namespace lookout::recorder
