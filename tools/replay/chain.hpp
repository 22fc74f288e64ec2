// The services of a boat, or some of them, in one process, over a memory bus, in lockstep.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/memory_bus.hpp"
#include "common/bus/schema.hpp"
#include "tools/replay/lacks.hpp"
#include "tools/replay/plan.hpp"
#include "tools/replay/stage.hpp"

namespace lookout::replay {

/// Traffic of one channel.
struct ChannelDigest {
  std::int64_t count = 0;
  bus::Sha256 sha256;  // over the payloads, one after the other
};

/// The faults that the processes would find at their start, of all files at once.
///
/// @throws config::ConfigError
void CheckConfig(const std::filesystem::path& config_folder);

class Chain {
 public:
  /// Each message, with the time of the event that caused it.
  using Sink = std::function<void(Utime time, std::string_view channel, Bytes bytes)>;

  /// @throws config::ConfigError
  Chain(const std::filesystem::path& config_folder, const Plan& plan, Sink sink, const std::vector<StageFactory>& factories = StageFactories());
  ~Chain();

  /// A datagram out of a capture, for the first service that has its port; counted where none has.
  void OnDatagram(const Datagram& datagram);

  /// A line of a text log.
  void OnTextLine(Utime time, Bytes line);

  /// A message out of a log, on a channel that the plan reads.
  void OnLogged(Utime log_time, const bus::Channel& channel, Bytes bytes);

  /// End of a capture: every service flushes what it holds, as it does live at its own end.
  void Finish();

  /// End of logs: a service that reads marks has flushed at its end mark, or was cut off and flushed nothing.
  ///
  /// @param is_whole  the run came to its end in the logs
  /// @return messages that were left out, since nobody knows the live run's results of them
  std::int64_t FinishLogs(bool is_whole);

  /// Time of the latest event; nullopt before the first.
  std::optional<Utime> time() const { return time_; }

  /// From the first event to the latest.
  std::chrono::microseconds span() const { return time_ ? *time_ - *first_time_ : std::chrono::microseconds(0); }

  /// Time that the digests took.
  std::chrono::nanoseconds digest_time() const { return digest_time_; }

  std::map<std::string, ChannelDigest, std::less<>>& digests() { return digests_; }

  /// Service and seconds that it took, in the order of the data.
  std::vector<std::pair<std::string, double>> StageTimes() const;

  /// Counters of all services that are not 0, as "service.counter".
  std::vector<std::pair<std::string, std::int64_t>> Counters() const;

  /// Messages that are missing in the input, by channel that is read; counts above 0.
  std::vector<std::pair<std::string, std::int64_t>> Gaps() const;

  /// Datagrams for which no service has the port.
  const OtherPorts& other_ports() const { return other_ports_; }

  /// The service that publishes the channel; nullptr: it does not run.
  const Stage* FindPublisher(const bus::Channel& channel) const;

 private:
  struct Running;

  // Calls `call` with the stage of each service, one after the other, and hands out the resulting messages.
  template <typename Call>
  void ForEachStage(const Call& call);
  void AdvanceTo(Utime time);
  void Drain();

  bus::MemoryBus bus_;
  Sink sink_;
  std::map<std::string, ChannelDigest, std::less<>> digests_;
  std::vector<std::string> read_;
  std::optional<Utime> first_time_;
  std::optional<Utime> time_;
  OtherPorts other_ports_;
  std::chrono::nanoseconds digest_time_{0};
  std::vector<std::unique_ptr<Running>> running_;  // in the order of the data
};

}  // namespace lookout::replay
