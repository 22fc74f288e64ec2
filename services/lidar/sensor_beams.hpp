// Asks the sensor of the config for its beams while the service runs.
#pragma once

#include <optional>
#include <string>

#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/io/beam_fetcher.hpp"
#include "services/lidar/params.hpp"
#include "services/lidar/service.hpp"

namespace lookout::lidar {

/// Does nothing where the config names no sensor to be asked, and where packets come from a capture or the bus.
class SensorBeams {
 public:
  /// @param service  outlives this
  SensorBeams(const Params& params, Service& service);

  /// To be called every second or so: hands the service what has come, and asks again, each ten seconds at most, while it wants another.
  ///
  /// @return a line for the journal; empty = none
  std::string Poll(Utime now);

  /// Adds the requests that failed; the fault, while the service has no beams.
  void AddTo(HealthReport& report) const;

 private:
  Service& service_;
  std::string origin_;
  std::string refusal_;  // of the last answer
  std::optional<Utime> asked_;
  std::string told_;
  std::optional<BeamFetcher> fetcher_;
};

}  // namespace lookout::lidar
