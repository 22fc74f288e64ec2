// From scenes to figures: truth joined to its cells, methods, curves and tables.
#include "tools/eval/judge.hpp"

#include <gtest/gtest.h>
#include <numeric>
#include <set>
#include <sstream>

#include "common/config/text_config.hpp"
#include "tools/eval/methods.hpp"
#include "tools/eval/paper_tests.hpp"
#include "tools/eval/projection.hpp"
#include "tools/eval/result_tables.hpp"
#include "tools/eval/sweep.hpp"

namespace lookout::eval {
namespace {

const std::filesystem::path kRoot = LOOKOUT_SOURCE_DIR;
constexpr double kSeconds = 0.4;  // three whole turns

Boat Catabot() { return LoadBoat(kRoot / "config/catabot"); }

RunPlan SmallPlan(const std::string& scene) { return {{scene}, 1, 1, kSeconds}; }

std::vector<LabelledScan> Render(const std::string& scene) {
  std::vector<LabelledScan> turns;
  Progress silent(nullptr, 1);
  ForEachTurn(SmallPlan(scene), Catabot(), silent, [&turns](const TurnPlace&, const LabelledScan& truth) { turns.push_back(truth); });
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

TEST(Judge, TruthAsLabelsScoresOneHundred) {
  const auto turns = Render("sparse");
  Methods methods;
  methods.push_back(std::make_unique<Oracle>(turns));
  Judge judge(methods);
  for (const auto& turn : turns) judge.Add({"sparse", 1, 0}, turn);
  const auto& score = judge.results()[0].by_scene.at("sparse");
  EXPECT_DOUBLE_EQ(MeanIou(score), 1.0);
  EXPECT_EQ(score.num_false_segments, 0);
  EXPECT_EQ(judge.results()[0].worst.size(), 1U) << "one of each scene";
}

TEST(Judge, KeepsTheWorstTurnsOfDifferentScenesWorstFirst) {
  const auto boat = Catabot();
  const std::vector<std::string> names{"paper W=512"};
  const auto methods = MakeMethods(boat.segmenter, names);
  ASSERT_EQ(methods.size(), 1U);
  Judge judge(methods);
  const auto turns = Render("sparse");
  const auto easy = Render("motorboat_6m");
  for (std::size_t i = 0; i < turns.size(); ++i) judge.Add({"sparse", 1, static_cast<int>(i)}, turns[i]);
  judge.Add({"motorboat_6m", 1, 0}, easy.at(0));
  const auto& worst = judge.results()[0].worst;
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
    ASSERT_EQ(labelling.stages.size(), 4U);
    EXPECT_EQ(labelling.stages[0].first, "project");
  }
}

TEST(Methods, WithoutSearchEveryReturnIsAComponent) {
  const auto boat = Catabot();
  auto params = WithoutSearch(PaperParams(boat.segmenter, 512));
  params.component_clustering = false;
  const auto turn = Render("sparse").at(0);
  for (const auto& segment : segmenter::SegmentScan(turn.scan, params).segments) ASSERT_EQ(segment.num_points, 1);
}

TEST(Methods, WhatIsOutsideOfTheFieldOfViewIsNotJudged) {
  const auto boat = Catabot();
  const std::vector<std::string> names{"paper W=1800 at 90 deg"};
  const auto turn = Render("sparse").at(0);
  const auto labelling = MakeMethods(boat.segmenter, names).at(0)->Segment(turn.scan);
  const auto num_not_judged = std::ranges::count(labelling.label, kNotJudged);
  EXPECT_GT(num_not_judged, 0);
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

TEST(PaperTests, ABoatIsMoreClustersTheLessE3Joins) {
  const auto curve = RunPaperTest(3, SmallPlan(""), Catabot(), nullptr);
  ASSERT_EQ(curve.lines.size(), 1U);
  const auto& points = curve.lines[0].points;
  ASSERT_GE(points.size(), 2U);
  EXPECT_GE(points.front().second, points.back().second);
  EXPECT_GE(points.back().second, 1.0);
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

TEST(ResultTables, EmptyResultsGiveNoTable) { EXPECT_TRUE(TablesOf(Results{}).empty()); }

TEST(ResultTables, SceneWithoutObjectsHasADash) {
  Results results;
  results.scenes = {"a", "b"};
  MethodResult method;
  method.method = "m";
  Score with_object;
  with_object.num_turns = with_object.num_turns_with_object = 4;
  with_object.sum_iou = 3.0;
  Score without;
  without.num_turns = 4;
  without.num_false_segments = 2;
  method.by_scene = {{"a", with_object}, {"b", without}};
  results.methods.push_back(method);
  std::ostringstream out;
  TablesOf(results).at(0).table.PrintCsv(out);
  EXPECT_EQ(out.str(), "method,mean,a,b\nm,75.0,75.0,-\n") << "the mean is over scenes with objects";
}

}  // namespace
}  // namespace lookout::eval
