#include "tools/calibrate/boat_file.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <stdexcept>

#include "common/core/angles.hpp"
#include "tests/support/files.hpp"

namespace lookout::calibrate {
namespace {

const Angles kAngles{DegToRad(1.234), DegToRad(-0.001), DegToRad(-95.0)};

std::string TextOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(BoatFile, ChangesTheThreeAnglesAndNothingElse) {
  const std::string text =
      "# lidar { roll_deg: 7 }\nname: \"lidar { yaw_deg: 1 }\"\nlidar_2 { roll_deg: 8 pitch_deg: 8 yaw_deg: 8 }\n"
      "lidar {\n  x_m: 0.5  # roll_deg: 9\n  roll_deg: 1.0\n  yaw_deg: 5  # by hand\n  pitch_deg:-0.5}\ngnss_antenna { x_m: 1 }\n";
  const auto changed = WithAngles(text, kAngles);
  ASSERT_TRUE(changed);
  EXPECT_EQ(*changed,
            "# lidar { roll_deg: 7 }\nname: \"lidar { yaw_deg: 1 }\"\nlidar_2 { roll_deg: 8 pitch_deg: 8 yaw_deg: 8 }\n"
            "lidar {\n  x_m: 0.5  # roll_deg: 9\n  roll_deg: 1.23\n  yaw_deg: -95.00  # by hand\n  pitch_deg:0.00}\ngnss_antenna { x_m: 1 }\n");
}

TEST(BoatFile, IsLeftAloneWhereItIsNotUnderstood) {
  EXPECT_FALSE(WithAngles("name: \"a\"\n", kAngles));
  EXPECT_FALSE(WithAngles("lidar { roll_deg: 1 pitch_deg: 2 }\n", kAngles)) << "no yaw";
  EXPECT_FALSE(WithAngles("lidar { roll_deg: 1 roll_deg: 1 pitch_deg: 2 yaw_deg: 3 }\n", kAngles)) << "twice";
  EXPECT_FALSE(WithAngles("lidar { roll_deg: 1 pitch_deg: 2 yaw_deg: 3\n", kAngles)) << "no end";
  EXPECT_FALSE(WithAngles("lidar { roll_deg: 1 pitch_deg: 2 yaw_deg: 3 } lidar { }\n", kAngles)) << "two lidars";
  EXPECT_FALSE(WithAngles("lidar < roll_deg: 1 pitch_deg: 2 yaw_deg: 3 >\n", kAngles)) << "the other brackets of text format";
  EXPECT_FALSE(WithAngles("", kAngles));
}

TEST(BoatFile, TheOldFileStaysAndASecondIsRefused) {
  const support::TempDir folder;
  const std::string text =
      "name: 'Ida' gnss_antenna { x_m: 0 y_m: 0 z_m: 1 } reference_point_above_water_m: 0.2 "
      "own_vessel { min_x_m: -1 max_x_m: 1 min_y_m: -1 max_y_m: 1 min_z_m: -1 max_z_m: 2 }\n"
      "lidar { x_m: 0 y_m: 0 z_m: 1 roll_deg: 1 pitch_deg: 2 yaw_deg: 3 }\n";
  std::ofstream(folder / "boat.txtpb") << text;
  WriteAngles(folder / ".", kAngles);
  EXPECT_EQ(TextOf(folder / "boat.txtpb.old"), text);
  const auto written = TextOf(folder / "boat.txtpb");
  EXPECT_EQ(written.substr(written.find("lidar")), "lidar { x_m: 0 y_m: 0 z_m: 1 roll_deg: 1.23 pitch_deg: 0.00 yaw_deg: -95.00 }\n");
  EXPECT_THROW(WriteAngles(folder / ".", {}), std::runtime_error);
  EXPECT_EQ(TextOf(folder / "boat.txtpb"), written) << "nothing is changed where the old file could not be kept";
}

}  // namespace
}  // namespace lookout::calibrate
