// A service inside a replay: its interface to the chain, and the services that replay can run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/core/driver/sender_lock.hpp"
#include "tools/replay/plan.hpp"

namespace lookout::replay {

/// A UDP datagram of a capture.
struct Datagram {
  Utime host_time;
  int port;  // destination
  Bytes payload;
  lidar::Sender sender = {};
};

/// Messages reach a service over the bus that it was made with; the rest comes here. A service leaves out input that it has no use for.
class Stage {
 public:
  Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  virtual ~Stage() = default;

  virtual void AdvanceTo(Utime /*time*/) {}

  /// @return whether it is on one of the service's ports
  virtual bool OnDatagram(const Datagram& /*datagram*/) { return false; }

  /// A line of a text log of NMEA 0183.
  virtual void OnTextLine(Utime /*time*/, Bytes /*line*/) {}

  /// End of a capture: flushes the messages that the service holds, as it does live at its own end.
  virtual void Finish(Utime /*time*/) {}

  /// End of logs.
  ///
  /// @param is_whole  the run came to its end in the logs
  /// @return messages that are left out, since nobody knows the live run's results of them
  virtual std::int64_t FinishLogs(Utime /*time*/, bool /*is_whole*/) { return 0; }

  virtual HealthReport Report() const = 0;

  /// Measurements from outside that were for it: lines, and datagrams on ports of measurements.
  std::int64_t num_measured() const { return num_measured_; }

 protected:
  std::int64_t num_measured_ = 0;
};

/// Facts that a stage is told beforehand.
struct StageInput {
  bool reads_raw = false;  // the service's input is the raw channel that it publishes live
  const Plan& plan;
};

struct StageFactory {
  std::string_view service;  // of the service table
  /// @throws config::ConfigError
  void (*check_config)(const std::filesystem::path& config_folder);
  /// @throws config::ConfigError
  std::unique_ptr<Stage> (*make)(bus::Bus& bus, const std::filesystem::path& config_folder, const StageInput& input);
};

/// Factories of all services that replay can run.
const std::vector<StageFactory>& StageFactories();

}  // namespace lookout::replay
