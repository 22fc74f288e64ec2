#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

#include "lab/eval/report/report_page.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/eval_report/made_up.hpp"

namespace lookout::eval {
namespace {

using nlohmann::json;

json Parsed(const Results& results) { return json::parse(JsonOf(results)); }

json WorstOf(const WorstScan& worst) {
  auto results = MadeUpResults();
  results.methods[0].worst = {worst};
  return Parsed(results)["worlds"][0]["methods"][0]["worst"][0];
}

void ExpectNear(const json& value, double expected) {
  ASSERT_TRUE(value.is_number()) << value;
  EXPECT_NEAR(value.get<double>(), expected, 1e-6 * (1.0 + std::abs(expected)));
}

TEST(Page, IsTheBuiltTemplateWithTheResultsInPlace) {
  std::ostringstream page;
  WriteHtml(MadeUpResults(), page);
  auto expected = support::ReadFile(support::kSources / "lab/eval/page/built/page.html");
  const std::string place = "{{results}}";
  const auto at = expected.find(place);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(page.str(), expected.replace(at, place.size(), JsonOf(MadeUpResults())));
}

// Only the script of the template runs, and nothing can be fetched.
TEST(Page, HasAPolicyThatAllowsItsOwnScriptAlone) {
  const auto page = support::ReadFile(support::kSources / "lab/eval/page/built/page.html");
  EXPECT_NE(page.find("content=\"default-src 'none'; script-src 'sha256-"), std::string::npos);
  for (const auto* word : {"<link", "<img", "<iframe", "@import", " src=", "url("}) {
    EXPECT_EQ(page.substr(0, page.find("<script>")).find(word), std::string::npos) << word;
  }
}

TEST(Json, SameResultsGiveTheSameBytes) { EXPECT_EQ(JsonOf(MadeUpResults()), JsonOf(MadeUpResults())); }

TEST(Json, NoTextEndsItsElementAndControlCharactersAreReplaced) {
  auto results = MadeUpResults();
  results.version = "</script><!--\x1b[31m \xff sj\xc3\xb6";
  const auto text = JsonOf(results);
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(json::parse(text)["version"], "</script><!--?[31m ? sj\xc3\xb6");
}

TEST(Json, SaysWhatWasRun) {
  const auto page = Parsed(MadeUpResults());
  EXPECT_EQ(page["command"], "lookout-eval --scenes 'dense' <&>");
  EXPECT_EQ(page["first_seed"], "5");
  EXPECT_EQ(page["last_seed"], "7");
  EXPECT_EQ(page["num_seeds"], 3);
  EXPECT_EQ(page["seconds"], 2.0);
  EXPECT_EQ(page["worlds"][0]["scenes"], (json{"dense", "open<water>", "rain"}));
  EXPECT_EQ(page["worlds"][0]["methods"][0]["total"]["num_scans"], 12);
}

TEST(Json, FiguresOfAMethodAreMeansOverScenesSumsOverScansAndOfEachScene) {
  const auto world = Parsed(MadeUpResults())["worlds"][0];
  const auto& ours = world["methods"][0];
  ExpectNear(ours["mean"]["iou_percent"], 85.2);
  ExpectNear(ours["scenes"][0]["iou_percent"], 90.2);
  EXPECT_TRUE(ours["scenes"][1]["iou_percent"].is_null()) << "no object over open water";
  ExpectNear(ours["scenes"][2]["iou_percent"], 80.2);
  ExpectNear(ours["mean"]["water_iou_percent"], 80.2);
  ExpectNear(ours["mean"]["with_segment_percent"], 87.5);
  ExpectNear(ours["mean"]["false_segments"], 0.5);
  ExpectNear(ours["scenes"][2]["false_segments"], 0.75);
  ExpectNear(ours["total"]["segments"], 2.0);
  ExpectNear(ours["total"]["over_segmented_percent"], 12.5);
  ExpectNear(ours["total"]["under_segmented_percent"], 25.0);
  ExpectNear(ours["total"]["true_positive_percent"], 93.7);
  ExpectNear(world["methods"][1]["mean"]["components"], 461.0);
  EXPECT_TRUE(world["methods"][2]["mean"]["components"].is_null());
  EXPECT_EQ(world["kinds"], (json{"buoy", "shore"}));
  ExpectNear(ours["kinds_iou_percent"][0], 80.2);
  ExpectNear(ours["kinds_iou_percent"][1], 90.2);
}

TEST(Json, TimesAreOfAllScansByNearestRank) {
  const auto ours = Parsed(MadeUpResults())["worlds"][0]["methods"][0];
  ExpectNear(ours["total"]["time_ms"]["median"], 1.25);
  ExpectNear(ours["total"]["time_ms"]["p99"], 2.5);
  ExpectNear(ours["scenes"][1]["time_ms"]["p99"], 0.5);
  const auto& cluster = ours["stages"][0];
  EXPECT_EQ(cluster["name"], "cluster");
  ExpectNear(cluster["time_ms"]["median"], 0.25);
  ExpectNear(cluster["time_ms"]["p99"], 0.5);
  ExpectNear(cluster["time_ms"]["mean"], 0.375);
  ExpectNear(cluster["time_ms"]["sd"], 0.125);
}

TEST(Json, BinsOfRangeHoldTheirMiddleAndNearRecallIsByMethod) {
  const auto world = Parsed(MadeUpResults())["worlds"][0];
  const auto& bins = world["methods"][0]["iou_by_range"];
  ASSERT_EQ(bins.size(), 2U);
  ExpectNear(bins[0]["middle_m"], 5.0);
  ExpectNear(bins[0]["percent"], 62.5);
  EXPECT_EQ(bins[0]["num_object_scans"], 8);
  ExpectNear(world["methods"][0]["recall_by_range"][1]["middle_m"], 25.0);
  ExpectNear(world["methods"][0]["recall_by_range"][1]["percent"], 25.0);
  const auto& row = world["near_recall"][0];
  EXPECT_EQ(row["scene"], "dense");
  EXPECT_EQ(row["kind"], "buoy");
  EXPECT_EQ(row["percent"], (json{75.0, 75.0, 75.0}));
}

TEST(Json, HoldsBinsOfStatedProbability) {
  const auto methods = Parsed(MadeUpResults())["worlds"][0]["methods"];
  const auto& bins = methods[0]["total"]["reliability"];
  ASSERT_EQ(bins.size(), 10U);
  ExpectNear(bins[8]["from"], 0.8);
  ExpectNear(bins[8]["to"], 0.9);
  EXPECT_EQ(bins[8]["num_segments"], 100);
  ExpectNear(bins[8]["stated"], 0.85);
  ExpectNear(bins[8]["observed"], 0.8);
  EXPECT_EQ(bins[3]["num_segments"], 0);
  EXPECT_TRUE(bins[3]["stated"].is_null());
  EXPECT_TRUE(bins[3]["observed"].is_null());
  EXPECT_EQ(methods[0]["scenes"][0]["reliability"], bins);
  EXPECT_TRUE(methods[0]["scenes"][2]["reliability"].empty()) << "nothing is known of that scene";
  EXPECT_TRUE(methods[1]["total"]["reliability"].empty()) << "it states no probability";
}

TEST(Json, CountsWhatBecameOfThingsByKind) {
  const auto rows = Parsed(MadeUpResults())["worlds"][0]["methods"][0]["outcomes"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1], (json{{"kind", "dock"}, {"found", 5}, {"into_land", 1}, {"into_thing", 0}, {"cut", 4}, {"with_clutter", 0}, {"missed", 0}}));
}

TEST(Json, OurErrorIsAShareOfTheBestPeers) {
  auto results = MadeUpResults();
  EXPECT_TRUE(Parsed(results)["worlds"][0]["against_peers"].empty()) << "there is none";
  results.methods[1].method = "Euclidean (tuned)";
  results.methods[2].method = "F3D";
  const auto rows = Parsed(results)["worlds"][0]["against_peers"];
  // 9.8 of 69.3, 19.8 of 19.7; the mean: 14.8 of 44.5.
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0]["tuned"]["name"], "Euclidean (tuned)");
  ExpectNear(rows[0]["iou_percent"], 90.2);
  ExpectNear(rows[0]["tuned"]["iou_percent"], 30.7);
  ExpectNear(rows[0]["tuned"]["false_segments"], 0.75);
  ExpectNear(rows[0]["tuned"]["error_percent"], 100.0 * 9.8 / 69.3);
  ExpectNear(rows[1]["all"]["error_percent"], 100.0 * 19.8 / 19.7);
  EXPECT_EQ(rows[2]["scene"], "mean");
  ExpectNear(rows[2]["tuned"]["error_percent"], 100.0 * 14.8 / 44.5);
}

TEST(Json, HoldsProjectionsAndCurves) {
  const auto page = Parsed(MadeUpResults());
  const auto& row = page["worlds"][0]["projections"][0];
  EXPECT_EQ(row["columns"], 512);
  ExpectNear(row["true_positive_percent"], 90.2);
  ExpectNear(row["points_kept"], 1563);
  ExpectNear(row["returns"], 5580);
  ExpectNear(row["nearest_mean_m"], 0.079);
  EXPECT_TRUE(row["nearest_sd_m"].is_null());
  EXPECT_EQ(page["curves"][0]["title"], "Test <1>");
  EXPECT_EQ(page["curves"][0]["lines"][0]["points"], (json{{1.0, 2.0}, {2.0, 3.25}}));
}

TEST(Json, AnotherWorldHasItsOwnFiguresOrIsNotHere) {
  auto results = MadeUpResults();
  auto other = MadeUpResults();
  other.world = "second world";
  other.methods[0].by_scene["dense"] = MadeUpScore(0.602, 1.0);
  results.other_worlds = {other, {}};
  results.other_worlds[1].is_here = false;
  results.methods[1].by_scene["dense"].num_not_scored = 1;
  const auto worlds = Parsed(results)["worlds"];
  ASSERT_EQ(worlds.size(), 3U);
  EXPECT_EQ(worlds[1]["name"], "second world");
  ExpectNear(worlds[1]["methods"][0]["mean"]["iou_percent"], 70.2);
  EXPECT_TRUE(worlds[1]["is_here"]);
  EXPECT_FALSE(worlds[2]["is_here"]);
  EXPECT_FALSE(worlds[0]["methods"][0]["is_partial"]);
  EXPECT_TRUE(worlds[0]["methods"][1]["is_partial"]);
}

TEST(Json, WhatIsNotANumberIsNull) {
  auto results = MadeUpResults();
  for (auto& method : results.methods) {
    for (auto& [scene, score] : method.by_scene) {
      score.iou.sum = std::numeric_limits<double>::quiet_NaN();
      score.time_ms = {std::numeric_limits<double>::infinity()};
    }
  }
  const auto ours = Parsed(results)["worlds"][0]["methods"][0];
  EXPECT_TRUE(ours["scenes"][0]["iou_percent"].is_null());
  EXPECT_TRUE(ours["total"]["time_ms"].is_null());
  EXPECT_TRUE(Parsed(Results{})["worlds"][0]["methods"].empty());
}

TEST(WorstScan, HoldsTheScoresOfItsObjectsByBearing) {
  const auto worst = WorstOf(MadeUpScan({2, 2, 1, 1, 1}, {0, 0, 1, 1, 2}));
  EXPECT_EQ(worst["scene"], "rain");
  EXPECT_EQ(worst["seed"], "7");
  EXPECT_EQ(worst["scan"], 3);
  ExpectNear(worst["iou_percent"], 12.5);
  ASSERT_EQ(worst["objects"].size(), 2U);
  EXPECT_EQ(worst["objects"][0]["name"], "shore") << "the one of the lesser bearing";
  EXPECT_EQ(worst["objects"][0]["num_returns"], 2);
  EXPECT_EQ(worst["objects"][0]["iou_percent"], 0.0);
  EXPECT_EQ(worst["objects"][1]["name"], "<Anna>");
  EXPECT_EQ(worst["objects"][1]["kind"], "kayak");
  EXPECT_EQ(worst["objects"][1]["num_returns"], 3);
  ExpectNear(worst["objects"][1]["iou_percent"], 200.0 / 3.0);
}

TEST(WorstScan, HoldsWhereTheReturnsAre) {
  const auto worst = WorstOf(MadeUpScan({1, 0, 0}, {4, 0, 0}));
  ASSERT_EQ(worst["returns"].size(), 1U);
  const auto& group = worst["returns"][0];
  EXPECT_EQ(group["object"], 1);
  EXPECT_EQ(group["segment"], 4);
  EXPECT_EQ(group["num_returns"], 1);
  const auto& run = group["runs"];  // 10 m ahead
  EXPECT_EQ(run[0], 0);
  ExpectNear(run[1].get<double>() * worst["unit_m"].get<double>(), 10.0);
  EXPECT_EQ(run[2], 1);
}

TEST(WorstScan, WhatIsNotScoredBelongsToNoObject) {
  const auto worst = WorstOf(MadeUpScan({1, 1, 2, 2}, {1, 1, kNotScored, kNotScored}));
  ASSERT_EQ(worst["objects"].size(), 1U);
  EXPECT_EQ(worst["objects"][0]["name"], "<Anna>");
  EXPECT_EQ(worst["returns"][0]["object"], 0);
  EXPECT_EQ(worst["returns"][0]["segment"], 0);
}

TEST(WorstScan, FullScanTakesAFewKilobytes) {
  // 16 rings and 1800 columns of a ragged shore all round, cut into 300 pieces.
  constexpr int kNumColumns = 1800;
  constexpr int kNumRings = 16;
  auto worst = MadeUpScan(std::vector<std::int32_t>(kNumColumns, 2), std::vector<std::int32_t>(kNumColumns, 1));
  auto& scan = worst.truth.scan;
  scan.head.rings.resize(kNumRings);
  scan.columns.range.clear();
  worst.truth.object.clear();
  worst.label.clear();
  for (int column = 0; column < kNumColumns; ++column) {
    scan.columns.azimuth_rad[static_cast<std::size_t>(column)] = static_cast<float>(column * 2.0 * std::numbers::pi / kNumColumns);
    for (int ring = 0; ring < kNumRings; ++ring) {
      scan.columns.range.push_back(static_cast<std::uint16_t>(20'000 + 200 * ring + 97 * column % 400));
      worst.truth.object.push_back(2);
      worst.label.push_back(1 + column / 6);
    }
  }
  scan.columns.reflectivity.assign(scan.columns.range.size(), 0);
  EXPECT_LT(WorstOf(worst).dump().size(), 80'000U) << "28 800 returns, more than any scan of a lake";
}

TEST(WorstScan, EmptyScanHasNoReturnsAndOneWhoseArraysDifferInSizeIsNotDrawn) {
  for (const auto& worst : {MadeUpScan({}, {}), MadeUpScan({0, 0}, {0, 0}), WorstScan{}}) EXPECT_EQ(WorstOf(worst)["returns"], json::array());
  auto worst = MadeUpScan({1, 1}, {1, 1});
  worst.label.pop_back();
  EXPECT_TRUE(WorstOf(worst)["returns"].is_null());
}

}  // namespace
}  // namespace lookout::eval
