#include "lab/data/pcd.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/support/files.hpp"
#include "tests/unit/data/cloud_text.hpp"
#include "tools/import/file_bytes.hpp"

namespace lookout::data {
namespace {

using namespace test;
using importer::PointFileError;

std::string PcdFaultOf(const std::string& bytes) {
  try {
    ParsePcd(bytes, "a.pcd");
  } catch (const PointFileError& error) {
    return error.what();
  }
  return "none";
}

std::string Xyz(int num_points, const std::string& data) { return PcdHeaderText(num_points, "x y z", "4 4 4", "F F F", data); }

TEST(Pcd, ReadsTextWithoutLabels) {
  const auto cloud = ParsePcd(Xyz(2, "ascii") + "1 2.5 -3e0\n4\t5 6\r\n", "a.pcd");
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[0].y_m, 2.5F);
  EXPECT_EQ(cloud.points[0].z_m, -3.0F);
  EXPECT_EQ(cloud.points[1].z_m, 6.0F);
  EXPECT_FALSE(cloud.has_labels);
  EXPECT_TRUE(cloud.objects.empty());
}

TEST(Pcd, FieldsComeInAnyOrderWithOthersBetween) {
  const auto header =
      "FIELDS label z _ x normal y intensity\nSIZE 4 4 1 8 4 4 4\nTYPE U F U F F F F\nCOUNT 1 1 2 1 3 1 1\nWIDTH 2\nHEIGHT 1\nDATA ascii\n";
  const auto cloud = ParsePcd(std::string(header) + "7 3 0 0 1 9 9 9 2 41.6\n0 30 0 0 10 9 9 9 20 1e9\n", "a.pcd");
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[0].x_m, 1.0F);
  EXPECT_EQ(cloud.points[0].y_m, 2.0F);
  EXPECT_EQ(cloud.points[0].z_m, 3.0F);
  EXPECT_EQ(cloud.points[0].reflectivity, 42);
  EXPECT_EQ(cloud.points[0].object, 1);
  EXPECT_EQ(cloud.points[1].reflectivity, 255);
  EXPECT_EQ(cloud.points[1].object, kNoTrueObject);
  EXPECT_TRUE(cloud.has_labels);
  EXPECT_EQ(cloud.objects.at(1).name, "label 7");
}

TEST(Pcd, ReadsBinaryOfAnySizeAndType) {
  const auto header = [](std::string_view sizes, std::string_view types) { return PcdHeaderText(1, "label x y z", sizes, types, "binary"); };
  std::string doubles = header("1 8 8 8", "I F F F");
  Append<std::int8_t>(doubles, -3);
  for (const double value : {1.5, -2.0, 3.0}) Append(doubles, value);
  auto cloud = ParsePcd(doubles, "a.pcd");
  EXPECT_EQ(cloud.points.at(0).x_m, 1.5F);
  EXPECT_EQ(cloud.points.at(0).object, kNoTrueObject);

  std::string mixed = header("8 2 1 4", "U I U I");
  Append<std::uint64_t>(mixed, 5);
  Append<std::int16_t>(mixed, -300);
  Append<std::uint8_t>(mixed, 200);
  Append<std::int32_t>(mixed, -70000);
  cloud = ParsePcd(mixed, "a.pcd");
  EXPECT_EQ(cloud.points.at(0).x_m, -300.0F);
  EXPECT_EQ(cloud.points.at(0).y_m, 200.0F);
  EXPECT_EQ(cloud.points.at(0).z_m, -70000.0F);
  EXPECT_EQ(cloud.points.at(0).object, 1);
}

TEST(Pcd, ObjectsAreNumberedInTheOrderOfTheirLabels) {
  const auto cloud = ParsePcd(PcdHeaderText(3, "x y z label", "4 4 4 4", "F F F U", "ascii") + "1 1 1 900\n1 1 2 4\n1 1 3 900", "a.pcd");
  EXPECT_EQ(cloud.points.at(0).object, 2);
  EXPECT_EQ(cloud.points.at(1).object, 1);
  EXPECT_EQ(cloud.points.at(2).object, 2);
}

TEST(Pcd, PointsThatAreNotNumbersAreLeftOutAndCounted) {
  const auto cloud = ParsePcd(Xyz(3, "ascii") + "nan nan nan\n1 inf 1\n1 2 3\n", "a.pcd");
  EXPECT_EQ(cloud.points.size(), 1U);
  EXPECT_EQ(cloud.num_not_finite, 2);
}

TEST(Pcd, NoPointsAreACloudToo) { EXPECT_TRUE(ParsePcd(Xyz(0, "binary"), "a.pcd").points.empty()); }

TEST(Pcd, ReadsAFile) {
  const support::TempDir folder;
  const auto file = folder / "file.pcd";
  std::ofstream(file) << Xyz(1, "ascii") << "1 2 3\n";
  EXPECT_EQ(ReadPcd(file).points.size(), 1U);
  std::filesystem::remove(file);
  EXPECT_THROW(ReadPcd(file), PointFileError);
}

TEST(Pcd, SaysInWhichLineTheHeaderIsBroken) {
  EXPECT_EQ(PcdFaultOf(""), "a.pcd:1: the file ends before the line DATA");
  EXPECT_EQ(PcdFaultOf("FIELDS x\nBREADTH 7\n"), "a.pcd:2: no line of a PCD header: BREADTH");
  EXPECT_EQ(PcdFaultOf("FIELDS x\nFIELDS y\n"), "a.pcd:2: FIELDS stands in line 1 already");
  EXPECT_EQ(PcdFaultOf("DATA ascii\n"), "a.pcd:1: the header has no FIELDS");
  EXPECT_EQ(PcdFaultOf("FIELDS x y z\nSIZE 4 4\nTYPE F F F\nDATA ascii\n"), "a.pcd:2: 2 values where 3 belong");
  EXPECT_EQ(PcdFaultOf("FIELDS x y z\nSIZE 4 4 2\nTYPE F F F\nDATA ascii\n"), "a.pcd:2: there is no number of type F with 2 bytes");
  EXPECT_EQ(PcdFaultOf("FIELDS x y z\nSIZE 4 4 4\nTYPE F F Q\nDATA ascii\n"), "a.pcd:3: a type is F, I or U, not Q");
  EXPECT_EQ(PcdFaultOf("FIELDS x\nSIZE 4\nTYPE F\nCOUNT 0\nDATA ascii\n"), "a.pcd:1: a point holds nothing");
  EXPECT_EQ(PcdFaultOf("FIELDS x\nSIZE 4\nTYPE F\nWIDTH 2\nHEIGHT 3\nPOINTS 5\nDATA ascii\n"), "a.pcd:6: POINTS is not WIDTH times HEIGHT, 6");
  EXPECT_EQ(PcdFaultOf("FIELDS x\nSIZE 4\nTYPE F\nWIDTH -2\nHEIGHT 3\nDATA ascii\n"), "a.pcd:4: no whole number from 0 to 2097152: -2");
  EXPECT_EQ(PcdFaultOf("FIELDS x\nSIZE 4\nTYPE F\nWIDTH 2097152\nHEIGHT 2\nDATA ascii\n"), "a.pcd:4: 4194304 points are no scan");
  EXPECT_EQ(PcdFaultOf("FIELDS x\nSIZE 4\nTYPE F\nVIEWPOINT 1 0 0 1 0 0 0\nWIDTH 0\nHEIGHT 0\nDATA ascii\n"),
            "a.pcd:4: the sensor must be at the origin and upright (0 0 0 1 0 0 0): bring the points into its frame");
  EXPECT_EQ(PcdFaultOf(Xyz(0, "packed")), "a.pcd:10: DATA is ascii, binary or binary_compressed");
  EXPECT_EQ(PcdFaultOf(PcdHeaderText(0, "x y y z", "4 4 4 4", "F F F F", "ascii")), "a.pcd: the field y must be one number, and stand once");
  EXPECT_EQ(PcdFaultOf(PcdHeaderText(0, "x z", "4 4", "F F", "ascii")), "a.pcd: there is no field y");
}

TEST(Pcd, AHeaderThatPromisesMoreThanTheFileHoldsIsRefusedBeforeMemoryIsTaken) {
  EXPECT_EQ(PcdFaultOf(Xyz(2000000, "ascii") + "1 2 3\n"), "a.pcd:10: 2000000 points take at least 12000000 bytes; 6 follow");
  EXPECT_EQ(PcdFaultOf(Xyz(2, "binary") + std::string(23, 'a')), "a.pcd:10: 2 points take 24 bytes; 23 follow");
  EXPECT_EQ(PcdFaultOf(Xyz(2, "binary") + std::string(25, 'a')), "a.pcd:10: 2 points take 24 bytes; 25 follow");
}

TEST(Pcd, SaysWhereAPointIsBroken) {
  EXPECT_EQ(PcdFaultOf(Xyz(2, "ascii") + "1 2 3\n4 5\n6 7 8 \n"), "a.pcd:12: 2 numbers where 3 belong");
  EXPECT_EQ(PcdFaultOf(Xyz(1, "ascii") + "1 2 3x\n"), "a.pcd:11: not a number: 3x");
  EXPECT_EQ(PcdFaultOf(Xyz(1, "ascii") + "1 2 3\n4 5 6\n"), "a.pcd:12: more points than the header says, 1");
  EXPECT_EQ(PcdFaultOf(Xyz(2, "ascii") + "100000 200000 3\n"), "a.pcd: 1 points, where the header says 2");
  EXPECT_EQ(PcdFaultOf(PcdHeaderText(1, "x y z label", "4 4 4 4", "F F F F", "ascii") + "1 2 3 1.5\n"),
            "a.pcd:11: a label is a whole number of at most 53 bits");
  std::string binary = PcdHeaderText(1, "x y z label", "4 4 4 4", "F F F F", "binary");
  const auto offset = binary.size();
  for (const float value : {1.0F, 2.0F, 3.0F, 0.5F}) Append(binary, value);
  EXPECT_EQ(PcdFaultOf(binary), "a.pcd: byte " + std::to_string(offset) + ": a label is a whole number of at most 53 bits");
}

}  // namespace
}  // namespace lookout::data
