// A simulated boat's navigation sensors through the navigator process, against the truth.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/config/boat.hpp"
#include "common/core/angles.hpp"
#include "lab/sim/motion.hpp"
#include "lab/sim/navigation.hpp"
#include "lookout/lidar_odometry_t.hpp"
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

/// Own motion by the lidar as it would be told, with errors that are independent from scan to scan.
class DrawnOdometry {
 public:
  DrawnOdometry(const sim::OwnMotion& motion, double reference_point_above_water_m, std::uint64_t seed)
      : motion_(motion), above_water_m_(reference_point_above_water_m), random_(seed) {}

  // Scan `number` ends at number / 10 s; its motion comes 50 ms later.
  lidar_odometry_t Next() {
    using namespace std::chrono_literals;
    const double begin_s = 0.1 * number_++;
    const auto from = sim::StateAt(motion_, above_water_m_, begin_s);
    const auto to = sim::StateAt(motion_, above_water_m_, begin_s + 0.1);
    const Eigen::Vector2d way_m = (to.position_map_m - from.position_map_m).head<2>();
    const double sin = std::sin(from.heading_rad);
    const double cos = std::cos(from.heading_rad);
    lidar_odometry_t message{};
    message.begin_utime_us = ToUtimeUs(kSimulatedStart) + std::llround(begin_s * 1e6);
    message.utime_us = message.begin_utime_us + 100'000;
    message.displacement_m[0] = sin * way_m.x() + cos * way_m.y() + kWaySdM * normal_(random_);
    message.displacement_m[1] = -cos * way_m.x() + sin * way_m.y() + kWaySdM * normal_(random_);
    message.turn_rad = WrapToPi(to.heading_rad - from.heading_rad) + kTurnSdRad * normal_(random_);
    message.covariance[0][0] = message.covariance[1][1] = kWaySdM * kWaySdM;
    message.covariance[2][2] = kTurnSdRad * kTurnSdRad;
    return message;
  }
  Utime next_arrival() const { return kSimulatedStart + std::chrono::milliseconds(100 * (number_ + 1) + 50); }

 private:
  // Those of the lake (services/odometer/README.md), the worst of its scenes.
  static constexpr double kWaySdM = 0.015;
  static constexpr double kTurnSdRad = DegToRad(0.017);

  sim::OwnMotion motion_;
  double above_water_m_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  int number_ = 0;
};

inline SimulatedRun Simulate(const std::string& scene_name, std::uint64_t seed, double seconds, const std::vector<std::string>& faults = {},
                             const sim::NavigationParams& navigation_params = {}, bool has_odometry = false) {
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

  DrawnOdometry odometry(scene.own_motion, boat.reference_point_above_water_m, seed);
  std::vector<sim::Datagram> waiting;
  double next_report_s = 1.0;
  while (navigation.next_time() < kSimulatedStart + std::chrono::microseconds(std::llround(seconds * 1e6))) {
    const Utime now = navigation.next_time();
    for (auto& datagram : navigation.Next()) waiting.push_back(std::move(datagram));
    std::ranges::stable_sort(waiting, {}, &sim::Datagram::time);
    auto datagram = waiting.begin();
    for (; datagram != waiting.end() && datagram->time <= now; ++datagram) {
      for (; has_odometry && odometry.next_arrival() <= datagram->time;) {
        service.AdvanceTo(odometry.next_arrival());
        support::Send(bus, bus::kLidarOdometry, odometry.Next());
      }
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
