#include "lab/eval/navigation/own_motion.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "common/io/output_file.hpp"
#include "common/messages/part_assembler.hpp"
#include "lab/data/csv_file.hpp"
#include "lab/eval/navigation/kiss_icp_motions.hpp"
#include "lab/sim/simulation.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/odometer/wire.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {

namespace {

namespace fs = std::filesystem;

constexpr auto kHeader = "time_us,begin_us,end_us,reason,forward_m,port_m,turn_rad,cov_0,cov_1,cov_2,cov_3,cov_4,cov_5,cov_6,cov_7,cov_8\n";
constexpr std::int64_t kMostUs = 7'258'118'400'000'000;  // the year 2200

// Simulates the lidar, and runs lidar and odometer. @return seconds that odometer took
double RunServices(const fs::path& config_folder, const sim::Scene& scene, std::uint64_t seed, double seconds, const replay::Chain::Sink& sink) {
  const auto boat = config::LoadBoat(config_folder);
  auto params = sim::ParamsOfConfig(config_folder);
  params.start = kSimulationStart;
  params.duration = std::chrono::microseconds(std::llround(seconds * 1e6));
  params.seed = seed;
  sim::Simulation simulation(scene, boat, params, nullptr);
  replay::Chain chain(config_folder, replay::MakeCapturePlan({.only = {"lidar", "odometer"}}), sink);
  while (const auto datagram = simulation.Next()) chain.OnDatagram({datagram->time, datagram->port, datagram->payload});
  chain.Finish();
  double odometer_s = 0.0;
  for (const auto& [service, took_s] : chain.StageTimes()) odometer_s += service == "odometer" ? took_s : 0.0;
  return odometer_s;
}

std::vector<OdometryMessage> Simulated(const fs::path& config_folder, const sim::Scene& scene, std::uint64_t seed, double seconds) {
  std::vector<OdometryMessage> motions;
  RunServices(config_folder, scene, seed, seconds, [&](Utime time, std::string_view channel, Bytes bytes) {
    if (channel == bus::kLidarOdometry.name) motions.push_back({time, bus::Decode<lidar_odometry_t>(bytes).value()});
  });
  return motions;
}

void Write(const fs::path& file, const std::vector<OdometryMessage>& motions) {
  io::OutputFile out(file, {.force = true});
  out.Write(std::string_view(kHeader));
  for (const auto& [time, message] : motions) {
    std::string row = fmt::format("{},{},{},{}", ToUtimeUs(time), message.begin_utime_us, message.utime_us, message.reason);
    // Exact, with 17 digits. Values of an unknown motion are not read again.
    const bool is_known = message.status == lidar_odometry_t::STATUS_OK;
    const auto add = [&](double value) { row += fmt::format(",{:.17g}", is_known ? value : 0.0); };
    add(message.displacement_m[0]);
    add(message.displacement_m[1]);
    add(message.turn_rad);
    for (const auto& line : message.covariance) {
      for (const double value : line) add(value);
    }
    out.Write(row + "\n");
  }
  out.Commit();
}

std::vector<OdometryMessage> Read(const fs::path& file) {
  data::CsvFile csv(file, {"time_us", "begin_us", "end_us", "reason", "forward_m", "port_m", "turn_rad", "cov_0", "cov_1", "cov_2", "cov_3", "cov_4",
                           "cov_5", "cov_6", "cov_7", "cov_8"});
  std::vector<OdometryMessage> motions;
  while (csv.Next()) {
    auto& motion = motions.emplace_back();
    motion.time = Utime(std::chrono::microseconds(csv.WholeNumber(0, 0, kMostUs)));
    auto& message = motion.message;
    message.begin_utime_us = csv.WholeNumber(1, 0, kMostUs);
    message.utime_us = csv.WholeNumber(2, 0, kMostUs);
    message.reason = static_cast<std::int32_t>(csv.WholeNumber(3, 0, lidar_odometry_t::REASON_UNDETERMINED));
    const bool is_known = message.reason == lidar_odometry_t::REASON_NONE;
    message.status = is_known ? +lidar_odometry_t::STATUS_OK : +lidar_odometry_t::STATUS_UNKNOWN;
    const auto value = [&](std::size_t column) { return is_known ? csv.Number(column) : kNan; };
    message.displacement_m[0] = value(4);
    message.displacement_m[1] = value(5);
    message.turn_rad = value(6);
    for (std::size_t i = 0; i < 9; ++i) message.covariance[i / 3][i % 3] = value(7 + i);
  }
  return motions;
}

// Forward, port and turn (clockwise) from one place to the other.
Eigen::Vector3d MotionBetween(const sim::OwnState& from, const sim::OwnState& to) {
  const Eigen::Vector2d way_m = (to.position_map_m - from.position_map_m).head<2>();
  const double sin = std::sin(from.heading_rad);
  const double cos = std::cos(from.heading_rad);
  return {sin * way_m.x() + cos * way_m.y(), -cos * way_m.x() + sin * way_m.y(), WrapToPi(to.heading_rad - from.heading_rad)};
}

// A place and a heading, and a motion from there.
struct PlanarPose {
  Eigen::Vector2d p_m = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;

  void Move(const Eigen::Vector3d& motion) {
    const double sin = std::sin(heading_rad);
    const double cos = std::cos(heading_rad);
    p_m += Eigen::Vector2d(sin * motion.x() - cos * motion.y(), cos * motion.x() + sin * motion.y());
    heading_rad += motion.z();
  }
};

}  // namespace

std::vector<OdometryMessage> OdometryOf(const fs::path& config_folder, const sim::Scene& scene, std::uint64_t seed, double seconds,
                                        const fs::path& kept) {
  if (!kept.empty() && fs::exists(kept)) return Read(kept);
  auto motions = Simulated(config_folder, scene, seed, seconds);
  if (!kept.empty()) Write(kept, motions);
  return motions;
}

ComparedMotions CompareWithKissIcp(const fs::path& config_folder, const sim::Scene& scene, std::uint64_t seed, double seconds) {
  ComparedMotions compared;
  const auto boat = config::LoadBoat(config_folder);
  messages::PartAssembler<lidar_scan_t> assembler;
  std::optional<KissIcpMotions> kiss_icp;
  const auto on_scan = [&](Utime time, Bytes bytes) {
    const auto parts = assembler.Add(bus::Decode<lidar_scan_t>(bytes).value()).whole;
    if (parts.empty()) return;
    const auto scan = odometer::ToScan(parts).value();
    if (!kiss_icp) {
      const auto state = sim::StateAt(scene.own_motion, boat.reference_point_above_water_m, ToSeconds(scan.end_time - kSimulationStart));
      kiss_icp.emplace(boat, RotationMapVessel(0.5 * kPi, state.pitch_rad, state.roll_rad));
    }
    compared.kiss_icp.push_back({time, kiss_icp->Consume(scan)});
  };
  compared.odometer_s = RunServices(config_folder, scene, seed, seconds, [&](Utime time, std::string_view channel, Bytes bytes) {
    if (channel == bus::kLidarOdometry.name) compared.odometer.push_back({time, bus::Decode<lidar_odometry_t>(bytes).value()});
    if (channel != bus::kLidarScan.name) return;
    const auto begin = std::chrono::steady_clock::now();
    on_scan(time, bytes);
    compared.kiss_icp_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  });
  return compared;
}

void OdometryScores::Add(const OdometryScores& other) {
  num_scans += other.num_scans;
  num_known += other.num_known;
  way_m += other.way_m;
  known_s += other.known_s;
  drift_m += other.drift_m;
  turned_rad += other.turned_rad;
  forward_m2 += other.forward_m2;
  port_m2 += other.port_m2;
  turn_rad2 += other.turn_rad2;
  nees += other.nees;
  longest_wrong_s = std::max(longest_wrong_s, other.longest_wrong_s);
}

OdometryScores ScoreOdometry(const std::vector<OdometryMessage>& motions, const sim::Scene& scene, const config::BoatFacts& boat) {
  OdometryScores scores;
  const auto state_at = [&](std::int64_t utime_us) {
    return sim::StateAt(scene.own_motion, boat.reference_point_above_water_m, 1e-6 * static_cast<double>(utime_us - ToUtimeUs(kSimulationStart)));
  };
  PlanarPose said;
  PlanarPose truth;
  double wrong_s = 0.0;
  for (const auto& [time, message] : motions) {
    ++scores.num_scans;
    if (message.status != lidar_odometry_t::STATUS_OK) {
      wrong_s = 0.0;
      continue;
    }
    ++scores.num_known;
    const auto begin = state_at(message.begin_utime_us);
    const auto end = state_at(message.utime_us);
    const Eigen::Vector3d motion(message.displacement_m[0], message.displacement_m[1], message.turn_rad);
    const Eigen::Vector3d true_motion = MotionBetween(begin, end);
    const Eigen::Vector3d error = motion - true_motion;
    said.Move(motion);
    truth.Move(true_motion);
    const double for_s = 1e-6 * static_cast<double>(message.utime_us - message.begin_utime_us);
    scores.way_m += true_motion.head<2>().norm();
    scores.known_s += for_s;
    scores.forward_m2 += error.x() * error.x();
    scores.port_m2 += error.y() * error.y();
    scores.turn_rad2 += error.z() * error.z();
    Eigen::Matrix3d covariance;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) covariance(i, k) = message.covariance[i][k];
    }
    scores.nees += error.dot(covariance.inverse() * error) / 3.0;
    const bool is_wrong = error.head<2>().norm() > OdometryScores::kWrongM || std::abs(error.z()) > OdometryScores::kWrongTurnRad;
    wrong_s = is_wrong ? wrong_s + for_s : 0.0;
    scores.longest_wrong_s = std::max(scores.longest_wrong_s, wrong_s);
  }
  scores.drift_m = (said.p_m - truth.p_m).norm();
  scores.turned_rad = std::abs(said.heading_rad - truth.heading_rad);
  return scores;
}

}  // namespace lookout::eval
