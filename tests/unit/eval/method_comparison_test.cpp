// From scenes to figures: truth joined to its cells, methods, curves and tables.
#include "lab/eval/methods/method_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "common/config/text_config.hpp"
#include "lab/eval/methods/against_peers.hpp"
#include "lab/eval/methods/methods.hpp"
#include "lab/eval/methods/paper_tests.hpp"
#include "lab/eval/methods/projection.hpp"
#include "lab/eval/methods/result_tables.hpp"
#include "lab/eval/methods/scoring.hpp"
#include "lab/eval/methods/sweep.hpp"
#include "tests/support/files.hpp"

namespace lookout::eval {
namespace {

const std::filesystem::path kRoot = support::kSources;
constexpr double kSeconds = 0.4;  // three whole scans

Boat Catabot() { return LoadBoat(kRoot / "config/catabot"); }

RunPlan SmallPlan(const std::string& scene) { return {{scene}, 1, 1, kSeconds}; }

std::vector<LabelledScan> Render(const std::string& scene) {
  std::vector<LabelledScan> turns;
  ForEachScan(SmallPlan(scene), Catabot(), nullptr, [&turns](const ScanPlace&, const LabelledScan& truth) { turns.push_back(truth); });
  return turns;
}

// Labels that are the truth.
class Oracle final : public Method {
 public:
  explicit Oracle(const std::vector<LabelledScan>& turns) : turns_(turns) {}
  std::string name() const override { return "oracle"; }
  Labelling Segment(const segmenter::Scan& scan) override {
    for (const auto& turn : turns_) {
      if (turn.scan.head.seq != scan.head.seq) continue;
      Labelling labelling{turn.object, {}, {}};
      for (auto& label : labelling.label) label = std::max(label, 0);
      return labelling;
    }
    return {};
  }

 private:
  const std::vector<LabelledScan>& turns_;
};

TEST(Render, GivesWholeTurnsInWhichObjectsLieTogether) {
  const auto turns = Render("sparse");
  ASSERT_GE(turns.size(), 2U);
  for (const auto& turn : turns) {
    ASSERT_EQ(turn.object.size(), turn.scan.num_cells());
    std::set<std::int32_t> seen;
    for (std::size_t cell = 0; cell < turn.object.size(); ++cell) {
      if (turn.scan.columns.range[cell] == 0) {
        EXPECT_EQ(turn.object[cell], kNoTrueObject);
      } else if (turn.object[cell] > 0) {
        EXPECT_TRUE(turn.objects.contains(turn.object[cell]));
        seen.insert(turn.object[cell]);
      }
    }
    EXPECT_FALSE(seen.empty());
    // Were the truth shifted by a cell, neighbours in a column would often be of different objects and hardly differ in range.
    const std::size_t num_rings = turn.scan.head.rings.size();
    int num_near = 0;
    int num_of_two = 0;
    for (std::size_t cell = 0; cell + 1 < turn.object.size(); ++cell) {
      if (turn.scan.head.num_returns != 1 || (cell + 1) % num_rings == 0) continue;
      const int range = turn.scan.columns.range[cell];
      const int next = turn.scan.columns.range[cell + 1];
      if (range == 0 || next == 0 || std::abs(range - next) > 50) continue;  // 0.1 m
      ++num_near;
      num_of_two += turn.object[cell] != turn.object[cell + 1] ? 1 : 0;
    }
    EXPECT_GT(num_near, 100);
    EXPECT_LT(num_of_two, num_near / 50);
  }
}

TEST(Render, IsTheSameEachTime) {
  const auto one = Render("sparse");
  const auto other = Render("sparse");
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].scan.columns.range, other[i].scan.columns.range);
    EXPECT_EQ(one[i].object, other[i].object);
  }
}

TEST(Render, JoinsBothReturnsOfDualMode) {
  const auto turns = Render("dual");
  ASSERT_FALSE(turns.empty());
  EXPECT_EQ(turns[0].scan.head.num_returns, 2);
}

TEST(MethodComparison, TruthAsLabelsScoresOneHundred) {
  const auto turns = Render("sparse");
  Methods methods;
  methods.push_back(std::make_unique<Oracle>(turns));
  MethodComparison comparison(methods);
  for (const auto& turn : turns) comparison.Add({"sparse", 1, 0}, turn);
  const auto& score = comparison.results()[0].by_scene.at("sparse");
  EXPECT_DOUBLE_EQ(score.iou.value(), 1.0);
  EXPECT_EQ(score.false_segments.sum, 0);
  EXPECT_EQ(comparison.results()[0].worst.size(), 1U) << "one of each scene";
}

TEST(MethodComparison, KeepsTheWorstTurnsOfDifferentScenesWorstFirst) {
  const auto boat = Catabot();
  const std::vector<std::string> names{"paper W=512"};
  const auto methods = MakeMethods(boat.segmenter, names);
  ASSERT_EQ(methods.size(), 1U);
  MethodComparison comparison(methods);
  const auto turns = Render("sparse");
  const auto easy = Render("motorboat_6m");
  for (std::size_t i = 0; i < turns.size(); ++i) comparison.Add({"sparse", 1, static_cast<int>(i)}, turns[i]);
  comparison.Add({"motorboat_6m", 1, 0}, easy.at(0));
  const auto& worst = comparison.results()[0].worst;
  ASSERT_EQ(worst.size(), 2U);
  EXPECT_LE(worst[0].iou, worst[1].iou);
  EXPECT_NE(worst[0].scene, worst[1].scene);
  EXPECT_EQ(worst[0].label.size(), worst[0].truth.object.size());
}

TEST(Methods, LabelsAreThoseOfTheSegmenter) {
  const auto boat = Catabot();
  const auto turn = Render("sparse").at(0);
  for (const auto& params : {boat.segmenter, PaperParams(boat.segmenter, 512)}) {
    const auto segments = segmenter::SegmentScan(turn.scan, params);
    const auto labelling = SegmenterMethod("", params).Segment(turn.scan);
    ASSERT_EQ(labelling.label.size(), segments.label.size());
    for (std::size_t i = 0; i < segments.label.size(); ++i) ASSERT_EQ(labelling.label[i], std::max<int>(segments.label[i], 0));
    ASSERT_EQ(labelling.stages.size(), params.method == segmenter::Method::kPaper ? 4U : 3U);  // ours has no search of its own
    EXPECT_EQ(labelling.stages[0].first, "project");
    ASSERT_EQ(labelling.probability.has_value(), params.method == segmenter::Method::kLookout);
    if (!labelling.probability) continue;
    ASSERT_EQ(labelling.probability->size(), segments.segments.size());
    double of_sure = 0.0;
    double of_tentative = 0.0;
    for (std::size_t i = 0; i < segments.segments.size(); ++i) {
      if (segments.segments[i].kind == segmenter::SegmentKind::kLand) continue;  // sure for being land
      auto& greatest = labelling.is_sure[i] ? of_sure : of_tentative;
      greatest = std::max(greatest, (*labelling.probability)[i]);
    }
    EXPECT_GT(of_sure, of_tentative);
  }
}

TEST(Methods, SayHowManyComponentsTheyCluster) {
  const auto boat = Catabot();
  const auto turn = Render("sparse").at(0);
  const auto count = [&](const segmenter::Params& params) { return SegmenterMethod("", params).Segment(turn.scan).num_components.value_or(-1); };
  auto params = PaperParams(boat.segmenter, 512);
  const auto with_search = count(params);
  const auto without_search = count(WithoutSearch(params));
  params.component_clustering = false;
  EXPECT_EQ(with_search, static_cast<std::int64_t>(segmenter::SegmentScan(turn.scan, params).segments.size()));
  EXPECT_EQ(without_search, static_cast<std::int64_t>(segmenter::SegmentScan(turn.scan, WithoutSearch(params)).segments.size()));
  EXPECT_LT(with_search, without_search);
  const std::vector<std::string> peer{"Euclidean 2 m"};
  EXPECT_FALSE(MakeMethods(boat.segmenter, peer).at(0)->Segment(turn.scan).num_components);
}

// The truth, of which it is sure where it must be; and a doubtful segment of the strays.
class Doubter final : public Method {
 public:
  explicit Doubter(const LabelledScan& turn) : turn_(turn) {}
  std::string name() const override { return "ours"; }
  bool knows_doubt() const override { return true; }
  Labelling Segment(const segmenter::Scan& scan) override {
    Labelling labelling;
    const auto num_objects = turn_.objects.rbegin()->first;
    for (std::size_t cell = 0; cell < turn_.object.size(); ++cell) {
      const bool is_stray = scan.columns.range[cell] != 0 && turn_.object[cell] == kNoTrueObject;
      labelling.label.push_back(is_stray ? num_objects + 1 : std::max(turn_.object[cell], 0));
    }
    for (std::int32_t id = 1; id <= num_objects; ++id)
      labelling.is_sure.push_back(!turn_.objects.contains(id) || turn_.objects.at(id).kind != "dock");
    labelling.is_sure.push_back(false);
    return labelling;
  }

 private:
  const LabelledScan& turn_;
};

TEST(MethodComparison, AMethodThatKnowsDoubtHasARowForEachOperatingPoint) {
  const auto turn = Render("sparse").at(0);
  Methods methods;
  methods.push_back(std::make_unique<Doubter>(turn));
  MethodComparison comparison(methods);
  comparison.Add({"sparse", 1, 0}, turn);
  Results results;
  results.scenes = {"sparse"};
  results.methods = comparison.results();
  std::map<std::string, std::string> csv;
  for (const auto& table : TablesOf(results)) {
    std::ostringstream out;
    table.table.PrintCsv(out);
    csv[table.name] = out.str();
  }
  // The docks are doubtful: with the sure ones alone they are lost, and with all the strays are a false segment.
  const std::string all = "ours (all segments)";
  const std::string sure = "ours (sure only)";
  EXPECT_EQ(csv.at("table_1").substr(0, 51), "method,mean,sparse\n" + all + ",100.0,100.0\n");
  EXPECT_EQ(csv.at("table_1").find(sure + ",100.0"), std::string::npos);
  EXPECT_EQ(csv.at("false_segments"), "method,mean,sparse\n" + all + ",1.00,1.00\n" + sure + ",0.00,0.00\n");
  EXPECT_EQ(csv.at("kinds").find(",0.0"), csv.at("kinds").find(",0.0", csv.at("kinds").find(sure))) << "docks, among the sure ones alone";
  EXPECT_NE(csv.at("kinds").find(",0.0"), std::string::npos);
  EXPECT_NE(csv.at("near_recall").find(sure), std::string::npos);
  for (const auto& [name, text] : csv)
    EXPECT_EQ(text.substr(0, text.find('\n')).find("sure"), std::string::npos) << name << ": a column of another row's kind";
}

TEST(Methods, WithoutSearchEveryReturnIsAComponent) {
  const auto boat = Catabot();
  auto params = WithoutSearch(PaperParams(boat.segmenter, 512));
  params.component_clustering = false;
  const auto turn = Render("sparse").at(0);
  for (const auto& segment : segmenter::SegmentScan(turn.scan, params).segments) ASSERT_EQ(segment.num_points, 1);
}

TEST(Methods, WhatIsOutsideOfTheFieldOfViewIsNotScored) {
  const auto boat = Catabot();
  const std::vector<std::string> names{"paper W=1800 at 90 deg"};
  const auto turn = Render("sparse").at(0);
  const auto labelling = MakeMethods(boat.segmenter, names).at(0)->Segment(turn.scan);
  const auto num_not_scored = std::ranges::count(labelling.label, kNotScored);
  EXPECT_GT(num_not_scored, 0);
}

TEST(Methods, AreChosenByNameAndByGroup) {
  const auto boat = Catabot();
  const auto count = [&](std::vector<std::string> names) { return MakeMethods(boat.segmenter, names).size(); };
  EXPECT_EQ(count({}), 0U);
  EXPECT_EQ(count({"paper W=512", "paper W=512"}), 1U);
  EXPECT_EQ(count({"ours"}) + count({"paper"}) + count({"peers"}), count({"all"}));
  EXPECT_EQ(count({"ours", "all"}), count({"all"}));
  EXPECT_THROW(count({"theirs"}), std::invalid_argument);
}

TEST(Sweep, ReadsRangesWithTheirEnd) {
  const auto sweep = ParseSweep("e1=0.6:0.95:0.05");
  EXPECT_EQ(sweep.field, "e1_cosine");
  ASSERT_EQ(sweep.values.size(), 8U);
  EXPECT_DOUBLE_EQ(sweep.values.front(), 0.6);
  EXPECT_NEAR(sweep.values.back(), 0.95, 1e-12);
  EXPECT_EQ(ParseSweep("image_columns=512:512:1").values.size(), 1U);
}

TEST(Sweep, RefusesWhatMakesNoSense) {
  for (const auto* text : {"e1", "e1=0.6", "e1=0.6:0.9", "e1=0.9:0.6:0.1", "e1=0.6:0.9:0", "e1=0.6:0.9:-1", "e1=a:0.9:0.1", "e1=0:1:0.0001",
                           "e9=0:1:1", "component_clustering=0:1:1", "image_columns=512:513:0.5", "e1=nan:1:1", "e1=0:inf:1"}) {
    EXPECT_THROW(ParseSweep(text), std::invalid_argument) << text;
  }
}

TEST(Sweep, SetsOneFieldAndChecksItsRange) {
  const auto boat = Catabot();
  const auto params = ParamsWith(boat, "e3_distance_m", 2.5);
  EXPECT_DOUBLE_EQ(params.clustering.e3_distance_m, 2.5);
  EXPECT_DOUBLE_EQ(params.clustering.e1_cosine, boat.segmenter.clustering.e1_cosine);
  EXPECT_EQ(ParamsWith(boat, "image_columns", 512.0).labelling.image_columns, 512);
  EXPECT_THROW(ParamsWith(boat, "e1_cosine", 1.5), config::ConfigError);
}

TEST(Sweep, GivesACurveForEachScene) {
  const auto curve = RunSweep(ParseSweep("bfs_distance_m=0.5:1.0:0.5"), SmallPlan("sparse"), Catabot(), nullptr);
  ASSERT_EQ(curve.lines.size(), 1U);
  EXPECT_EQ(curve.lines[0].name, "sparse");
  ASSERT_EQ(curve.lines[0].points.size(), 2U);
  for (const auto& [value, percent] : curve.lines[0].points) {
    EXPECT_GT(percent, 0.0);
    EXPECT_LE(percent, 100.0);
  }
}

TEST(PaperTests, OwnSegmentIsFromWhereItNeverFailsAgain) {
  EXPECT_EQ(OwnSegmentFromM({{1.0, 0.0}, {5.0, 0.9}, {3.0, 0.6}, {2.0, 0.2}, {4.0, 0.5}}), 3.0);
  EXPECT_EQ(OwnSegmentFromM({{1.0, 0.9}, {2.0, 0.2}}), std::nullopt);
  EXPECT_EQ(OwnSegmentFromM({{2.0, 0.2}, {3.1, 0.2}, {3.9, 0.9}, {7.5, 0.9}}), 3.0) << "a single turn is outvoted by the others of its metre";
  EXPECT_EQ(OwnSegmentFromM({{3.0, 0.9}, {40.0, 0.0}}), 3.0) << "far off it is lost for other reasons";
  EXPECT_EQ(OwnSegmentFromM({}), std::nullopt);
}

TEST(PaperTests, PartsAreThoseOfOneObjectAlone) {
  LabelledScan truth;
  Labelling labelling;
  const auto add = [&](int count, std::int32_t object, std::int32_t label) {
    for (int i = 0; i < count; ++i) {
      truth.scan.columns.range.push_back(1000);
      truth.object.push_back(object);
      labelling.label.push_back(label);
    }
  };
  add(16, 7, 1);
  add(2, 7, 2);
  add(1, 7, 3);
  add(1, 7, 0);
  add(9, 7, kNotScored);
  add(30, 8, 4);
  add(30, kNoTrueObject, 5);
  const auto objects = MatchScan(truth, labelling.label).objects;
  const auto& parts = objects.at(7);
  EXPECT_EQ(parts.num_segments, 3);
  EXPECT_EQ(parts.num_parts, 2) << "2 of 20 are a tenth";
  EXPECT_EQ(parts.num_in_largest, 16);
  EXPECT_EQ(parts.num_returns, 20);
  EXPECT_FALSE(objects.contains(9));
}

TEST(PaperTests, ABoatIsMoreClustersTheLessE3Joins) {
  const auto curve = RunPaperTest(3, SmallPlan(""), Catabot(), nullptr);
  ASSERT_EQ(curve.lines.size(), 2U);
  EXPECT_GE(curve.lines[0].points.back().second, curve.lines[1].points.back().second) << "all, and those with a tenth of it";
  EXPECT_DOUBLE_EQ(curve.lines[1].points.back().second, 1.0);
  const auto& points = curve.lines[0].points;
  ASSERT_GE(points.size(), 2U);
  EXPECT_GE(points.front().second, points.back().second);
  EXPECT_GE(points.back().second, 1.0);
}

TEST(PaperTests, AShoreIsOneObjectAtTheThresholdInPrintButForCrumbs) {
  const auto curve = RunPaperTest(2, SmallPlan(""), Catabot(), nullptr);
  ASSERT_EQ(curve.lines.size(), 2U);
  const auto at = std::ranges::find(curve.lines[1].points, 50.0, &std::pair<double, double>::first);
  ASSERT_NE(at, curve.lines[1].points.end());
  EXPECT_LT(at->second, 1.5);
  // Of a scene with a dock, a boat and glints as well, the least threshold leaves one.
  EXPECT_DOUBLE_EQ(curve.lines[0].points.front().second, 1.0);
  EXPECT_GT(curve.lines[0].points.back().second, 5.0);
}

TEST(Projection, WiderImagesKeepMoreAndMoveLess) {
  ProjectionTable table(Catabot().segmenter);
  for (const auto& turn : Render("sparse")) table.Add(turn);
  const auto rows = table.Rows();
  ASSERT_EQ(rows.size(), 3U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_LE(rows[i].num_ground_points, rows[i].num_points);
    EXPECT_GE(rows[i].nearest_mean_m, 0.0);
    EXPECT_LE(rows[i].true_positive_ratio, 1.0);
    if (i > 0) {
      EXPECT_GT(rows[i].num_ground_points, rows[i - 1].num_ground_points);
      EXPECT_LT(rows[i].nearest_mean_m, rows[i - 1].nearest_mean_m);
    }
  }
}

TEST(ResultTables, AnotherWorldStandsBesideOurs) {
  const auto results_of = [](const std::string& scene, double iou) {
    Results results;
    results.scenes = {scene};
    Score score;
    score.iou = {1, iou};
    score.near_recall_by_kind["buoy"] = {1, 1};
    results.methods = {{"ours (all segments)", {{scene, score}}, {}, {}}, {"F3D (tuned)", {{scene, score}}, {}, {}}};
    return results;
  };
  auto results = results_of("dense", 0.5);
  results.other_worlds = {results_of("islands", 0.25)};
  results.other_worlds[0].world = "second world";
  const auto csv = [&results](const std::string& name) {
    const auto tables = TablesOf(results);
    std::ostringstream out;
    std::ranges::find(tables, name, &NamedTable::name)->table.PrintCsv(out);
    return out.str();
  };
  EXPECT_EQ(csv("table_1"),
            "method,mean,dense,second world: mean,second world: islands\n"
            "ours (all segments),50.0,50.0,25.0,25.0\nF3D (tuned),50.0,50.0,25.0,25.0\n");
  EXPECT_NE(csv("near_recall").find("F3D (tuned),second world: islands,buoy,1,100.0\n"), std::string::npos) << csv("near_recall");
  EXPECT_NE(csv("against_peers").find("second world: mean,25.0"), std::string::npos);
  results.other_worlds[0] = {};
  results.other_worlds[0].world = "second world";
  results.other_worlds[0].is_here = false;
  EXPECT_EQ(csv("table_1"), "method,mean,dense,second world\nours (all segments),50.0,50.0,not here\nF3D (tuned),50.0,50.0,not here\n");
}

void CheckSeeds(SeedUse use, std::uint64_t first_seed, int num_seeds) { RunPlan{{}, first_seed, num_seeds}.CheckSeeds(use); }

TEST(Seeds, OfTuningAndOfTablesAreKeptApart) {
  EXPECT_NO_THROW(CheckSeeds(SeedUse::kTables, kFirstTableSeed, 1000));
  EXPECT_NO_THROW(CheckSeeds(SeedUse::kTuning, kFirstTuningSeed, 100));
  EXPECT_THROW(CheckSeeds(SeedUse::kTables, 1, 20), std::invalid_argument);
  EXPECT_THROW(CheckSeeds(SeedUse::kTables, 100, 2), std::invalid_argument) << "a mixture";
  EXPECT_THROW(CheckSeeds(SeedUse::kTuning, 101, 1), std::invalid_argument);
  EXPECT_THROW(CheckSeeds(SeedUse::kTuning, 100, 2), std::invalid_argument) << "a mixture";
  EXPECT_THROW(CheckSeeds(SeedUse::kTuning, 0, 1), std::invalid_argument);
}

TEST(Seeds, BeyondTheGreatestNumberAreRefused) {
  constexpr auto kGreatest = std::numeric_limits<std::uint64_t>::max();
  EXPECT_NO_THROW(CheckSeeds(SeedUse::kTables, kGreatest, 1));
  EXPECT_THROW(CheckSeeds(SeedUse::kTables, kGreatest, 3), std::invalid_argument) << "they would go on with 0 and 1";
  EXPECT_THROW(CheckSeeds(SeedUse::kTuning, kGreatest, 3), std::invalid_argument);
}

// Only the first seed was: a later one ended a run of an hour.
TEST(Seeds, AreAllCheckedBeforeTheFirstIsRendered) {
  const support::TempDir folder;
  const auto scene = folder / "ends.txtpb";
  support::WriteFile(scene, "description: \"ends\"\nown_boat {}\nobject { kind: BUOY name: \"in_the_way\" chance: 0.2 }\n");
  RunPlan plan = SmallPlan(scene.string());
  while (plan.first_seed < 100) {
    try {
      ForEachScan(plan, Catabot(), nullptr, [](const ScanPlace&, const LabelledScan&) {});
      break;
    } catch (const config::ConfigError&) {
      ++plan.first_seed;
    }
  }
  plan.num_seeds = 50;
  int num_scans = 0;
  EXPECT_THROW(ForEachScan(plan, Catabot(), nullptr, [&num_scans](const ScanPlace&, const LabelledScan&) { ++num_scans; }), config::ConfigError);
  EXPECT_EQ(num_scans, 0) << "from seed " << plan.first_seed << " on, which is right";
}

TEST(ResultTables, EmptyResultsGiveNoTable) { EXPECT_TRUE(TablesOf(Results{}).empty()); }

TEST(ResultTables, OursIsHeldAgainstTheBestPeers) {
  Results results;
  results.scenes = {"a", "b", "c"};
  const auto add = [&](const std::string& name, std::vector<double> iou) {
    MethodResult method;
    method.method = name;
    for (std::size_t i = 0; i < iou.size(); ++i) {
      method.by_scene[results.scenes[i]].iou = {1, iou[i]};
    }
    results.methods.push_back(method);
  };
  add("paper W=512", {0.99, 0.99, 0.99});
  add("ours", {0.9, 0.6, 0.7});
  EXPECT_TRUE(CompareWithPeers(results).empty()) << "no peers";
  add("Euclidean 2 m", {0.95, 0.3, 1.0});
  add("Euclidean 3 m (tuned)", {0.8, 0.5, 0.4});
  add("F3D (tuned)", {0.8, 0.2, 0.9});
  const auto rows = CompareWithPeers(results);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[0].tuned->name, "Euclidean 3 m (tuned)") << "of equals the first";
  EXPECT_NEAR(rows[0].tuned->error_share, 0.1 / 0.2, 1e-12);
  EXPECT_NEAR(rows[1].tuned->error_share, 0.4 / 0.5, 1e-12);
  EXPECT_EQ(rows[2].tuned->name, "F3D (tuned)");
  EXPECT_NEAR(rows[2].tuned->error_share, 0.3 / 0.1, 1e-12);
  EXPECT_EQ(rows[3].scene, "mean");
  EXPECT_EQ(rows[3].tuned->name, "F3D (tuned)");
  EXPECT_NEAR(rows[3].tuned->error_share, (0.8 / 3.0) / (1.1 / 3.0), 1e-12);
  EXPECT_EQ(rows[0].of_all.name, "Euclidean 2 m");
  EXPECT_TRUE(std::isnan(rows[2].of_all.error_share)) << "that peer makes no error";
}

TEST(ResultTables, SceneWithoutObjectsHasADash) {
  Results results;
  results.scenes = {"a", "b"};
  MethodResult method;
  method.method = "m";
  method.by_scene["a"].iou = {4, 3.0};
  method.by_scene["b"].false_segments = {4, 2.0};
  results.methods.push_back(method);
  std::ostringstream out;
  TablesOf(results).at(0).table.PrintCsv(out);
  EXPECT_EQ(out.str(), "method,mean,a,b\nm,75.0,75.0,-\n") << "the mean is over scenes with objects";
}

}  // namespace
}  // namespace lookout::eval
