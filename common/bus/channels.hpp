// The channel table: one line per channel. Recorder, health report and README are checked against it.
#pragma once

#include <array>
#include <string_view>

namespace lookout::bus {

struct Channel {
  std::string_view name;
  std::string_view type;       // struct of package lookout
  std::string_view publisher;  // role of the process that sends it (services.hpp: who fills it); "all" for HEALTH, "several" where more than one may
  double max_rate_hz;          // messages per second, greatest expected
  int queue_depth;             // messages that a subscriber holds before the newest is dropped
  bool is_raw;                 // input from which all else can be computed again
  bool is_replayed;            // computed again by replay, byte for byte (or raw); else it tells of the machine
};

// Depths hold two seconds at the greatest rate. A scan in parts, or a scan in rain, comes as a burst.
inline constexpr Channel kLidarPackets{"LIDAR_PACKETS", "lidar_packets_t", "lidar", 100, 200, true, true};
inline constexpr Channel kLidarScan{"LIDAR_SCAN", "lidar_scan_t", "lidar", 40, 80, false, true};
inline constexpr Channel kLidarClock{"LIDAR_CLOCK", "lidar_clock_t", "lidar", 20, 40, false, true};
inline constexpr Channel kLidarOdometry{"LIDAR_ODOMETRY", "lidar_odometry_t", "odometer", 20, 40, false, true};
inline constexpr Channel kLidarNmea{"LIDAR_NMEA", "lidar_nmea_t", "lidar", 150, 300, false, true};
inline constexpr Channel kSegments{"SEGMENTS", "segments_t", "segmenter", 80, 160, false, true};
inline constexpr Channel kNavRaw{"NAV_RAW", "nav_raw_t", "navigator", 500, 1000, true, true};
inline constexpr Channel kGnssFix{"GNSS_FIX", "gnss_fix_t", "navigator", 40, 80, false, true};
inline constexpr Channel kAttitude{"ATTITUDE", "attitude_t", "navigator", 100, 200, false, true};
inline constexpr Channel kPose{"POSE", "pose_t", "navigator", 50, 1000, false, true};  // 0.1 s to 10 s come at once
inline constexpr Channel kObstacles{"OBSTACLES", "obstacles_t", "georeferencer", 80, 160, false, true};
inline constexpr Channel kTracks{"TRACKS", "tracks_t", "tracker", 80, 160, false, true};
inline constexpr Channel kAis{"AIS", "ais_t", "ais", 20, 40, false, true};
inline constexpr Channel kAlerts{"ALERTS", "alerts_t", "tracker", 22, 44, false, true};  // one a scan, and two a second where nobody looks
// Of a second lidar: config/<boat>/lidar_2.txtpb. Its segments go into OBSTACLES.
inline constexpr Channel kLidarPackets2{"LIDAR_PACKETS_2", "lidar_packets_t", "lidar", 100, 200, true, true};
inline constexpr Channel kLidarScan2{"LIDAR_SCAN_2", "lidar_scan_t", "lidar", 40, 80, false, true};
inline constexpr Channel kLidarClock2{"LIDAR_CLOCK_2", "lidar_clock_t", "lidar", 20, 40, false, true};
inline constexpr Channel kSegments2{"SEGMENTS_2", "segments_t", "segmenter", 80, 160, false, true};
// Published by the page, the plotter and other programs that show alerts. ALERTS say with which scan a message was used.
inline constexpr Channel kAlertAck{"ALERT_ACK", "alert_ack_t", "several", 10, 40, true, true};
inline constexpr Channel kOrders{"ORDERS", "order_t", "several", 2, 40, true, true};
// Published by each process of a lidar that has a table of beams, and written by the recorder into each of its files.
inline constexpr Channel kLidarBeams{"LIDAR_BEAMS", "lidar_beams_t", "several", 1, 10, true, true};
inline constexpr Channel kHealth{"HEALTH", "health_t", "all", 10, 40, false, false};
inline constexpr Channel kRunInfo{"RUN_INFO", "run_info_t", "recorder", 1, 10, false, false};
// Of a simulation: stands in its own log, never on a boat's bus.
inline constexpr Channel kSimTruth{"SIM_TRUTH", "sim_truth_t", "sim", 80, 160, false, false};

inline constexpr std::array kChannels{kLidarBeams, kLidarPackets,  kLidarScan,  kLidarClock,  kLidarOdometry, kLidarNmea, kSegments, kNavRaw,
                                      kGnssFix,    kAttitude,      kPose,       kObstacles,   kTracks,        kAis,       kAlerts,   kAlertAck,
                                      kOrders,     kLidarPackets2, kLidarScan2, kLidarClock2, kSegments2,     kHealth,    kRunInfo,  kSimTruth};

/// Whether more than one process may send it: then its messages carry no numbers of one stream.
constexpr bool HasSeveralPublishers(const Channel& channel) { return channel.publisher == "all" || channel.publisher == "several"; }

/// Whether it is of the second lidar, which few boats have: nothing waits for it, and no log must hold it.
constexpr bool IsOfSecondLidar(const Channel& channel) { return channel.name.ends_with("_2"); }

/// Greatest size of an encoded message. Measured with LCM 1.3.1: about 120 kB pass with the kernel's default buffers, 212 kB vanish.
inline constexpr int kMaxMessageBytes = 120'000;

/// @return nullptr when no channel has that name
constexpr const Channel* FindChannel(std::string_view name) {
  for (const auto& channel : kChannels) {
    if (channel.name == name) return &channel;
  }
  return nullptr;
}

}  // namespace lookout::bus
