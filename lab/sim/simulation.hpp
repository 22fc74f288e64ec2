// Lidar, receiver and attitude sensor of the simulated boat, in one order of arrival.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "common/config/boat.hpp"
#include "lab/sim/datagram.hpp"
#include "lab/sim/fault_plan.hpp"
#include "lab/sim/lidar.hpp"
#include "lab/sim/lidar_clock.hpp"
#include "lab/sim/navigation.hpp"
#include "lab/sim/truth.hpp"

namespace lookout::sim {

struct SimulationParams {
  LidarParams lidar;
  NavigationParams navigation;
  int data_port = vlp16::format::kDataPort;
  int second_data_port = 0;  // of the boat's second lidar, which sends no position packets; 0 = no second lidar
  Utime start;
  std::chrono::microseconds duration{0};
  std::uint64_t seed = 1;
  std::vector<TimedFault> faults;                          // faults of sensors; faults of the network are FaultyNetwork's
  std::function<void(const LidarPacket&)> on_packet = {};  // called with each packet that is sent, before its datagram is returned
};

/// Adds the parameters in the boat's config folder: ports, and settings of sensors. @throws config::ConfigError
SimulationParams ParamsOfConfig(const std::filesystem::path& config_folder, SimulationParams params = {});

class Simulation {
 public:
  /// @param scene  outlives this
  /// @param truth  may be nullptr; outlives this. Returns that a lidar without power does not see are not written
  /// @throws std::invalid_argument  as FaultPlan
  Simulation(const Scene& scene, const config::BoatFacts& boat, const SimulationParams& params, TruthWriter* truth);

  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// @return the next datagram by time; nullopt at the end
  std::optional<Datagram> Next();

 private:
  void Fill();
  void FillSecond();

  SimulationParams params_;
  TruthWriter* truth_;
  FaultPlan plan_;
  LidarClock clock_;
  Lidar lidar_;
  Navigation navigation_;
  Random random_;
  std::optional<Datagram> lidar_datagram_;  // made, not yet given
  std::optional<Lidar> second_;
  Random second_random_;
  std::optional<Datagram> second_datagram_;
  std::vector<Datagram> navigation_datagrams_;  // measured, not yet given; by time
};

}  // namespace lookout::sim
