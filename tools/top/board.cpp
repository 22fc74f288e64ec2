#include "tools/top/board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <tuple>
#include <type_traits>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/services.hpp"
#include "common/core/angles.hpp"
#include "common/core/printable.hpp"
#include "common/messages/alert_sound.hpp"
#include "common/messages/words.hpp"
#include "tools/diff/fields.hpp"

namespace lookout::top {

namespace {

using std::chrono::seconds;

// HEALTH and the slowest data come once a second, RUN_INFO every ten.
constexpr seconds kSilence(3);
constexpr seconds kRunInfoSilence(25);
// OBSTACLES come with every scan: older ones say nothing about the water of now.
constexpr seconds kObstaclesAge(2);
// ALERTS come with every scan, and twice a second where none comes: this screen says when they do not.
constexpr seconds kAlertsAge(1);
constexpr std::string_view kTracker = "tracker";
constexpr std::string_view kLidar = "lidar";
constexpr std::string_view kSecondLidar = "lidar_2";

template <typename T>
std::int64_t NumLostBefore(const T& message, bus::SequenceWatch& sequence) {
  if constexpr (requires { message.part_index; }) {
    return sequence.NumLostBefore(message.seq, message.part_index, message.num_parts);
  } else {
    return sequence.NumLostBefore(message.seq);
  }
}

std::string LevelText(const alerts_t& alerts, const alert_t& alert) {
  if (alert.state == alert_t::STATE_RECTIFIED) return alert.level == alert_t::LEVEL_WARNING ? "WARNING OVER: " : "CAUTION OVER: ";
  const auto sound = messages::SoundOf(alerts, alert);
  return fmt::format("{}{}{}: ", sound == messages::AlertSound::kSounds ? "(*) " : "", alert.level == alert_t::LEVEL_WARNING ? "WARNING" : "CAUTION",
                     sound == messages::AlertSound::kSilenced ? " SILENCED" : "");
}

// In the order of the data flow. The second lidar's process is of the lidar's service, beside it.
std::size_t PlaceInSuite(std::string_view process) {
  const auto service = process == kSecondLidar ? kLidar : process;
  return static_cast<std::size_t>(std::ranges::find(bus::kServices, service, &bus::ServiceRow::name) - bus::kServices.begin());
}
bool IsOfSuite(std::string_view process) { return PlaceInSuite(process) < bus::kServices.size(); }

std::int64_t GreatestLatencyUs(const health_t& health) {
  std::int64_t greatest_us = -1;
  for (const auto& channel : health.channels) {
    const auto* entry = bus::FindChannel(channel.channel);
    if (channel.is_input == 0 && entry != nullptr && entry->is_replayed) greatest_us = std::max(greatest_us, channel.latency_p99_us);
  }
  return greatest_us;
}

bool IsNearer(const ObstacleLine& a, const ObstacleLine& b) {
  const auto key = [](const ObstacleLine& line) {
    return std::tuple(!std::isfinite(line.range_m), std::isfinite(line.range_m) ? line.range_m : 0.0, line.id);
  };
  return key(a) < key(b);
}

// Sorted; memory stays small whatever a message holds.
void KeepNearest(std::vector<ObstacleLine>& lines) {
  std::ranges::sort(lines, IsNearer);
  lines.resize(std::min(lines.size(), Nearest::kMaxLines));
  lines.shrink_to_fit();
}

}  // namespace

void Nearest::Take(const obstacles_t& part, TimePoint now) {
  Part kept{part.utime_us, part.seq, part.part_index, part.num_parts, {}};
  auto& nearest = kept.nearest;
  nearest.time = now;
  for (const auto& obstacle : part.obstacles) {
    ObstacleLine line{obstacle};
    for (auto* numbers : {&line.footprint_vessel_x_m, &line.footprint_vessel_y_m, &line.footprint_east_m, &line.footprint_north_m,
                          &line.waterline_vessel_x_m, &line.waterline_vessel_y_m, &line.waterline_east_m, &line.waterline_north_m}) {
      *numbers = {};
    }
    if (const auto heading_rad = headings_.At(obstacle.utime_us); heading_rad && std::isfinite(line.bearing_rad)) {
      line.true_bearing_rad = WrapTo2Pi(*heading_rad + line.bearing_rad);
    }
    nearest.lines.push_back(line);
    if (line.confidence == obstacle_t::CONFIDENCE_SURE) nearest.sure_lines.push_back(line);
  }
  nearest.num_obstacles = static_cast<std::int64_t>(nearest.lines.size());
  nearest.num_sure = static_cast<std::int64_t>(nearest.sure_lines.size());
  KeepNearest(nearest.lines);
  KeepNearest(nearest.sure_lines);
  const auto ended = assembler_.Add(std::move(kept));
  if (!ended.incomplete.empty()) newest_ = ToNearest(ended.incomplete);
  if (!ended.whole.empty()) newest_ = ToNearest(ended.whole);
}

NearestObstacles Nearest::ToNearest(const std::vector<Part>& parts) {
  NearestObstacles nearest;
  nearest.num_parts_missing = parts.front().num_parts - static_cast<std::int64_t>(parts.size());
  for (const auto& [utime_us, seq, part_index, num_parts, part] : parts) {
    nearest.lines.insert(nearest.lines.end(), part.lines.begin(), part.lines.end());
    nearest.sure_lines.insert(nearest.sure_lines.end(), part.sure_lines.begin(), part.sure_lines.end());
    nearest.num_obstacles += part.num_obstacles;
    nearest.num_sure += part.num_sure;
    nearest.time = std::max(nearest.time, part.time);
  }
  KeepNearest(nearest.lines);
  KeepNearest(nearest.sure_lines);
  return nearest;
}

void Board::Take(std::string_view channel, Bytes bytes, TimePoint now) {
  auto found = channels_.find(channel);
  if (found == channels_.end()) {
    // A channel of the table has its place whatever else is sent.
    if (channels_.size() >= kMaxChannels && bus::FindChannel(channel) == nullptr) {
      ++num_unlisted_;
      return;
    }
    found = channels_.emplace(std::string(channel), Traffic{RateMeter(start_), now, 0, 0, {}}).first;
  }
  auto& traffic = found->second;
  traffic.rate.Add(now, static_cast<std::int64_t>(bytes.size()));
  traffic.last = now;

  const auto* entry = bus::FindChannel(channel);
  if (entry == nullptr) return;
  if (entry->name == bus::kHealth.name) {
    TakeHealth(traffic, bytes, now);
    return;
  }
  bool is_good = false;
  ForEachType([&]<typename T>(const T& /*message*/) {
    if constexpr (requires(T message) { message.seq; }) {
      if (T::getTypeName() != entry->type) return;
      const auto message = bus::Decode<T>(bytes);
      is_good = message && Note(*message, now);
      if (is_good && !bus::HasSeveralPublishers(*entry)) traffic.num_lost += NumLostBefore(*message, traffic.sequence);
    }
  });
  if (!is_good) ++traffic.num_bad;
}

void Board::CountAnew() {
  for (auto& [name, traffic] : channels_) traffic.num_lost = traffic.num_bad = 0;
  num_unlisted_ = num_unlisted_health_ = 0;
}

// Keeps the shown part of a message. @return false when it contradicts itself
template <typename T>
bool Board::Note(const T& message, TimePoint now) {
  if constexpr (std::is_same_v<T, obstacles_t>) {
    if (!messages::IsWellFormed(message)) return false;
    nearest_.Take(message, now);
  } else if constexpr (std::is_same_v<T, pose_t>) {
    nearest_.Take(message);
    own_.pose = message;
    own_.pose_time = now;
  } else if constexpr (std::is_same_v<T, tracks_t>) {
    if (!messages::IsWellFormed(message)) return false;
    const auto ended = tracks_parts_.Add(message);
    if (!ended.whole.empty()) KeepTracks(ended.whole, now);
    MarkAlerts();
    MarkShips();
  } else if constexpr (std::is_same_v<T, alerts_t>) {
    alerts_ = message;
    alerts_time_ = now;
    MarkAlerts();
  } else if constexpr (std::is_same_v<T, ais_t>) {
    ais_ = message;
    MarkShips();
  } else if constexpr (std::is_same_v<T, gnss_fix_t>) {
    own_.fix_quality = message.quality;
    own_.num_satellites = message.num_satellites;
    own_.fix_time = now;
  }
  return true;
}

void Board::KeepTracks(const std::vector<tracks_t>& parts, TimePoint now) {
  TrackPicture picture;
  picture.time = now;
  for (const auto& part : parts) {
    for (const auto& track : part.tracks) {
      if (track.status != track_t::STATUS_CONFIRMED && track.status != track_t::STATUS_COASTING) continue;
      TrackLine line{track};
      line.outline_east_m = line.outline_north_m = {};
      picture.lines.push_back(std::move(line));
    }
  }
  picture.num_tracks = static_cast<std::int64_t>(picture.lines.size());
  std::ranges::sort(picture.lines, [](const TrackLine& a, const TrackLine& b) {
    const auto key = [](const TrackLine& line) {
      return std::tuple(!std::isfinite(line.range_m), std::isfinite(line.range_m) ? line.range_m : 0.0F, line.id);
    };
    return key(a) < key(b);
  });
  picture.lines.resize(std::min(picture.lines.size(), TrackPicture::kMaxLines));
  std::ranges::sort(picture.lines, {}, &TrackLine::id);
  tracks_ = std::move(picture);
  tracks_begin_utime_us_ = parts.front().begin_utime_us;
  tracks_utime_us_ = parts.front().utime_us;
}

// AIS of a scan comes after its TRACKS: until then AIS of the scan before counts.
void Board::MarkShips() {
  constexpr std::int64_t kMostApartUs = 2'000'000;
  if (!tracks_) return;
  for (auto& line : tracks_->lines) line.ship.clear();
  auto& unseen = tracks_->unseen_ships;
  unseen.clear();
  if (!ais_ || ais_->tracks_begin_utime_us != tracks_begin_utime_us_ || std::abs(ais_->utime_us - tracks_utime_us_) > kMostApartUs) return;
  for (const auto& ship : ais_->ships) {
    const auto name = ship.name.empty() ? words::MmsiText(ship.mmsi) : Printable(ship.name);
    if (ship.state == ais_ship_t::STATE_AIS_ONLY) unseen.push_back({name, ship.range_m, ship.bearing_rad});
    if (ship.state != ais_ship_t::STATE_TRACKED) continue;
    const auto line = std::ranges::lower_bound(tracks_->lines, ship.track_id, {}, &TrackLine::id);
    if (line == tracks_->lines.end() || line->id != ship.track_id) continue;
    line->ship = name;
  }
  std::erase_if(unseen, [](const UnseenShip& ship) { return !std::isfinite(ship.range_m); });
  std::ranges::stable_sort(unseen, {}, &UnseenShip::range_m);
  unseen.resize(std::min(unseen.size(), TrackPicture::kMaxUnseenShips));
}

// Marks each track with its gravest alert.
void Board::MarkAlerts() {
  if (!tracks_ || !alerts_) return;
  for (auto& line : tracks_->lines) {
    line.alert_level = 0;
    for (const auto& alert : alerts_->alerts) {
      const bool holds = alert.state == alert_t::STATE_ACTIVE || alert.state == alert_t::STATE_ACKNOWLEDGED;
      if (!holds || alert.track_id != line.id || alert.level <= line.alert_level) continue;
      line.alert_level = alert.level;
      line.is_acknowledged = alert.state == alert_t::STATE_ACKNOWLEDGED;
    }
  }
}

bool Board::HasRoomFor(std::string_view process) const {
  const bool is_of_suite = IsOfSuite(process);
  const auto num_alike = std::ranges::count_if(processes_, [&](const auto& entry) { return IsOfSuite(entry.second.health.process) == is_of_suite; });
  return static_cast<std::size_t>(num_alike) < (is_of_suite ? kMaxProcesses - kMaxStrangers : kMaxStrangers);
}

void Board::TakeHealth(Traffic& traffic, Bytes bytes, TimePoint now) {
  auto message = bus::Decode<health_t>(bytes);
  if (!message) {
    ++traffic.num_bad;
    return;
  }
  const ProcessKey key{message->process, message->host, message->pid};
  if (!processes_.contains(key)) ForgetReplaced(now);
  if (!processes_.contains(key) && !HasRoomFor(message->process) && !ForgetSilent(message->process, now)) {
    ++num_unlisted_health_;
    return;
  }
  if (processes_.empty()) first_host_ = message->host;
  auto& process = processes_.try_emplace(key, ProcessState{{}, now, now, {}}).first->second;
  traffic.num_lost += process.sequence.NumLostBefore(message->seq);  // seq is per process
  process.health = std::move(*message);
  process.last = now;
}

// A process that starts anew has another process id, and the replaced process sends nothing after that. Where two processes run, both still send.
bool Board::IsReplaced(const ProcessKey& key, const ProcessState& process) const {
  return std::ranges::any_of(processes_, [&](const auto& other) {
    return other.first.name == key.name && other.first.host == key.host && other.first.pid != key.pid && other.second.first > process.last;
  });
}

void Board::ForgetReplaced(TimePoint now) {
  std::erase_if(processes_, [&](const auto& entry) { return now - entry.second.last > kSilence && IsReplaced(entry.first, entry.second); });
}

// The one that is silent for longest makes room, but never the only one of its name: that it is silent is what there is to show.
bool Board::ForgetSilent(std::string_view process, TimePoint now) {
  std::map<std::string_view, int> number;
  for (const auto& [key, state] : processes_) ++number[key.name];
  auto oldest = processes_.end();
  for (auto entry = processes_.begin(); entry != processes_.end(); ++entry) {
    const bool may_go = IsOfSuite(entry->first.name) == IsOfSuite(process) && now - entry->second.last > kSilence &&
                        (!IsOfSuite(process) || entry->first.name == process || number[entry->first.name] > 1);
    if (may_go && (oldest == processes_.end() || entry->second.last < oldest->second.last)) oldest = entry;
  }
  if (oldest == processes_.end()) return false;
  processes_.erase(oldest);
  return true;
}

std::vector<ChannelLine> Board::Channels(TimePoint now) const {
  std::vector<ChannelLine> lines;
  const auto add = [&](const std::string& name, const Traffic& traffic, const bus::Channel* entry) {
    ChannelLine line;
    line.name = name;
    line.rate = traffic.rate.At(now);
    if (entry != nullptr) line.num_lost = traffic.num_lost;
    line.num_bad = traffic.num_bad;
    line.age = now - traffic.last;
    line.is_silent = line.age > (name == bus::kRunInfo.name ? kRunInfoSilence : kSilence);
    lines.push_back(std::move(line));
  };
  for (const auto& entry : bus::kChannels) {
    const auto found = channels_.find(entry.name);
    if (found != channels_.end()) add(found->first, found->second, &entry);
  }
  for (const auto& [name, traffic] : channels_) {
    if (bus::FindChannel(name) == nullptr) add(name, traffic, nullptr);
  }
  return lines;
}

std::vector<ProcessLine> Board::Processes(TimePoint now) const {
  std::vector<const std::pair<const ProcessKey, ProcessState>*> sorted;
  for (const auto& entry : processes_) sorted.push_back(&entry);
  std::ranges::stable_sort(sorted, {}, [](const auto* entry) { return PlaceInSuite(entry->first.name); });
  std::vector<ProcessLine> lines;
  const auto num_of = [this, now](const std::string& name) {
    return std::ranges::count_if(processes_, [&](const auto& entry) {
      return entry.first.name == name && now - entry.second.last <= kSilence && !IsReplaced(entry.first, entry.second);
    });
  };
  for (const auto* entry : sorted) {
    const auto& [key, process] = *entry;
    if (IsReplaced(key, process)) continue;
    const auto& health = process.health;
    ProcessLine line;
    line.name = health.process + (health.host == first_host_ ? "" : "@" + health.host);
    line.age = now - process.last;
    line.is_silent = line.age > kSilence;
    line.state = health.state;
    line.reason = health.reason;
    if (const auto number = num_of(key.name); number > 1 && !line.is_silent) {
      line.reason = fmt::format("one of {} {}s on this bus: pid {} on {}{}{}", number, key.name, key.pid, key.host, health.reason.empty() ? "" : "; ",
                                health.reason);
    }
    line.cpu_fraction = health.cpu_fraction;
    line.resident_bytes = health.resident_bytes;
    line.latency_p99_us = GreatestLatencyUs(health);
    lines.push_back(std::move(line));
  }
  return lines;
}

const NearestObstacles* Board::Obstacles(TimePoint now) const {
  const auto& newest = nearest_.newest();
  return newest && now - newest->time <= kObstaclesAge ? &*newest : nullptr;
}

const TrackPicture* Board::Tracks(TimePoint now) const { return tracks_ && now - tracks_->time <= kObstaclesAge ? &*tracks_ : nullptr; }

std::vector<std::string> Board::AlertLines(TimePoint now) const {
  std::vector<std::string> lines;
  if (!alerts_) {
    // A tracker that does not run at all says nothing: the others do.
    const auto lacks_alerts = [now](const auto& entry) {
      return entry.first.name == kTracker || (IsOfSuite(entry.first.name) && now - entry.second.first >= kSilence);
    };
    if (std::ranges::any_of(processes_, lacks_alerts)) lines.emplace_back("NO LOOK-OUT: no ALERTS yet");
    return lines;
  }
  const bool is_old = now - alerts_time_ > kAlertsAge;
  if (is_old) lines.push_back(fmt::format("NO LOOK-OUT: no ALERTS for {:.0f} s", std::chrono::duration<double>(now - alerts_time_).count()));
  for (const auto state : std::initializer_list<std::int32_t>{alert_t::STATE_ACTIVE, alert_t::STATE_RECTIFIED}) {
    for (const auto& alert : alerts_->alerts) {
      if (alert.state != state || lines.size() == kMaxAlertLines) continue;
      // Alerts that stood when ALERTS stopped are still shown: their causes need not have gone.
      const bool is_over = state == alert_t::STATE_RECTIFIED;
      lines.push_back((is_old ? std::string(is_over ? "before that, over: " : "before that: ") : LevelText(*alerts_, alert)) + alert.text);
    }
  }
  return lines;
}

}  // namespace lookout::top
