// What is said of a segment beside its returns: land, sure or tentative, and why. With evidence of the test's own.
#include <cmath>
#include <gtest/gtest.h>
#include <string_view>
#include <vector>

#include "services/segmenter/core/segmenter.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

constexpr float kYes = 10.0F;
constexpr float kNo = -10.0F;

Evidence Always(std::size_t sum, float log_odds) {
  return {{kEvidenceLayouts[sum].name, kEvidenceLayouts[sum].features, log_odds, {}}, kEvidenceLayouts[sum]};
}

// A thing where this feature is above what it ever is.
Evidence LacksThat(std::string_view feature) {
  const std::vector<NamedTree> trees{{{{{feature, 1e6F}}}, {kNo, kYes}}};
  return {{"thing", kPieceFeatureNames, 0.0F, trees}, kEvidenceLayouts[kThingSum]};
}

Params With(const Evidence& land, const Evidence& thing) {
  Params params;
  params.lookout.evidence[kLandSum] = land;
  params.lookout.evidence[kThingSum] = thing;
  return params;
}

// A boat on its own, 20 m ahead.
Scan Boat() {
  auto scan = test::EmptyScan({});
  std::vector<test::Wall> walls;
  test::AddBoat(walls, 20.0, 0.0, 0.5, 6.0, 2.0, -1.0, 1.5);
  test::Look(scan, walls);
  return scan;
}

Segment TheOnlyOne(const Scan& scan, const Params& params) {
  const auto segments = SegmentScan(scan, params).segments;
  EXPECT_EQ(segments.size(), 1U);
  return segments.at(0);
}

TEST(Confidence, IsAThresholdOnTheProbabilityOfAThing) {
  auto params = With(Always(kLandSum, kNo), Always(kThingSum, std::log(3.0F)));
  params.lookout.sure_probability = 0.74;
  const auto sure = TheOnlyOne(Boat(), params);
  EXPECT_EQ(sure.confidence, Confidence::kSure);
  EXPECT_EQ(sure.grounds, 0);
  EXPECT_EQ(sure.kind, SegmentKind::kObstacle);
  params.lookout.sure_probability = 0.76;
  const auto tentative = TheOnlyOne(Boat(), params);
  EXPECT_EQ(tentative.confidence, Confidence::kTentative);
  EXPECT_NE(tentative.grounds, 0);
}

TEST(Confidence, LandIsAThresholdOnItsProbabilityAndSure) {
  auto params = With(Always(kLandSum, std::log(3.0F)), Always(kThingSum, kNo));
  params.lookout.land_probability = 0.74;
  const auto land = TheOnlyOne(Boat(), params);
  EXPECT_EQ(land.kind, SegmentKind::kLand);
  EXPECT_EQ(land.confidence, Confidence::kSure);
  EXPECT_EQ(land.grounds, 0);
  EXPECT_FALSE(land.waterline.empty());
  params.lookout.land_probability = 0.76;
  EXPECT_EQ(TheOnlyOne(Boat(), params).kind, SegmentKind::kObstacle);
}

TEST(Confidence, GroundsAreWhatIsMeasured) {
  const auto params = With(Always(kLandSum, kNo), Always(kThingSum, kNo));
  auto scan = test::EmptyScan({});
  test::SetReturn(scan, 100, 8, 20.0);
  EXPECT_EQ(TheOnlyOne(scan, params).grounds, kFewReturns);

  // The lidar is 1 m over the water: the lowest ring, 15 degrees down, meets it at 3.7 m.
  scan = test::EmptyScan({});
  for (int column = 100; column < 110; ++column) test::SetReturn(scan, column, 0, 3.6);
  EXPECT_EQ(TheOnlyOne(scan, params).grounds, kAtSurface);

  scan = test::EmptyScan({});
  for (int column = 100; column < 120; column += 3) test::SetReturn(scan, column, 8, 8.0);
  EXPECT_EQ(TheOnlyOne(scan, params).grounds, kScattered);

  scan = test::EmptyScan({});
  test::SetReturn(scan, 100, 0, 3.6);
  EXPECT_EQ(TheOnlyOne(scan, params).grounds, kFewReturns | kAtSurface);
}

TEST(Confidence, WhereNothingIsPlainGroundsAreWhatSpeaksMostAgainst) {
  const auto grounds = [](std::string_view feature) { return TheOnlyOne(Boat(), With(Always(kLandSum, kNo), LacksThat(feature))).grounds; };
  EXPECT_EQ(grounds("width_m"), kFewReturns);
  EXPECT_EQ(grounds("crowd"), kScattered);
  EXPECT_EQ(grounds("top_m"), kAtSurface);
}

}  // namespace
}  // namespace lookout::segmenter
