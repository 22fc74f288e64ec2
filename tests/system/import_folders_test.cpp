// Folders of labelled scans as a user imports, replays and judges them: SemanticKITTI's and SeePerSea's layouts, written here.
#include <cstdint>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/support/child.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/import/made_folders.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
using namespace importer::test;
namespace fs = std::filesystem;

class ImportFolders : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  // What lookout-eval says of the folder's scans against their labels.
  std::string Judge(const std::string& recording, int expected_exit) {
    const auto imported = RunProgram(
        {Bin("import"), "--config", kDemoConfig.string(), "--in", Path(recording), "--out", Path("import.lcmlog"), "--truth", Path("truth")},
        Path("out"));
    EXPECT_EQ(imported.exit_code, expected_exit) << imported.output;
    notes_ = imported.output;
    const auto replayed = RunProgram(
        {Bin("replay"), "--config", kDemoConfig.string(), "--in", Path("import.lcmlog"), "--from", "LIDAR_SCAN", "--out", Path("replay.lcmlog")},
        Path("out"));
    EXPECT_EQ(replayed.exit_code, 0) << replayed.output;
    const auto judged = RunProgram({Bin("eval"), "--in", Path("replay.lcmlog"), "--truth", Path("truth")}, Path("out"));
    EXPECT_EQ(judged.exit_code, 0) << judged.output;
    return judged.output;
  }

  TempDir folder_;
  std::string notes_;
};

// Things alone on the water, with nothing behind them.
std::vector<MadePoint> Things(double first_deg, std::uint32_t label) {
  std::vector<MadePoint> points;
  for (const auto& point : MadeTurn(first_deg, first_deg + 14.0, label)) {
    if (point.label != 0 && point.z_m < 1.0F) points.push_back(point);
  }
  return points;
}

TEST_F(ImportFolders, OfSemanticKittiAreJudgedByTheirLabels) {
  for (int i = 0; i < 4; ++i) {
    auto points = Things(10.0 + i, 10U | 1U << 16);
    for (const auto& point : Things(100.0, 50)) points.push_back(point);
    const auto name = "00000" + std::to_string(i);
    WriteIn(folder_ / "sequences/00/velodyne", name + ".bin", KittiBytes(points) + (i == 2 ? "cut" : ""));
    WriteIn(folder_ / "sequences/00/labels", name + ".label", LabelBytes(points));
  }
  WriteIn(folder_ / "sequences/00", "times.txt", "0.0\n1.0e-01\n2.0e-01\n3.0e-01\n");
  const auto text = Judge("sequences/00", 3);
  EXPECT_NE(notes_.find("10 obstacle car\n"), std::string::npos) << notes_;
  EXPECT_NE(notes_.find("000002.bin: the file ends inside a point"), std::string::npos) << notes_;
  EXPECT_NE(notes_.find("truth: 4 scans, 2 objects"), std::string::npos) << notes_;
  EXPECT_NE(text.find("segmentation over 4 whole scans"), std::string::npos) << text;
  EXPECT_NE(text.find("100.0 % found in the truth"), std::string::npos) << text;
  EXPECT_NE(text.find("mIoU 100.0 %"), std::string::npos) << text;
  EXPECT_NE(text.find("car 1"), std::string::npos) << text;
}

TEST_F(ImportFolders, OfSeePerSeaAreJudgedByTheirBoxes) {
  for (int i = 0; i < 4; ++i) {
    const auto points = Things(353.0, 1);  // ahead, at 8 m
    const auto name = "00000" + std::to_string(i);
    WriteIn(folder_ / "sea/point_clouds", name + ".pcd", PcdBytes(points, PcdKind::kCompressed));
    WriteIn(folder_ / "sea/timestamp", name + ".txt", "1665158400." + std::to_string(i) + "\n");
    WriteIn(folder_ / "sea/annotations", name + ".json",
            R"({"labels":[{"id":0,"category":"ship","box3d":{"dimension":{"width":1,"length":4,"height":6},"location":{"x":8,"y":0,"z":0},
                "orientation":{"rotationYaw":0}}}]})");
  }
  const auto text = Judge("sea", 0);
  EXPECT_NE(notes_.find("1 obstacle ship\n"), std::string::npos) << notes_;
  EXPECT_NE(notes_.find("truth: 4 scans, 1 objects"), std::string::npos) << notes_;
  EXPECT_NE(text.find("100.0 % found in the truth"), std::string::npos) << text;
  EXPECT_NE(text.find("ship"), std::string::npos) << text;
  EXPECT_NE(text.find("mIoU"), std::string::npos) << text;
}

}  // namespace
}  // namespace lookout::system_test
