// The services of the way of the data, or some of them, in one process, over a memory bus, in lockstep.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/bus/schema.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/georeferencer/service.hpp"
#include "services/navigator/service.hpp"
#include "services/segmenter/service.hpp"
#include "services/vlp16/service.hpp"
#include "tools/replay/plan.hpp"

namespace lookout::replay {

/// What went over one channel.
struct ChannelDigest {
  std::int64_t count = 0;
  bus::Sha256 sha256;  // over the payloads, one after the other
};

/// What the processes would find wrong at their start, of all files at once.
///
/// @throws config::ConfigError
void CheckConfig(const std::filesystem::path& config_folder);

class Chain {
 public:
  /// Each message, with the time of the event that caused it.
  using Sink = std::function<void(Utime time, std::string_view channel, Bytes bytes)>;

  /// @throws config::ConfigError
  Chain(const std::filesystem::path& config_folder, const Plan& plan, Sink sink);

  /// A datagram out of a capture. What is on none of the ports of the config is left out and counted.
  void OnDatagram(Utime host_time, int udp_port, Bytes payload, const vlp16::Sender& sender);

  /// A line of a text log: for the navigator's input "udp", as if it had come by that. Left out where the navigator does not run.
  void OnTextLine(Utime time, Bytes line);

  /// A message out of a log, on a channel that the plan reads.
  void OnLogged(Utime log_time, const bus::Channel& channel, Bytes bytes);

  /// End of a capture: every service flushes what it holds, as it does live at its own end.
  void Finish();

  /// End of logs: a service that reads marks has flushed at its end mark, or was cut off and flushed nothing.
  ///
  /// @param is_whole  the run came to its end in the logs: what waits for POSE is given with the poses that are there, as live. Else it is left out,
  /// unless
  ///                  there is no POSE at all
  /// @return messages of SEGMENTS that were left out
  std::int64_t FinishLogs(bool is_whole);

  /// Time of the latest event; nullopt before the first.
  std::optional<Utime> time() const { return time_; }

  /// From the first event to the latest.
  std::chrono::microseconds span() const { return time_ ? *time_ - *first_time_ : std::chrono::microseconds(0); }

  /// Time that the digests took.
  std::chrono::nanoseconds digest_time() const { return digest_time_; }

  std::map<std::string, ChannelDigest, std::less<>>& digests() { return digests_; }

  /// Time that each service took, in the order of the data.
  struct StageTime {
    std::string service;
    double seconds;
  };
  std::vector<StageTime> StageTimes() const;

  /// Counters of all services that are not 0, as "service.counter".
  std::vector<std::pair<std::string, std::int64_t>> Counters() const;

  /// Messages that are missing in the input, by channel that is read; counts above 0.
  std::vector<std::pair<std::string, std::int64_t>> Gaps() const;

  /// Why the lidar gives nothing, in words; empty when it gives.
  std::string LidarComplaint() const { return vlp16_ ? vlp16_->Report().reason : std::string(); }

  /// Datagrams of a capture on the port of NMEA 0183, and on that of the lidar's data.
  std::int64_t num_nmea_datagrams() const { return num_nmea_datagrams_; }
  std::int64_t num_data_datagrams() const { return num_data_datagrams_; }

 private:
  // Destination ports by which datagrams of a capture are told apart.
  struct Ports {
    Ports(const vlp16::Params& lidar, const navigator::Params& navigation);
    int lidar_data;
    int lidar_position;
    std::map<int, std::string> nmea;  // sources by port
  };

  void AdvanceTo(Utime time);
  void Drain();

  bus::MemoryBus bus_;
  Sink sink_;
  std::map<std::string, ChannelDigest, std::less<>> digests_;
  std::vector<std::string_view> read_;
  std::optional<Utime> first_time_;
  std::optional<Utime> time_;
  bool is_navigation_live_;  // else it comes as NAV_RAW
  Ports ports_;
  std::int64_t num_nmea_datagrams_ = 0;
  std::int64_t num_data_datagrams_ = 0;
  std::int64_t num_other_ports_ = 0;
  std::chrono::nanoseconds vlp16_time_{0};
  std::chrono::nanoseconds navigator_time_{0};
  std::chrono::nanoseconds digest_time_{0};
  // Empty where it does not run. They subscribe as they are made; the sink subscribes last, so that it sees a message after the services did.
  std::optional<vlp16::Service> vlp16_;
  std::optional<segmenter::Service> segmenter_;
  std::optional<navigator::Service> navigator_;
  std::optional<georeferencer::Service> georeferencer_;
};

}  // namespace lookout::replay
