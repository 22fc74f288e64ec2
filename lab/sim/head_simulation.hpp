// The simulated boat with a lidar whose packets are not made: its whole scans, and all other sensors, in one order of arrival.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "common/config/boat.hpp"
#include "lab/sim/datagram.hpp"
#include "lab/sim/fault_plan.hpp"
#include "lab/sim/head_lidar.hpp"
#include "lab/sim/navigation.hpp"
#include "lab/sim/simulation.hpp"
#include "lab/sim/truth.hpp"

namespace lookout::sim {

class HeadSimulation {
 public:
  /// An input of a computer on board, and its time.
  struct Event {
    Utime time;
    std::variant<Datagram, HeadScan> heard;
  };

  /// @param scene   outlives this
  /// @param params  params.lidar.model is not looked at
  /// @param truth   may be nullptr; outlives this
  /// @throws std::invalid_argument  as FaultPlan; for a fault of the lidar's packets or clock, which this head does not have here
  HeadSimulation(const Scene& scene, const config::BoatFacts& boat, const Head& head, const SimulationParams& params, TruthWriter* truth);

  HeadSimulation(const HeadSimulation&) = delete;
  HeadSimulation& operator=(const HeadSimulation&) = delete;

  /// @return the next by time; nullopt at the end
  std::optional<Event> Next();

 private:
  SimulationParams params_;
  TruthWriter* truth_;
  FaultPlan plan_;
  HeadLidar lidar_;
  Navigation navigation_;
  std::optional<HeadScan> scan_;     // made, not yet given
  std::vector<Datagram> datagrams_;  // measured, not yet given; by time
};

}  // namespace lookout::sim
