// Traffic of each channel, state of each process, the nearest obstacles. Knows no clock, terminal or transport.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "common/bus/sequence.hpp"
#include "common/core/bytes.hpp"
#include "common/messages/heading_history.hpp"
#include "common/messages/part_assembler.hpp"
#include "lookout/ais_t.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tools/top/rate_meter.hpp"

namespace lookout::top {

struct ChannelLine {
  std::string name;
  std::optional<Rate> rate;              // nullopt: too early to tell
  std::optional<std::int64_t> num_lost;  // by gaps in seq, since the start or CountAnew; nullopt for a channel that is not of this project
  std::int64_t num_bad = 0;              // did not decode, or contradict themselves
  std::chrono::nanoseconds age{0};       // since the channel's last message
  bool is_silent = false;                // for longer than it should be
};

struct ProcessLine {
  std::string name;                 // with the host where it is another than that of the first process that was heard
  std::chrono::nanoseconds age{0};  // since the process's last report
  bool is_silent = false;           // for longer than it should be
  std::int32_t state = 0;           // as in health_t
  std::string reason;
  double cpu_fraction = 0.0;
  std::int64_t resident_bytes = 0;
  std::int64_t latency_p99_us = -1;  // greatest latency of the process's data channels, from measurement to publication; -1 = none
};

/// Where the own boat is, out of POSE and GNSS_FIX.
struct OwnShip {
  std::optional<pose_t> pose;  // the newest
  TimePoint pose_time;
  std::optional<std::int32_t> fix_quality;  // as in gnss_fix_t, of the newest
  std::int32_t num_satellites = -1;         // -1 = not known
  TimePoint fix_time;
};

/// An obstacle without its outlines.
struct ObstacleLine : obstacle_t {
  double true_bearing_rad = std::numeric_limits<double>::quiet_NaN();  // of the nearest return, from true north clockwise; NaN = not known
};

/// The nearest of a scan, at most Nearest::kMaxLines.
struct NearestObstacles {
  std::vector<ObstacleLine> lines;       // nearest first; obstacles without a range last
  std::vector<ObstacleLine> sure_lines;  // lines of sure obstacles
  std::int64_t num_obstacles = 0;        // of the scan
  std::int64_t num_sure = 0;             // sure obstacles of the scan
  std::int64_t num_parts_missing = 0;
  TimePoint time;  // when its last message came
};

/// The obstacles of the newest scan, nearest first.
class Nearest {
 public:
  static constexpr std::size_t kMaxLines = 50;  // as many as a screen may have room for

  void Take(const pose_t& pose) { headings_.Add(pose.utime_us, pose.heading_rad); }
  /// @param part  well-formed (messages::IsWellFormed)
  void Take(const obstacles_t& part, TimePoint now);

  /// @return the newest whole scan, or, once the next has begun, the parts of it that came; nullopt before the first
  const std::optional<NearestObstacles>& newest() const { return newest_; }

 private:
  // The kept part of a message.
  struct Part {
    std::int64_t utime_us = 0;
    std::int64_t seq = 0;
    std::int32_t part_index = 0;
    std::int32_t num_parts = 1;
    NearestObstacles nearest;
  };
  static NearestObstacles ToNearest(const std::vector<Part>& parts);

  messages::HeadingHistory headings_;
  messages::PartAssembler<Part> assembler_;
  std::optional<NearestObstacles> newest_;
};

/// A track without its outline, and its gravest alert.
struct TrackLine : track_t {
  std::int32_t alert_level = 0;  // as in alert_t; 0: none
  bool is_acknowledged = false;
  std::string ship = {};  // the ship of AIS that this track is for sure: her name, else her MMSI; empty: none
};

/// A ship that AIS tells of, that the lidar should see, and that is no track.
struct UnseenShip {
  std::string name;  // else her MMSI
  float range_m = 0.0F;
  float bearing_rad = 0.0F;  // from the bow clockwise
};

/// Tracks of the newest scan that came whole.
struct TrackPicture {
  std::vector<TrackLine> lines;               // the nearest confirmed and coasting tracks, at most kMaxLines; by id, so that rows keep their place
  std::int64_t num_tracks = 0;                // confirmed and coasting
  TimePoint time;                             // when its last message came
  std::vector<UnseenShip> unseen_ships = {};  // at most kMaxUnseenShips, the nearest first

  static constexpr std::size_t kMaxLines = 50;
  static constexpr std::size_t kMaxUnseenShips = 3;
};

class Board {
 public:
  /// @param start  since when it listens
  explicit Board(TimePoint start) : start_(start) {}

  /// A message of any channel. A message that does not decode is counted. Memory is bounded: names above kMaxChannels are not told apart.
  void Take(std::string_view channel, Bytes bytes, TimePoint now);

  /// Counts of lost, bad and unlisted messages start again from 0. Channels and processes that were heard stay known, as does their silence.
  void CountAnew();

  /// Channels of the channel table in its order, then the others by name.
  std::vector<ChannelLine> Channels(TimePoint now) const;

  /// Processes of the suite in the order of the data flow, then the others by name. A silent process stays, until another of its name on its host has
  /// taken its place. Where several send under one name each has a line, with host and process id. Names that are not of the suite count as
  /// kMaxStrangers at most.
  std::vector<ProcessLine> Processes(TimePoint now) const;

  const OwnShip& own() const { return own_; }

  /// @return nullptr when OBSTACLES never came, or for more than 2 s
  const NearestObstacles* Obstacles(TimePoint now) const;

  /// @return nullptr when TRACKS never came, or for more than 2 s
  const TrackPicture* Tracks(TimePoint now) const;

  /// Alerts that nobody acknowledged: the active ones, the gravest first, then those that are over (rectified). "WARNING: ...", "CAUTION: ...", "(*)
  /// " before the one that sounds, "WARNING SILENCED: ...", "WARNING OVER: ...". At most kMaxAlertLines. Or "NO LOOK-OUT: ...": a tracker was heard,
  /// or another process of the suite 3 s ago, and ALERTS do not come yet; or they came and do not for more than 1 s, then with the alerts of before.
  std::vector<std::string> AlertLines(TimePoint now) const;
  static constexpr std::size_t kMaxAlertLines = 4;

  /// Messages on channels beyond kMaxChannels.
  std::int64_t num_unlisted() const { return num_unlisted_; }

  /// Messages of HEALTH of processes that found no room.
  std::int64_t num_unlisted_health() const { return num_unlisted_health_; }

  static constexpr std::size_t kMaxChannels = 64;
  static constexpr std::size_t kMaxProcesses = 64;
  static constexpr std::size_t kMaxStrangers = 8;  // most processes among them that are not of the suite

 private:
  struct Traffic {
    RateMeter rate;
    TimePoint last;
    std::int64_t num_lost = 0;
    std::int64_t num_bad = 0;
    bus::SequenceWatch sequence;
  };
  struct ProcessState {
    health_t health;
    TimePoint first;
    TimePoint last;
    bus::SequenceWatch sequence;
  };
  struct ProcessKey {
    std::string name;
    std::string host;
    std::int32_t pid = 0;
    bool operator<(const ProcessKey& other) const { return std::tie(name, host, pid) < std::tie(other.name, other.host, other.pid); }
  };

  template <typename T>
  bool Note(const T& message, TimePoint now);
  void KeepTracks(const std::vector<tracks_t>& parts, TimePoint now);
  void MarkAlerts();
  void MarkShips();
  bool HasRoomFor(std::string_view process) const;
  void TakeHealth(Traffic& traffic, Bytes bytes, TimePoint now);
  bool IsReplaced(const ProcessKey& key, const ProcessState& process) const;
  void ForgetReplaced(TimePoint now);
  bool ForgetSilent(std::string_view process, TimePoint now);

  TimePoint start_;
  std::map<std::string, Traffic, std::less<>> channels_;
  std::map<ProcessKey, ProcessState> processes_;
  std::string first_host_;
  Nearest nearest_;
  messages::PartAssembler<tracks_t> tracks_parts_;
  std::optional<TrackPicture> tracks_;
  std::int64_t tracks_utime_us_ = 0;
  std::int64_t tracks_begin_utime_us_ = 0;  // of the tracker's process
  std::optional<ais_t> ais_;
  std::optional<alerts_t> alerts_;
  TimePoint alerts_time_;
  std::int64_t num_unlisted_ = 0;
  std::int64_t num_unlisted_health_ = 0;
  OwnShip own_;
};

}  // namespace lookout::top
