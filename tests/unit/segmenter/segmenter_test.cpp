// The whole method on small scenes, and what the paper says of such scenes.
#include "services/segmenter/core/segmenter.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <set>

#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

// Ids of the segments with a return within `radius_m` of a place.
std::set<int> SegmentsAt(const Scan& scan, const Segments& segments, double x_m, double y_m, double radius_m) {
  std::set<int> ids;
  for (const auto& one : ClassifyReturns(scan, {}).returns) {
    if (std::hypot(one.point.x_m - x_m, one.point.y_m - y_m) <= radius_m) ids.insert(segments.label[static_cast<std::size_t>(one.cell)]);
  }
  return ids;
}

Scan See(const std::vector<test::Wall>& walls) {
  auto scan = test::EmptyScan({});
  test::Look(scan, walls, 0.02);
  return scan;
}

Params AsThePaper() {
  Params params;
  params.method = Method::kPaper;
  return params;
}

// Ours, and every way of projecting of the paper's.
std::vector<Params> AllWays() {
  std::vector<Params> ways(1);
  for (const int columns : {0, 512, 1024, 1800}) {
    ways.push_back(AsThePaper());
    ways.back().labelling.image_columns = columns;
  }
  return ways;
}

TEST(SegmentScan, OfAnEmptyScanHasZeroLabels) {
  for (const auto& params : AllWays()) {
    const auto segments = SegmentScan(test::EmptyScan({}), params);
    EXPECT_TRUE(segments.segments.empty());
    EXPECT_EQ(segments.label, std::vector<std::int16_t>(28928, 0));
    EXPECT_TRUE(SegmentScan(test::EmptyScan({.num_columns = 0}), params).label.empty());
  }
}

TEST(SegmentScan, OfOneReturnIsOneSegment) {
  auto scan = test::EmptyScan({});
  test::SetReturn(scan, 1000, 8, 25.0);
  for (const auto& params : AllWays()) {
    const auto segments = SegmentScan(scan, params);
    ASSERT_EQ(segments.segments.size(), 1U);
    EXPECT_EQ(segments.segments[0].num_points, 1);
    EXPECT_EQ(segments.label[test::CellOf(scan, 1000, 8)], 1);
    EXPECT_EQ(std::ranges::count(segments.label, 0), 28927);
  }
}

TEST(SegmentScan, OfAFullScanLabelsEveryReturn) {
  auto scan = test::EmptyScan({});
  for (int column = 0; column < 1808; ++column) {
    for (int ring = 0; ring < 16; ++ring) test::SetReturn(scan, column, ring, 20.0);
  }
  for (const auto& params : AllWays()) {
    const auto segments = SegmentScan(scan, params);
    EXPECT_EQ(segments.segments.size(), 1U);
    EXPECT_EQ(segments.label, std::vector<std::int16_t>(28928, 1));
  }
}

TEST(SegmentScan, NumbersSegmentsInTheOrderOfTheirFirstCell) {
  auto scan = test::EmptyScan({});
  for (const int column : {300, 100, 200, 101}) test::SetReturn(scan, column, 4, 10.0);
  const auto segments = SegmentScan(scan, AsThePaper());
  ASSERT_EQ(segments.segments.size(), 3U);
  EXPECT_EQ(segments.label[test::CellOf(scan, 100, 4)], 1);
  EXPECT_EQ(segments.label[test::CellOf(scan, 101, 4)], 1);
  EXPECT_EQ(segments.label[test::CellOf(scan, 200, 4)], 2);
  EXPECT_EQ(segments.label[test::CellOf(scan, 300, 4)], 3);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(segments.segments[static_cast<std::size_t>(i)].id, i + 1);
}

TEST(SegmentScan, DropsSmallSegmentsWithAReason) {
  auto scan = test::EmptyScan({});
  test::SetReturn(scan, 100, 4, 10.0);
  test::SetReturn(scan, 500, 4, 10.0);
  test::SetReturn(scan, 501, 4, 10.0);
  Params params = AsThePaper();
  params.min_segment_points = 2;
  const auto segments = SegmentScan(scan, params);
  EXPECT_EQ(segments.segments.size(), 1U);
  EXPECT_EQ(segments.num_too_small, 1);
  EXPECT_EQ(segments.label[test::CellOf(scan, 100, 4)], ToLabel(Reason::kTooSmall));
  EXPECT_EQ(segments.label[test::CellOf(scan, 500, 4)], 1);
}

TEST(SegmentScan, SaysWhichReturnsAreShadowedInTheMethodOfThePaper) {
  auto scan = test::EmptyScan({.num_columns = 2048});  // four to a pixel of 512
  for (int column = 0; column < 4; ++column) test::SetReturn(scan, column, 4, 10.0 + column);
  Params params = AsThePaper();
  params.labelling.image_columns = 512;
  params.labelling.label_shadowed_returns = false;
  const auto segments = SegmentScan(scan, params);
  EXPECT_EQ(segments.label[test::CellOf(scan, 0, 4)], 1);
  for (int column = 1; column < 4; ++column) EXPECT_EQ(segments.label[test::CellOf(scan, column, 4)], ToLabel(Reason::kShadowed));
  EXPECT_EQ(segments.segments[0].num_points, 1);
}

TEST(SegmentScan, JoinsAnObjectAcrossTheSeam) {
  std::vector<test::Wall> walls;
  test::AddBoat(walls, 12.0, 0.0, 1.0, 4.0, 2.0, -1.0, 1.0);
  for (const auto& params : AllWays()) EXPECT_EQ(SegmentScan(See(walls), params).segments.size(), 1U);
}

// Each piece is of one segment, and has a number where a cell is in a segment, else 0.
void ExpectGoodPieces(const Segments& segments) {
  ASSERT_EQ(segments.piece.size(), segments.label.size());
  std::map<int, int> segment_of;
  for (std::size_t cell = 0; cell < segments.label.size(); ++cell) {
    ASSERT_EQ(segments.piece[cell] > 0, segments.label[cell] > 0);
    ASSERT_GE(segments.piece[cell], 0);
    if (segments.piece[cell] == 0) continue;
    ASSERT_EQ(segment_of.try_emplace(segments.piece[cell], segments.label[cell]).first->second, segments.label[cell]);
  }
}

int NumPieces(const Segments& segments) {
  std::set<int> pieces(segments.piece.begin(), segments.piece.end());
  pieces.erase(0);
  return static_cast<int>(pieces.size());
}

TEST(SegmentScan, NumbersThePiecesThatASegmentIsMadeOf) {
  std::vector<test::Wall> walls;
  test::AddBoat(walls, 12.0, 0.0, 1.0, 4.0, 2.0, -1.0, 1.0);
  test::AddBoat(walls, -20.0, 5.0, 0.3, 6.0, 2.0, -1.0, 1.0);
  auto scan = See(walls);
  for (int column = 600; column < 640; ++column)
    test::SetReturn(scan, column, 4, column < 620 ? 15.0 : 15.6);  // closer than 0.8 m, farther than a link
  for (const auto& params : AllWays()) {
    const auto segments = SegmentScan(scan, params);
    ExpectGoodPieces(segments);
    EXPECT_GE(NumPieces(segments), static_cast<int>(segments.segments.size()));
  }
  const auto ours = SegmentScan(scan, {});
  EXPECT_NE(ours.piece[test::CellOf(scan, 600, 4)], ours.piece[test::CellOf(scan, 639, 4)]);
  EXPECT_EQ(ours.piece[test::CellOf(scan, 600, 4)], ours.piece[test::CellOf(scan, 619, 4)]);
  EXPECT_EQ(ours.label[test::CellOf(scan, 600, 4)], ours.label[test::CellOf(scan, 639, 4)]);
}

// The paper's components are its pieces: without clustering each segment is one.
TEST(SegmentScan, HasThePapersComponentsAsPieces) {
  auto scan = test::EmptyScan({});
  for (const int column : {100, 101, 103, 500}) test::SetReturn(scan, column, 4, 10.0);
  auto params = AsThePaper();
  const auto clustered = SegmentScan(scan, params);
  ExpectGoodPieces(clustered);
  EXPECT_EQ(clustered.segments.size(), 2U);
  EXPECT_EQ(NumPieces(clustered), 3);
  EXPECT_EQ(clustered.label[test::CellOf(scan, 100, 4)], clustered.label[test::CellOf(scan, 103, 4)]);
  EXPECT_NE(clustered.piece[test::CellOf(scan, 100, 4)], clustered.piece[test::CellOf(scan, 103, 4)]);
  params.component_clustering = false;
  const auto components = SegmentScan(scan, params);
  EXPECT_EQ(components.piece, components.label);
}

// 16 bits number no more pieces than segments; alone in its column and two rings from the next, each return is a component.
TEST(SegmentScan, HasNoPieceNumberBeyondSixteenBits) {
  auto scan = test::EmptyScan({.num_columns = 8192});
  for (int column = 0; column < 8192; ++column) {
    for (int ring = column % 2; ring < 16; ring += 3) test::SetReturn(scan, column, ring, 5.0 + 7.0 * ((column + ring) % 12));
  }
  auto params = AsThePaper();
  params.component_clustering = false;
  const auto segments = SegmentScan(scan, params);
  ExpectGoodPieces(segments);
  EXPECT_GT(segments.num_over_limit, 0);
  EXPECT_EQ(NumPieces(segments), 32'767);
  ExpectGoodPieces(SegmentScan(scan, {}));
}

TEST(SegmentScan, LabelsBothReturnsOfAShot) {
  auto scan = test::EmptyScan({.num_returns = 2});
  for (int column = 100; column < 110; ++column) {
    test::SetReturn(scan, column, 5, 10.0, 0);
    test::SetReturn(scan, column, 5, 30.0, 1);
  }
  for (const auto& params : AllWays()) {
    const auto segments = SegmentScan(scan, params);
    ASSERT_EQ(segments.segments.size(), 2U);
    for (int column = 100; column < 110; ++column) {
      EXPECT_EQ(segments.label[test::CellOf(scan, column, 5, 0)], 1);
      EXPECT_EQ(segments.label[test::CellOf(scan, column, 5, 1)], 2);
    }
  }
}

TEST(SegmentScan, GivesARepeatTheLabelOrReasonOfItsTwin) {
  auto scan = test::EmptyScan({.num_returns = 2});
  for (const int column : {100, 500, 501}) {
    test::SetReturn(scan, column, 4, 10.0, 0);
    test::SetReturn(scan, column, 4, 10.03, 1);
  }
  Params params = AsThePaper();
  params.min_segment_points = 2;
  const auto segments = SegmentScan(scan, params);
  ASSERT_EQ(segments.segments.size(), 1U);
  EXPECT_EQ(segments.segments[0].num_points, 2);
  EXPECT_EQ(segments.num_repeats, 3);
  EXPECT_EQ(segments.num_too_small, 1);
  for (const int index : {0, 1}) {
    EXPECT_EQ(segments.label[test::CellOf(scan, 100, 4, index)], ToLabel(Reason::kTooSmall));
    EXPECT_EQ(segments.label[test::CellOf(scan, 500, 4, index)], 1);
    EXPECT_EQ(segments.label[test::CellOf(scan, 501, 4, index)], 1);
  }
}

TEST(Numbering, KeepsTheLargestWhereThereAreMoreThanCanBeNumbered) {
  const Groups components{{0, 1, 1, 2, 3, 3, 3, 4}, 5};
  const std::vector<std::int32_t> each{0, 1, 2, 3, 4};
  Numbering numbering;
  numbering.Number(components, each, 1, 3);
  EXPECT_EQ(numbering.num_over_limit(), 2);
  EXPECT_EQ(numbering.num_too_small(), 0);
  EXPECT_EQ(numbering.groups().count, 3);
  EXPECT_EQ(numbering.groups().of_return, (std::vector<std::int32_t>{0, 1, 1, -1, 2, 2, 2, -1}));
}

TEST(SegmentScan, HasLabelsForAtMost32767Segments) {
  auto scan = test::EmptyScan({.num_columns = 5000});
  for (int column = 0; column < 5000; ++column) {
    for (int ring = 0; ring < 16; ++ring) test::SetReturn(scan, column, ring, (column + ring) % 2 == 0 ? 40.0 : 80.0);
  }
  Params params = AsThePaper();
  params.component_clustering = false;
  params.labelling.search = {.angle_rad = DegToRad(90.0), .distance_m = 0.0};
  const auto segments = SegmentScan(scan, params);
  EXPECT_EQ(segments.segments.size(), 32767U);
  EXPECT_EQ(segments.num_over_limit, 80000 - 32767);
  EXPECT_EQ(std::ranges::max(segments.label), 32767);
}

// The paper, simulation: two objects 4 m apart are told apart.
TEST(PaperExamples, TwoObjectsFourMetresApartAreToldApart) {
  for (const double range_m : {10.0, 15.0}) {
    std::vector<test::Wall> walls;
    test::AddBoat(walls, range_m, 0.0, 0.0, 1.0, 1.0, -1.0, 1.0);
    test::AddBoat(walls, range_m + 5.0, -1.5, 0.0, 1.0, 1.0, -1.0, 1.0);
    const auto scan = See(walls);
    for (const auto& params : AllWays()) {
      const auto segments = SegmentScan(scan, params);
      EXPECT_EQ(segments.segments.size(), 2U) << range_m << " m, columns " << params.labelling.image_columns;
    }
  }
}

// A shore of slabs at about 20 m, with gaps, 32 m long.
Scan SlabsOnAShore(double slab_m, double gap_m, double winding_m) {
  std::vector<test::Wall> walls;
  for (double x_m = -16.0; x_m < 16.0; x_m += slab_m + gap_m) {
    const double y_m = 20.0 + winding_m * std::sin(x_m);
    walls.push_back({x_m, y_m, x_m + slab_m, y_m + 0.2, -1.0, 3.0});
  }
  return See(walls);
}

// The paper, test 2: a shore at about 20 m is one object. Here it has gaps of 0.8 m, which the search does not bridge. To the lookout method such
// slabs may be boats at their berths; to it a shore with gaps of 0.3 m is one.
TEST(PaperExamples, AShoreAtTwentyMetresIsOneObject) {
  const auto scan = SlabsOnAShore(2.2, 0.8, 0.5);
  Params without = AsThePaper();
  without.component_clustering = false;
  EXPECT_GT(SegmentScan(scan, without).segments.size(), 5U);
  for (const auto& params : AllWays()) {
    if (params.method == Method::kLookout) continue;
    EXPECT_EQ(SegmentScan(scan, params).segments.size(), 1U) << params.labelling.image_columns;
  }
  EXPECT_EQ(SegmentScan(SlabsOnAShore(2.2, 0.3, 0.05), {}).segments.size(), 1U);
}

// The paper, test 3: a 6 m motor boat is one object; against e3 this holds from 3 m.
TEST(PaperExamples, ASixMetreMotorBoatIsOneObject) {
  // Seen from astern: transom, windscreen and bow rail are what returns.
  std::vector<test::Wall> walls;
  walls.push_back({15.0, -1.0, 15.0, 1.0, -1.0, 0.1});
  walls.push_back({18.0, -0.8, 18.0, 0.8, 0.8, 1.3});
  walls.push_back({21.0, -0.5, 21.0, 0.5, 2.2, 3.0});
  const auto scan = See(walls);
  Params params = AsThePaper();
  EXPECT_EQ(SegmentScan(scan, params).segments.size(), 1U);
  params.clustering.e3_distance_m = 2.5;
  EXPECT_EQ(SegmentScan(scan, params).segments.size(), 3U);
}

// The paper, test 1: a kayak that leaves the shore is an object of its own from some distance on (they: 8.6 m).
TEST(PaperExamples, AKayakThatLeavesTheShoreBecomesAnObjectOfItsOwn) {
  const auto count = [](double from_shore_m) {
    std::vector<test::Wall> walls{{30.0, -40.0, 30.0, 40.0, -1.0, 4.0}};
    test::AddBoat(walls, 30.0 - from_shore_m, 0.0, DegToRad(90.0), 4.0, 0.7, -1.0, 0.6);
    return SegmentScan(See(walls), AsThePaper()).segments.size();
  };
  EXPECT_EQ(count(2.0), 1U);
  EXPECT_EQ(count(10.0), 2U);
}

TEST(SegmentScan, TellsBoatsSideBySideApartWhenTheAngleRuleIsLimited) {
  const std::vector<test::Wall> walls{{39.0, -7.2, 39.0, -4.2, -1.0, 1.5}, {39.0, 4.2, 39.0, 7.2, -1.0, 1.5}};
  const auto scan = See(walls);
  Params params = AsThePaper();
  EXPECT_EQ(SegmentScan(scan, params).segments.size(), 1U);
  params.clustering.e2_max_distance_m = 10.0;
  EXPECT_EQ(SegmentScan(scan, params).segments.size(), 2U);
}

// A buoy before a shore at 512 columns: the shore's returns in the buoy's pixels used to be lost, or would be the buoy's.
TEST(SegmentScan, NeitherHidesNorSwallowsWhatIsBehindANearBuoy) {
  std::vector<test::Wall> walls{{40.0, -20.0, 40.0, 20.0, -1.0, 4.0}};
  test::AddBoat(walls, 10.0, 0.0, 0.0, 0.3, 0.3, -1.0, 0.5);
  const auto scan = See(walls);
  for (const auto& params : AllWays()) {
    const auto segments = SegmentScan(scan, params);
    EXPECT_EQ(segments.segments.size(), 2U) << params.labelling.image_columns;
    const auto shore = SegmentsAt(scan, segments, 40.0, 0.0, 15.0);
    const auto buoy = SegmentsAt(scan, segments, 10.0, 0.0, 1.0);
    EXPECT_EQ(shore.size(), 1U);
    EXPECT_EQ(buoy.size(), 1U);
    EXPECT_NE(shore, buoy);
    EXPECT_EQ(std::ranges::count_if(segments.label, [](std::int16_t label) { return label < 0; }), 0);
  }
}

}  // namespace
}  // namespace lookout::segmenter
