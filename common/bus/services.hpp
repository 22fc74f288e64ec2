// The service table: one row per process of a boat, in the order of the data. Replay, systemd units, lookout-up, doctor, top and tests are made of it
// (deploy/ServiceTable.cmake reads these lines), the tables in README.md and deploy/README.md are tested against it. Outputs: the channels whose
// publisher is the role of the row.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"

namespace lookout::bus {

struct ServiceRow {
  std::string_view name;  // of its folder below services/; the program is lookout-<name>
  std::string_view role;  // which channels name as their publisher. one service may fill it
  std::string_view purpose;
  int watchdog_s;           // silence of the main loop after which systemd ends and restarts it; HEALTH feeds the watchdog once a second
  std::string_view needs;   // logs: writes to /var/lib/lookout; serial: opens serial ports; network: nothing else
  std::string_view hangup;  // effect of SIGHUP (systemctl reload)
  std::string_view state;   // remembered from message to message, and lost at a restart
  // nullptr: no more. The recorder reads every channel. HEALTH and RUN_INFO tell of processes, and are in no row.
  std::array<const Channel*, 16> inputs{};
};

// Readers stand behind the publishers of what they read. A boat starts them in the reverse order, so that no reader misses a first message.
inline constexpr std::array kServices{
    ServiceRow{
        "lidar", "lidar", "scans of the lidar", 10, "network", "new config, new run", "scan under way, sensor's clock, sender", {&kLidarBeams}},
    ServiceRow{"segmenter", "segmenter", "obstacles in the lidar's scans", 10, "network", "checks the config", "none", {&kLidarScan, &kLidarScan2}},
    ServiceRow{"odometer", "odometer", "own motion by the lidar", 10, "network", "checks the config", "what stood in sight, speed", {&kLidarScan}},
    ServiceRow{"navigator",
               "navigator",
               "position and attitude of the vessel",
               10,
               "serial",
               "new config, new run",
               "filter, latest measurements",
               {&kLidarNmea, &kLidarOdometry}},
    ServiceRow{"georeferencer",
               "georeferencer",
               "obstacles on the earth",
               10,
               "network",
               "checks the config",
               "poses, waiting scans",
               {&kSegments, &kSegments2, &kPose}},
    ServiceRow{"tracker",
               "tracker",
               "tracks, closest approach and alerts",
               10,
               "network",
               "checks the config",
               "tracks, land, alerts, poses, waiting scans",
               {&kObstacles, &kSegments, &kLidarScan, &kPose, &kAlertAck, &kOrders}},
    ServiceRow{"ais",
               "ais",
               "ships of AIS, and which tracks they are",
               10,
               "network",
               "checks the config",
               "ships, their tracks, poses, waiting scans",
               {&kNavRaw, &kTracks, &kPose}},
    ServiceRow{"plotter",
               "plotter",
               "targets and alerts for chart plotters, Signal K and NMEA 2000, distances for autopilots",
               10,
               "serial",
               "checks the config",
               "target numbers, what was told to whom",
               {&kLidarScan, &kLidarScan2, &kSegments, &kSegments2, &kTracks, &kAlerts, &kPose, &kAis}},
    ServiceRow{"page",
               "page",
               "the look-out in a browser",
               10,
               "logs",
               "checks the config",
               "who watches, the last minutes where no recorder runs",
               {&kLidarScan, &kLidarScan2, &kLidarClock, &kSegments, &kSegments2, &kGnssFix, &kAttitude, &kPose, &kObstacles, &kTracks, &kAlerts,
                &kAlertAck, &kAis}},
    ServiceRow{"recorder", "recorder", "every channel into a log", 60, "logs", "new log", "queue of what is not yet written", {}}};

constexpr bool Publishes(const ServiceRow& service, const Channel& channel) { return channel.publisher == service.role; }

/// The publisher of a channel, for people: the service that fills the role, or the word of the channel table where none does.
constexpr std::string_view PublisherName(const Channel& channel) {
  for (const auto& service : kServices) {
    if (Publishes(service, channel)) return service.name;
  }
  return channel.publisher;
}

/// The input from which replay computes the service's other outputs, if it publishes one: it holds all that the service consumed.
constexpr const Channel* RawOutput(const ServiceRow& service) {
  for (const auto& channel : kChannels) {
    if (channel.is_raw && Publishes(service, channel)) return &channel;
  }
  return nullptr;
}

/// Names of all services in the order in which a boat starts them.
inline std::vector<std::string> StartOrder() {
  std::vector<std::string> names;
  for (auto service = kServices.rbegin(); service != kServices.rend(); ++service) names.emplace_back(service->name);
  return names;
}

}  // namespace lookout::bus
