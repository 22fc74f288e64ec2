#include "tools/doctor/watch.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/bus/services.hpp"
#include "common/core/angles.hpp"
#include "common/core/utime.hpp"
#include "common/io/source.hpp"
#include "common/io/udp_receiver.hpp"
#include "common/runtime/process.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/lidar/sensor_beams.hpp"
#include "services/lidar/service.hpp"
#include "services/lidar/sources.hpp"
#include "services/navigator/service.hpp"
#include "services/navigator/sources.hpp"
#include "services/tracker/alert_text.hpp"
#include "services/tracker/wire.hpp"
#include "tools/doctor/cable.hpp"

namespace lookout::doctor {

namespace {

using SteadyClock = std::chrono::steady_clock;

// HEALTH comes once a second: a process that is silent for longer does not run.
constexpr std::chrono::milliseconds kHealthWait(1500);
constexpr std::chrono::milliseconds kPoll(5);
// lcm-log: sync word, number, time, two lengths.
constexpr std::int64_t kEventHeaderBytes = 28;

// Whichever service fills the role on this boat.
std::string LidarService() { return std::string(bus::PublisherName(bus::kLidarScan)); }

// Taken from one source before the others get their turn: 100 ms of packets in dual return.
constexpr int kMaxDatagramsPerPoll = 150;

// Reads the lidar's datagrams as lookout-lidar does, and publishes on `bus` as it would.
class OwnLidar {
 public:
  /// @throws std::runtime_error when a port or the interface cannot be opened
  OwnLidar(bus::Bus& bus, const lidar::Params& params) : params_(params), service_(bus, params), beams_(params, service_) {
    if (params.sources.kind == lidar::Sources::Kind::kInterface) {
      sources_.push_back(std::make_unique<lidar::LiveCapture>(lidar::ToLiveOptions(params)));
      return;
    }
    for (const int port : {params.data_port, params.position_port}) {
      auto options = lidar::ToUdpOptions(params.sources, port);
      options.allowed_source_addresses.clear();  // every sender is to be seen; which is allowed is decided here
      sources_.push_back(std::make_unique<io::UdpReceiver>(options));
    }
  }

  /// Takes waiting datagrams. @param seen  gets senders and complaint. @param survey  hears each
  void Poll(Utime now, LidarSeen& seen, lidar::Survey& survey) {
    const auto& allowed = params_.sources.allowed_source_addresses;
    const bool is_udp = params_.sources.kind == lidar::Sources::Kind::kUdp;
    for (auto& source : sources_) {
      source->Poll(now);
      for (int i = 0; i < kMaxDatagramsPerPoll; ++i) {
        const auto datagram = source->Receive(now);
        if (!datagram) break;
        const auto& sender = datagram->source_address;
        if (is_udp && datagram->port == params_.data_port) ++seen.num_by_sender[sender];
        survey.Add(datagram->host_time, sender, datagram->destination_address, datagram->port, datagram->bytes);
        if (is_udp && !allowed.empty() && std::ranges::find(allowed, sender) == allowed.end()) continue;
        service_.OnDatagram(datagram->host_time, datagram->port, datagram->bytes, {sender, datagram->source_port});
      }
      if (!source->fault().empty()) seen.fault = source->fault();
    }
    service_.AdvanceTo(now);
    beams_.Poll(now);
    auto report = service_.Report();
    beams_.AddTo(report);
    seen.complaint = report.reason;
  }

 private:
  lidar::Params params_;
  lidar::Service service_;
  lidar::SensorBeams beams_;
  std::vector<std::unique_ptr<io::Source>> sources_;
};

// Stands in for lookout-navigator, as OwnLidar does for lookout-lidar. Text logs are not played.
class OwnNavigator {
 public:
  /// @param seen  gets the inputs that cannot be opened
  OwnNavigator(bus::Bus& bus, const navigator::Params& params, NavigationSeen& seen) : service_(bus, params) {
    for (const auto& connection : params.connections) {
      if (connection.kind == navigator::Connection::Kind::kTextLog) continue;
      try {
        inputs_.emplace_back(connection.name, navigator::OpenSource(connection));
      } catch (const std::exception& error) {
        seen.input_faults.emplace_back(connection.name, error.what());
      }
    }
  }

  void Poll(Utime now, NavigationSeen& seen) {
    for (auto& [name, source] : inputs_) {
      source->Poll(now);
      for (int i = 0; i < kMaxDatagramsPerPoll; ++i) {
        const auto piece = source->Receive(runtime::HostNow());
        if (!piece) break;
        navigator::Pass(name, *piece, service_);
      }
    }
    service_.AdvanceTo(now);
    seen.complaint = service_.Report().reason;
  }

  /// Adds the faults of inputs that are still not open.
  void Finish(NavigationSeen& seen) const {
    for (const auto& [name, source] : inputs_) {
      if (const auto fault = source->fault(); !fault.empty()) seen.input_faults.emplace_back(name, fault);
    }
  }

 private:
  navigator::Service service_;
  std::vector<std::pair<std::string, std::unique_ptr<io::Source>>> inputs_;
};

class Watcher {
 public:
  Watcher(Observations& seen, MountingWatch* mounting) : seen_(seen), mounting_(mounting), notes_(seen, runtime::HostNow) {
    if (seen_.bus.fault.empty()) OpenBus();
  }

  void Run(std::chrono::milliseconds duration) {
    const auto start = SteadyClock::now();
    if (lcm_) ListenUntil(start + kHealthWait);
    notes_.ListenTo(memory_, Via::kItself);
    if (mounting_ != nullptr) mounting_->ListenTo(memory_);
    OpenOwnSources();
    // Time to see a rate, whenever it began.
    ListenUntil(std::max(start + duration, SteadyClock::now() + duration / 2));
    if (navigator_) navigator_->Finish(seen_.navigation);
    ForgivePortsOfProcesses(seen_);
    seen_.lidar.speakers = survey_.Speakers();
    seen_.lidar.num_fragments_lost = std::max<std::int64_t>(0, NumReassemblyFailures() - num_reassembly_failures_);
    seen_.end = runtime::HostNow();
    seen_.watched_s = ToSeconds(SteadyClock::now() - start);
    if (seen_.lidar.via == Via::kBus && seen_.lidar.num_packets > 0) {
      seen_.disk.rate_bytes_per_s = static_cast<double>(notes_.num_log_bytes()) / seen_.watched_s;
    }
    if (const auto* health = seen_.LastHealth(LidarService())) seen_.lidar.complaint = health->reason;
    if (const auto* health = seen_.LastHealth("navigator")) seen_.navigation.complaint = health->reason;
  }

 private:
  void OpenBus() {
    try {
      lcm_.emplace(seen_.bus.url);
      notes_.ListenTo(*lcm_, Via::kBus);
      notes_.ListenToProcesses(*lcm_);
      if (mounting_ != nullptr) mounting_->ListenTo(*lcm_);
      // For a navigator of our own, when the lidar's process runs.
      lcm_->SubscribeRaw(bus::kLidarNmea, [this](std::string_view, Bytes bytes) { memory_.Publish(bus::kLidarNmea, {bytes.begin(), bytes.end()}); });
      lcm_->HandleOnce(std::chrono::milliseconds(0));  // joins LCM's group
    } catch (const std::exception& error) {
      seen_.bus.fault = error.what();
      lcm_.reset();
    }
  }

  void OpenOwnSources() {
    const auto& config = seen_.config;
    if (seen_.processes.contains(LidarService())) {
      seen_.lidar.via = Via::kBus;
    } else if (config.lidar &&
               (config.lidar->sources.kind == lidar::Sources::Kind::kUdp || config.lidar->sources.kind == lidar::Sources::Kind::kInterface)) {
      seen_.lidar.via = Via::kItself;
      try {
        lidar_.emplace(memory_, *config.lidar);
      } catch (const std::exception& error) {
        seen_.lidar.fault = error.what();
      }
    }
    std::vector<int> ports;
    for (const auto* lidar : {&config.lidar, &config.lidar_2}) {
      if (*lidar) ports.insert(ports.end(), {(*lidar)->data_port, (*lidar)->position_port});
    }
    cable_.emplace(ports);
    if (seen_.processes.contains("navigator")) {
      seen_.navigation.via = Via::kBus;
    } else if (config.navigation && !config.navigation->reads_nav_raw) {
      seen_.navigation.via = Via::kItself;
      navigator_.emplace(memory_, *config.navigation, seen_.navigation);
    }
  }

  void ListenUntil(SteadyClock::time_point end) {
    while (SteadyClock::now() < end) {
      const auto now = runtime::HostNow();
      if (lidar_) lidar_->Poll(now, seen_.lidar, survey_);
      if (cable_) cable_->Poll(now, survey_);
      if (navigator_) navigator_->Poll(now, seen_.navigation);
      while (memory_.HandleOnce()) {
      }
      if (lcm_) {
        // Waits for one, then takes those that came with it.
        if (lcm_->HandleOnce(kPoll)) {
          const auto round_end = std::min(end, SteadyClock::now() + kPoll);
          while (SteadyClock::now() < round_end && lcm_->HandleOnce(std::chrono::milliseconds(0))) {
          }
        }
      } else {
        std::this_thread::sleep_for(kPoll);
      }
    }
  }

  Observations& seen_;
  MountingWatch* mounting_;
  Notes notes_;
  bus::MemoryBus memory_;
  std::optional<bus::LcmBus> lcm_;
  std::optional<OwnLidar> lidar_;
  std::optional<OwnNavigator> navigator_;
  std::optional<Cable> cable_;
  lidar::Survey survey_;
  std::int64_t num_reassembly_failures_ = NumReassemblyFailures();
};

}  // namespace

Notes::Notes(Observations& seen, std::function<Utime()> clock) : seen_(seen), clock_(std::move(clock)) {}

void Notes::ListenTo(bus::Bus& bus, Via via) {
  bus::Subscribe<lidar_packets_t>(bus, bus::kLidarPackets, [this, via](const lidar_packets_t& message) { OnPackets(message, via); });
  bus::Subscribe<lidar_clock_t>(bus, bus::kLidarClock, [this](const lidar_clock_t& message) {
    if (!seen_.lidar.first_clock) seen_.lidar.first_clock = message;
    seen_.lidar.last_clock = message;
  });
  bus::Subscribe<lidar_scan_t>(bus, bus::kLidarScan, [this](const lidar_scan_t& message) { OnScan(message); });
  bus::Subscribe<nav_raw_t>(bus, bus::kNavRaw, [this, via](const nav_raw_t& message) {
    seen_.navigation.via = via;
    if (message.kind == nav_raw_t::KIND_SENTENCE || message.kind == nav_raw_t::KIND_IMU) ++seen_.navigation.num_by_source[message.source];
  });
  bus::Subscribe<gnss_fix_t>(bus, bus::kGnssFix, [this](const gnss_fix_t& message) { OnFix(message); });
  bus::Subscribe<attitude_t>(bus, bus::kAttitude, [this](const attitude_t& message) {
    ++seen_.navigation.told_by_source[message.source].num_attitudes;
    if (std::isfinite(message.heading_rad)) seen_.navigation.heading = message;
  });
  bus::Subscribe<pose_t>(bus, bus::kPose, [this](const pose_t& message) { seen_.navigation.pose = message; });
}

void Notes::ListenToProcesses(bus::Bus& bus) {
  bus::Subscribe<health_t>(bus, bus::kHealth, [this](const health_t& message) { OnHealth(message); });
  bus::Subscribe<obstacles_t>(bus, bus::kObstacles, [this](const obstacles_t& message) {
    auto& obstacles = seen_.obstacles;
    if (message.part_index == message.num_parts - 1) ++obstacles.num_scans;
    obstacles.num_obstacles += message.num_obstacles;
    for (const auto& obstacle : message.obstacles) {
      obstacles.num_placed += obstacle.status == obstacle_t::STATUS_OK ? 1 : 0;
      obstacles.num_timeouts += obstacle.status == obstacle_t::STATUS_POSE_TIMEOUT ? 1 : 0;
    }
  });
  bus::Subscribe<tracks_t>(bus, bus::kTracks, [this](const tracks_t& message) {
    auto& look_out = seen_.look_out;
    if (message.part_index == 0) look_out.num_tracks = look_out.num_moving = 0;
    for (const auto& track : message.tracks) {
      if (track.status != track_t::STATUS_CONFIRMED && track.status != track_t::STATUS_COASTING) continue;
      ++look_out.num_tracks;
      look_out.num_moving += track.speed_mps > 0.0F ? 1 : 0;
    }
    if (message.part_index == message.num_parts - 1) ++look_out.num_scans;
    look_out.tracks_heard = clock_();
  });
  bus::Subscribe<alerts_t>(bus, bus::kAlerts, [this](const alerts_t& message) {
    seen_.look_out.alerts = message;
    seen_.look_out.alerts_heard = clock_();
  });
  bus.SubscribeAll([this](std::string_view channel, Bytes bytes) {
    num_log_bytes_ += kEventHeaderBytes + static_cast<std::int64_t>(channel.size() + bytes.size());
  });
}

void Notes::OnPackets(const lidar_packets_t& message, Via via) {
  auto& lidar = seen_.lidar;
  lidar.via = via;
  if (!seen_.config.lidar) return;
  for (int i = 0; i < message.num_packets; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const auto time = UtimeFromWire(message.host_utime_us[index]);
    if (!time || message.udp_port[index] != seen_.config.lidar->data_port) continue;
    if (lidar.num_packets == 0) lidar.first = *time;
    lidar.last = *time;
    ++lidar.num_packets;
    lidar.heard_last = clock_();
  }
}

void Notes::OnScan(const lidar_scan_t& message) {
  seen_.lidar.model = message.model;
  seen_.lidar.num_returns = message.num_returns;
  if (!message.return_kind.empty()) seen_.lidar.return_kind = message.return_kind.front();
  if (messages::FaultOf(message, bus::kMaxMessageBytes)) return;
  CountAzimuths(message);
  if (!seen_.config.tracker) return;
  if (message.num_parts == 1 && scan_parts_.is_empty()) return LookAtZone({&message, 1});
  LookAtZone(scan_parts_.Add(message).whole);
}

void Notes::CountAzimuths(const lidar_scan_t& message) {
  const auto& boat = seen_.config.boat;
  const double own_radius_m =
      boat ? (boat->own_vessel_box_m.diagonal().norm() + (boat->own_vessel_box_m.center() - boat->T_vessel_lidar.translation()).norm()) : 0.0;
  const auto num_rings = static_cast<std::size_t>(message.num_rings);
  const auto num_returns = static_cast<std::size_t>(message.num_returns);
  for (std::size_t column = 0; column < static_cast<std::size_t>(message.num_columns); ++column) {
    for (std::size_t ring = 0; ring < num_rings; ++ring) {
      const double azimuth_rad = WrapTo2Pi(double{message.azimuth_rad[column]} + message.azimuth_offset_rad[ring]);
      auto& azimuth = seen_.lidar.azimuths.at(static_cast<std::size_t>(RadToDeg(azimuth_rad)) % seen_.lidar.azimuths.size());
      ++azimuth.num_shots;
      const auto range = static_cast<std::uint16_t>(message.range[(column * num_rings + ring) * num_returns]);
      const double range_m = range * message.range_unit_m;
      if (range != 0) ++azimuth.num_returns;
      if (range == 0 || range_m > own_radius_m) continue;
      const double level_m = range_m * std::cos(message.elevation_rad[ring]);
      const Eigen::Vector3d p_lidar_m(level_m * std::cos(azimuth_rad), -level_m * std::sin(azimuth_rad),
                                      range_m * std::sin(message.elevation_rad[ring]) + message.origin_height_m[ring]);
      azimuth.num_own += boat->own_vessel_box_m.contains(boat->T_vessel_lidar * p_lidar_m) ? 1 : 0;
    }
  }
}

// Scans that lack a part say nothing here.
void Notes::LookAtZone(std::span<const lidar_scan_t> parts) {
  if (parts.empty()) return;
  const auto beams = tracker::ToBeams(parts);
  if (!beams) return;
  if (!zone_sight_) zone_sight_.emplace(seen_.config.tracker->zone_sight);
  zone_sight_->Update(beams->key.time, beams->sweep);
  seen_.zone_unseen = zone_sight_->parts().empty() ? "" : tracker::TextOf(zone_sight_->parts(), zone_sight_->is_whole());
}

// A receiver tells one epoch in several sentences, maybe to several inputs, and not each tells how many satellites there are.
void Notes::OnFix(const gnss_fix_t& message) {
  auto& told = seen_.navigation.told_by_source[message.source];
  told.num_places += std::isfinite(message.latitude_deg) ? 1 : 0;
  told.num_fixes += message.quality != gnss_fix_t::QUALITY_NONE ? 1 : 0;
  auto& fix = seen_.navigation.fix;
  const bool says_less = fix && fix->num_satellites >= 0 && message.num_satellites < 0;
  constexpr std::int64_t kEpochUs = 1'500'000;  // of the slowest receivers, a fix a second, and some delay
  if (says_less && fix->quality > 0 && message.quality > 0 && std::abs(message.arrival_utime_us - fix->arrival_utime_us) < kEpochUs) return;
  fix = message;
  seen_.navigation.fix_heard = clock_();
}

void Notes::OnHealth(const health_t& message) {
  auto& instances = seen_.processes[message.process];
  const auto now = clock_();
  const auto found =
      std::ranges::find_if(instances, [&message](const ProcessSeen& seen) { return seen.last.pid == message.pid && seen.last.host == message.host; });
  if (found == instances.end()) {
    instances.push_back({message, message, now});
  } else {
    found->last = message;
    found->heard_last = now;
  }
}

void Watch(Observations& seen, std::chrono::milliseconds duration, MountingWatch* mounting) { Watcher(seen, mounting).Run(duration); }

void ForgivePortsOfProcesses(Observations& seen) {
  if (!seen.lidar.fault.empty() && seen.processes.contains(LidarService())) {
    seen.lidar.fault.clear();
    seen.lidar.via = Via::kBus;
  }
  if (!seen.navigation.input_faults.empty() && seen.processes.contains("navigator")) {
    seen.navigation.input_faults.clear();
    seen.navigation.via = Via::kBus;
  }
}

}  // namespace lookout::doctor
