#include "common/config/boat.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "common/config/text_config.hpp"
#include "common/runtime/run_info.hpp"
#include "tests/support/files.hpp"

namespace lookout::config {
namespace {

const std::string kDemo = support::kDemoConfig.string();

// Words and cures of what is doubtful.
std::string Warnings(const BoatFacts& boat) {
  std::string text;
  for (const auto& remark : RemarksOnBoat(boat)) {
    if (!remark.cure.empty()) text += remark.words + " | " + remark.cure + "\n";
  }
  return text;
}

bool Has(const std::string& text, const std::string& piece) { return text.find(piece) != std::string::npos; }

TEST(BoatInWords, OfTheBoatsInConfigIsNotDoubtful) {
  for (const std::string boat : {"demo", "catabot"}) EXPECT_EQ(Warnings(LoadBoat(support::kSources / "config" / boat)), "");
  const auto remarks = RemarksOnBoat(LoadBoat(kDemo));
  ASSERT_EQ(remarks.size(), 3U);
  EXPECT_EQ(
      remarks[0].words,
      "returns up to 1.4 m ahead and 1.4 m astern, up to 0.9 m to port and 0.9 m to starboard of the reference point, from 0.6 m below the water to "
      "2.4 m above the water, are own boat");
  EXPECT_EQ(remarks[1].words, "the lidar is 0.50 m ahead and 0.10 m to starboard of the reference point, 1.50 m above the water");
  EXPECT_EQ(remarks[2].words, "the GNSS antenna is 0.80 m astern and 0.40 m to port of the reference point, 1.30 m above the water");
}

// Such a box was taken without a word, and everything ahead of the boat was own boat.
TEST(BoatInWords, NamesABoxThatReachesFarAhead) {
  auto boat = LoadBoat(kDemo);
  boat.own_vessel_box_m.max().x() = 14.0;
  const auto warnings = Warnings(boat);
  EXPECT_TRUE(Has(warnings, "returns up to 14.0 m ahead and 1.4 m astern")) << warnings;
  EXPECT_TRUE(Has(warnings, "that box is 15.4 m x 1.8 m, the hull 2.4 m x 1.4 m")) << warnings;
  EXPECT_TRUE(Has(warnings, "own_vessel in boat.txtpb")) << warnings;
}

TEST(BoatInWords, NamesABoxThatIsLargerByMoreThanAMetreInAnyDirection) {
  const auto with_box = [](double min_x_m, double max_x_m, double min_y_m, double max_y_m) {
    auto boat = LoadBoat(kDemo);
    boat.own_vessel_box_m = {Eigen::Vector3d(min_x_m, min_y_m, -1.0), Eigen::Vector3d(max_x_m, max_y_m, 2.0)};
    return !Warnings(boat).empty();
  };
  EXPECT_FALSE(with_box(-1.7, 1.69, -1.2, 1.19));
  EXPECT_TRUE(with_box(-1.7, 1.75, -1.2, 1.19));
  EXPECT_TRUE(with_box(-1.7, 1.69, -1.2, 1.25));
  EXPECT_TRUE(with_box(3.0, 3.5, -0.9, 0.9)) << "small, but ahead of the whole boat";
  EXPECT_TRUE(with_box(-1.4, 1.4, -2.9, -2.3)) << "small, but beside it";
}

TEST(BoatInWords, OfABoxBesideTheReferencePointTellsBothEnds) {
  auto boat = LoadBoat(kDemo);
  boat.own_vessel_box_m.min().x() = 0.2;
  EXPECT_TRUE(Has(RemarksOnBoat(boat)[0].words, "returns from 0.2 m ahead to 1.4 m ahead, up to 0.9 m to port"));
}

// 80 m of lever arm was taken without a word: every obstacle 80 m off, with status ok.
TEST(BoatInWords, NamesAnAntennaAndALidarThatAreNotOnTheBoat) {
  auto boat = LoadBoat(kDemo);
  boat.p_vessel_antenna_m.x() = 80.5;
  EXPECT_TRUE(Has(Warnings(boat),
                  "the GNSS antenna is 80.50 m ahead and 0.40 m to port of the reference point, 1.30 m above the water; that is more than 2.0 m "
                  "outside of a hull "
                  "of 2.4 m x 1.4 m | the place of the GNSS antenna: gnss_antenna in boat.txtpb"))
      << Warnings(boat);
  boat = LoadBoat(kDemo);
  boat.T_vessel_lidar.translation().y() = -5.0;
  EXPECT_TRUE(Has(Warnings(boat), "the lidar is 0.50 m ahead and 5.00 m to starboard")) << Warnings(boat);
  boat.hull_m.reset();
  EXPECT_TRUE(Has(Warnings(boat), "more than 2.0 m outside of own_vessel")) << Warnings(boat);
}

TEST(BoatInWords, NamesAnAntennaUnderWater) {
  auto boat = LoadBoat(kDemo);
  boat.p_vessel_antenna_m.z() = -2.0;
  EXPECT_TRUE(RemarksOnBoat(boat)[2].is_under_water);
  EXPECT_TRUE(Has(Warnings(boat), "1.60 m below the water | the sign of gnss_antenna.z_m")) << Warnings(boat);
}

// A file from before these facts is accepted, with a warning.
TEST(BoatInWords, SaysThatTheSizeOfTheHullIsNotSet) {
  auto boat = LoadBoat(kDemo);
  boat.hull_m.reset();
  EXPECT_TRUE(Has(Warnings(boat), "the size of the hull is not set")) << Warnings(boat);
}

TEST(BoatInWords, ARefusedHullIsOneThatIsHalfTold) {
  const support::TempDir folder;
  std::ifstream demo(kDemo + "/boat.txtpb");
  std::string text{std::istreambuf_iterator<char>(demo), {}};
  text.erase(text.find("hull_beam_m: 1.4"), 16);
  std::ofstream(folder / "boat.txtpb") << text;
  try {
    LoadBoat(folder);
    ADD_FAILURE() << "was taken";
  } catch (const ConfigError& error) {
    EXPECT_TRUE(Has(error.what(), "hull_beam_m: must be set where the other of the two is")) << error.what();
  }
}

// What --check prints is a config again: the words are comments.
TEST(BoatInWords, StandsInTheEffectiveConfigAsComments) {
  const auto text = runtime::EffectiveConfig(kDemo, {"boat.txtpb"});
  EXPECT_TRUE(Has(text, "\n# boat.txtpb: returns up to 1.4 m ahead")) << text;
  const support::TempDir folder;
  std::ofstream(folder / "boat.txtpb") << text;
  EXPECT_EQ(RemarksAsComments(LoadBoat(folder)), RemarksAsComments(LoadBoat(kDemo)));
}

}  // namespace
}  // namespace lookout::config
