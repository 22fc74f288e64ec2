#include "services/tracker/params.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "services/tracker/params_text.hpp"
#include "tests/support/files.hpp"

namespace lookout::tracker {
namespace {

TEST(TrackerParams, HaveTheGuardZoneOfTheBoats) {
  for (const auto& folder : {support::kDemoConfig, support::kCatabotConfig}) {
    const auto zone = LoadParams(folder.string()).look_out.limits.guard_zone;
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

// What --check says of the zone, beside the values. A config that cuts the zone away was taken without a word.
TEST(ZoneInWords, SaysWhatNobodyLooksInto) {
  const support::TempDir folder;
  const auto says = [&folder](const std::string& tracker, const std::string& segmenter, const std::string& vlp16 = "") {
    std::filesystem::copy_file(support::kCatabotConfig / "boat.txtpb", folder / "boat.txtpb", std::filesystem::copy_options::overwrite_existing);
    std::ofstream(folder / "segmenter.txtpb") << segmenter << "\n";
    std::ofstream(folder / "tracker.txtpb") << tracker << "\n";
    if (!vlp16.empty()) std::ofstream(folder / "lidar.txtpb") << vlp16 << "\n";
    return ZoneRemarksAsComments(LoadParams(folder));
  };
  const std::string ahead = "guard_zone { range_m: 10 from_bearing_deg: 300 to_bearing_deg: 60 }";
  const std::string ok =
      "# tracker.txtpb: by the config the lidar can look into all of the guard zone of 10.0 m; what the lidar itself is set to, and what stands "
      "before "
      "it, its scans tell\n";
  EXPECT_EQ(says("", ""),
            "# tracker.txtpb: warning: there is no guard zone: what lies near raises no alert, a closest approach alone does; look at guard_zone in "
            "tracker.txtpb, or in tracker of boat.txtpb\n");
  EXPECT_EQ(says(ahead, ""),
            ok + "# tracker.txtpb: in the guard zone things of 0.5 m above the water are seen from 1.5 m on, with the boat level: nearer "
                 "they are below the lowest beam\n");
  const auto holds = [&](const std::string& segmenter, const std::string& words) {
    const auto text = says(ahead, segmenter);
    EXPECT_EQ(text.rfind("# tracker.txtpb: warning: " + words + "; look at guard_zone in tracker.txtpb; ", 0), 0U) << text;
  };
  holds("min_range_m: 20", "no look-out in the whole guard zone: 300 to 60 deg (nearer than min_range_m of the segmenter)");
  holds("max_range_m: 5", "no look-out in part of the guard zone: 300 to 60 deg, from 5.0 m on (beyond max_range_m of the segmenter)");
  holds("field_of_view_start_deg: 90 field_of_view_width_deg: 180",
        "no look-out in the whole guard zone: 300 to 60 deg (outside of the segmenter's field of view)");
  holds("field_of_view_start_deg: 0 field_of_view_width_deg: 300",
        "no look-out in part of the guard zone: 300 to 0 deg (outside of the segmenter's field of view)");
  EXPECT_NE(says(ahead, "", "source: UDP model: MODEL_PUCK_HI_RES cut_azimuth_deg: 0 bind_address: '0.0.0.0'").find("from 2.5 m on"),
            std::string::npos)
      << "10 deg down instead of 15";
}

}  // namespace
}  // namespace lookout::tracker
