// What was heard on the bus: traffic of each channel, state of each process, the nearest obstacles. Knows no clock, terminal or transport.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "common/bus/sequence.hpp"
#include "common/core/bytes.hpp"
#include "lookout/health_t.hpp"
#include "lookout/pose_t.hpp"
#include "tools/top/nearest.hpp"
#include "tools/top/rate_meter.hpp"

namespace lookout::top {

struct ChannelLine {
  std::string name;
  std::optional<Rate> rate;              // nullopt: too early to tell
  std::optional<std::int64_t> num_lost;  // by gaps in seq, since the start; nullopt for a channel that is not of this project
  std::int64_t num_bad = 0;              // did not decode, or contradict themselves
  std::chrono::nanoseconds age{0};       // of its last message
  bool is_silent = false;                // for longer than it should be
};

struct ProcessLine {
  std::string name;                 // with its host where that is another than that of the first process heard of
  std::chrono::nanoseconds age{0};  // of its last report
  bool is_silent = false;           // for longer than it should be
  std::int32_t state = 0;           // as in health_t
  std::string reason;
  double cpu_fraction = 0.0;
  std::int64_t resident_bytes = 0;
  std::int64_t latency_p99_us = -1;  // greatest of its data channels, from measurement to publication; -1 = none
};

/// Where the own boat is, out of POSE and GNSS_FIX.
struct OwnShip {
  std::optional<pose_t> pose;  // the newest
  TimePoint pose_time;
  std::optional<std::int32_t> fix_quality;  // as in gnss_fix_t, of the newest
  std::int32_t num_satellites = -1;         // -1 = not known
  TimePoint fix_time;
};

/// The alarm of the guard zone, out of HEALTH.
struct Alarm {
  bool is_active = false;
  std::string text;                 // what is near, or that nobody looks, in the words of HEALTH
  std::chrono::nanoseconds age{0};  // of the report
};

class Board {
 public:
  /// @param start  since when it listens
  explicit Board(TimePoint start) : start_(start) {}

  /// A message of any channel. What does not decode is counted. Memory is bounded: names above kMaxChannels are not told apart.
  void Take(std::string_view channel, Bytes bytes, TimePoint now);

  /// Those of the channel table in its order, then the others by name.
  std::vector<ChannelLine> Channels(TimePoint now) const;

  /// Those of the suite in the order of the data flow, then the others by name. One that fell silent stays, until another of its name on its host has
  /// taken its place. Of several that speak under one name each has its line, with host and process id. Names that are not of the suite count
  /// as kMaxStrangers at most.
  std::vector<ProcessLine> Processes(TimePoint now) const;

  /// @return nullopt when no process has a guard zone
  std::optional<Alarm> NearestAlarm(TimePoint now) const;

  const OwnShip& own() const { return own_; }

  /// @return nullptr when OBSTACLES never came, or for more than 2 s
  const NearestObstacles* Obstacles(TimePoint now) const;

  /// Messages on channels beyond kMaxChannels.
  std::int64_t num_unlisted() const { return num_unlisted_; }

  /// Messages of HEALTH of processes that found no room.
  std::int64_t num_unlisted_health() const { return num_unlisted_health_; }

  static constexpr std::size_t kMaxChannels = 64;
  static constexpr std::size_t kMaxProcesses = 64;
  static constexpr std::size_t kMaxStrangers = 8;  // among them

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
  std::int64_t num_unlisted_ = 0;
  std::int64_t num_unlisted_health_ = 0;
  OwnShip own_;
};

}  // namespace lookout::top
