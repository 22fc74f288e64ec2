#include "services/tracker/params.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "tests/support/files.hpp"

namespace lookout::tracker {
namespace {

TEST(TrackerParams, HaveTheGuardZoneOfTheBoats) {
  for (const auto& folder : {support::kDemoConfig, support::kCatabotConfig}) {
    const auto zone = LoadParams(folder.string()).guard_zone;
    EXPECT_EQ(zone.range_m, 10.0);
    EXPECT_NEAR(zone.bearing.start_rad, DegToRad(300.0), 1e-12);
    EXPECT_NEAR(zone.bearing.width_rad, DegToRad(120.0), 1e-12);
    EXPECT_FALSE(zone.takes_tentative);
  }
}

// Returns in the box around the hull are own boat: such a zone was taken, and could never ring.
TEST(TrackerParams, RefuseAGuardZoneInsideTheOwnHull) {
  const support::TempDir folder;
  for (const auto* file : {"boat.txtpb", "segmenter.txtpb"}) std::filesystem::copy_file(support::kDemoConfig / file, folder / file);
  const auto load = [&folder](const std::string& zone) {
    std::ofstream(folder / "tracker.txtpb") << "guard_zone { " + zone + " }\n";
    try {
      LoadParams(folder);
    } catch (const config::ConfigError& error) {
      return error.faults().at(0);
    }
    return std::string();
  };
  const auto fault = load("range_m: 1.3 from_bearing_deg: 330 to_bearing_deg: 30");
  EXPECT_NE(fault.find("guard_zone.range_m: the zone of 1.3 m lies wholly inside own_vessel of boat.txtpb, which reaches 1.4 m forward, 1.4 m aft, "
                       "0.9 m to port and 0.9 m to starboard"),
            std::string::npos)
      << fault;
  EXPECT_EQ(load("range_m: 1.3"), "") << "all round it reaches out to the sides";
  EXPECT_EQ(load("range_m: 1.5 from_bearing_deg: 330 to_bearing_deg: 30"), "");
}

}  // namespace
}  // namespace lookout::tracker
