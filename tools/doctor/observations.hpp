// Observations, in plain values, so that each check can be tested without a boat.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/utime.hpp"
#include "common/io/network.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/pose_t.hpp"
#include "services/lidar/params.hpp"
#include "services/lidar/survey.hpp"
#include "services/navigator/params.hpp"
#include "services/odometer/params.hpp"
#include "services/page/params.hpp"
#include "services/tracker/params.hpp"

namespace lookout::doctor {

/// The boat's config, as far as it is right.
struct ConfigSeen {
  std::map<std::string, std::vector<std::string>> files;  // by name, without the folder: lines "path:line: field: reason"; none = the file is right
  std::optional<config::BoatFacts> boat;
  std::optional<lidar::Params> lidar;
  std::string lidar_place = "lidar.txtpb";  // file where the lidar's values stand, or belong, for people
  std::optional<lidar::Params> lidar_2;     // nullopt: no second lidar, or its file is wrong
  std::optional<navigator::Params> navigation;
  std::optional<tracker::Params> tracker;
  std::optional<odometer::Params> odometer;
  std::optional<std::filesystem::path> log_folder;  // as the recorder's config says: may be relative
  std::int64_t log_reserve_bytes = 0;               // bytes of the disk that the recorder leaves free
  bool has_plotter_outputs = true;                  // without outputs lookout-plotter need not run
  std::optional<page::Params> page;
};

/// The bus, before anything is heard on it.
struct BusSeen {
  std::string url;
  std::string group;  // empty: no multicast
  int time_to_live = 0;
  std::string route_device;  // device by which datagrams to the group leave; empty = not known
  std::string fault;         // why the bus could not be opened
  int port = 7667;
};

/// The port of the bus, which LCM opens on every address of the computer.
struct PortSeen {
  bool is_closed = false;  // by lookout-firewall: to other computers, but for the interface of the bus
  // Programs that listen to it and are not Lookout's: "lcm-logger (pid 17)", "a program of user pi". No filter stands in front of them.
  std::vector<std::string> without_filter;
};

/// Receive buffers of UDP sockets, bytes.
struct BuffersSeen {
  std::int64_t granted = 0;     // to a socket that asks for `asked`
  std::int64_t asked = 0;       // by Lookout's processes
  std::int64_t by_default = 0;  // to a socket that asks for none
};

/// One address of an interface of this computer; an interface without any has `address` empty.
struct InterfaceSeen {
  std::string name;
  std::optional<io::IpAddress> address;
  int prefix_bits = 0;       // of `address` in its own family
  bool has_carrier = false;  // the interface is up, and a device is at the other end of the cable
  bool is_loopback = false;
};

/// How something was observed.
enum class Via {
  kNothing,  // not looked for: reason in `fault`, or the config says that there is none
  kBus,      // its process runs and was heard
  kItself    // its process was not heard: the doctor opened the sources of the config itself
};

/// Shots into one degree of azimuth of the lidar's frame.
struct AzimuthSeen {
  std::int64_t num_shots = 0;
  std::int64_t num_returns = 0;
  std::int64_t num_own = 0;  // returns within own_vessel
};

struct LidarSeen {
  Via via = Via::kNothing;
  std::string fault;      // why the ports could not be opened
  std::string complaint;  // of the process, or of the same code inside the doctor; empty = none
  // Datagrams to the data port by numeric source; kItself with source UDP alone.
  std::map<std::string, std::int64_t> num_by_sender;
  std::int64_t num_packets = 0;  // data packets, and the receiver's times of the first and the last
  Utime first{};
  Utime last{};
  Utime heard_last{};   // by this computer's clock; `last` may be by another clock
  std::string model;    // of the last scan; empty = no scan
  int num_returns = 0;  // per shot
  int return_kind = 0;  // lidar_scan_t::RETURN_..., of the first
  std::optional<lidar_clock_t> first_clock;
  std::optional<lidar_clock_t> last_clock;
  bool is_capture = false;                  // read from captures, with their times
  std::vector<lidar::Speaker> speakers;     // all lidars that were heard, by the config or not
  std::int64_t num_fragments_lost = 0;      // datagrams that could not be put together from IP fragments
  std::array<AzimuthSeen, 360> azimuths{};  // by whole degree, of all scans
};

/// The messages of one input of the navigator.
struct InputSeen {
  std::int64_t num_places = 0;  // measured or not
  std::int64_t num_fixes = 0;   // measured
  std::int64_t num_attitudes = 0;
};

struct NavigationSeen {
  Via via = Via::kNothing;
  std::vector<std::pair<std::string, std::string>> input_faults;  // name, reason
  std::string complaint;                                          // as in LidarSeen
  std::map<std::string, std::int64_t> num_by_source;              // sentences and IMU samples
  std::map<std::string, InputSeen> told_by_source;
  std::optional<gnss_fix_t> fix;      // the last fix; of one epoch the fix that says most
  Utime fix_heard{};                  // by this computer's clock
  std::optional<attitude_t> heading;  // the last attitude that holds a heading
  std::optional<pose_t> pose;         // the last
};

/// One process, told apart by computer and process id.
struct ProcessSeen {
  health_t first;
  health_t last;
  Utime heard_last{};
};

/// OBSTACLES that were heard.
struct ObstaclesSeen {
  std::int64_t num_scans = 0;
  std::int64_t num_obstacles = 0;
  std::int64_t num_placed = 0;  // on the earth
  std::int64_t num_timeouts = 0;
};

/// TRACKS and ALERTS that were heard.
struct LookOutSeen {
  std::int64_t num_scans = 0;
  std::int64_t num_tracks = 0;  // confirmed and coasting tracks of the last scan
  std::int64_t num_moving = 0;  // tracks of num_tracks that move
  Utime tracks_heard{};         // the last
  std::optional<alerts_t> alerts;
  Utime alerts_heard{};
};

/// The mounting by the lidar's own scans: only with the right mounting do standing things keep their place while the boat moves.
struct MountingSeen {
  /// Turn of the mounting about one axis of the vessel.
  struct Axis {
    double turned_rad = 0.0;        // from the mounting of boat.txtpb to the one that was found
    double sd_rad = 0.0;            // its deviation
    double reference_sd_rad = 0.0;  // deviation of the heading, or of the roll or pitch, against which the turn was found
  };
  double watched_s = 0.0;
  std::string not_known;             // why nothing is told, in words; empty where the axes count
  std::vector<std::string> missing;  // motions that would help, in words
  std::string turned_in_words;       // how the lidar is turned by right angles; empty where it is not
  std::array<Axis, 3> axes{};        // forward, port, up
};

/// Needs of the page on this computer, as far as this user may look.
struct PageSeen {
  bool is_port_taken = false;    // by anybody; ours while the page runs here
  std::string token_fault;       // empty: the token file is right, or will be made
  std::string map_fault;         // empty: the map is right, or there is none
  std::int64_t free_bytes = -1;  // beyond the reserve, where the last minutes are kept; -1 = not known
};

struct DiskSeen {
  std::string other_host;        // host where the recorder runs, if not this one: its disk cannot be seen from here
  std::filesystem::path folder;  // absolute; empty = not known
  bool is_guessed = false;       // relative in the config, and the recorder does not run: taken from where the doctor was started
  bool is_writable = true;
  std::int64_t free_bytes = -1;            // beyond the recorder's reserve; -1 = not known
  std::optional<double> rate_bytes_per_s;  // heard on the bus with the lidar running
};

struct Observations {
  ConfigSeen config;
  BusSeen bus;
  BuffersSeen buffers;
  PortSeen port;
  std::vector<InterfaceSeen> interfaces;
  bool is_host_clock_set = false;  // the kernel says that something (NTP, PPS) steers the clock
  LidarSeen lidar;
  NavigationSeen navigation;
  std::map<std::string, std::vector<ProcessSeen>> processes;  // by name
  ObstaclesSeen obstacles;
  LookOutSeen look_out;
  std::optional<MountingSeen> mounting;  // nullopt: not asked for
  std::string zone_unseen;               // by the scans: into which part of the guard zone nobody looks, in words; empty = none, or no scans
  DiskSeen disk;
  PageSeen page;
  Utime end{};  // host time at which watching ended
  double watched_s = 0.0;

  /// The last HEALTH of the process of that name that was heard of last; nullptr = none.
  const health_t* LastHealth(const std::string& process) const {
    const auto found = processes.find(process);
    return found == processes.end() || found->second.empty() ? nullptr : &found->second.back().last;
  }
};

}  // namespace lookout::doctor
