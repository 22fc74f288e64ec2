// lookout-eval --points as a user runs it, on recordings that the test writes: a wall and two boats, seen by lidars of 16 and of 64 rings.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/child.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/data/cloud_text.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;
using data::test::Append;

struct Point {
  float x_m;
  float y_m;
  float z_m;
  std::uint16_t object;  // 1 and 2 are boats, 3 is a wall
};

// Elevations from -15 degrees up. All things stand upright: a ring sees them at the same distance over ground, if at all.
std::vector<Point> Turn(int num_rings, double step_deg, double jitter_deg) {
  constexpr int kNumColumns = 900;
  constexpr double kHeightM = 2.0;
  std::vector<Point> points;
  for (int ring = 0; ring < num_rings; ++ring) {
    for (int column = 0; column < kNumColumns; ++column) {
      const double azimuth_deg = 360.0 * (column + 0.5) / kNumColumns;
      const bool is_boat = azimuth_deg < 14.0;
      const bool is_other_boat = azimuth_deg >= 90.0 && azimuth_deg < 104.0;
      const bool is_wall = azimuth_deg >= 200.0 && azimuth_deg < 250.0;
      if (!is_boat && !is_other_boat && !is_wall) continue;
      const double distance_m = is_boat ? 12.0 : is_other_boat ? 20.0 : 30.0;
      const double elevation_deg = -15.0 + step_deg * ring + jitter_deg * std::sin(7.0 * column);
      const double z_m = distance_m * std::tan(elevation_deg * std::numbers::pi / 180.0);
      if (std::abs(z_m) > kHeightM) continue;
      const double azimuth_rad = azimuth_deg * std::numbers::pi / 180.0;
      points.push_back({static_cast<float>(distance_m * std::cos(azimuth_rad)), static_cast<float>(-distance_m * std::sin(azimuth_rad)),
                        static_cast<float>(z_m),
                        static_cast<std::uint16_t>(is_boat         ? 1
                                                   : is_other_boat ? 2
                                                                   : 3)});
    }
  }
  return points;
}

class Points : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return Path(name);
  }
  RunResult Evaluate(const std::vector<std::string>& files) const {
    std::vector<std::string> command{Bin("eval"), "--config", kCatabotConfig.string(), "--methods", "ours",    "--csv",
                                     Path("csv"), "--html",   Path("page.html"),       "--force",   "--points"};
    command.insert(command.end(), files.begin(), files.end());
    return RunProgram(command, Path("out"));
  }
  // Of the first method, in the column of recordings.
  std::string Miou() const {
    std::ifstream in(folder_ / "csv/table_1.csv");
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line, "method,mean,points");
    std::getline(in, line);
    return line;
  }

  static std::string Kitti(const std::vector<Point>& points) {
    std::string bytes;
    for (const auto& point : points) bytes += data::test::KittiPoint(point.x_m, point.y_m, point.z_m);
    return bytes;
  }
  template <typename ToLabel>
  static std::string Labels(const std::vector<Point>& points, ToLabel to_label) {
    std::string bytes;
    for (const auto& point : points) Append(bytes, static_cast<std::uint32_t>(to_label(point)));
    return bytes;
  }
  static std::string Pcd(const std::vector<Point>& points, bool is_binary) {
    std::string bytes =
        data::test::PcdHeaderText(static_cast<int>(points.size()), "x y z label", "4 4 4 4", "F F F U", is_binary ? "binary" : "ascii");
    for (const auto& point : points) {
      if (is_binary) {
        for (const float value : {point.x_m, point.y_m, point.z_m}) Append(bytes, value);
        Append(bytes, std::uint32_t{point.object});
      } else {
        for (const float value : {point.x_m, point.y_m, point.z_m}) bytes += std::to_string(value) + " ";
        bytes += std::to_string(point.object) + "\n";
      }
    }
    return bytes;
  }

  TempDir folder_;
};

constexpr int kKittiRings = 64;
constexpr double kKittiStepDeg = 0.4;

TEST_F(Points, SixtyFourRingsWithInstancesAreScored) {
  const auto turn = Turn(kKittiRings, kKittiStepDeg, 0.0);
  const auto file = Write("a.bin", Kitti(turn));
  Write("a.label", Labels(turn, [](const Point& point) { return (std::uint32_t{point.object} << 16) | 18U; }));
  const auto result = Evaluate({file});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(Miou(), "ours (all segments),100.0,100.0") << result.output;
  EXPECT_NE(result.output.find("rings"), std::string::npos);
  EXPECT_EQ(result.output.find("bands"), std::string::npos) << "the rings of an even cloud are found";
  EXPECT_GT(fs::file_size(folder_ / "page.html"), 0U);
}

TEST_F(Points, AClassWithoutInstanceIsNoObjectBesideOthersThatHaveOne) {
  const auto turn = Turn(kKittiRings, kKittiStepDeg, 0.0);
  const auto file = Write("a.bin", Kitti(turn));
  Write("a.label", Labels(turn, [](const Point& point) { return point.object == 3 ? 50U : (std::uint32_t{point.object} << 16) | 18U; }));
  const auto result = Evaluate({file});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(Miou(), "ours (all segments),100.0,100.0");
  std::ifstream in(folder_ / "csv/kinds.csv");
  std::string kinds;
  std::getline(in, kinds);
  EXPECT_EQ(kinds, "method,class 18") << "the wall is none";
}

TEST_F(Points, ClassesAreObjectsWhereNoPointHasAnInstance) {
  const auto turn = Turn(kKittiRings, kKittiStepDeg, 0.0);
  const auto file = Write("a.bin", Kitti(turn));
  Write("a.label", Labels(turn, [](const Point& point) { return point.object + 10U; }));
  const auto result = Evaluate({file});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(Miou(), "ours (all segments),100.0,100.0");
  EXPECT_NE(result.output.find("each class is an object"), std::string::npos);
}

TEST_F(Points, TextAndBinaryPcdGiveTheSameFigures) {
  const auto turn = Turn(16, 2.0, 0.0);
  const auto text = Evaluate({Write("text.pcd", Pcd(turn, false))});
  ASSERT_EQ(text.exit_code, 0) << text.output;
  EXPECT_EQ(Miou(), "ours (all segments),100.0,100.0");
  const auto binary = Evaluate({Write("binary.pcd", Pcd(turn, true))});
  ASSERT_EQ(binary.exit_code, 0) << binary.output;
  EXPECT_EQ(Miou(), "ours (all segments),100.0,100.0");
  // Of the 16 those from -9 to 9 degrees meet something.
  EXPECT_NE(text.output.find(" 10 rings"), std::string::npos);
}

TEST_F(Points, CloudWhoseRingsFlowTogetherIsOrganisedByElevation) {
  const auto turn = Turn(40, 0.7, 0.5);
  const auto result = Evaluate({Write("a.pcd", Pcd(turn, true))});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("bands of equal height"), std::string::npos) << result.output;
  EXPECT_TRUE(Miou() == "ours (all segments),99.9,99.9" || Miou() == "ours (all segments),100.0,100.0")
      << Miou() << ": of two points in a cell the farther may be hidden";
}

TEST_F(Points, WithoutLabelsThereIsNoIou) {
  const auto result = Evaluate({Write("a.bin", Kitti(Turn(kKittiRings, kKittiStepDeg, 0.0)))});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(Miou(), "ours (all segments),-,-");
  EXPECT_NE(result.output.find("no labels"), std::string::npos);
}

TEST_F(Points, BrokenFileIsNamedWithItsReason) {
  const auto turn = Turn(16, 2.0, 0.0);
  const auto bytes = Kitti(turn);
  const auto cut = Evaluate({Write("cut.bin", bytes.substr(0, bytes.size() - 3))});
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_NE(cut.output.find("cut.bin: byte"), std::string::npos) << cut.output;
  EXPECT_NE(cut.output.find("ends inside a point"), std::string::npos) << cut.output;
  const auto text = Pcd(turn, false);
  const auto bad = Evaluate({Write("bad.pcd", text.substr(0, text.size() - 2) + "x\n")});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_NE(bad.output.find("bad.pcd:"), std::string::npos) << bad.output;
  EXPECT_NE(bad.output.find("not a number"), std::string::npos) << bad.output;
  EXPECT_EQ(Evaluate({Write("a.xyz", "1 2 3\n")}).exit_code, 2);
}

}  // namespace
}  // namespace lookout::system_test
