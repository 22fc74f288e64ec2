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

TEST(Confidence, LandIsAThresholdOnItsProbability) {
  auto params = With(Always(kLandSum, std::log(3.0F)), Always(kThingSum, -kNo));
  params.lookout.land_probability = 0.74;
  const auto land = TheOnlyOne(Boat(), params);
  EXPECT_EQ(land.kind, SegmentKind::kLand);
  EXPECT_EQ(land.confidence, Confidence::kSure);
  EXPECT_EQ(land.grounds, 0);
  EXPECT_FALSE(land.waterline.empty());
  params.lookout.land_probability = 0.76;
  EXPECT_EQ(TheOnlyOne(Boat(), params).kind, SegmentKind::kObstacle);
}

// A wide veil of spray has the extent of land.
TEST(Confidence, WhatIsLikelierClutterIsNoLand) {
  const auto spray = TheOnlyOne(Boat(), With(Always(kLandSum, -kNo), Always(kThingSum, kNo)));
  EXPECT_EQ(spray.kind, SegmentKind::kObstacle);
  EXPECT_EQ(spray.confidence, Confidence::kTentative);
  EXPECT_NE(spray.grounds, 0);
}

// Whatever the evidence says: in one scan a buoy's single return and a drop are alike.
TEST(Confidence, OneReturnIsNeverSureNorLand) {
  auto scan = test::EmptyScan({});
  test::SetReturn(scan, 100, 8, 20.0);
  const auto params = With(Always(kLandSum, -kNo), Always(kThingSum, -kNo));
  const auto one = TheOnlyOne(scan, params);
  EXPECT_GT(one.thing_probability, 0.99F);
  EXPECT_EQ(one.confidence, Confidence::kTentative);
  EXPECT_EQ(one.grounds & kFewReturns, kFewReturns);
  EXPECT_EQ(one.kind, SegmentKind::kObstacle);
  test::SetReturn(scan, 101, 8, 20.0);
  EXPECT_EQ(TheOnlyOne(scan, params).confidence, Confidence::kSure);
}

TEST(Confidence, ProbabilitiesAreThoseOfTheSums) {
  const auto boat = TheOnlyOne(Boat(), With(Always(kLandSum, -std::log(4.0F)), Always(kThingSum, std::log(3.0F))));
  EXPECT_NEAR(boat.land_probability, 0.2F, 1e-6F);
  EXPECT_NEAR(boat.thing_probability, 0.75F, 1e-6F);
  const auto certain = TheOnlyOne(Boat(), With(Always(kLandSum, -1e4F), Always(kThingSum, 1e4F)));
  EXPECT_EQ(certain.land_probability, 0.0F);
  EXPECT_EQ(certain.thing_probability, 1.0F);
}

// What is published decides, to its last bit: who reads SEGMENTS and applies the same threshold gets the same words.
TEST(Confidence, IsExactlyWhatThePublishedProbabilitiesSay) {
  for (const float land_log_odds : {-3.0F, -0.4F, 0.1F, 2.0F}) {
    for (const float thing_log_odds : {-2.0F, 0.3F, 1.9924F, 5.0F}) {
      auto params = With(Always(kLandSum, land_log_odds), Always(kThingSum, thing_log_odds));
      const auto published = TheOnlyOne(Boat(), params);
      const double thing = published.thing_probability;
      const double land = published.land_probability;
      for (const double sure_probability : {0.5, 0.88, thing, std::nextafter(thing, 0.0), std::nextafter(thing, 1.0)}) {
        for (const double land_probability : {0.5, land, std::nextafter(land, 0.0)}) {
          params.lookout.sure_probability = sure_probability;
          params.lookout.land_probability = land_probability;
          const auto segment = TheOnlyOne(Boat(), params);
          ASSERT_EQ(segment.kind == SegmentKind::kLand, thing > sure_probability && land > land_probability);
          ASSERT_EQ(segment.confidence == Confidence::kSure, thing > sure_probability) << thing << ' ' << sure_probability;
        }
      }
    }
  }
}

TEST(Confidence, ThePapersMethodStatesNoProbability) {
  Params params;
  params.method = Method::kPaper;
  const auto boat = TheOnlyOne(Boat(), params);
  EXPECT_TRUE(std::isnan(boat.thing_probability));
  EXPECT_TRUE(std::isnan(boat.land_probability));
  EXPECT_EQ(boat.confidence, Confidence::kSure);
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
