#include "lab/eval/truth.hpp"

#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/unit/eval/truth_fixture.hpp"

namespace lookout::eval {
namespace {

TEST(Truth, FindsReturnsWithinAMicrosecondByRingAndReturn) {
  const support::TempDir folder;
  WriteTruth(folder);
  const Truth truth(folder);
  const auto object_of = [&truth](std::int64_t utime_us, int ring, int return_index) {
    const auto* found = truth.Find(utime_us, ring, return_index);
    return found != nullptr ? std::optional(found->object_id) : std::nullopt;
  };
  EXPECT_EQ(object_of(kStartUs, 0, 0), 1);
  EXPECT_EQ(object_of(kStartUs + 1, 0, 0), 1);
  EXPECT_EQ(object_of(kStartUs - 1, 0, 0), 1);
  EXPECT_EQ(object_of(kStartUs - 2, 0, 0), std::nullopt);
  EXPECT_EQ(object_of(kStartUs, 1, 0), std::nullopt);
  EXPECT_EQ(object_of(kStartUs, 0, 1), std::nullopt);
  EXPECT_EQ(object_of(kStartUs + 55, 0, 0), 2);
}

// Of clouds without times all returns of a ring are of one time.
TEST(Truth, FindsReturnsOfOneTimeByTheirColumn) {
  const support::TempDir folder;
  WriteTruth(folder);
  WriteFile(folder / "returns.csv", "utime_us,ring,return_index,object_id,column\n5,0,0,1,0\n5,1,0,2,0\n5,0,0,3,1\n5,0,1,4,1\n");
  const Truth truth(folder);
  const auto object_of = [&truth](std::int64_t utime_us, int ring, int return_index, int column) {
    const auto* found = truth.Find(utime_us, ring, return_index, column);
    return found != nullptr ? found->object_id : -9;
  };
  EXPECT_EQ(object_of(5, 0, 0, 0), 1);
  EXPECT_EQ(object_of(5, 1, 0, 0), 2);
  EXPECT_EQ(object_of(6, 0, 0, 1), 3);
  EXPECT_EQ(object_of(4, 0, 1, 1), 4);
  EXPECT_EQ(object_of(7, 0, 0, 1), -9);
  EXPECT_EQ(object_of(5, 1, 0, 1), -9);
}

TEST(Truth, OutlineOfAMovingObjectLiesBetweenItsSamples) {
  const support::TempDir folder;
  WriteTruth(folder);
  const Truth truth(folder);
  const auto outlines = truth.OutlinesIn({kDatumLatitudeDeg, kDatumLongitudeDeg, kDatumHeightM});
  const auto middle_m = outlines.At(1, kStartUs + 500'000);
  ASSERT_TRUE(middle_m);
  EXPECT_NEAR(middle_m->at(0).x(), 0.0, 1e-3);
  EXPECT_NEAR(middle_m->at(0).y(), 0.5, 1e-3);
  EXPECT_NEAR(outlines.At(1, kStartUs - 9)->at(2).y(), 2.0, 1e-3) << "before the first it is the first";
  EXPECT_NEAR(outlines.At(1, kStartUs + 9'000'000)->at(2).y(), 3.0, 1e-3) << "behind the last it is the last";
  EXPECT_NEAR(outlines.At(2, kStartUs + 9'000'000)->at(1).x(), 12.0, 1e-3);
  EXPECT_FALSE(outlines.At(7, kStartUs));
}

TEST(Truth, BadFilesAreNamedWithTheirLine) {
  const support::TempDir folder;
  WriteTruth(folder);
  WriteFile(folder / "returns.csv", "utime_us,ring,return_index,object_id\n1,2,3,4\n1,2,x,4\n");
  try {
    const Truth truth(folder);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), (folder / "returns.csv").string() + ":3: return_index: not a whole number: x");
  }
  WriteFile(folder / "returns.csv", "utime_us,ring\n");
  EXPECT_THROW(Truth{folder}, std::runtime_error);
  WriteFile(folder / "returns.csv", "utime_us,ring,return_index,object_id\n1,2\n");
  EXPECT_THROW(Truth{folder}, std::runtime_error);
  std::filesystem::remove(folder / "returns.csv");
  EXPECT_THROW(Truth{folder}, std::runtime_error);
}

}  // namespace
}  // namespace lookout::eval
