// What a page is given at most: ten scans a second of so many returns and so many tracks, on the bus, with the times of now. They are made of a log
// with dual returns, to and fro, so that what moves in it goes on moving.
//   load_page --log FILE --seconds N [--returns N] [--tracks N]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/segments_t.hpp"
#include "lookout/tracks_t.hpp"

namespace {

using namespace lookout;
using SteadyClock = std::chrono::steady_clock;

constexpr int kMaxScans = 100;
constexpr int kPosesAScan = 5;
constexpr double kMetresADegree = 111'000;

struct Options {
  std::string log;
  int length_s = 60;
  int num_returns = 30'000;
  std::size_t num_tracks = 200;
};

struct Moment {
  std::vector<lidar_scan_t> scans;
  std::vector<segments_t> segments;
  std::vector<obstacles_t> obstacles;
  std::vector<tracks_t> tracks;
  std::vector<alerts_t> alerts;
  std::vector<pose_t> poses;
};

template <typename T>
void Take(std::vector<T>& messages, Bytes bytes) {
  if (auto message = bus::Decode<T>(bytes)) messages.push_back(*std::move(message));
}

std::int64_t HostUtimeUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// Empty cells become returns of a wall of many steps, until there are enough.
int Fill(Moment& moment, int num_wanted) {
  int num_returns = 0;
  for (const auto& scan : moment.scans)
    num_returns += static_cast<int>(std::count_if(scan.range.begin(), scan.range.end(), [](auto range) { return range != 0; }));
  for (std::size_t part = 0; part < moment.scans.size(); ++part) {
    auto& scan = moment.scans[part];
    for (std::size_t i = 0; i < scan.range.size() && num_returns < num_wanted; ++i) {
      if (scan.range[i] != 0) continue;
      scan.range[i] = static_cast<std::int16_t>(5'000 + (i * 37) % 20'000);
      scan.reflectivity[i] = static_cast<std::uint8_t>(i % 200);
      if (part < moment.segments.size() && i < moment.segments[part].label.size())
        moment.segments[part].label[i] = static_cast<std::int16_t>(1 + (i / 64) % 8);
      ++num_returns;
    }
  }
  return num_returns;
}

// The tracks of the scan again and again, each time further to the east and north.
void Multiply(std::vector<tracks_t>& parts, std::size_t num_wanted) {
  if (parts.empty() || parts[0].tracks.empty()) return;
  std::vector<track_t> tracks;
  for (const auto& part : parts) tracks.insert(tracks.end(), part.tracks.begin(), part.tracks.end());
  const auto num_given = tracks.size();
  for (std::size_t i = num_given; i < num_wanted; ++i) {
    auto track = tracks[i % num_given];
    const double away_m = 12.0 * static_cast<double>(i / num_given);
    track.id += 1'000'000 * static_cast<std::int64_t>(i / num_given);
    track.position_map_m[0] += away_m;
    track.position_map_m[1] += (i % 2 == 0 ? 0.5 : -0.5) * away_m;
    track.latitude_deg += (i % 2 == 0 ? 0.5 : -0.5) * away_m / kMetresADegree;
    track.longitude_deg += away_m / kMetresADegree;
    tracks.push_back(track);
  }
  const auto head = parts[0];
  parts.clear();
  constexpr std::size_t kTracksAPart = 100;
  for (std::size_t begin = 0; begin < tracks.size(); begin += kTracksAPart) {
    auto part = head;
    part.tracks.assign(tracks.begin() + static_cast<std::ptrdiff_t>(begin),
                       tracks.begin() + static_cast<std::ptrdiff_t>(std::min(tracks.size(), begin + kTracksAPart)));
    part.num_tracks = static_cast<std::int32_t>(part.tracks.size());
    part.part_index = static_cast<std::int32_t>(parts.size());
    parts.push_back(std::move(part));
  }
  for (auto& part : parts) part.num_parts = static_cast<std::int32_t>(parts.size());
}

std::vector<Moment> Read(const Options& options) {
  bus::LogReader reader(options.log);
  std::map<std::int64_t, Moment> moments;
  std::vector<pose_t> poses;
  while (auto event = reader.Next()) {
    const Bytes bytes(event->bytes);
    Moment moment;
    std::int64_t seq = -1;
    const auto take = [&](auto& messages, auto member) {
      Take(messages, bytes);
      if (messages.empty()) return;
      seq = messages[0].seq;
      auto& into = moments[seq].*member;
      into.insert(into.end(), messages.begin(), messages.end());
    };
    if (event->channel == bus::kLidarScan.name) take(moment.scans, &Moment::scans);
    if (event->channel == bus::kSegments.name) take(moment.segments, &Moment::segments);
    if (event->channel == bus::kObstacles.name) take(moment.obstacles, &Moment::obstacles);
    if (event->channel == bus::kTracks.name) take(moment.tracks, &Moment::tracks);
    if (event->channel == bus::kAlerts.name) take(moment.alerts, &Moment::alerts);
    if (event->channel == bus::kPose.name) Take(poses, bytes);
  }
  std::vector<Moment> whole;
  for (auto& [seq, moment] : moments) {
    if (moment.scans.empty() || moment.segments.size() != moment.scans.size() || moment.tracks.empty() || moment.tracks[0].tracks.empty()) continue;
    const auto end = std::find_if(poses.begin(), poses.end(), [&](const pose_t& pose) { return pose.utime_us > moment.scans[0].end_utime_us; });
    moment.poses.assign(end - std::min<std::ptrdiff_t>(kPosesAScan, end - poses.begin()), end);
    whole.push_back(std::move(moment));
    if (whole.size() == kMaxScans) break;
  }
  return whole;
}

template <typename T>
void Send(bus::Bus& bus, const bus::Channel& channel, std::vector<T>& messages, std::int64_t seq, std::int64_t later_us) {
  for (auto message : messages) {
    message.seq = seq;
    message.utime_us += later_us;
    message.end_utime_us += later_us;
    bus.Publish(channel, bus::Encode(message));
  }
}

void SendAll(bus::Bus& bus, Moment& moment, std::int64_t seq) {
  const auto later_us = HostUtimeUs() - moment.scans[0].end_utime_us;
  for (auto pose : moment.poses) {
    pose.utime_us += later_us;
    bus.Publish(bus::kPose, bus::Encode(pose));
  }
  Send(bus, bus::kLidarScan, moment.scans, seq, later_us);
  Send(bus, bus::kSegments, moment.segments, seq, later_us);
  Send(bus, bus::kObstacles, moment.obstacles, seq, later_us);
  for (auto& part : moment.tracks) {
    for (auto& track : part.tracks) track.seen_utime_us = HostUtimeUs();
  }
  Send(bus, bus::kTracks, moment.tracks, seq, later_us);
  for (auto alerts : moment.alerts) {
    alerts.seq = seq;
    alerts.utime_us += later_us;
    bus.Publish(bus::kAlerts, bus::Encode(alerts));
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    if (name == "--log") options.log = argv[i + 1];
    if (name == "--seconds") options.length_s = std::stoi(argv[i + 1]);
    if (name == "--returns") options.num_returns = std::stoi(argv[i + 1]);
    if (name == "--tracks") options.num_tracks = std::stoul(argv[i + 1]);
  }
  auto moments = Read(options);
  if (moments.size() < 2) {
    std::fprintf(stderr, "%s holds no scans with segments and tracks\n", options.log.c_str());
    return 1;
  }
  int least_returns = options.num_returns;
  for (auto& moment : moments) {
    least_returns = std::min(least_returns, Fill(moment, options.num_returns));
    Multiply(moment.tracks, options.num_tracks);
  }
  bus::LcmBus bus(bus::DefaultLcmUrl());
  std::printf("sends: %zu moments, %d returns or more, %zu tracks\n", moments.size(), least_returns, options.num_tracks);
  std::fflush(stdout);
  const auto begin = SteadyClock::now();
  const std::int64_t num_scans = std::int64_t{10} * options.length_s;
  const auto period = 2 * (static_cast<std::int64_t>(moments.size()) - 1);
  for (std::int64_t seq = 0; seq < num_scans; ++seq) {
    std::this_thread::sleep_until(begin + std::chrono::milliseconds(100 * seq));
    const auto place = seq % period;
    SendAll(bus, moments[static_cast<std::size_t>(std::min(place, period - place))], seq);
  }
  std::printf("sent %lld scans, %lld messages were not taken\n", static_cast<long long>(num_scans), static_cast<long long>(bus.num_unsent()));
}
