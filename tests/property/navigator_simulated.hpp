// A simulated boat's navigation sensors through the navigator process, against the truth.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/config/boat.hpp"
#include "common/core/angles.hpp"
#include "lab/sim/motion.hpp"
#include "lab/sim/navigation.hpp"
#include "lookout/pose_t.hpp"
#include "services/navigator/service.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/sim/scenes.hpp"

namespace lookout::navigator {

inline const std::string kDemo = support::kDemoConfig.string();
inline const Utime kSimulatedStart = Utime(std::chrono::seconds(1'781'532'600));

/// A pose beside the true one, east and north in the map of the simulation.
struct ComparedPose {
  double time_s = 0.0;  // since the start
  pose_t pose{};
  Eigen::Vector2d position_m;  // stated
  Eigen::Vector2d error_m;     // stated minus true
  double heading_error_rad = 0.0;
  double roll_error_rad = 0.0;
  double pitch_error_rad = 0.0;
  Eigen::Vector2d velocity_error_mps;

  bool is_placed() const { return pose.status == pose_t::STATUS_OK || pose.status == pose_t::STATUS_COASTING; }
  Eigen::Matrix2d position_covariance_m2() const {
    Eigen::Matrix2d covariance;
    covariance << pose.covariance[0][0], pose.covariance[0][1], pose.covariance[1][0], pose.covariance[1][1];
    return covariance;
  }
  double position_sd_m() const { return std::sqrt(pose.covariance[0][0] + pose.covariance[1][1]); }  // of the distance
};

struct SimulatedRun {
  std::vector<ComparedPose> poses;
  std::map<std::string, std::int64_t, std::less<>> counters;  // at the end; a report's own names live as long as the service
  std::vector<std::pair<double, std::string>> reasons;        // of health, each second
  double nis_per_degree = 0.0;

  std::int64_t Count(std::string_view name) const {
    const auto counter = counters.find(name);
    return counter == counters.end() ? -1 : counter->second;
  }
};

inline SimulatedRun Simulate(const std::string& scene_name, std::uint64_t seed, double seconds, const std::vector<std::string>& faults = {},
                             const sim::NavigationParams& navigation_params = {}) {
  using namespace std::chrono_literals;
  const auto boat = config::LoadBoat(kDemo);
  const auto scene = sim::MakeScene(scene_name, seed);
  std::vector<sim::TimedFault> timed;
  for (const auto& fault : faults) timed.push_back(sim::ParseTimedFault(fault));
  const sim::FaultPlan plan(timed, kSimulatedStart);
  sim::Navigation navigation(scene, boat, navigation_params, plan, kSimulatedStart, seed);
  const auto map = sim::MapFrame(boat);

  bus::MemoryBus bus;
  Service service(bus, LoadParams(kDemo));
  SimulatedRun run;
  bus.SubscribeAll([&](std::string_view channel, Bytes bytes) {
    if (channel != bus::kPose.name) return;
    ComparedPose compared;
    compared.pose = bus::Decode<pose_t>(bytes).value();
    const Utime time{std::chrono::microseconds(compared.pose.utime_us)};
    compared.time_s = ToSeconds(time - kSimulatedStart);
    const auto truth = sim::StateAt(scene.own_motion, boat.reference_point_above_water_m, compared.time_s);
    double up_m = 0.0;
    map.Forward(compared.pose.latitude_deg, compared.pose.longitude_deg, 0.0, compared.position_m.x(), compared.position_m.y(), up_m);
    compared.error_m = compared.position_m - truth.position_map_m.head<2>();
    compared.heading_error_rad = WrapToPi(compared.pose.heading_rad - truth.heading_rad);
    compared.roll_error_rad = compared.pose.roll_rad - truth.roll_rad;
    compared.pitch_error_rad = compared.pose.pitch_rad - truth.pitch_rad;
    compared.velocity_error_mps = Eigen::Vector2d(compared.pose.velocity_map_mps[0], compared.pose.velocity_map_mps[1]) - truth.velocity_map_mps;
    run.poses.push_back(compared);
  });

  std::vector<sim::Datagram> waiting;
  double next_report_s = 1.0;
  while (navigation.next_time() < kSimulatedStart + std::chrono::microseconds(std::llround(seconds * 1e6))) {
    const Utime now = navigation.next_time();
    for (auto& datagram : navigation.Next()) waiting.push_back(std::move(datagram));
    std::ranges::stable_sort(waiting, {}, &sim::Datagram::time);
    auto datagram = waiting.begin();
    for (; datagram != waiting.end() && datagram->time <= now; ++datagram) {
      service.AdvanceTo(datagram->time);
      if (datagram->port == navigation_params.nmea_port) service.OnDatagram(datagram->time, datagram->payload);
      support::HandleAll(bus);
    }
    waiting.erase(waiting.begin(), datagram);
    if (ToSeconds(now - kSimulatedStart) >= next_report_s) {
      run.reasons.emplace_back(next_report_s, service.Report().reason);
      next_report_s += 1.0;
    }
  }
  service.Finish(kSimulatedStart + std::chrono::microseconds(std::llround(seconds * 1e6)));
  support::HandleAll(bus);
  for (const auto& counter : service.Report().counters) run.counters[std::string(counter.name)] = counter.count;
  run.nis_per_degree = service.navigator().filter().nis_sum() / static_cast<double>(service.navigator().filter().num_nis_degrees());
  return run;
}

}  // namespace lookout::navigator
