#include "services/page/film/timeline.hpp"

#include <algorithm>
#include <set>

namespace lookout::page {

namespace {

using std::chrono::microseconds;
using std::chrono::seconds;

// Messages of one scan come within this time; a later message with its time is of another run.
constexpr seconds kScanSpread(5);
constexpr std::size_t kOpenScans = 16;
// The second lidar's scan of a moment ended no earlier than so long before the first's.
constexpr std::int64_t kSecondBeforeUs = 500'000;
constexpr seconds kRecent(5);           // HEALTH and other channels without a scan
constexpr std::size_t kMaxBack = 2000;  // messages of ALERTS that are looked through

bool Is(ChannelIndex channel, const bus::Channel& of) { return bus::kChannels[channel].name == of.name; }

bool MakesScans(ChannelIndex channel) {
  return Is(channel, bus::kLidarScan) || Is(channel, bus::kSegments) || Is(channel, bus::kObstacles) || Is(channel, bus::kTracks);
}

auto FirstAt(const std::deque<Place>& places, Utime time) { return std::ranges::lower_bound(places, time, {}, &Place::time); }
auto FirstAfter(const std::deque<Place>& places, Utime time) { return std::ranges::upper_bound(places, time, {}, &Place::time); }

// Whether this part was found already: a second publisher may have sent it too.
bool HasPart(const std::vector<Place>& places, std::uint16_t part) {
  return std::ranges::any_of(places, [part](const Place& place) { return place.part == part; });
}

// Places of one group: parts of a scan, or what all processes say in one second.
bool IsOneGroup(ChannelIndex channel, const Place& one, const Place& other) {
  if (Is(channel, bus::kHealth)) return std::chrono::floor<seconds>(one.time) == std::chrono::floor<seconds>(other.time);
  if (bus::HasSeveralPublishers(bus::kChannels[channel])) return false;
  return one.utime_us == other.utime_us && other.part > one.part;
}

}  // namespace

void Timeline::Append(const LogPart& part, std::uint16_t file, microseconds shift) {
  std::vector<std::uint16_t> processes;
  for (const auto& process : part.processes) {
    auto found = std::ranges::find(processes_, process);
    if (found == processes_.end()) found = processes_.insert(found, process);
    processes.push_back(static_cast<std::uint16_t>(found - processes_.begin()));
  }
  for (const auto& entry : part.entries) {
    const Utime time = begin_ ? std::max(end_, entry.time + shift) : entry.time + shift;
    const bool is_health = Is(entry.channel, bus::kHealth);
    const Place place{
        time, entry.utime_us, entry.offset_bytes, entry.size_bytes, entry.duration_us, is_health ? processes.at(entry.part) : entry.part, file};
    channels_[entry.channel].push_back(place);
    if (MakesScans(entry.channel)) NoteScan(place);
    end_ = time;
    if (!begin_) begin_ = time;
  }
  const auto shift_s = std::chrono::floor<seconds>(shift).count();
  for (auto cell : part.cells) {
    cell.second += shift_s;
    if (!cells_.empty() && cells_.back().second >= cell.second) {
      cells_.back().Add(cell);
    } else {
      cells_.push_back(cell);
    }
  }
  for (auto event : part.events) {
    event.time += shift;
    events_.insert(std::ranges::upper_bound(events_, event.time, {}, &FilmEvent::time), event);
  }
}

void Timeline::NoteScan(const Place& place) {
  const auto num_open = std::min(kOpenScans, scans_.size());
  for (std::size_t i = scans_.size(); i-- > scans_.size() - num_open;) {
    auto& scan = scans_[i];
    if (scan.utime_us != place.utime_us || place.time - scan.first > kScanSpread) continue;
    scan.end_utime_us = std::max(scan.end_utime_us, place.utime_us + place.duration_us);
    scan.last = place.time;
    for (std::size_t k = i; k < scans_.size(); ++k) scans_[k].whole = place.time;  // so that the times of `whole` never go back
    return;
  }
  scans_.push_back({place.utime_us, place.utime_us + place.duration_us, place.time, place.time, place.time});
}

void Timeline::DropBefore(Utime time) {
  if (!begin_ || time <= *begin_) return;
  for (auto& places : channels_) {
    // A moment needs the last RUN_INFO before it.
    const bool keeps_last = &places == &channels_[static_cast<std::size_t>(bus::FindChannel("RUN_INFO") - bus::kChannels.data())];
    while (!places.empty() && places.front().time < time && !(keeps_last && places.size() == 1)) places.pop_front();
  }
  while (!scans_.empty() && scans_.front().whole < time) scans_.pop_front();
  while (!cells_.empty() && cells_.front().second < std::chrono::floor<seconds>(time).time_since_epoch().count()) cells_.pop_front();
  while (!events_.empty() && events_.front().time < time) events_.pop_front();
  begin_ = std::min(time, end_);
}

const Timeline::Places& Timeline::Of(const bus::Channel& channel) const {
  return channels_[static_cast<std::size_t>(bus::FindChannel(channel.name) - bus::kChannels.data())];
}

bool Timeline::Holds(const bus::Channel& channel) const { return !Of(channel).empty(); }

Utime Timeline::OpensAt() const {
  const auto& tracks = Of(bus::kTracks);
  if (tracks.empty()) return begin();
  const auto& poses = Of(bus::kPose);
  auto first = tracks.begin();
  if (!poses.empty()) {
    first = std::ranges::find_if(tracks, [&](const Place& place) { return place.utime_us >= poses.front().utime_us; });
    if (first == tracks.end()) first = tracks.begin();
  }
  const auto scan = std::ranges::find(scans_, first->utime_us, &Scan::utime_us);
  return scan == scans_.end() ? begin() : std::max(scan->whole, begin());
}

Moment Timeline::Find(const At& request) const {
  if (request.scan_time) {
    Moment moment{.time = begin(), .scan = {}};
    std::uint64_t least = 0;
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      const auto distance = static_cast<std::uint64_t>(std::abs(scans_[i].utime_us - ToUtimeUs(*request.scan_time)));
      if (moment.scan && distance >= least) continue;
      least = distance;
      moment = {scans_[i].whole, i};
    }
    return moment;
  }
  const Utime time = std::clamp(request.time.value_or(end()), begin(), end());
  const auto after = std::ranges::upper_bound(scans_, time, {}, &Scan::whole) - scans_.begin();
  if (request.num_scans_on == 0 || scans_.empty()) {
    return {time, after == 0 ? std::nullopt : std::optional(static_cast<std::size_t>(after - 1))};
  }
  const auto wanted = std::clamp<std::int64_t>(std::int64_t{after} - 1 + request.num_scans_on, 0, static_cast<std::int64_t>(scans_.size()) - 1);
  const auto scan = static_cast<std::size_t>(wanted);
  return {scans_[scan].whole, scan};
}

std::vector<PlacesOfChannel> Timeline::Of(const Moment& moment, const std::vector<ChannelIndex>& channels) const {
  std::vector<PlacesOfChannel> found;
  const std::set<ChannelIndex> wanted(channels.begin(), channels.end());
  for (const auto channel : wanted) {
    if (channel < channels_.size()) found.push_back({channel, OfChannel(channel, moment)});
  }
  return found;
}

std::vector<Place> Timeline::OfChannel(ChannelIndex channel, const Moment& moment) const {
  const auto& places = channels_[channel];
  const Scan* const scan = moment.scan ? &scans_[*moment.scan] : nullptr;
  const auto after = FirstAfter(places, moment.time);
  if (MakesScans(channel) || Is(channel, bus::kLidarClock)) return scan == nullptr ? std::vector<Place>() : OfScan(places, *scan);
  if (Is(channel, bus::kLidarScan2) || Is(channel, bus::kSegments2)) return scan == nullptr ? std::vector<Place>() : OfSecond(places, *scan);
  if (Is(channel, bus::kPose)) return OfPose(places, moment);
  if (Is(channel, bus::kHealth)) {
    std::vector<Place> found;
    std::set<std::uint16_t> processes;
    for (auto place = after; place != places.begin() && moment.time - std::prev(place)->time <= kRecent; --place) {
      if (processes.insert(std::prev(place)->part).second) found.push_back(*std::prev(place));
    }
    std::ranges::sort(found, {}, &Place::part);
    return found;
  }
  if (Is(channel, bus::kAlerts)) {
    // One a scan, after its TRACKS, and later ones of the watch, which name the last scan, too: the last that was there by then counts.
    const auto is_of_scan = [&](const Place& place) { return place.utime_us == scan->utime_us; };
    if (scan == nullptr) return {};
    auto place = after;
    for (std::size_t i = 0; i < kMaxBack && place != places.begin() && std::prev(place)->time >= scan->first; ++i) {
      if (is_of_scan(*--place)) return {*place};
    }
    for (place = after; place != places.end() && place->time - scan->last <= kScanSpread; ++place) {
      if (is_of_scan(*place)) return {*place};
    }
    return {};
  }
  if (places.empty()) return {};
  if (Is(channel, bus::kRunInfo)) return {after == places.begin() ? *after : *std::prev(after)};
  if (after != places.begin() && moment.time - std::prev(after)->time <= kRecent) return {*std::prev(after)};
  return {};
}

std::vector<Place> Timeline::OfScan(const Places& places, const Scan& scan) const {
  std::vector<Place> found;
  for (auto place = FirstAt(places, scan.first - kScanSpread); place != places.end() && place->time <= scan.last; ++place) {
    if (place->utime_us != scan.utime_us || scan.last - place->time > 2 * kScanSpread) continue;
    if (!HasPart(found, place->part)) found.push_back(*place);
  }
  std::ranges::sort(found, {}, &Place::part);
  return found;
}

std::vector<Place> Timeline::OfSecond(const Places& places, const Scan& scan) const {
  std::vector<Place> found;
  for (auto place = FirstAt(places, scan.first - kScanSpread); place != places.end() && place->time <= scan.last + kScanSpread; ++place) {
    const auto end_utime_us = place->utime_us + place->duration_us;
    if (end_utime_us > scan.end_utime_us || scan.end_utime_us - end_utime_us > kSecondBeforeUs) continue;
    if (!found.empty() && place->utime_us < found.back().utime_us) continue;
    if (!found.empty() && place->utime_us > found.back().utime_us) found.clear();
    if (!HasPart(found, place->part)) found.push_back(*place);
  }
  std::ranges::sort(found, {}, &Place::part);
  return found;
}

std::vector<Place> Timeline::OfPose(const Places& places, const Moment& moment) const {
  const Scan* const scan = moment.scan ? &scans_[*moment.scan] : nullptr;
  const auto after = FirstAfter(places, moment.time);
  if (scan == nullptr) return after == places.begin() ? std::vector<Place>() : std::vector<Place>{*std::prev(after)};
  // From the last that is not after the first firing on: returns are placed by the attitude at their time.
  std::vector<Place> found;
  std::int64_t begin_utime_us = INT64_MIN;
  for (auto place = FirstAt(places, scan->first - 2 * kScanSpread); place != places.end() && place->time <= scan->last + kScanSpread; ++place) {
    if (place->utime_us > scan->end_utime_us) continue;
    found.push_back(*place);
    if (place->utime_us <= scan->utime_us) begin_utime_us = std::max(begin_utime_us, place->utime_us);
  }
  std::erase_if(found, [&](const Place& place) { return place.utime_us < begin_utime_us; });
  std::ranges::stable_sort(found, {}, &Place::utime_us);
  const auto is_again = [](const Place& one, const Place& other) { return one.utime_us == other.utime_us; };
  found.erase(std::unique(found.begin(), found.end(), is_again), found.end());
  return found;
}

std::vector<Place> Timeline::Of(const Range& request, std::int64_t max_bytes) const {
  std::vector<Place> found;
  if (request.channel >= channels_.size() || request.max_messages <= 0) return found;
  const auto& places = channels_[request.channel];
  const auto begin = static_cast<std::size_t>(FirstAt(places, request.from) - places.begin());
  const auto end = static_cast<std::size_t>(FirstAfter(places, request.to) - places.begin());
  std::vector<std::size_t> groups;  // where each begins
  std::int64_t num_bytes = 0;
  for (std::size_t i = begin; i < end; ++i) {
    if (i == begin || !IsOneGroup(request.channel, places[i - 1], places[i])) groups.push_back(i);
    num_bytes += places[i].size_bytes;
  }
  if (groups.empty()) return found;
  // As many groups as the mean says; where theirs are larger, fewer.
  double share = std::min(1.0, static_cast<double>(request.max_messages) / static_cast<double>(end - begin));
  if (num_bytes > max_bytes) share = std::min(share, static_cast<double>(max_bytes) / static_cast<double>(num_bytes));
  const auto num_groups = std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(groups.size())));
  groups.push_back(end);
  std::int64_t given_bytes = 0;
  for (std::size_t k = 0; k < num_groups; ++k) {
    const auto group = k * (groups.size() - 1) / num_groups;
    std::int64_t group_bytes = 0;
    for (auto i = groups[group]; i < groups[group + 1]; ++i) group_bytes += places[i].size_bytes;
    const auto group_size = groups[group + 1] - groups[group];
    if (found.size() + group_size > static_cast<std::size_t>(request.max_messages) || given_bytes + group_bytes > max_bytes) continue;
    given_bytes += group_bytes;
    for (auto i = groups[group]; i < groups[group + 1]; ++i) found.push_back(places[i]);
  }
  return found;
}

}  // namespace lookout::page
