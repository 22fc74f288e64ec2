// The bytes of a capture against the files of the truth. Nothing here is shared with decoder or simulator but the class that writes the files: the
// capture is read by the layout of libpcap, the packets by the VLP-16's manual, frames by the words of the design.
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "lab/sim/simulation.hpp"
#include "lab/sim/sinks.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/sim/scenes.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr std::array<double, 16> kElevationDeg{-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};

struct Point {
  double since_hour_us = 0.0;
  int ring = 0;
  int return_index = 0;
  Vector3d p_lidar_m;
};

unsigned Byte(const std::string& bytes, std::size_t at) { return static_cast<unsigned char>(bytes.at(at)); }
unsigned Little(const std::string& bytes, std::size_t at, std::size_t size) {
  unsigned value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | Byte(bytes, at + i);
  return value;
}

// Payloads to UDP port 2368.
std::vector<std::string> DataPackets(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  std::vector<std::string> payloads;
  for (std::size_t at = 24; at < bytes.size();) {
    const std::size_t length = Little(bytes, at + 8, 4);
    const std::string frame = bytes.substr(at + 16, length);
    at += 16 + length;
    const std::size_t udp = 14 + 4 * (Byte(frame, 14) & 0xF);
    if (Byte(frame, udp + 2) * 256 + Byte(frame, udp + 3) == 2368) payloads.push_back(frame.substr(udp + 8));
  }
  return payloads;
}

// In the order of the shots; of a pair of dual return the last one first.
std::vector<Point> Decode(const std::vector<std::string>& payloads) {
  std::vector<Point> points;
  for (const auto& payload : payloads) {
    const std::size_t step = Byte(payload, 1204) == 0x39 ? 2 : 1;
    const auto azimuth_deg = [&](std::size_t block) { return Little(payload, block * 100 + 2, 2) / 100.0; };
    for (std::size_t block = 0; block < 12; block += step) {
      // A turn of more than 1.2 deg is the gap of a field of view: then the next pair of blocks that has none tells the rate.
      double turned_deg = 2.0;
      for (std::size_t i = 0; i < 12 && turned_deg > 1.2; i += step) {
        const std::size_t from = (block + i) % 12;
        if (from + step < 12) turned_deg = std::fmod(azimuth_deg(from + step) - azimuth_deg(from) + 360.0, 360.0);
      }
      for (std::size_t k = 0; k < 32; ++k) {
        const double since_us = 55.296 * static_cast<double>(k / 16) + 2.304 * static_cast<double>(k % 16);
        const double alpha_rad = (azimuth_deg(block) + turned_deg * since_us / 110.592) * kDegree;
        const double omega_deg = kElevationDeg[k % 16];
        const double omega_rad = omega_deg * kDegree;
        for (std::size_t i = 0; i < step; ++i) {
          const double range_m = Little(payload, (block + i) * 100 + 4 + 3 * k, 2) * 0.002;
          if (range_m == 0.0) continue;
          points.push_back(
              {Little(payload, 1200, 4) + 110.592 * static_cast<double>(block / step) + since_us,
               static_cast<int>(std::lround((omega_deg + 15.0) / 2.0)), static_cast<int>(i),
               range_m * Vector3d(std::cos(omega_rad) * std::cos(alpha_rad), -std::cos(omega_rad) * std::sin(alpha_rad), std::sin(omega_rad))});
        }
      }
    }
  }
  return points;
}

std::vector<std::vector<std::string>> Rows(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  for (std::getline(in, line); std::getline(in, line);) {
    rows.emplace_back();
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

// Of the vessel: what is ahead, to port and above it, as columns east, north, up.
Eigen::Matrix3d Axes(double heading_rad, double pitch_rad, double roll_rad) {
  const Vector3d ahead(std::sin(heading_rad) * std::cos(pitch_rad), std::cos(heading_rad) * std::cos(pitch_rad), std::sin(pitch_rad));
  const Vector3d level_starboard(std::cos(heading_rad), -std::sin(heading_rad), 0.0);
  const Vector3d level_up = level_starboard.cross(ahead);
  Eigen::Matrix3d axes;
  axes.col(0) = ahead;
  axes.col(1) = -(level_starboard * std::cos(roll_rad) - level_up * std::sin(roll_rad));  // starboard goes down
  axes.col(2) = level_up * std::cos(roll_rad) + level_starboard * std::sin(roll_rad);
  return axes;
}

double ShareOf(std::int64_t time_us, std::int64_t from_us, std::int64_t to_us) {
  return static_cast<double>(time_us - from_us) / static_cast<double>(to_us - from_us);
}

// How far a point lies outside of a convex outline that runs counter-clockwise; less than 0 inside.
double OutsideM(const Vector2d& p_m, const std::vector<Vector2d>& outline_m) {
  double outside_m = -1e9;
  for (std::size_t i = 0; i < outline_m.size(); ++i) {
    const Vector2d edge = (outline_m[(i + 1) % outline_m.size()] - outline_m[i]).normalized();
    outside_m = std::max(outside_m, edge.y() * (p_m - outline_m[i]).x() - edge.x() * (p_m - outline_m[i]).y());
  }
  return outside_m;
}

// The lidar stands before the mast and is turned in all ways, as in config/demo but more so.
config::BoatFacts TurnedBoat() {
  auto boat = SmallBoat();
  boat.lidar = {{0.5, -0.1, 1.1}, 2.0 * kDegree, -3.0 * kDegree, 15.0 * kDegree};
  boat.T_vessel_lidar = TransformVesselSensor(boat.lidar);
  return boat;
}

// The same by hand. Mounting angles are right-handed: about x, then about y, then about z.
Vector3d ToVessel(const Vector3d& p_lidar_m) {
  const auto turned = [](const Vector3d& v, int from, int to, double angle_rad) {
    Vector3d result = v;
    result[from] = std::cos(angle_rad) * v[from] - std::sin(angle_rad) * v[to];
    result[to] = std::sin(angle_rad) * v[from] + std::cos(angle_rad) * v[to];
    return result;
  };
  return Vector3d(0.5, -0.1, 1.1) + turned(turned(turned(p_lidar_m, 1, 2, 2.0 * kDegree), 2, 0, -3.0 * kDegree), 0, 1, 15.0 * kDegree);
}

class SimWireTruth : public testing::Test {
 protected:
  void Run(const std::string& scene_name, const LidarParams& lidar, std::optional<config::Scene::ReturnMode> mode = {}) {
    auto scene = MakeScene(scene_name, 4);
    scene.effects.set_range_sd_m(0.0);
    if (mode) scene.effects.set_return_mode(*mode);
    SimulationParams params;
    params.start = Utime(1'781'532'600s);
    params.duration = 1500ms;
    params.seed = 4;
    params.lidar = lidar;
    TruthWriter truth(folder_ / "truth", scene, TurnedBoat(), params.start, {.force = true});
    Simulation simulation(scene, TurnedBoat(), params, &truth);
    PcapSink sink(folder_ / "a.pcap", {2368, 8308}, {.force = true});
    while (const auto datagram = simulation.Next()) sink.Send(*datagram);
    sink.Finish().Commit();
    io::CommitAll(truth.Finish());
    points_ = Decode(DataPackets(folder_ / "a.pcap"));
    rows_ = Rows(folder_ / "truth" / "returns.csv");
  }

  // Each return of the packets is the one of its row, to a centimetre, or to what its azimuth tells: that is rounded to 0.01 deg, and behind the last
  // block of a packet two of them are drawn out by 0.81 of their distance, 0.005 deg x (1 + 2 x 0.81): a centimetre at 44 m. Ranges are rounded to 2
  // mm.
  // @param has_gaps  times behind a gap within a packet are not those that its stamp tells
  void ExpectReturnsOfTheTruth(bool has_gaps) {
    ASSERT_EQ(points_.size(), rows_.size());
    ASSERT_GT(points_.size(), 5'000U);
    std::size_t num_far = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto& point = points_[i];
      const auto& row = rows_[i];
      ASSERT_EQ(point.ring, std::stoi(row.at(1))) << "row " << i;
      ASSERT_EQ(point.return_index, std::stoi(row.at(2)));
      const double row_since_hour_us = static_cast<double>(std::stoll(row.at(0)) % 3'600'000'000);
      if (!has_gaps) {
        ASSERT_NEAR(point.since_hour_us, row_since_hour_us, 1.0);
      }
      const Vector3d truth_m(std::stod(row.at(5)), std::stod(row.at(6)), std::stod(row.at(7)));
      const double difference_m = (point.p_lidar_m - truth_m).norm();
      ASSERT_LT(difference_m, std::max(0.01, std::hypot(truth_m.norm() * 0.0132 * kDegree, 0.001))) << row.at(4) << " at " << truth_m.norm() << " m";
      num_far += difference_m > 0.01 ? 1 : 0;
    }
    EXPECT_LT(static_cast<double>(num_far), 0.01 * static_cast<double>(points_.size()));
  }

  // By the truth's pose of the own boat, what is told to be an object's lies within the object's outline. Calm scenes only: outlines are those of
  // boats that stand level. A return lies on the axis of its beam, also where only the beam's edge met the object: 1.5 mrad beside it.
  void ExpectReturnsWithinOutlines() {
    std::map<int, std::map<std::int64_t, std::vector<Vector2d>>> outlines;
    for (const auto& row : Rows(folder_ / "truth" / "outlines.csv")) {
      outlines[std::stoi(row[0])][std::stoll(row[1])].emplace_back(std::stod(row[5]), std::stod(row[6]));
    }
    std::map<std::int64_t, Vector3d> places_m;  // of the own boat, each 100 ms
    for (const auto& row : Rows(folder_ / "truth" / "object_poses.csv")) {
      if (row[0] == "-1") places_m[std::stoll(row[1])] = {std::stod(row[4]), std::stod(row[5]), std::stod(row[6])};
    }
    std::map<std::int64_t, Vector3d> angles_deg;  // heading, pitch, roll, each 20 ms
    for (const auto& row : Rows(folder_ / "truth" / "pose.csv"))
      angles_deg[std::stoll(row[0])] = {std::stod(row[3]), std::stod(row[5]), std::stod(row[4])};
    std::map<std::string, std::string> kinds;
    for (const auto& row : Rows(folder_ / "truth" / "objects.csv")) kinds[row[0]] = row[2];
    std::size_t num_checked = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto& row = rows_[i];
      const std::string& kind = kinds.at(row[3]);
      // Land reaches beyond the first trees; a mixed edge lies between two things.
      if (row[4] != "object" || kind == "shore" || kind == "island") continue;
      const std::int64_t time_us = std::stoll(row[0]);
      const auto after = places_m.upper_bound(time_us);
      const auto before = std::prev(after);
      const double share = ShareOf(time_us, before->first, after->first);
      const Vector3d origin_m = before->second + share * (after->second - before->second);
      const auto angles_after = angles_deg.upper_bound(time_us);
      if (angles_after == angles_deg.end()) continue;
      const auto angles_before = std::prev(angles_after);
      Vector3d turn_deg = angles_after->second - angles_before->second;
      turn_deg.x() = std::remainder(turn_deg.x(), 360.0);
      const Vector3d angles_rad = (angles_before->second + ShareOf(time_us, angles_before->first, angles_after->first) * turn_deg) * kDegree;
      const Vector3d p_map_m = origin_m + Axes(angles_rad.x(), angles_rad.y(), angles_rad.z()) * ToVessel(points_[i].p_lidar_m);
      const auto& by_time = outlines.at(std::stoi(row[3]));
      std::vector<Vector2d> outline_m = by_time.begin()->second;
      if (by_time.size() > 1) {
        const auto& next_m = by_time.at(after->first);
        outline_m = by_time.at(before->first);
        for (std::size_t k = 0; k < outline_m.size(); ++k) outline_m[k] += share * (next_m[k] - outline_m[k]);
      }
      ASSERT_LT(OutsideM(p_map_m.head<2>(), outline_m), 0.01 + 0.0015 * points_[i].p_lidar_m.norm())
          << kind << " " << row[3] << " at " << points_[i].p_lidar_m.norm() << " m, " << p_map_m.transpose();
      ASSERT_GT(p_map_m.z(), -0.03) << kind << ": nothing is seen below the water";
      ++num_checked;
    }
    EXPECT_GT(num_checked, 300U);
  }

  support::TempDir folder_;
  std::vector<Point> points_;
  std::vector<std::vector<std::string>> rows_;
};

TEST_F(SimWireTruth, IsToldByPacketsOfABoatAmongManyThings) {
  Run("dense", {});
  ExpectReturnsOfTheTruth(false);
  ExpectReturnsWithinOutlines();
}

TEST_F(SimWireTruth, IsToldByPacketsOfABoatThatTurns) {
  Run("turning", {});
  ExpectReturnsOfTheTruth(false);
  ExpectReturnsWithinOutlines();
}

TEST_F(SimWireTruth, IsToldByPacketsOfDualReturn) {
  Run("dual", {});
  ExpectReturnsOfTheTruth(false);
  ExpectReturnsWithinOutlines();
}

TEST_F(SimWireTruth, IsToldByPacketsOfAQuickHeadThatGivesTheLastReturn) {
  LidarParams lidar;
  lidar.rotation_rpm = 1200.0;
  Run("marina", lidar, config::Scene::LAST);
  ExpectReturnsOfTheTruth(false);
  ExpectReturnsWithinOutlines();
}

TEST_F(SimWireTruth, IsToldByPacketsOfALimitedFieldOfView) {
  for (const auto mode : {config::Scene::STRONGEST, config::Scene::DUAL}) {
    LidarParams lidar;
    lidar.field_of_view = {300.0 * kDegree, 120.0 * kDegree};
    Run("marina", lidar, mode);
    ExpectReturnsOfTheTruth(true);
    ExpectReturnsWithinOutlines();
  }
}

TEST_F(SimWireTruth, IsToldByPacketsOfRainAndWaves) {
  for (const auto* scene : {"rain", "waves"}) {
    Run(scene, {});
    ExpectReturnsOfTheTruth(false);
  }
}

}  // namespace
}  // namespace lookout::sim
