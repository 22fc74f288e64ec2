// The sources of the lidar and of the navigation, opened by the doctor while no process of Lookout holds them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/bus/memory_bus.hpp"
#include "common/io/source.hpp"
#include "services/navigator/service.hpp"
#include "services/vlp16/service.hpp"
#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

/// Reads the lidar's datagrams as lookout-vlp16 does, and tells on `bus` what it would tell.
class OwnLidar {
 public:
  /// @throws std::runtime_error when a port or the interface cannot be opened
  OwnLidar(bus::Bus& bus, const vlp16::Params& params);

  /// Takes what waits. @param seen  gets senders and complaint
  void Poll(Utime now, LidarSeen& seen);

 private:
  vlp16::Params params_;
  vlp16::Service service_;
  std::vector<std::unique_ptr<io::Source>> sources_;
};

/// The same for lookout-navigator. Text logs are not played.
class OwnNavigator {
 public:
  /// @param seen  gets the inputs that cannot be opened
  OwnNavigator(bus::Bus& bus, const navigator::Params& params, NavigationSeen& seen);

  void Poll(Utime now, NavigationSeen& seen);

  /// Adds the faults of inputs that are still not open.
  void Finish(NavigationSeen& seen) const;

 private:
  struct Input {
    std::string name;
    std::unique_ptr<io::Source> source;
  };
  navigator::Service service_;
  std::vector<Input> inputs_;
};

}  // namespace lookout::doctor
