// The list of things that were lost, and the pictures of the worst scans.
#include <algorithm>
#include <gtest/gtest.h>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "lab/eval/methods/lost_list.hpp"
#include "lab/eval/methods/scoring.hpp"
#include "lab/eval/methods/worst_pictures.hpp"
#include "tests/support/files.hpp"

namespace lookout::eval {
namespace {

// A column for each return of one level ring: kayak 1 of `num_found` returns in segment 1, the others of six in none; a shore in segment 2.
struct KayakAndShore {
  LabelledScan truth;
  std::vector<std::int32_t> label;
};

KayakAndShore MakeScan(int num_found) {
  constexpr int kNumOfEach = 6;
  KayakAndShore made;
  auto& scan = made.truth.scan;
  scan.head.range_unit_m = 0.002;
  scan.head.rings.resize(1);
  for (int i = 0; i < 2 * kNumOfEach; ++i) {
    const bool is_kayak = i < kNumOfEach;
    scan.columns.azimuth_rad.push_back(0.01F * static_cast<float>(i));
    scan.columns.time_ns.push_back(0);
    scan.columns.range.push_back(is_kayak ? 5000 : 10000);
    scan.columns.reflectivity.push_back(1);
    made.truth.object.push_back(is_kayak ? 1 : 2);
    made.label.push_back(!is_kayak ? 2 : i < num_found ? 1 : 0);
  }
  scan.head.num_turn_columns = 2 * kNumOfEach;
  made.truth.objects = {{1, {"kayak_1", "kayak", true}}, {2, {"shore", "shore", false}}};
  return made;
}

void AddTo(WorstPictures& pictures, const ScanPlace& place, int num_found) {
  const auto made = MakeScan(num_found);
  pictures.Add("ours (all segments)", place, made.truth, made.label, ScoreScan(made.truth, {made.label, {}}));
}

std::vector<std::string> FilesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  return names;
}

TEST(LostList, HasARowForEachThingThatWasLost) {
  std::ostringstream out;
  LostList list(out);
  for (const int num_found : {6, 2}) {
    const auto made = MakeScan(num_found);
    list.Add("ours", {"harbour", 101, num_found}, made.truth, made.label);
  }
  EXPECT_EQ(out.str(),
            "method,scene,seed,scan,object,name,kind,returns,range_m,iou,outcome,segment,held_by,held_by_kind\n"
            "ours,harbour,101,2,1,kayak_1,kayak,6,10.00,0.3333,missed,1,kayak_1,kayak\n");
}

TEST(PictureOf, SaysWhatBecameOfWhatWasLost) {
  const auto made = MakeScan(2);
  const auto svg = PictureOf("ours <1>", made.truth, made.label);
  EXPECT_NE(svg.find("ours &lt;1>"), std::string::npos);
  EXPECT_NE(svg.find("1: kayak_1 (kayak), 6 returns at 10.0 m, IoU 0.33: missed</text>"), std::string::npos);
  EXPECT_EQ(PictureOf("", MakeScan(6).truth, MakeScan(6).label).find("kayak"), std::string::npos);
}

TEST(WorstPictures, AreTheWorstOfEachSceneAndOneOfASecond) {
  const support::TempDir folder;
  WorstPictures pictures(2);
  AddTo(pictures, {"harbour", 101, 0}, 4);
  AddTo(pictures, {"harbour", 101, 1}, 1);  // of the same second, and worse
  AddTo(pictures, {"harbour", 102, 0}, 5);
  AddTo(pictures, {"harbour", 103, 0}, 3);
  AddTo(pictures, {"harbour", 104, 0}, 6);
  AddTo(pictures, {"canal", 101, 0}, 6);
  pictures.Write(folder / "pictures", false);
  const auto of_method = folder / "pictures" / "ours__all_segments_";
  EXPECT_EQ(FilesIn(of_method / "harbour"), (std::vector<std::string>{"01-seed-101-scan-1.svg", "02-seed-103-scan-0.svg"}));
  EXPECT_EQ(FilesIn(of_method / "canal"), (std::vector<std::string>{"01-seed-101-scan-0.svg"}));
  EXPECT_THROW(pictures.Write(folder / "pictures", false), std::runtime_error);

  WorstPictures others(2);
  AddTo(others, {"harbour", 109, 0}, 4);
  others.Write(folder / "pictures", true);
  EXPECT_EQ(FilesIn(of_method / "harbour"), (std::vector<std::string>{"01-seed-109-scan-0.svg"})) << "nothing of the earlier run is left";
}

}  // namespace
}  // namespace lookout::eval
