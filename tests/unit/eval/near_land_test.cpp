// Which things lie near land: distances in space between returns.
#include "lab/eval/methods/near_land.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace lookout::eval {
namespace {

struct Beam {
  std::int32_t object;
  float azimuth_rad;
  double range_m;
};

// One ring, level; kayaks 1 and 3, dock 2, shore 8.
LabelledScan ScanOf(const std::vector<Beam>& beams) {
  LabelledScan truth;
  truth.scan.head.range_unit_m = 0.002;
  truth.scan.head.rings.resize(1);
  truth.scan.head.num_turn_columns = static_cast<int>(beams.size());
  for (const auto& beam : beams) {
    truth.scan.columns.azimuth_rad.push_back(beam.azimuth_rad);
    truth.scan.columns.time_ns.push_back(0);
    truth.scan.columns.range.push_back(static_cast<std::uint16_t>(std::lround(beam.range_m / truth.scan.head.range_unit_m)));
    truth.scan.columns.reflectivity.push_back(1);
    truth.object.push_back(beam.object);
  }
  truth.objects = {{1, {"", "kayak", true}}, {2, {"", "dock", false}}, {3, {"", "kayak", true}}, {8, {"", "shore", false}}};
  return truth;
}

TEST(NearLand, IsWithinTheDistanceOfAReturnOfLand) {
  // The shore is 2.9 m behind kayak 1; kayak 3 is 0.1 rad aside and 5 m before it, 5.4 m away; no return is of land beside dock 2.
  const auto truth = ScanOf({{1, 0.0F, 17.1}, {8, 0.0F, 20.0}, {3, 0.1F, 15.0}, {2, 1.0F, 20.0}, {kNoTrueObject, 1.01F, 20.0}});
  EXPECT_EQ(NearLand(truth, 3.0), (std::set<std::int32_t>{1}));
  EXPECT_EQ(NearLand(truth, 2.8), (std::set<std::int32_t>{}));
  EXPECT_EQ(NearLand(truth, 6.0), (std::set<std::int32_t>{1, 3}));
  EXPECT_EQ(NearLand(truth, 100.0), (std::set<std::int32_t>{1, 2, 3})) << "docks are no land";
}

TEST(NearLand, IsNothingWhereNoLandIsSeen) { EXPECT_TRUE(NearLand(ScanOf({{1, 0.0F, 17.1}, {2, 0.0F, 17.2}}), 3.0).empty()); }

}  // namespace
}  // namespace lookout::eval
