// Families that are left out: which evidence is used where, what is refused, and the tables.
#include "lab/eval/methods/leave_out.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <stdexcept>

#include "lab/eval/methods/result_tables.hpp"
#include "lab/eval/methods/run_plan.hpp"
#include "tests/support/files.hpp"

namespace lookout::eval {
namespace {

// The evidence that is compiled in, as if it had been fitted on these. Where nothing may merge, the bias of both mergings says so.
void WriteEvidence(const std::filesystem::path& file, const std::string& comment, bool may_merge = true) {
  auto text = support::ReadFile(support::kSources / "config/evidence/lookout.txtpb");
  const auto first_sum = text.find("sum {");
  std::string head = "# proto-file: config/schema/evidence.proto\n# proto-message: lookout.config.Evidence\n# " + comment + "\n";
  text = head + text.substr(first_sum);
  for (auto at = text.find("\n  bias: "); !may_merge && at != std::string::npos; at = text.find("\n  bias: ", at + 1)) {
    text.replace(at, text.find('\n', at + 1) - at, "\n  bias: -100");
  }
  support::WriteFile(file, text);
}

constexpr const char* kOfTwo = "Fitted on seeds 1 to 10, 0.5 s each, of beach, quay_side.";

std::string ReasonOf(const LeaveOutEvidence& evidence, const std::string& scene) {
  try {
    evidence.FileOf(scene);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(FittedOn, IsReadFromTheCommentsOfTheFile) {
  const support::TempDir folder;
  WriteEvidence(folder / "a.txtpb", kOfTwo);
  EXPECT_EQ(FittedOn(folder / "a.txtpb"), (std::set<std::string>{"beach", "quay_side"}));
  WriteEvidence(folder / "a.txtpb", "Fitted on seeds 1 to 10, 0.5 s each, of beach,\n# quay_side, canal.");
  EXPECT_EQ(FittedOn(folder / "a.txtpb"), (std::set<std::string>{"beach", "quay_side", "canal"})) << "a long line may be broken";
  WriteEvidence(folder / "a.txtpb", "by hand");
  EXPECT_THROW(FittedOn(folder / "a.txtpb"), std::invalid_argument);
}

TEST(LeaveOutEvidence, IsThatWithoutTheFamilyAndOfAllElsewhere) {
  const support::TempDir folder;
  WriteEvidence(folder / "without-harbour.txtpb", kOfTwo);
  WriteEvidence(folder / "without-beach.txtpb", kOfTwo);
  WriteEvidence(folder / "all.txtpb", kOfTwo);
  const LeaveOutEvidence evidence(folder, {"harbour", "beach", "canal"});
  EXPECT_EQ(evidence.FileOf("harbour").filename(), "without-harbour.txtpb");
  EXPECT_EQ(evidence.FileOf("lake").filename(), "all.txtpb");
  EXPECT_NE(ReasonOf(evidence, "beach").find("without-beach.txtpb: was fitted on beach"), std::string::npos) << ReasonOf(evidence, "beach");
  EXPECT_NE(ReasonOf(evidence, "quay_side").find("all.txtpb: was fitted on quay_side"), std::string::npos) << "it is not left out";
  EXPECT_NE(ReasonOf(evidence, "canal").find("without-canal.txtpb: is not there"), std::string::npos) << ReasonOf(evidence, "canal");
}

TEST(LeaveOutMethod, UsesTheEvidenceOfTheScene) {
  const support::TempDir folder;
  WriteEvidence(folder / "without-harbour.txtpb", kOfTwo);
  WriteEvidence(folder / "all.txtpb", kOfTwo, false);
  const auto boat = LoadBoat(support::kCatabotConfig);
  const std::vector<std::string> scenes{"harbour", "lake"};
  LeaveOutMethod method(boat, LeaveOutEvidence(folder, {"harbour"}), scenes);
  LabelledScan scan;
  ForEachScan({{"lake"}, 1, 1, 0.4}, boat, nullptr, [&scan](const ScanPlace&, const LabelledScan& truth) { scan = truth; });
  const auto count = [&](const std::string& scene) {
    method.BeginScan({scene, 1, 0});
    return method.Segment(scan.scan).is_sure.size();
  };
  const auto merged = count("harbour");
  EXPECT_GT(count("lake"), merged + merged / 10) << "nothing is merged";
  EXPECT_EQ(count("harbour"), merged);
}

MethodResult RowOf(const std::string& name, const std::map<std::string, double>& iou) {
  MethodResult row{name, {}, {}, {}};
  for (const auto& [scene, value] : iou) {
    row.by_scene[scene].iou.Add(value);
    row.by_scene[scene].segments.Add(1.0);
    row.by_scene[scene].false_segments.Add(0.0);
  }
  return row;
}

TEST(LeaveOutTables, HoldOursAgainstTheBestPeerOfEachScene) {
  Results results;
  results.scenes = {"beach", "canal"};
  results.methods = {RowOf("ours, left out (all segments)", {{"beach", 0.9}, {"canal", 0.8}}),
                     RowOf("ours (all segments)", {{"beach", 0.95}, {"canal", 0.85}}), RowOf("Euclidean 2 m", {{"beach", 0.5}, {"canal", 0.75}}),
                     RowOf("F3D (tuned)", {{"beach", 0.8}, {"canal", 0.6}})};
  const auto tables = LeaveOutTablesOf(results);
  ASSERT_EQ(tables.size(), 2U);
  const auto& rows = tables[0].table.rows();
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(rows[1], (Table::Row{"beach", "90.0", "0.00", "95.0", "F3D (tuned)", "80.0", "50.0", "F3D (tuned)", "80.0", "50.0"}));
  EXPECT_EQ(rows[2], (Table::Row{"canal", "80.0", "0.00", "85.0", "F3D (tuned)", "60.0", "50.0", "Euclidean 2 m", "75.0", "80.0"}));
  EXPECT_EQ(rows[3][0], "mean");
  EXPECT_EQ(rows[4], (Table::Row{"worst", "80.0", "-", "85.0", "-", "-", "50.0", "-", "-", "80.0"}));
  EXPECT_EQ(tables[1].table.rows()[1], (Table::Row{"ours, left out (all segments)", "85.0", "80.0", "90.0", "80.0"}));
  results.methods.erase(results.methods.begin());
  EXPECT_TRUE(LeaveOutTablesOf(results).empty()) << "nothing was left out";
}

}  // namespace
}  // namespace lookout::eval
