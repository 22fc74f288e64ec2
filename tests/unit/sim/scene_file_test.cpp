#include "lab/sim/scene_file.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "lab/sim/scene_maker.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/sim/scenes.hpp"

namespace lookout::sim {
namespace {

namespace fs = std::filesystem;

const std::string kHead = "description: \"a test\"\nown_boat {}\n";

std::string FaultsOf(const std::string& text, std::uint64_t seed = 1) {
  try {
    ParseScene(text, "s.txtpb", seed);
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "";
}

// What one object too many says; it stands in line 3.
std::string ObjectFaults(const std::string& object) { return FaultsOf(kHead + "object { " + object + " }\n"); }

TEST(SceneFile, EmptyWaterIsAScene) {
  const Scene scene = ParseScene(kHead, "s.txtpb", 1);
  EXPECT_TRUE(scene.objects.empty());
  EXPECT_TRUE(scene.sea.is_calm());
}

TEST(SceneFile, NeedsADescriptionAndAnOwnBoat) {
  EXPECT_EQ(FaultsOf(""), "s.txtpb:1: description: must be set\ns.txtpb:1: own_boat: must be set");
  EXPECT_EQ(FaultsOf("own_boat {}\ndescription: \"\"\n"), "s.txtpb:2: description: must be one line of printable ASCII");
  EXPECT_NE(FaultsOf("own_boat {}\ndescription: \"a\\nb\"\n"), "");
}

TEST(SceneFile, RefusesUnknownKindsAndFieldsWithTheirLine) {
  EXPECT_NE(ObjectFaults("kind: SUBMARINE").find("s.txtpb:3:"), std::string::npos);
  EXPECT_NE(ObjectFaults("kind: BUOY colour: 3").find("s.txtpb:3:"), std::string::npos);
  EXPECT_EQ(ObjectFaults("east_m: 20"), "s.txtpb:3: object[0]: kind: must be set");
}

TEST(SceneFile, RefusesNumbersThatAreNotFiniteOrOutOfRange) {
  EXPECT_EQ(ObjectFaults("kind: BUOY east_m: nan"), "s.txtpb:3: object.east_m: must be a finite number (is nan)");
  EXPECT_EQ(ObjectFaults("kind: BUOY east_m: [5, 5000]"), "s.txtpb:3: object.east_m: must be at most 1000 (is 5000)");
  EXPECT_EQ(ObjectFaults("kind: BUOY count: 0"), "s.txtpb:3: object.count: must be at least 1 (is 0)");
  EXPECT_EQ(FaultsOf(kHead + "effects {\n  stray_probability: 1.5\n}\n"), "s.txtpb:4: effects.stray_probability: must be at most 1 (is 1.5)");
}

TEST(SceneFile, ChoosesAHead) {
  EXPECT_EQ(ParseScene(kHead, "s.txtpb", 1).lidar, "vlp16");
  EXPECT_EQ(ParseScene(kHead + "lidar: \"os1-64\"\n", "s.txtpb", 1).lidar, "os1-64");
  EXPECT_EQ(FaultsOf(kHead + "lidar: \"os9\"\n"),
            "s.txtpb:3: lidar: there is no such head; there are: vlp16, hi-res, vlp-32c, hdl-32e, os1-64, os1-128, xt32, qt64");
}

TEST(SceneFile, RefusesRangesThatAreNone) {
  EXPECT_EQ(ObjectFaults("kind: BUOY east_m: [30, 20]"), "s.txtpb:3: object[0].east_m: the range must run from the lesser to the greater value");
  EXPECT_EQ(ObjectFaults("kind: BUOY east_m: [10, 20, 30]"), "s.txtpb:3: object[0].east_m: must be a value or a range of two values");
}

TEST(SceneFile, RefusesFieldsThatDoNotSuitTheKind) {
  EXPECT_EQ(ObjectFaults("kind: SWIMMER east_m: 20 length_m: 2"), "s.txtpb:3: object[0].length_m: a swimmer has none");
  EXPECT_EQ(ObjectFaults("kind: DOCK east_m: 20 path { speed_mps: 1 }"), "s.txtpb:3: object[0].path: a dock cannot move");
  EXPECT_EQ(ObjectFaults("kind: BUOY east_m: 20 land { mean_radius_m: 5 }"), "s.txtpb:3: object[0].land: only a shore or an island has it");
  EXPECT_EQ(ObjectFaults("kind: ISLAND east_m: 40"), "s.txtpb:3: object[0].land: must be set");
  EXPECT_EQ(ObjectFaults("kind: KAYAK on_shore_bearing_deg: 20"),
            "s.txtpb:3: object[0].on_shore_bearing_deg: only a dock or a pier has it\n"
            "s.txtpb:3: object[0].on_shore_bearing_deg: there is no shore before it");
}

TEST(SceneFile, RefusesWaysThatCannotBeGone) {
  EXPECT_EQ(ObjectFaults("kind: KAYAK east_m: 20 path {}"), "s.txtpb:3: object[0].path.speed_mps: must be set");
  EXPECT_EQ(ObjectFaults("kind: KAYAK east_m: 20 path { speed_mps: 1 waypoint { east_m: 20 north_m: 0 } }"),
            "s.txtpb:3: object[0].path.waypoint[0]: is where the object starts");
  EXPECT_EQ(FaultsOf(kHead + "object {\n kind: KAYAK east_m: 20\n path { speed_mps: 1\n waypoint { east_m: 30 north_m: 0 }\n"
                             " waypoint { east_m: 25 north_m: 0 }\n}\n}\n"),
            "s.txtpb:6: object[0].path.waypoint[0]: the path stands still here, or turns back on the spot");
  EXPECT_EQ(ObjectFaults("kind: KAYAK path { speed_mps: 1 circle { radius_m: 20 } waypoint { east_m: 5 north_m: 0 } }"),
            "s.txtpb:3: object[0].path.circle: not with waypoints");
}

TEST(SceneFile, RefusesARowOfOneAndOneThatFollowsWaypoints) {
  EXPECT_EQ(ObjectFaults("kind: BUOY east_m: 20 row { bearing_deg: 0 gap_m: 2 }"), "s.txtpb:3: object[0].row: needs a count of two or more");
  EXPECT_EQ(ObjectFaults("kind: KAYAK count: 2 row { bearing_deg: 0 gap_m: 2 } path { speed_mps: 1 waypoint { east_m: 5 north_m: 9 } }"),
            "s.txtpb:3: object[0].row: not with waypoints");
}

TEST(SceneFile, RefusesNamesThatDoNotFitATableOrComeTwice) {
  EXPECT_EQ(ObjectFaults("kind: BUOY east_m: 20 name: \"a,b\""),
            "s.txtpb:3: object[0].name: must consist of lower case letters, digits and _ (is \"a,b\")");
  EXPECT_EQ(FaultsOf(kHead + "object { kind: BUOY east_m: 20 name: \"b\" }\nobject { kind: BUOY east_m: 30\n name: \"b\" }\n"),
            "s.txtpb:5: object[1].name: there are two objects of the name b");
}

TEST(SceneFile, RefusesBreakingWavesAndAnEllipseThatAlsoTurns) {
  EXPECT_EQ(FaultsOf(kHead + "sea { significant_height_m: 1 wavelength_m: 5 }\n"),
            "s.txtpb:3: sea.significant_height_m: must be at most a seventh of wavelength_m, or the waves break");
  EXPECT_EQ(FaultsOf("description: \"x\"\nown_boat { speed_mps: 2\n ellipse { semi_axis_east_m: 5 semi_axis_north_m: 5 period_s: 60 } }\n"),
            "s.txtpb:2: own_boat.speed_mps: the ellipse says it");
}

TEST(SceneFile, SaysWhichObjectLiesInTheWayOfTheOwnBoat) {
  const std::string head = "description: \"x\"\nown_boat { speed_mps: 1 }\n";
  EXPECT_EQ(FaultsOf(head + "object { kind: BUOY name: \"far\" east_m: 10 }\nobject { kind: BUOY name: \"ahead\" north_m: 30 }\n"),
            "s.txtpb:4: object[1]: ahead comes to 0.00 m of own boat within 60 s, must stay 1.50 m away");
  EXPECT_EQ(FaultsOf(head + "object { kind: BUOY north_m: 70 }\n"), "") << "not reached in 60 s";
  EXPECT_NE(FaultsOf(head + "object { kind: MOTOR_BOAT east_m: 40 north_m: 20 heading_deg: 270 path { speed_mps: 2 } }\n"), "")
      << "both at (0, 20) after 20 s";
}

// Two boats that were written to one place used to be one boat with two ids.
TEST(SceneFile, RefusesTwoHullsInOnePlaceAlsoWhereThePlacesAreExact) {
  EXPECT_EQ(FaultsOf(kHead + "object { kind: MOTOR_BOAT east_m: 30 }\nobject { kind: KAYAK east_m: 31 north_m: 1 }\n"),
            "s.txtpb:4: object[1]: kayak_1 and motor_boat_1 are in one place within 60 s");
  EXPECT_EQ(FaultsOf(kHead + "object { kind: MOTOR_BOAT east_m: 30 }\nobject { kind: KAYAK east_m: 31.5 }\n"), "") << "alongside";
  EXPECT_EQ(FaultsOf(kHead + "object { kind: PIER east_m: 30 heading_deg: 90 }\nobject { kind: BUOY east_m: 31 }\n"), "") << "a fender at a pier";
}

TEST(SceneFile, RefusesMoreObjectsThanFitIntoAMessageOfTheTruth) {
  std::string text = kHead;
  for (const auto* name : {"a", "b", "c"}) {
    text += "object { kind: BUOY count: 100 name: \"" + std::string(name) + "\" east_m: [-900, 900] north_m: [20, 900] }\n";
  }
  EXPECT_EQ(FaultsOf(text), "s.txtpb:5: object[2]: too many objects, or too long an outline: all must fit into one message of 120 kB");
}

TEST(SceneFile, GivesUpWhenADrawnObjectFindsNoPlace) {
  const std::string faults = ObjectFaults("kind: BUOY count: 50 east_m: [10, 12] north_m: [10, 12]");
  EXPECT_EQ(faults.find("s.txtpb:3: object[0]: no place in 200 tries: at the last buoy_"), 0U) << faults;
}

TEST(SceneFile, DrawsWithinRangesAndNewForEachOfACount) {
  const Scene scene =
      ParseScene(kHead + "object { kind: BUOY count: 20 east_m: [10, 40] north_m: 7 width_m: [0.4, 0.8] min_distance_m: 0.1 }", "s", 3);
  ASSERT_EQ(scene.objects.size(), 20U);
  EXPECT_EQ(scene.objects[19].name, "buoy_20");
  for (const auto& buoy : scene.objects) {
    const Eigen::Vector2d place_m = buoy.track.start.position_map_m;
    EXPECT_GE(place_m.x(), 10.0);
    EXPECT_LT(place_m.x(), 40.0);
    EXPECT_EQ(place_m.y(), 7.0);
    EXPECT_GE(buoy.outline_m[0].x(), 0.2);
    EXPECT_LT(buoy.outline_m[0].x(), 0.4);
  }
}

TEST(SceneFile, AnObjectMoreLeavesTheOthersWhereTheyWere) {
  const std::string one = kHead + "object { kind: BUOY east_m: [10, 40] }\n";
  const Scene alone = ParseScene(one, "s", 5);
  const Scene both = ParseScene(one + "object { kind: KAYAK east_m: [-40, -10] heading_deg: [0, 360] }\n", "s", 5);
  EXPECT_EQ(alone.objects[0].track.start.position_map_m, both.objects[0].track.start.position_map_m);
}

TEST(SceneFile, PutsARowSideBySideWithItsGaps) {
  const Scene scene = ParseScene(kHead + "object { kind: MOTOR_BOAT count: 4 east_m: -10 north_m: 20 row { bearing_deg: 90 gap_m: 4 } }", "s", 1);
  ASSERT_EQ(scene.objects.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    // Hulls of 2.2 m and 4 m between them.
    EXPECT_NEAR(scene.objects[i].track.start.position_map_m.x(), -10.0 + 6.2 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR(scene.objects[i].track.start.position_map_m.y(), 20.0, 1e-9);
  }
}

TEST(SceneFile, BuildsADockOntoTheShoreAnywhere) {
  const Scene scene =
      ParseScene(kHead +
                     "object { kind: SHORE east_m: 100 north_m: 50 land { mean_radius_m: 60 from_bearing_deg: 300 width_deg: 120 } }\n"
                     "object { kind: DOCK on_shore_bearing_deg: 0 length_m: 10 }\n",
                 "s", 1);
  const Placement dock = scene.objects[1].track.start;
  EXPECT_NEAR(dock.position_map_m.x(), 100.0, 1e-9);
  EXPECT_NEAR(dock.position_map_m.y(), 111.0, 1e-9);
  EXPECT_NEAR(dock.ToMap({10.0, 0.0}).y(), 101.0, 1e-9) << "out into the water";
}

TEST(SceneFile, TellsTheOwnBoatHowToMove) {
  const auto at = [](const std::string& own_boat, double time_s) {
    const Scene scene = ParseScene("description: \"x\"\nown_boat { " + own_boat + " }\n", "s", 1);
    return StateAt(scene.own_motion, 0.0, time_s);
  };
  EXPECT_TRUE(at("east_m: 3 north_m: 4 heading_deg: 30", 9.0).position_map_m.isApprox(Eigen::Vector3d(3.0, 4.0, 0.0)));
  EXPECT_NEAR(at("heading_deg: 90 speed_mps: 3", 10.0).position_map_m.x(), 30.0, 1e-9);
  const auto turned = at("turn_rate_degps: 20 speed_mps: 1", 4.5);
  EXPECT_NEAR(RadToDeg(turned.heading_rad), 90.0, 1e-9);
  EXPECT_NEAR(turned.velocity_map_mps.x(), 1.0, 1e-9);
  EXPECT_NEAR(at("ellipse { semi_axis_east_m: 9 semi_axis_north_m: 5 period_s: 60 start_deg: 90 }", 0.0).position_map_m.y(), 5.0, 1e-9);
  EXPECT_NEAR(RadToDeg(at("turn_rate_degps: 20", 1.0).heading_rad), 20.0, 1e-9) << "on the spot";
}

TEST(SceneFile, RocksTheOwnBoatNoMoreThanAsked) {
  const Scene scene = ParseScene("description: \"x\"\nown_boat { roll_deg: 8 pitch_deg: 5 heave_m: 0.3 }\n", "s", 1);
  double greatest_rad = 0.0;
  for (double time_s = 0.0; time_s < 200.0; time_s += 0.05) {
    const auto state = StateAt(scene.own_motion, 0.0, time_s);
    greatest_rad = std::max(greatest_rad, std::abs(state.roll_rad));
    EXPECT_LE(std::abs(state.pitch_rad), DegToRad(5.0) + 1e-9);
    EXPECT_LE(std::abs(state.heave_m), 0.3 + 1e-9);
  }
  EXPECT_LE(greatest_rad, DegToRad(8.0) + 1e-9);
  EXPECT_GT(greatest_rad, DegToRad(7.0));
}

TEST(SceneFile, TakesEffectsOverAndLeavesTheRestAtTheirDefaults) {
  const Scene scene = ParseScene(kHead + "effects { return_mode: DUAL rain_probability_per_m: 0.01 }", "s", 1);
  EXPECT_EQ(scene.effects.return_mode(), config::Scene::DUAL);
  EXPECT_EQ(scene.effects.rain_probability_per_m(), 0.01);
  const Effects none = ParseScene(kHead, "s", 1).effects;
  EXPECT_EQ(none.range_sd_m(), 0.025);
  EXPECT_EQ(none.half_seen_range_m(), 100.0);
  EXPECT_EQ(none.stray_probability(), 1e-4);
  for (const double strength : {none.horizontal_divergence_mrad(), none.vertical_divergence_mrad(), none.glint_probability(), none.mirror_strength(),
                                none.crest_probability(), none.wake_probability(), none.spray_probability(), none.rain_probability_per_m()}) {
    EXPECT_EQ(strength, 0.0);
  }
  EXPECT_EQ(none.return_mode(), config::Scene::STRONGEST);
}

TEST(Kinds, EveryKindOfTheSchemaCanBeMade) {
  for (int value = config::Scene::Kind_MIN; value <= config::Scene::Kind_MAX; ++value) {
    if (!config::Scene::Kind_IsValid(value)) continue;
    const auto kind = static_cast<config::Scene::Kind>(value);
    const bool is_ring = kind == config::Scene::SHORE || kind == config::Scene::ISLAND;
    const bool is_along_a_line = kind == config::Scene::COAST || kind == config::Scene::QUAY || kind == config::Scene::BREAKWATER;
    const bool is_built = kind == config::Scene::PILE_PIER || kind == config::Scene::BRIDGE;
    EXPECT_EQ(FindKind(kind) == nullptr, is_ring || is_along_a_line || is_built) << NameOf(kind);
    const std::string place = is_ring ? " land { mean_radius_m: 12 num_trees: 5 }" : is_along_a_line ? " length_m: 40 land { depth_m: 20 }" : "";
    // A shore lies outward of its place, so the own boat is in it at the place only when it is an island.
    EXPECT_EQ(ObjectFaults("kind: " + config::Scene::Kind_Name(kind) + (kind == config::Scene::SHORE ? "" : " east_m: 60") + place), "");
  }
}

TEST(Kinds, BoatsSwimmersBuoysAndMarkersAreInTheWater) {
  std::string in_water;
  for (const auto& kind : Kinds()) in_water += kind.is_in_water ? std::string(kind.name) + ' ' : "";
  EXPECT_EQ(in_water,
            "motor_boat cabin_boat sailing_boat kayak swimmer buoy marker open_boat cruiser sailing_dinghy yacht twin_hull raft canoe paddle_board "
            "pedal_boat barge workboat navigation_buoy float race_mark stake fish_farm bather log water_bird rowing_shell houseboat jet_ski "
            "windsurfer robot_boat any_craft any_buoy ");
}

class SceneFolders : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_ / "scenes"); }
  void Write(const std::string& name, const std::string& text) { std::ofstream(folder_ / "scenes" / name) << text; }

  support::TempDir folder_;
};

TEST_F(SceneFolders, BesideTheBoatComeFirst) {
  Write("mine.txtpb", kHead);
  Write("lake.txtpb", kHead);
  EXPECT_EQ(FindScene("mine", folder_ / "boat"), folder_ / "scenes/mine.txtpb");
  EXPECT_EQ(FindScene("mine", folder_ / "boat/"), folder_ / "scenes/mine.txtpb");
  EXPECT_EQ(FindScene("lake", folder_ / "boat"), folder_ / "scenes/lake.txtpb");
  EXPECT_EQ(FindScene("dense", folder_ / "boat"), support::kSources / "config/scenes/dense.txtpb");
  EXPECT_EQ(FindScene("elsewhere/other.txtpb", folder_ / "boat"), "elsewhere/other.txtpb");
}

TEST_F(SceneFolders, AreListedWithTheirDescriptions) {
  Write("mine.txtpb", kHead);
  const auto scenes = ListScenes(folder_ / "boat");
  EXPECT_EQ(scenes.size(), SceneNames().size() + 1);
  const auto mine = std::ranges::find(scenes, "mine", &SceneSummary::name);
  ASSERT_NE(mine, scenes.end());
  EXPECT_EQ(mine->description, "a test");
}

TEST_F(SceneFolders, AnUnknownNameSaysWhichThereAre) {
  try {
    FindScene("nowhere", folder_ / "boat");
    FAIL();
  } catch (const config::ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("no such scene: nowhere (there are: black_buoys, canal, "), std::string::npos) << error.what();
  }
}

// A boat's folder elsewhere, and programs that were moved with their tree, once found no scene: "there are: ".
TEST_F(SceneFolders, AreFoundAboveTheBoatAndAboveTheProgram) {
  const auto folders = sim::SceneFolders(folder_ / "fleet/boat", folder_ / "opt/tree/build/release/bin/lookout-sim");
  for (const auto* wanted : {"fleet/boat/scenes", "fleet/scenes", "scenes", "config/scenes", "opt/tree/config/scenes",
                             "opt/tree/build/release/share/lookout/config/scenes"}) {
    EXPECT_NE(std::ranges::find(folders, folder_ / wanted), folders.end()) << wanted;
  }
  EXPECT_LT(std::ranges::find(folders, folder_ / "fleet/scenes"), std::ranges::find(folders, folder_ / "opt/tree/config/scenes"));
  Write("mine.txtpb", kHead);
  EXPECT_EQ(FindScene("mine", folder_ / "fleet/boat"), folder_ / "scenes/mine.txtpb");
}

TEST_F(SceneFolders, AnUnknownNameSaysWhereItWasLookedFor) {
  try {
    FindScene("nowhere", folder_ / "boat");
    FAIL();
  } catch (const config::ConfigError& error) {
    for (const auto& folder : sim::SceneFolders(folder_ / "boat", {})) {
      EXPECT_NE(std::string(error.what()).find(folder.string()), std::string::npos) << folder << ": " << error.what();
    }
  }
}

TEST_F(SceneFolders, AFileThatIsNotThereIsAnError) { EXPECT_THROW(LoadScene(folder_ / "none.txtpb", 1), config::ConfigError); }

}  // namespace
}  // namespace lookout::sim
