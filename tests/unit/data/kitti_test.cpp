#include "lab/data/kitti.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "tests/unit/data/cloud_text.hpp"
#include "tools/import/file_bytes.hpp"

namespace lookout::data {
namespace {

using namespace test;
using importer::PointFileError;

std::string FaultOf(const std::string& points, std::optional<std::string_view> labels = std::nullopt) {
  try {
    ParseKitti(points, "a.bin", labels, "a.label");
  } catch (const PointFileError& error) {
    return error.what();
  }
  return "none";
}

TEST(Kitti, AnEmptyFileHasNoPoints) {
  const auto cloud = ParseKitti("", "a.bin", std::nullopt, "");
  EXPECT_TRUE(cloud.points.empty());
  EXPECT_FALSE(cloud.has_labels);
}

TEST(Kitti, ReadsPointsWithoutLabels) {
  const auto cloud = ParseKitti(KittiPoint(1.0F, -2.0F, 3.0F, 0.37F) + KittiPoint(4.0F, 5.0F, 6.0F, 7.0F), "a.bin", std::nullopt, "");
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[0].y_m, -2.0F);
  EXPECT_EQ(cloud.points[0].reflectivity, 37);
  EXPECT_EQ(cloud.points[1].reflectivity, 100);
  EXPECT_EQ(cloud.points[1].object, kNoTrueObject);
}

TEST(Kitti, AnInstanceIsAnObjectAndAClassWithoutOneIsNone) {
  std::string points;
  for (int i = 0; i < 5; ++i) points += KittiPoint(static_cast<float>(i + 1), 0.0F, 0.0F);
  // Car 7, car 9, road, person 7, car 7: a number of an instance may stand for another thing in another class.
  const auto labels = KittiLabel(10, 7) + KittiLabel(10, 9) + KittiLabel(40, 0) + KittiLabel(30, 7) + KittiLabel(10, 7);
  const auto cloud = ParseKitti(points, "a.bin", labels, "a.label");
  ASSERT_EQ(cloud.objects.size(), 3U);
  EXPECT_EQ(cloud.points[0].object, 1);
  EXPECT_EQ(cloud.points[1].object, 3);
  EXPECT_EQ(cloud.points[2].object, kNoTrueObject);
  EXPECT_EQ(cloud.points[3].object, 2);
  EXPECT_EQ(cloud.points[4].object, 1);
  EXPECT_EQ(cloud.objects.at(2).name, "class 30 instance 7");
  EXPECT_EQ(cloud.objects.at(3).kind, "class 10");
}

TEST(Kitti, ClassesAreObjectsWhereNoPointOfTheFileHasAnInstance) {
  std::string points;
  for (int i = 0; i < 5; ++i) points += KittiPoint(static_cast<float>(i + 1), 0.0F, 0.0F);
  const auto labels = KittiLabel(0, 0) + KittiLabel(1, 0) + KittiLabel(50, 0) + KittiLabel(18, 0) + KittiLabel(50, 0);
  const auto cloud = ParseKitti(points, "a.bin", labels, "a.label");
  EXPECT_TRUE(cloud.are_classes_objects);
  ASSERT_EQ(cloud.objects.size(), 2U);
  EXPECT_EQ(cloud.objects.at(1).name, "class 18");
  EXPECT_EQ(cloud.points[0].object, kNoTrueObject) << "unlabelled";
  EXPECT_EQ(cloud.points[1].object, kNoTrueObject) << "outlier";
  EXPECT_EQ(cloud.points[2].object, 2);
  EXPECT_EQ(cloud.points[3].object, 1);
  EXPECT_EQ(cloud.points[4].object, 2);
  EXPECT_FALSE(ParseKitti(points.substr(0, 16), "a.bin", KittiLabel(0, 0), "a.label").are_classes_objects) << "nothing is labelled";
}

TEST(Kitti, LeavesOutWhatIsNotANumberAndCountsIt) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto cloud =
      ParseKitti(KittiPoint(1.0F, nan, 3.0F) + KittiPoint(4.0F, 5.0F, 6.0F, nan), "a.bin", KittiLabel(1, 1) + KittiLabel(1, 2), "a.label");
  ASSERT_EQ(cloud.points.size(), 1U);
  EXPECT_EQ(cloud.num_not_finite, 1);
  EXPECT_EQ(cloud.points[0].object, 2);
  EXPECT_EQ(cloud.points[0].reflectivity, 0);
}

TEST(Kitti, SaysWhereAFileIsBroken) {
  EXPECT_EQ(FaultOf(KittiPoint(1.0F, 2.0F, 3.0F) + "abc"), "a.bin: byte 16: the file ends inside a point of 16 bytes");
  EXPECT_EQ(FaultOf(KittiPoint(1.0F, 2.0F, 3.0F), "abc"), "a.label: byte 3: 1 points need 4 bytes of labels, not 3");
  EXPECT_EQ(FaultOf(KittiPoint(1.0F, 2.0F, 3.0F), KittiLabel(1, 1) + KittiLabel(1, 1)), "a.label: byte 4: 1 points need 4 bytes of labels, not 8");
  EXPECT_THROW(ReadKitti("/nowhere/a.bin", std::nullopt), PointFileError);
}

}  // namespace
}  // namespace lookout::data
