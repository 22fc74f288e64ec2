// The families of the source tree, and what makes a scene one.
#include <algorithm>
#include <chrono>
#include <gtest/gtest.h>
#include <map>
#include <set>

#include "common/config/text_config.hpp"
#include "lab/sim/family.hpp"
#include "lab/sim/scene_maker.hpp"
#include "lab/sim/traffic.hpp"
#include "tests/unit/sim/scenes.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;

const std::string kBegin = "description: \"a test\"\n";
const std::string kFreeBoat = kBegin + "own_boat { free_by_m: 1 beside { object: \"quay\" gap_m: [3, 9] turned: ALONG } }\n";

std::string FaultsOfFamily(const std::string& text) {
  try {
    ParseScene(text, "s.txtpb", 1);
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "";
}

Outline OnMap(const SceneObject& object) {
  Outline outline_m;
  for (const auto& p_m : object.outline_m) outline_m.push_back(object.track.At(0.0).ToMap(p_m));
  return outline_m;
}

Outline OwnOutline(const Scene& scene, double time_s) {
  const OwnState state = StateAt(scene.own_motion, 0.0, time_s);
  Outline outline_m;
  for (const auto& p_m : Rectangle(-1.2, 1.2, -0.7, 0.7)) {
    outline_m.push_back(Placement{state.position_map_m.head<2>(), state.heading_rad}.ToMap(p_m));
  }
  return outline_m;
}

// Names, kinds, places and numbers of parts: what differs where two layouts do.
std::string LayoutOf(const Scene& scene) {
  std::string layout;
  for (const auto& object : scene.objects) {
    layout += object.name + ' ' + object.kind + ' ' + std::to_string(object.track.start.position_map_m.x()) + ' ' +
              std::to_string(object.track.start.position_map_m.y()) + ' ' + std::to_string(object.parts.size()) + '\n';
  }
  return layout;
}

class Family : public testing::TestWithParam<std::string> {
 protected:
  Scene Make(std::uint64_t seed) { return LoadScene(support::kSources / "config/scenes/families" / (GetParam() + ".txtpb"), seed); }
};

std::vector<std::string> FamilyNames() {
  std::vector<std::string> names;
  for (const auto& family : ListFamilies(support::kSources / "config/demo")) names.push_back(family.name);
  return names;
}

TEST_P(Family, DrawsThirtyLayoutsInTimeThatDiffer) {
  constexpr std::uint64_t kNumSeeds = 30;
  constexpr std::chrono::seconds kLongest(3);
  std::set<std::string> layouts;
  for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
    const auto begin = std::chrono::steady_clock::now();
    Scene scene;
    ASSERT_NO_THROW(scene = Make(seed)) << seed;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, kLongest) << seed;
    layouts.insert(LayoutOf(scene));
  }
  EXPECT_GE(layouts.size(), kNumSeeds - 3) << "all but those of empty water";
}

TEST_P(Family, GivesTheSameForTheSameSeed) { EXPECT_EQ(LayoutOf(Make(4)), LayoutOf(Make(4))); }

TEST_P(Family, KeepsTheOwnBoatFreeOfEverything) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = Make(seed);
    for (const auto& object : scene.objects) {
      if (GetParam() == "alongside" && (object.kind == "pier" || object.kind == "bridge")) continue;  // one may lie below its deck
      EXPECT_GT(GapBetween(OwnOutline(scene, 0.0), OnMap(object)), GetParam() == "alongside" ? 0.34 : 0.5) << object.name << ", seed " << seed;
    }
  }
}

// Another boat's way led over its only place, or too near to it.
TEST(Families, AreLaidOutAnewWhereTheOwnBoatHasNoPlace) {
  const auto file = support::kSources / "config/scenes/families/wide_water.txtpb";
  std::set<std::string> layouts;
  for (const std::uint64_t seed : {83U, 126U, 131U, 200U}) {
    Scene scene;
    ASSERT_NO_THROW(scene = LoadScene(file, seed)) << seed;
    for (const auto& object : scene.objects) EXPECT_GT(GapBetween(OwnOutline(scene, 0.0), OnMap(object)), 2.99) << seed;
    EXPECT_EQ(LayoutOf(scene), LayoutOf(LoadScene(file, seed))) << seed;
    layouts.insert(LayoutOf(scene));
  }
  EXPECT_GE(layouts.size(), 2U);
}

// Nothing lay within 3 m of the own boat in any other family.
TEST(Alongside, HasThingsNearTheOwnBoatInMostLayoutsAndNoneInIt) {
  constexpr int kNumSeeds = 40;
  int num_near = 0;
  int num_between = 0;
  int num_moving = 0;
  for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
    const Scene scene = LoadScene(support::kSources / "config/scenes/families/alongside.txtpb", seed);
    int num_things = 0;
    for (const auto& object : scene.objects) {
      // One passes below decks, which are not in the way.
      if (object.kind == "pier" || object.kind == "bridge") continue;
      for (const double time_s : {0.0, 3.0, 6.0}) {
        Outline outline_m;
        for (const auto& p_m : object.outline_m) outline_m.push_back(object.track.At(time_s).ToMap(p_m));
        const double distance_m = GapBetween(OwnOutline(scene, time_s), outline_m);
        EXPECT_GE(distance_m, 0.34) << object.name << ", seed " << seed << " at " << time_s << " s";
        if (time_s == 0.0 && distance_m < 3.0) ++num_things;
      }
    }
    num_near += num_things > 0 ? 1 : 0;
    num_between += num_things > 1 ? 1 : 0;
    num_moving += scene.own_motion.track.speed_mps > 0.0 ? 1 : 0;
  }
  EXPECT_GE(num_near, kNumSeeds * 3 / 4);
  EXPECT_GE(num_between, kNumSeeds / 4);
  EXPECT_GE(num_moving, kNumSeeds / 5);
  EXPECT_LE(num_moving, kNumSeeds * 4 / 5);
}

INSTANTIATE_TEST_SUITE_P(All, Family, testing::ValuesIn(FamilyNames()), [](const auto& family) { return family.param; });

TEST(Families, AreFoundByNameAndListedApart) {
  EXPECT_EQ(FindScene("beach", support::kSources / "config/demo"), support::kSources / "config/scenes/families/beach.txtpb");
  EXPECT_GE(FamilyNames().size(), 12U);
  for (const auto& name : SceneNames()) EXPECT_NE(name, "beach");
}

TEST(Beside, ThingsLieAtTheirGapInFrontOfTheEdge) {
  const std::string text = kFreeBoat +
                           "object { kind: QUAY name: \"quay\" length_m: 120 heading_deg: 90 land { edge: FACE } }\n"
                           "object { kind: KAYAK name: \"kayak\" number: 6 beside { object: \"quay\" gap_m: [1, 2] turned: ALONG } }\n";
  const Scene scene = ParseScene(text, "s", 3);
  ASSERT_GE(scene.objects.size(), 5U);
  const Outline quay_m = OnMap(scene.objects[0]);
  for (std::size_t i = 1; i < scene.objects.size(); ++i) {
    const auto& kayak = scene.objects[i];
    EXPECT_LT(kayak.track.start.position_map_m.y(), 0.0) << "land is on the port side of a line to the east";
    const double gap_m = GapBetween(OnMap(kayak), quay_m);
    EXPECT_GE(gap_m, 0.99) << i;
    EXPECT_LE(gap_m, 2.01) << i;
    EXPECT_NEAR(std::abs(std::sin(kayak.track.start.heading_rad)), 1.0, 1e-6) << "parallel";
  }
  const double own_gap_m = GapBetween(OwnOutline(scene, 0.0), quay_m);
  EXPECT_GE(own_gap_m, 2.99);
  EXPECT_LE(own_gap_m, 9.01);
}

TEST(Beside, ARowKeepsItsGapsAndEachMemberItsPartner) {
  const std::string quay = "object { kind: QUAY name: \"quay\" length_m: 120 heading_deg: 90 land { edge: FACE } }\n";
  const Scene row = ParseScene(kFreeBoat + quay +
                                   "object { kind: KAYAK name: \"kayak\" number: 4 min_distance_m: 0\n"
                                   " beside { object: \"quay\" gap_m: 1 turned: OUT row_gap_m: 2 } }\n",
                               "s", 5);
  ASSERT_EQ(row.objects.size(), 5U);
  for (std::size_t i = 2; i < 5; ++i) EXPECT_NEAR(GapBetween(OnMap(row.objects[i - 1]), OnMap(row.objects[i])), 2.0, 1e-6);
  const Scene pairs = ParseScene(
      kFreeBoat + quay +
          "object { kind: BUOY name: \"ball\" number: 3 east_m: [-50, 50] north_m: [-60, -30] min_distance_m: 12 }\n"
          "object { kind: KAYAK name: \"kayak\" number: 9 min_distance_m: 0 beside { object: \"ball\" gap_m: 1 is_each: true turned: IN } }\n",
      "s", 5);
  ASSERT_EQ(pairs.objects.size(), 7U) << "a kayak for each ball";
  for (std::size_t i = 1; i <= 3; ++i) EXPECT_NEAR(GapBetween(OnMap(pairs.objects[i]), OnMap(pairs.objects[i + 3])), 1.0, 0.05);
}

// They ended at the border of the reeds, up to 4 m before the bank.
TEST(Beside, DocksReachTheLandBehindReeds) {
  for (const std::string dock : {"JETTY", "PONTOON", "DOCK_BAYS", "DOCK", "PIER", "PILE_PIER"}) {
    const Scene scene = ParseScene(kBegin +
                                       "own_boat { free_by_m: 1 north_m: -90 }\n"
                                       "object { kind: COAST name: \"bank\" length_m: 120 heading_deg: 90 land { edge: REEDS } }\n"
                                       "object { name: \"dock\" kind: " +
                                       dock + " number: 1 beside { object: \"bank\" gap_m: 0 turned: OUT } }\n",
                                   "s.txtpb", 3);
    ASSERT_EQ(scene.objects.size(), 2U) << dock;
    const auto& object = scene.objects[1];
    double end_m = -90.0;
    for (const auto& p_m : OnMap(object)) end_m = std::max(end_m, p_m.y());
    EXPECT_GE(end_m, 0.4) << dock << ": the waterline is at 0";
    EXPECT_LE(end_m, 5.0) << dock;
    // Its parts with it.
    for (const double along_m : {-0.3, 0.3}) {
      const Ray down{{along_m, 0.0, 20.0}, -Eigen::Vector3d::UnitZ()};
      EXPECT_TRUE(std::ranges::any_of(object.parts, [&](const Part& part) { return Intersect(part.solid, down).has_value(); }))
          << dock << ' ' << along_m;
    }
  }
}

TEST(Opposite, BanksRunAtTheirDistance) {
  const Scene scene = ParseScene(kFreeBoat +
                                     "object { kind: QUAY name: \"quay\" length_m: 150 heading_deg: 90\n"
                                     " land { edge: FACE bends: 2 bend_deg: [-20, 20] bend_radius_m: 80 } }\n"
                                     "object { kind: QUAY name: \"other\" opposite { object: \"quay\" distance_m: 20 } land { edge: FACE } }\n",
                                 "s", 2);
  ASSERT_EQ(scene.objects.size(), 2U);
  EXPECT_NEAR(GapBetween(OnMap(scene.objects[0]), OnMap(scene.objects[1])), 20.0, 0.6);
}

TEST(Layouts, OneIsDrawnWithItsOwnBoatAndItsObjectsAlone) {
  const std::string text =
      kBegin +
      "own_boat { free_by_m: 1 speed_mps: [1, 2] }\nlayout { name: \"a\" weight: 3 own_boat { speed_mps: 0 north_m: 10 } }\nlayout { name: \"b\" }\n"
      "object { kind: BUOY name: \"of_a\" layout: \"a\" east_m: 20 }\nobject { kind: BUOY name: \"of_b\" layout: \"b\" east_m: 20 }\n"
      "object { kind: BUOY name: \"of_both\" layout: \"a\" layout: \"b\" east_m: 30 }\nobject { kind: BUOY name: \"always\" east_m: -30 }\n";
  int num_a = 0;
  constexpr int kNumSeeds = 200;
  for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
    const Scene scene = ParseScene(text, "s.txtpb", seed);
    ASSERT_EQ(scene.objects.size(), 3U);
    const bool is_a = scene.objects[0].name == "of_a";
    num_a += is_a ? 1 : 0;
    EXPECT_EQ(is_a, scene.own_motion.track.speed_mps == 0.0);
    EXPECT_EQ(scene.own_motion.track.start.position_map_m.y(), is_a ? 10.0 : 0.0);
  }
  EXPECT_NEAR(num_a, 0.75 * kNumSeeds, 25);
}

TEST(OwnBoat, ThingsLieBesideItWhenItComesBeforeThem) {
  const std::string text =
      kBegin +
      "own_boat { free_by_m: 0.4 before: \"next\" heading_deg: [0, 360] speed_mps: 0 }\n"
      "object { kind: BUOY name: \"far\" east_m: 40 }\n"
      "object { kind: KAYAK name: \"next\" number: 2 min_distance_m: 0.3 beside { object: \"own_sides\" gap_m: [0.5, 1] turned: ALONG } }\n"
      "object { kind: BUOY name: \"round\" number: 3 min_distance_m: 0.3 beside { object: \"own_boat\" gap_m: [2, 4] } }\n";
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene scene = ParseScene(text, "s.txtpb", seed);
    const Outline own_m = OwnOutline(scene, 0.0);
    ASSERT_EQ(scene.objects.size(), 6U) << seed;
    for (std::size_t i = 1; i < 6; ++i) {
      const double distance_m = GapBetween(own_m, OnMap(scene.objects[i]));
      EXPECT_GE(distance_m, i < 3 ? 0.49 : 1.99) << scene.objects[i].name << ", seed " << seed;
      EXPECT_LE(distance_m, i < 3 ? 1.01 : 4.5) << scene.objects[i].name << ", seed " << seed;
    }
    for (const std::size_t i : {1U, 2U}) {
      EXPECT_NEAR(std::sin(scene.objects[i].track.start.heading_rad - scene.own_motion.track.start.heading_rad), 0.0, 1e-6) << "parallel";
    }
  }
}

TEST(OwnBoat, LiesBelowADeckAlone) {
  const auto text = [](const std::string& pier) {
    return kBegin +
           "own_boat { free_by_m: 0.3 east_m: [-1, 1] north_m: [6, 14] heading_deg: [0, 360] }\n"
           "object { kind: PILE_PIER name: \"pier\" length_m: 20 width_m: 8 " +
           pier + " }\n";
  };
  const Scene scene = ParseScene(text("height_m: 4 is_passed_under: true"), "s.txtpb", 2);
  const Outline own_m = OwnOutline(scene, 0.0);
  EXPECT_EQ(GapBetween(own_m, OnMap(scene.objects[0])), 0.0);
  for (const auto& part : scene.objects[0].parts) {
    const auto* pile = std::get_if<Cylinder>(&part.solid);
    if (pile == nullptr || pile->bottom_m > 0.0) continue;
    const Vector2d at_m = scene.objects[0].track.start.ToMap(pile->center_m);
    EXPECT_GE(GapBetween(own_m, {at_m, at_m, at_m}), pile->radius_m + 0.29);
  }
  for (const auto& low : {"height_m: 4", "height_m: 2 is_passed_under: true"}) {
    EXPECT_THROW(ParseScene(text(low), "s.txtpb", 2), config::ConfigError) << low;
  }
}

TEST(OneOf, DrawsByWeightAndAListOfOneReplacesThatOfTheObject) {
  config::Scene scene;
  config::ParseText(
      "description: 'x' own_boat {}\nobject { length_m: [5, 9] path { speed_mps: [1, 2] }\n"
      " one_of { kind: KAYAK weight: 9 length_m: 4 } one_of { kind: SWIMMER path { speed_mps: 0.5 } } }",
      "s", scene);
  const auto& object = scene.object(0);
  Random random(1, 1);
  std::map<config::Scene::Kind, int> drawn;
  for (int i = 0; i < 1000; ++i) {
    const auto member = DrawMember(object, random);
    ++drawn[member.kind()];
    EXPECT_EQ(member.length_m_size(), member.kind() == config::Scene::KAYAK ? 1 : 2);
    EXPECT_EQ(member.path().speed_mps_size(), member.kind() == config::Scene::KAYAK ? 2 : 1);
  }
  EXPECT_NEAR(drawn[config::Scene::KAYAK], 900, 40);
}

TEST(DrawnNumbers, LieBetweenBothAndWavesDoNotBreak) {
  config::Scene scene;
  config::ParseText(
      "description: 'x' own_boat { roll_deg: 1 }\nown_boat_to { roll_deg: 3 }\n"
      "sea { significant_height_m: 0 wavelength_m: 2 }\nsea_to { significant_height_m: 1 wavelength_m: 3 }\neffects_to { rain_probability_per_m: 0.5 "
      "}",
      "s", scene);
  std::set<double> rolls;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto drawn = WithDrawnNumbers(scene, seed);
    EXPECT_GE(drawn.own_boat().roll_deg(), 1.0);
    EXPECT_LE(drawn.own_boat().roll_deg(), 3.0);
    EXPECT_LE(drawn.effects().rain_probability_per_m(), 0.5);
    EXPECT_GE(drawn.sea().wavelength_m(), 7.0 * drawn.sea().significant_height_m());
    rolls.insert(drawn.own_boat().roll_deg());
  }
  EXPECT_EQ(rolls.size(), 20U);
}

// A dock on a shore that chance had left out ended the process, and so did the other bank of none.
TEST(Families, LeaveOutWhatLiesAtLandThatChanceLeftOut) {
  const std::string boat = kBegin + "own_boat { free_by_m: 1 }\n";
  const Scene dock = ParseScene(boat +
                                    "object { kind: SHORE chance: 0 land { mean_radius_m: 50 } }\n"
                                    "object { kind: DOCK on_shore_bearing_deg: 10 }\n",
                                "s.txtpb", 1);
  EXPECT_TRUE(dock.objects.empty());
  const Scene bank = ParseScene(boat +
                                    "object { kind: COAST name: \"bank\" chance: 0 north_m: 30 heading_deg: 270 land { edge: BANK } }\n"
                                    "object { kind: COAST opposite { object: \"bank\" distance_m: 60 } land { edge: BANK } }\n",
                                "s.txtpb", 1);
  EXPECT_TRUE(bank.objects.empty());
}

// What came after an island without a place had an edge as long as the island's: a boat could lie beside a part of it alone.
TEST(Beside, WholeOutlinesCountAlsoBehindLandWithoutAPlace) {
  const auto text = [](const std::string& island) {
    return kBegin +
           "own_boat { free_by_m: 1 north_m: -60 }\nobject { kind: COAST name: \"coast\" north_m: 40 heading_deg: 90 land { edge: BANK } }\n" +
           "object { " + island + " }\nobject { kind: BUOY name: \"mooring\" width_m: 3 }\n" +
           "object { kind: KAYAK name: \"at\" number: 20 min_distance_m: 0 beside { object: \"mooring\" gap_m: [1, 60] turned: OUT } }\n";
  };
  const auto num_north_and_south = [](const Scene& scene) {
    std::pair<int, int> count{0, 0};
    for (const auto& object : scene.objects) {
      if (object.kind == "kayak") ++(object.track.start.position_map_m.y() > 0.0 ? count.first : count.second);
    }
    return count;
  };
  const Scene without = ParseScene(text("kind: BUOY chance: 0"), "s.txtpb", 1);
  const Scene with = ParseScene(text("kind: ISLAND number: 1 north_m: [50, 51] length_m: 8 land { edge: BANK }"), "s.txtpb", 1);
  ASSERT_EQ(with.objects.size(), without.objects.size());
  EXPECT_EQ(num_north_and_south(with), num_north_and_south(without));
  EXPECT_GT(num_north_and_south(with).second, 0);
}

// Both were read, and did nothing.
TEST(FamilyFaults, FieldsWithoutEffectAreRefused) {
  EXPECT_EQ(FaultsOfFamily(kBegin + "own_boat {}\nown_boat_to { speed_mps: 3 }\n"),
            "s.txtpb:3: own_boat_to.speed_mps: own_boat says it, as a range where it is drawn");
  EXPECT_EQ(FaultsOfFamily(kBegin + "own_boat {}\nobject { north_m: 20\n one_of { kind: BUOY count: 3 } }\n"),
            "s.txtpb:4: object[0].one_of[0].count: the object around it says it");
}

TEST(DrawnNumbers, AreThoseOfOneOfSeveralEffects) {
  config::Scene scene;
  config::ParseText("description: 'x' own_boat {}\neffects_to { rain_probability_per_m: 0.01 }\neffects_to { crest_probability: 0.1 }", "s", scene);
  int num_rain = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto effects = WithDrawnNumbers(scene, seed).effects();
    EXPECT_NE(effects.rain_probability_per_m() > 0.0, effects.crest_probability() > 0.0);
    num_rain += effects.rain_probability_per_m() > 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(num_rain, 50, 20);
}

TEST(FamilyFaults, LayoutsAndWhatComesBeforeTheOwnBoatAreChecked) {
  const std::string boat = kBegin + "own_boat { free_by_m: 1 before: \"b\" }\n";
  EXPECT_EQ(FaultsOfFamily(boat + "object { kind: BUOY name: \"a\" beside { object: \"own_boat\" gap_m: 1 } }\nobject { kind: BUOY name: \"b\" }\n"),
            "s.txtpb:3: object[0].beside.object: there is no object of this name before it");
  EXPECT_EQ(FaultsOfFamily(boat + "object { kind: BUOY name: \"a\" }\n"), "s.txtpb:2: own_boat.before: there is no object of this name");
  EXPECT_EQ(FaultsOfFamily(boat + "object { kind: BUOY name: \"b\" layout: \"x\" }\n"),
            "s.txtpb:3: object[0].layout[0]: there is no layout of the name x");
  EXPECT_EQ(FaultsOfFamily(boat + "layout { name: \"x\" own_boat { free_by_m: 2 } }\nobject { kind: BUOY name: \"b\" }\n"),
            "s.txtpb:3: layout[0].own_boat.free_by_m: own_boat says it");
  EXPECT_EQ(FaultsOfFamily(boat + "object { kind: BUOY name: \"b\" is_passed_under: true }\n"),
            "s.txtpb:3: object[0].is_passed_under: only a pier on piles or a bridge has it");
  EXPECT_EQ(FaultsOfFamily(boat + "object { kind: BUOY name: \"b\" }\nobject { kind: BUOY name: \"own_boat\" }\n"),
            "s.txtpb:4: object[1].name: is that of the own boat");
}

TEST(FamilyFaults, WhatWouldMoveOnTheGroundOrLieElsewhereIsRefused) {
  EXPECT_EQ(FaultsOfFamily(kBegin + "own_boat {}\nobject { kind: ANY_BUOY north_m: 20\n path { speed_mps: 1 } }\n"),
            "s.txtpb:4: object[0].path: some of its kinds stand on the ground; name one that floats");
}

// It took minutes: 20 bends of 3 km each, tried 200 times.
TEST(FamilyFaults, ACoastOfTensOfKilometresIsRefusedAtOnce) {
  EXPECT_EQ(FaultsOfFamily(kBegin + "own_boat { free_by_m: 1 }\nobject { kind: COAST north_m: 40\n"
                                    " land { bends: 20 bend_deg: 170 bend_radius_m: 1000 bay_m: 5 edge: BANK } }\n"),
            "s.txtpb:4: object[0].land: with its bends it is longer than 5 km");
}

TEST(FamilyFaults, NameTheFieldAndTheLine) {
  EXPECT_EQ(FaultsOfFamily(kBegin + "own_boat { free_by_m: 1 }\nobject { kind: BUOY name: \"a\" east_m: 9 }\n"
                                    "object { kind: COAST opposite { object: \"a\" distance_m: 20 } land { edge: BANK } }\n"),
            "s.txtpb:4: object[1].opposite.object: a is no coast and no quay");
  EXPECT_EQ(FaultsOfFamily(kBegin + "own_boat { free_by_m: 1 }\nobject { kind: QUAY name: \"a\" north_m: 30 heading_deg: 270 land { edge: FACE } }\n"
                                    "object { kind: BUOY opposite { object: \"a\" distance_m: 20 } }\n"),
            "s.txtpb:4: object[1].opposite: only a coast or a quay has it");
  EXPECT_EQ(FaultsOfFamily(kBegin + "own_boat {}\nobject { kind: KAYAK number: 2 beside { object: \"quay\" gap_m: 1 } }\n"),
            "s.txtpb:3: object[0].beside.object: there is no object of this name before it");
  EXPECT_EQ(FaultsOfFamily(kBegin + "own_boat {}\nobject { name: \"a\" number: 2\n one_of { weight: 2 } }\n"),
            "s.txtpb:4: object[0].one_of[0]: kind: must be set");
  EXPECT_EQ(FaultsOfFamily(kBegin + "own_boat {}\nobject { kind: COAST land { mean_radius_m: 5 } }\n"),
            "s.txtpb:3: object[0].land.mean_radius_m: land with edges has length_m");
  const std::string no_room = FaultsOfFamily(kFreeBoat +
                                             "object { kind: QUAY name: \"quay\" length_m: 9 heading_deg: 90 land { edge: FACE } }\n"
                                             "object { kind: DOCK length_m: 30 width_m: 50 north_m: -22 heading_deg: 0 }\n");
  EXPECT_NE(no_room.find("own_boat: "), std::string::npos) << no_room;
}

}  // namespace
}  // namespace lookout::sim
