#include "lab/fit/fit_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/core/angles.hpp"
#include "services/segmenter/evidence_text.hpp"

namespace lookout::fit {
namespace {

constexpr int kColumns = 1800;
constexpr int kRings = 16;
constexpr double kUnitM = 0.002;
constexpr std::int32_t kWall = 1;
constexpr std::int32_t kBoat = 2;
constexpr std::int32_t kMoored = 3;

// A wall round half of the circle 20 m away, a boat moored at it, and before it one in three pieces, the third 2 m from the second; a drop of spray
// here and there. All of it moves with `step`.
TrainingScan MakeScan(const std::string& family, int step) {
  TrainingScan scan{family, {}};
  auto& truth = scan.truth;
  truth.objects = {{kWall, {"wall", "wall", false}}, {kBoat, {"boat", "motor_boat", true}}, {kMoored, {"moored", "motor_boat", true}}};
  auto& head = truth.scan.head;
  head.range_unit_m = kUnitM;
  for (int ring = 0; ring < kRings; ++ring) head.rings.push_back({static_cast<float>(DegToRad(2.0 * ring - 15.0)), 0.0F, 0, 0.0F});
  head.num_turn_columns = kColumns;
  truth.scan.parts = {{0, kColumns}};
  auto& columns = truth.scan.columns;
  for (int column = 0; column < kColumns; ++column) {
    columns.azimuth_rad.push_back(static_cast<float>(kTwoPi * column / kColumns));
    columns.time_ns.push_back(column * 55'296);
    for (int ring = 0; ring < kRings; ++ring) {
      const int off = column - 10 * step;
      const bool is_low = ring >= 6 && ring <= 8;
      const bool is_boat = is_low && ((off >= 300 && off < 330) || (off >= 345 && off < 370) || (off >= 440 && off < 460));
      const bool is_moored = is_low && off >= 600 && off < 640;
      const bool is_wall = ring >= 6 && column < 900;
      const bool is_spray = column > 1000 && (column * 7 + ring * 131 + step * 17) % 997 == 0;
      const double range_m = is_boat ? 8.0 + 0.2 * step : is_moored ? 19.2 : is_wall ? 20.0 : is_spray ? 3.0 + column % 5 : 0.0;
      columns.range.push_back(static_cast<std::uint16_t>(std::lround(range_m / kUnitM)));
      columns.reflectivity.push_back(30);
      truth.object.push_back(is_boat ? kBoat : is_moored ? kMoored : is_wall ? kWall : data::kNoTrueObject);
    }
  }
  return scan;
}

std::vector<TrainingScan> MakeScans() {
  std::vector<TrainingScan> scans;
  for (int step = 0; step < 8; ++step) scans.push_back(MakeScan(step % 2 == 0 ? "course" : "canal", step));
  return scans;
}

FittedEvidence FitAll(const std::set<std::string>& without = {}) {
  return FitEvidence(MakeScans(), {}, {.num_trees = 10, .l2 = 1.0}, without, [](const std::string&) {});
}

TEST(TrainingRows, PairsOfOneObjectAreTrueAndPairsOfClutterAreNone) {
  Rows rows;
  RowMaker({}).Add(0, MakeScan("course", 0), rows);
  ASSERT_GT(rows.size(), 0U);
  EXPECT_EQ(rows.features.size(), segmenter::kNumPairFeatures);
  EXPECT_EQ(rows.families, std::vector<std::string>{"course"});
  EXPECT_EQ(std::ranges::count(rows.is_true, 1), 1) << "two pieces of the boat; the third is beyond the first reach";
  EXPECT_EQ(std::ranges::count(rows.is_true, 0), 1) << "the boat at the wall";
}

TEST(TrainingRows, GroupsAreThingsOrLandByTheirObject) {
  Rows things;
  Rows land;
  const auto scan = MakeScan("course", 0);
  RowMaker({}).Add(segmenter::kThingSum, scan, things);
  RowMaker({}).Add(segmenter::kLandSum, scan, land);
  EXPECT_EQ(std::ranges::count(land.is_true, 1), 1);
  EXPECT_EQ(std::ssize(land.is_true), std::ranges::count(things.is_true, 1)) << "clutter is neither land nor not";
  const auto wall = std::ranges::find(land.is_true, 1) - land.is_true.begin();
  EXPECT_EQ(std::ranges::max_element(land.weight) - land.weight.begin(), wall) << "what has most returns counts most";
  EXPECT_GT(std::ranges::count(things.is_true, 1), 1);
  EXPECT_GT(std::ranges::count(things.is_true, 0), 5);
}

TEST(TrainingRows, APairWeighsWhatItsObjectsLoseByAWrongAnswer) {
  const PieceTruth boat{kBoat, 10, 10};
  const PieceTruth quay{kWall, 1000, 2000};
  const PieceTruth stone{kWall, 100, 2000};
  const PieceTruth drop{data::kNoTrueObject, 2, 2};
  EXPECT_FLOAT_EQ(PairWeight(stone, quay), 0.05F) << "the quay loses a twentieth";
  EXPECT_FLOAT_EQ(PairWeight(boat, quay), 1.0F) << "all of the boat";
  EXPECT_FLOAT_EQ(PairWeight(quay, boat), 1.0F);
  EXPECT_FLOAT_EQ(PairWeight({kBoat, 10, 100}, stone), 0.1F + 10.0F / 2010.0F) << "a tenth of the boat; and the quay is diluted";
  EXPECT_FLOAT_EQ(PairWeight(drop, boat), 2.0F / 12.0F) << "the boat is diluted";
  EXPECT_FLOAT_EQ(PairWeight({kBoat, 1, 1}, drop), 0.5F);
  EXPECT_FLOAT_EQ(PairWeight({kWall, 1, 2000}, quay), kLeastWeight);
}

TEST(FitEvidence, TellsWhatItWasFittedOn) {
  const auto evidence = FitAll();
  for (const auto& report : evidence.sums) {
    EXPECT_LT(report.of_all.loss, 0.2) << segmenter::kEvidenceLayouts.at(report.sum).name;
    EXPECT_EQ(report.families, (std::vector<std::string>{"course", "canal"}));
  }
  EXPECT_GT(evidence.miou.at("course"), 0.99);
}

TEST(FitEvidence, DoesNotLookAtWhatIsLeftOut) {
  const auto evidence = FitAll({"canal"});
  EXPECT_EQ(evidence.sums.front().families, std::vector<std::string>{"course"});
  EXPECT_TRUE(evidence.miou.contains("canal"));
}

// There is no other family to calibrate on: the share of things must not count twice.
TEST(FitEvidence, OfOneFamilyHasTheLogOddsOfItsRows) {
  const auto evidence = FitAll({"canal"});
  const auto& thing = evidence.sums[segmenter::kThingSum];
  const double share = thing.of_all.true_share;
  EXPECT_NEAR(thing.fitted.bias, std::log(share / (1.0 - share)), 0.01);
}

// The same scans twice: the same text. And the text is read as what was fitted.
TEST(FitEvidence, ItsTextIsTheSameEachTimeAndReadsBackAsItWas) {
  const auto evidence = FitAll();
  const auto text = TextOf(evidence, {"Written by a test."});
  EXPECT_EQ(text, TextOf(FitAll(), {"Written by a test."}));
  const auto file = std::filesystem::path(::testing::TempDir()) / "fitted.txtpb";
  std::ofstream(file) << text;
  const auto params = evidence.In({}).lookout;
  EXPECT_EQ(segmenter::LoadEvidence(file, segmenter::kEvidenceLayouts), std::vector(params.evidence.begin(), params.evidence.end()));
}

}  // namespace
}  // namespace lookout::fit
