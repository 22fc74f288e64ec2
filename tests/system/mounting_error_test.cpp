// A lidar that is mounted one degree off what boat.txtpb says: what comes of it at the end of the chain, and whether the stated covariance knows.
#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/core/angles.hpp"
#include "lookout/obstacles_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;

constexpr double kYawErrorDeg = 1.0;

class MountingError : public ::testing::Test {
 protected:
  // Of the table "distance to the centre of what was truly seen", the row of sure obstacles to 40 m.
  struct Seen {
    double count = 0;
    double median_m = 0;
    double stated_sd_m = 0;
    double in_ellipse_percent = 0;
  };
  // By turn and number in it.
  using Obstacles = std::map<std::pair<std::int64_t, int>, obstacle_t>;

  TempDir folder_;

  void SetUp() override {
    MakeConfig("right", 0.0, 0.0);
    const auto result = RunProgram(
        {Bin("sim"), "--config", Path("right"), "--scene", "lake", "--seed", "3", "--seconds", "4", "--pcap", Path("pcap"), "--truth", Path("truth")},
        Path("sim.out"));
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  // config/demo with a yaw that is so much too large, and with such a deviation of the mounting stated. POSE is of the other sensors alone, so that
  // it is the same with each mounting.
  void MakeConfig(const std::string& name, double yaw_error_deg, double stated_sd_deg) const {
    fs::copy(kDemoConfig, folder_ / name);
    std::ofstream(folder_ / name / "navigator.txtpb", std::ios::app) << "\nuse_lidar_odometry: false\n";
    ReplaceIn(folder_ / name / "boat.txtpb", "yaw_deg: 5.0", "yaw_deg: " + std::to_string(5.0 + yaw_error_deg));
    ReplaceIn(folder_ / name / "georeferencer.txtpb", "mounting_sd_deg: 0\n", "mounting_sd_deg: " + std::to_string(stated_sd_deg) + "\n");
  }

  Seen Evaluate(const std::string& config) const {
    const auto log = Path(config + ".lcmlog");
    const auto replay = RunProgram({Bin("replay"), "--config", Path(config), "--in", Path("pcap"), "--out", log}, Path("replay.out"));
    EXPECT_EQ(replay.exit_code, 0) << replay.output;
    const auto result = RunProgram({Bin("eval"), "--in", log, "--truth", Path("truth"), "--boat", Path("right")}, Path("eval.out"));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    std::istringstream lines(result.output);
    Seen seen;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string name;
      double most_m = 0;
      double p95_m = 0;
      if (line.rfind("sure ", 0) == 0 &&
          words >> name >> seen.count >> seen.median_m >> p95_m >> most_m >> seen.stated_sd_m >> seen.in_ellipse_percent) {
        return seen;
      }
    }
    ADD_FAILURE() << "no row of sure obstacles in\n" << result.output;
    return seen;
  }

  Obstacles Read(const std::string& config) const {
    Obstacles obstacles;
    bus::LogReader reader(Path(config + ".lcmlog"));
    while (const auto event = reader.Next()) {
      if (event->channel != "OBSTACLES") continue;
      const auto message = bus::Decode<obstacles_t>(event->bytes);
      EXPECT_TRUE(message);
      if (!message) continue;
      for (const auto& obstacle : message->obstacles) {
        if (obstacle.status == obstacle_t::STATUS_OK) obstacles[{message->seq, obstacle.id}] = obstacle;
      }
    }
    return obstacles;
  }
};

TEST_F(MountingError, IsSeenInTheObstaclesAndKnownToTheirCovariance) {
  MakeConfig("unknown", kYawErrorDeg, 0.0);
  MakeConfig("stated", kYawErrorDeg, kYawErrorDeg);
  const auto right = Evaluate("right");
  const auto unknown = Evaluate("unknown");
  const auto stated = Evaluate("stated");
  std::cout << "median error " << right.median_m << " m; with the yaw off " << unknown.median_m
            << " m. In the 95 % ellipse: " << right.in_ellipse_percent << " %; off " << unknown.in_ellipse_percent << " %, off and stated "
            << stated.in_ellipse_percent << " %\n";
  EXPECT_GT(right.count, 100);
  EXPECT_LT(right.median_m, 0.10);
  EXPECT_GE(right.in_ellipse_percent, 90.0);
  // At 10 to 40 m a degree is 0.17 to 0.7 m.
  EXPECT_GT(unknown.median_m, 3.0 * right.median_m);
  EXPECT_LT(unknown.in_ellipse_percent, 50.0) << "a covariance that holds an error which it does not know of is too large";
  EXPECT_NEAR(stated.median_m, unknown.median_m, 0.02) << "what is stated moves nothing";
  EXPECT_GE(stated.in_ellipse_percent, 90.0);
  EXPECT_GT(stated.stated_sd_m, 3.0 * right.stated_sd_m);

  // Every obstacle is turned about the lidar by that degree, to port; and the covariance grows across the line of sight by what that is there.
  const auto before = Read("right");
  const auto after = Read("stated");
  const double yaw_error_rad = DegToRad(kYawErrorDeg);
  const Eigen::Vector2d lidar_m(0.5, -0.1);  // boat.txtpb, vessel frame
  int num_compared = 0;
  for (const auto& [key, obstacle] : after) {
    const auto found = before.find(key);
    if (found == before.end() || found->second.num_points != obstacle.num_points) continue;
    const auto from_lidar = [&lidar_m](const obstacle_t& one) -> Eigen::Vector2d {
      return Eigen::Vector2d(one.center_vessel_m[0], one.center_vessel_m[1]) - lidar_m;
    };
    const Eigen::Vector2d was_m = from_lidar(found->second);
    const Eigen::Vector2d is_m = from_lidar(obstacle);
    const double turned_rad = WrapToPi(std::atan2(is_m.y(), is_m.x()) - std::atan2(was_m.y(), was_m.x()));
    const double distance_m = was_m.norm();
    if (distance_m < 5.0) continue;  // the outline of what is near and seen from above changes its shape
    ++num_compared;
    EXPECT_NEAR(RadToDeg(turned_rad), kYawErrorDeg, 0.05);
    const Eigen::Vector2d moved_m(obstacle.position_map_m[0] - found->second.position_map_m[0],
                                  obstacle.position_map_m[1] - found->second.position_map_m[1]);
    EXPECT_NEAR(moved_m.norm(), distance_m * yaw_error_rad, 0.02 + 0.02 * distance_m * yaw_error_rad);
    const Eigen::Vector2d across = moved_m.normalized();
    const auto variance_m2 = [&across](const obstacle_t& one) {
      return one.covariance_m2[0] * across.x() * across.x() + 2.0 * one.covariance_m2[1] * across.x() * across.y() +
             one.covariance_m2[2] * across.y() * across.y();
    };
    const double grown_m = std::sqrt(variance_m2(obstacle) - variance_m2(found->second));
    EXPECT_NEAR(grown_m, distance_m * yaw_error_rad, 0.02 + 0.05 * distance_m * yaw_error_rad);
  }
  EXPECT_GT(num_compared, 500);
}

}  // namespace
}  // namespace lookout::system_test
