// Labels of scans as the judge's truth.
#include "tools/import/truth_files.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/config/text_config.hpp"
#include "tests/support/files.hpp"
#include "tools/import/label_map.hpp"

namespace lookout::importer {
namespace {

using support::ReadFile;

TEST(LabelMap, IsReadWithItsFaults) {
  const auto map = ParseLabelMap("10 obstacle car # a note\n\n50 land\n9 water\n", "labels.txt");
  EXPECT_EQ(map.at(10).use, LabelUse::kObstacle);
  EXPECT_EQ(map.at(10).name, "car");
  EXPECT_EQ(map.at(50).use, LabelUse::kLand);
  try {
    ParseLabelMap("x land\n70000 land\n1 sea\n1 land\n", "labels.txt");
    FAIL();
  } catch (const config::ConfigError& error) {
    ASSERT_EQ(error.faults().size(), 4U) << error.what();
    EXPECT_EQ(error.faults()[2], "labels.txt:3: 'sea' is none of water, land, obstacle, none");
  }
  EXPECT_EQ(ParseLabelMap(std::string(kSemanticKittiLabels), "default").at(252).name, "moving-car");
  EXPECT_EQ(ParseLabelMap(std::string(kBoxLabels), "default").size(), 4U);
}

TEST(TruthFiles, HoldEachReturnWithItsObject) {
  const support::TempDir folder;
  lidar_scan_t part{};
  part.utime_us = 1000;
  part.num_rings = 2;
  part.num_returns = 1;
  part.num_columns = 1;
  part.time_ns = {1600};
  part.time_offset_ns = {0, 2000};
  part.range = {5, 6};
  auto second = part;
  second.first_column = 1;
  second.range = {0, 7};
  TruthFiles truth(folder / "truth", ParseLabelMap("10 obstacle car\n50 land\n40 water\n", "labels.txt"), false);
  truth.Add({part, second}, {10U | 7U << 16, 50U, 0U, 77U});
  truth.Add({part}, {});  // a cloud without labels
  truth.Finish();
  EXPECT_EQ(truth.num_scans(), 1);
  EXPECT_EQ(truth.num_objects(), 2);
  EXPECT_EQ(truth.num_unknown(), 1);
  EXPECT_EQ(ReadFile(folder / "truth" / "returns.csv"), "utime_us,ring,return_index,object_id,column\n1002,0,0,1,0\n1004,1,0,2,0\n1004,1,0,0,1\n");
  EXPECT_EQ(
      ReadFile(folder / "truth" / "objects.csv"),
      "object_id,name,kind,is_moving,is_in_water\n-1,own vessel,own vessel,0,0\n0,nothing,nothing,0,0\n1,car 7,car,0,1\n2,label 50,label 50,0,0\n");
  EXPECT_THROW(TruthFiles(folder / "truth", {}, false), std::runtime_error);
}

}  // namespace
}  // namespace lookout::importer
