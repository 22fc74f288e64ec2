// The command line of lookout-eval: what it refuses, with which exit code, and that it leaves no table then.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;

class EvalLine : public ::testing::Test {
 protected:
  RunResult Run(const std::vector<std::string>& options) const {
    std::vector<std::string> command{Bin("eval"), "--config", kCatabotConfig.string()};
    command.insert(command.end(), options.begin(), options.end());
    return RunProgram(command, Path("out"));
  }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  TempDir folder_;
};

TEST_F(EvalLine, TablesAreNotMadeOfSeedsOfTuning) {
  const auto result = Run({"--scenes", "sparse", "--methods", "ours", "--first-seed", "1", "--seeds", "1", "--seconds", "0.3", "--csv", Path("csv")});
  EXPECT_EQ(result.exit_code, 2) << result.output;
  EXPECT_NE(result.output.find("seeds of tuning are 1 to 100, those of tables 101 and above"), std::string::npos) << result.output;
  EXPECT_FALSE(fs::exists(Path("csv")));
  EXPECT_EQ(Run({"--scenes", "sparse", "--methods", "ours", "--first-seed", "100", "--seeds", "2"}).exit_code, 2);
  EXPECT_EQ(Run({"--test", "3", "--first-seed", "1", "--seeds", "1"}).exit_code, 2);
}

TEST_F(EvalLine, NothingIsTunedOnSeedsOfTables) {
  const auto result = Run({"--scenes", "sparse", "--sweep", "e1=0.9:0.9:0.1", "--first-seed", "101", "--seeds", "1"});
  EXPECT_EQ(result.exit_code, 2) << result.output;
  EXPECT_NE(result.output.find("nothing is tuned on seeds of tables"), std::string::npos) << result.output;
  EXPECT_EQ(Run({"--scenes", "sparse", "--sweep", "e1=0.9:0.9:0.1", "--seeds", "101"}).exit_code, 2) << "more than there are";
}

TEST_F(EvalLine, EachTakesItsOwnSeedsWhereNoneAreNamed) {
  const auto result =
      Run({"--scenes", "sparse", "--methods", "ours", "--sweep", "e1=0.9:0.9:0.1", "--seeds", "1", "--seconds", "0.3", "--html", Path("page.html")});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  std::ifstream in(Path("page.html"));
  const std::string page(std::istreambuf_iterator<char>(in), {});
  EXPECT_NE(page.find(R"("first_seed":"101")"), std::string::npos);
  EXPECT_NE(page.find(R"("last_seed":"101")"), std::string::npos);
}

TEST_F(EvalLine, TracksHaveTheirOwnTablesAndSeeds) {
  const std::vector<std::string> line{"--tracks", "--scenes", "sparse", "--seeds", "1", "--seconds", "1"};
  auto with_files = line;
  with_files.insert(with_files.end(), {"--csv", Path("csv"), "--lost", Path("lost.csv")});
  const auto result = Run(with_files);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  for (const auto* text : {"MOTA_%", "confirmed_median_s", "standing_mps", "land_too_many", "nearest neighbour", "all scenes"}) {
    EXPECT_NE(result.output.find(text), std::string::npos) << text;
  }
  EXPECT_TRUE(fs::exists(Path("csv") + "/tracks_identities.csv"));
  EXPECT_NE(ReadFile(Path("lost.csv")).find("sparse,101,nearest neighbour,"), std::string::npos);
  EXPECT_EQ(Run(with_files).exit_code, 1) << "tables were replaced unasked";
  auto of_tuning = line;
  of_tuning.insert(of_tuning.end(), {"--first-seed", "1"});
  EXPECT_EQ(Run(of_tuning).exit_code, 2);
  of_tuning.push_back("--tuning");
  EXPECT_EQ(Run(of_tuning).exit_code, 0);
  EXPECT_EQ(Run({"--tracks"}).exit_code, 2);
  auto with_methods = line;
  with_methods.insert(with_methods.end(), {"--methods", "ours"});
  EXPECT_EQ(Run(with_methods).exit_code, 2);
}

TEST_F(EvalLine, TracksWithoutEachPartHaveOneTable) {
  const auto result = Run({"--tracks", "--ablation", "--scenes", "sparse", "--seeds", "1", "--seconds", "1", "--csv", Path("csv")});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(std::distance(fs::directory_iterator(Path("csv")), fs::directory_iterator()), 1);
  const auto table = ReadFile(Path("csv") + "/tracks_ablation.csv");
  EXPECT_EQ(std::ranges::count(table, '\n'), 8) << table;  // its head, the tracker, six parts
  EXPECT_NE(table.find("own scenes,without ledger,"), std::string::npos) << table;
  EXPECT_EQ(Run({"--ablation", "--scenes", "sparse"}).exit_code, 2) << "of methods there is none";
  EXPECT_EQ(Run({"--tracks", "--scenes", "beach", "--leave-out", "beach"}).exit_code, 2) << "no weights";
  EXPECT_EQ(Run({"--tracks", "--scenes", "beach", "--leave-out", "beach", "--weights", Path("csv")}).exit_code, 2) << "none of that family";
}

TEST_F(EvalLine, LabelsByTracksAreOfEvidenceThatDoesNotKnowTheScene) {
  const auto evidence = ReadFile(kSources / "config/evidence/lookout.txtpb");
  fs::create_directory(Path("weights"));
  const std::vector<std::string> line{"--tracks",      "--scenes", "beach", "--leave-out", "beach", "--weights",
                                      Path("weights"), "--seeds",  "1",     "--seconds",   "1"};
  WriteFile(Path("weights") + "/without-beach.txtpb", evidence);
  EXPECT_EQ(Run(line).exit_code, 2) << "it was fitted on the scene";
  auto other = evidence;
  other.replace(other.find(" beach,"), 7, "");
  WriteFile(Path("weights") + "/without-beach.txtpb", other);
  const auto result = Run(line);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("fitted without the scene"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("single scans"), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find("MOTA"), std::string::npos) << result.output;
}

TEST_F(EvalLine, AlertsHaveTheirOwnTablesAndList) {
  const std::vector<std::string> line{"--alerts", "--scenes", "crossing", "--seeds", "2", "--seconds", "2"};
  const auto with = [&line](std::vector<std::string> more) {
    more.insert(more.begin(), line.begin(), line.end());
    return more;
  };
  const auto result = Run(with({"--csv", Path("csv"), "--list", Path("one.csv")}));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  for (const auto* text : {"false_h", "delay_median_s", "standing_mean", "turning_dangers", "all scenes"}) {
    EXPECT_NE(result.output.find(text), std::string::npos) << text;
  }
  EXPECT_TRUE(fs::exists(Path("csv") + "/alerts_verdicts.csv"));
  EXPECT_EQ(Run(with({"--list", Path("one.csv")})).exit_code, 1) << "a list was replaced unasked";
  // The same with two runs at once.
  EXPECT_EQ(Run(with({"--list", Path("two.csv"), "--jobs", "2"})).exit_code, 0);
  EXPECT_EQ(ReadFile(Path("one.csv")), ReadFile(Path("two.csv")));
  EXPECT_NE(ReadFile(Path("one.csv")).find("scene,seed,second,verdict"), std::string::npos);
  // The same where what the tracker reads is kept, and where it comes from there.
  for (const auto* list : {"three.csv", "four.csv"}) {
    EXPECT_EQ(Run(with({"--list", Path(list), "--keep", Path("kept")})).exit_code, 0);
    EXPECT_EQ(ReadFile(Path("one.csv")), ReadFile(Path(list)));
  }
  EXPECT_TRUE(fs::exists(Path("kept") + "/crossing-101-2.run"));
  EXPECT_EQ(Run(with({"--first-seed", "1"})).exit_code, 2);
  EXPECT_EQ(Run(with({"--tracks"})).exit_code, 2);
  EXPECT_EQ(Run(with({"--methods", "ours"})).exit_code, 2);
  EXPECT_EQ(Run({"--alerts"}).exit_code, 2);
  EXPECT_EQ(Run({"--scenes", "crossing", "--list", Path("five.csv")}).exit_code, 2);
  EXPECT_EQ(Run({"--methods", "ours", "--captures", Path("one"), Path("two")}).exit_code, 2);
}

TEST_F(EvalLine, AutoferryNeedsAFolderOfScenarios) {
  EXPECT_EQ(Run({"--autoferry", Path("none")}).exit_code, 2);
  fs::create_directory(Path("ferry"));
  EXPECT_EQ(Run({"--autoferry", Path("ferry")}).exit_code, 1);
  WriteFile(Path("ferry") + "/scenario7_lidar_detections.json",
            R"([{"ownshipPosition":[0,0],"time":1,"measurement":[10,0]},{"ownshipPosition":[0,0],"time":1.5,"measurement":[10,0]}])");
  EXPECT_EQ(Run({"--autoferry", Path("ferry")}).exit_code, 1) << "without its truth";
  WriteFile(Path("ferry") + "/scenario7_ground_truth.json", R"([[{"targetID":1,"position":[10,0,0],"time":1.25}]])");
  const auto result = Run({"--autoferry", Path("ferry")});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("open water"), std::string::npos) << result.output;
  EXPECT_EQ(Run({"--autoferry", Path("ferry"), "--scenes", "sparse"}).exit_code, 2);
  EXPECT_EQ(RunProgram({Bin("eval"), "--autoferry", Path("ferry")}, Path("out")).exit_code, 0) << "no boat of ours is needed";
  WriteFile(Path("page.md"), "<!-- figures: autoferry -->\n<!-- end -->\n");
  EXPECT_EQ(RunProgram({Bin("eval"), "--autoferry", Path("ferry"), "--blocks", Path("page.md")}, Path("out")).exit_code, 0);
  EXPECT_NE(ReadFile(Path("page.md")).find("| open water | nearest neighbour | 2 |"), std::string::npos) << ReadFile(Path("page.md"));
}

TEST_F(EvalLine, ATruthOfAnotherScenarioOfAutoferryIsRefused) {
  fs::create_directory(Path("ferry"));
  WriteFile(Path("ferry") + "/scenario7_lidar_detections.json",
            R"([{"ownshipPosition":[0,0],"time":1,"measurement":[10,0]},{"ownshipPosition":[0,0],"time":1.5,"measurement":[10,0]}])");
  WriteFile(Path("ferry") + "/scenario7_ground_truth.json", R"([[{"targetID":1,"position":[10,0,0],"time":100}]])");
  const auto result = Run({"--autoferry", Path("ferry")});
  EXPECT_EQ(result.exit_code, 1) << result.output;
  EXPECT_NE(result.output.find("are not of one run: no scan lies in the time of the truth"), std::string::npos) << result.output;
}

// The truth of another run once gave tables, exit code 0 and a MOTA of -106 %.
TEST_F(EvalLine, ATruthOfAnotherRunIsRefused) {
  const auto simulate = [&](const std::string& seed, const std::string& seconds) {
    const auto run = RunProgram({Bin("sim"), "--config", kCatabotConfig.string(), "--scene", "lake", "--seed", seed, "--seconds", seconds, "--pcap",
                                 Path(seed + ".pcap"), "--truth", Path(seed)},
                                Path("out"));
    ASSERT_EQ(run.exit_code, 0) << run.output;
  };
  simulate("1", "3");
  simulate("2", "3");
  const auto replay = RunProgram({Bin("replay"), "--config", kCatabotConfig.string(), "--in", Path("1.pcap"), "--out", Path("log")}, Path("out"));
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  const auto own = RunProgram({Bin("eval"), "--in", Path("log"), "--truth", Path("1")}, Path("out"));
  EXPECT_EQ(own.exit_code, 0) << own.output;
  EXPECT_EQ(own.output.find("the log covers"), std::string::npos) << own.output;
  const auto other = RunProgram({Bin("eval"), "--in", Path("log"), "--truth", Path("2")}, Path("out"));
  EXPECT_EQ(other.exit_code, 1) << other.output;
  EXPECT_NE(other.output.find("are not of one run: of "), std::string::npos) << other.output;
  EXPECT_EQ(other.output.find("MOTA"), std::string::npos) << other.output;
  const auto slice = RunProgram({Bin("log"), "slice", "--in", Path("log"), "--out", Path("part"), "--from", "1", "--to", "2"}, Path("out"));
  ASSERT_EQ(slice.exit_code, 0) << slice.output;
  const auto part = RunProgram({Bin("eval"), "--in", Path("part"), "--truth", Path("1")}, Path("out"));
  EXPECT_EQ(part.exit_code, 0) << part.output;
  EXPECT_NE(part.output.find("s of the 3.0 s of the truth"), std::string::npos) << part.output;
}

TEST_F(EvalLine, SeedsOfTuningCanBeLookedAtWithoutMakingATable) {
  const std::vector<std::string> line{"--tuning", "--scenes", "sparse", "--methods", "ours", "--seeds", "1", "--seconds", "0.3"};
  EXPECT_EQ(Run(line).exit_code, 0);
  auto with_file = line;
  with_file.insert(with_file.end(), {"--csv", Path("csv")});
  EXPECT_EQ(Run(with_file).exit_code, 2);
  EXPECT_FALSE(fs::exists(Path("csv")));
}

TEST_F(EvalLine, OutputsThatAreThereAreRefusedBeforeTheRunUnlessForced) {
  const std::vector<std::string> run{"--scenes", "sparse", "--methods", "ours", "--seeds", "1", "--seconds", "0.3"};
  const auto with = [&run](const std::vector<std::string>& more) {
    auto line = run;
    line.insert(line.end(), more.begin(), more.end());
    return line;
  };
  const auto read = [this](const std::string& name) {
    std::ifstream in(Path(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  std::ofstream(Path("page.html")) << "mine";
  fs::create_directories(Path("csv"));
  std::ofstream(Path("csv/table_1.csv")) << "mine";
  for (const auto& output : std::vector<std::vector<std::string>>{{"--html", Path("page.html")}, {"--csv", Path("csv")}}) {
    const auto result = Run(with(output));
    EXPECT_EQ(result.exit_code, 1) << output[0] << result.output;
    EXPECT_NE(result.output.find("--force"), std::string::npos) << result.output;
    EXPECT_EQ(result.output.find("mIoU"), std::string::npos) << "said before the run";
  }
  EXPECT_EQ(read("page.html"), "mine");
  EXPECT_EQ(read("csv/table_1.csv"), "mine");
  EXPECT_EQ(Run(with({"--html", Path("page.html"), "--csv", Path("csv"), "--force"})).exit_code, 0);
  EXPECT_NE(read("page.html"), "mine");
  EXPECT_NE(read("csv/table_1.csv"), "mine");
  EXPECT_FALSE(fs::exists(Path("page.html.partial")));
}

TEST_F(EvalLine, EvidenceThatKnowsWhatItIsScoredOnIsRefusedBeforeTheRun) {
  const auto out = Path("out.csv");
  const std::vector<std::string> line{"--scenes", "beach",   "--leave-out", "beach",     "--weights", Path("evidence"), "--methods",
                                      "ours",     "--seeds", "1",           "--seconds", "0.3",       "--lost",         out};
  EXPECT_EQ(Run(line).exit_code, 2) << "there is no such folder";
  fs::create_directories(Path("evidence"));
  const auto missing = Run(line);
  EXPECT_EQ(missing.exit_code, 2) << missing.output;
  EXPECT_NE(missing.output.find("without-beach.txtpb: is not there; lookout-fit --scenes families --without beach"), std::string::npos)
      << missing.output;
  const auto file = Path("evidence/without-beach.txtpb");
  std::ofstream(file) << "# Fitted on seeds 1 to 4, 0.5 s each, of beach, quay_side.\n";
  const auto known = Run(line);
  EXPECT_EQ(known.exit_code, 2) << known.output;
  EXPECT_NE(known.output.find("was fitted on beach"), std::string::npos) << known.output;
  EXPECT_FALSE(fs::exists(out));
  std::ofstream(file) << "# Fitted on seeds 1 to 4, 0.5 s each, of quay_side.\n" << ReadFile(kSources / "config/evidence/lookout.txtpb");
  const auto scored = Run(line);
  EXPECT_EQ(scored.exit_code, 0) << scored.output;
  EXPECT_NE(scored.output.find("ours, left out (all segments)"), std::string::npos) << scored.output;
  EXPECT_TRUE(ReadFile(out).starts_with("method,scene,seed,scan,")) << ReadFile(out);
  auto unknown = line;
  unknown[3] = "nowhere";
  EXPECT_NE(Run(unknown).output.find("no such family: nowhere"), std::string::npos);
}

TEST_F(EvalLine, SqueezeSegIsARowWithTheWeightsOfTheSources) {
  std::vector<std::string> line{"--scenes", "sparse", "--methods", "squeezeseg", "--seeds", "1", "--seconds", "0.3", "--csv", Path("csv")};
  const auto scored = Run(line);
  EXPECT_EQ(scored.exit_code, 0) << scored.output;
  EXPECT_NE(ReadFile(Path("csv/table_1.csv")).find("\nSqueezeSeg,"), std::string::npos) << scored.output;
  EXPECT_NE(ReadFile(Path("csv/table_3.csv")).find("\nSqueezeSeg,network,"), std::string::npos) << scored.output;
  fs::create_directories(Path("nothing"));
  line.insert(line.end(), {"--force", "--network", Path("nothing")});
  const auto refused = Run(line);
  EXPECT_EQ(refused.exit_code, 1) << refused.output;
  EXPECT_NE(refused.output.find("holds no weights"), std::string::npos) << refused.output;
}

// A table anywhere below the folder of --csv once was in the way, though nothing is written there.
TEST_F(EvalLine, TablesInSubfoldersAreNotInTheWay) {
  fs::create_directories(Path("csv/other"));
  std::ofstream(Path("csv/other/table_1.csv")) << "mine";
  const auto result = Run({"--scenes", "sparse", "--methods", "ours", "--seeds", "1", "--seconds", "0.3", "--csv", Path("csv")});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_TRUE(fs::exists(Path("csv/table_1.csv")));
  fs::create_directories(Path("svg/ours/sparse"));
  std::ofstream(Path("svg/ours/sparse/01.svg")) << "mine";
  EXPECT_EQ(Run({"--scenes", "sparse", "--methods", "ours", "--seeds", "1", "--seconds", "0.3", "--pictures", Path("svg")}).exit_code, 1);
}

TEST_F(EvalLine, BlocksAreFilledWithTheFiguresOfTheRun) {
  const std::string title = "# Title\n<!-- figures: ";
  const auto fill = [&](const std::string& name) {
    std::ofstream(Path("README.md")) << title << name << " -->\n<!-- end -->\n";
    return Run({"--scenes", "sparse", "--methods", "ours", "--seeds", "1", "--seconds", "0.3", "--blocks", Path("README.md")});
  };
  EXPECT_EQ(fill("main").exit_code, 0);
  std::ifstream in(Path("README.md"));
  const std::string text(std::istreambuf_iterator<char>(in), {});
  EXPECT_TRUE(text.starts_with(title + "main -->\n| method | mIoU, % |")) << text;
  EXPECT_NE(text.find("\n| ours (all segments) | "), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with(".\n<!-- end -->\n")) << text;
  const auto unknown = fill("two");
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.output.find("README.md:2: there are no figures of this name: two"), std::string::npos) << unknown.output;
  EXPECT_EQ(unknown.output.find("mIoU"), std::string::npos) << "said before the run";
}

TEST_F(EvalLine, CapturesThatAreNotHereAreSaidInTheTables) {
  const auto result = Run({"--scenes", "sparse", "--captures", Path("nothing"), "--methods", "ours", "--seeds", "1", "--seconds", "0.3"});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("not here"), std::string::npos) << result.output;
  EXPECT_EQ(Run({"--captures", Path("nothing")}).exit_code, 1) << "and there is nothing else";
  fs::create_directories(Path("empty"));
  EXPECT_EQ(Run({"--captures", Path("empty")}).exit_code, 1);
}

TEST_F(EvalLine, ADamagedCaptureEndsTheRunWithItsName) {
  for (const auto* ending : {".pcap.xz", ".truth.csv.xz", ".objects.csv.xz"})
    std::ofstream(Path("dense-1" + std::string(ending))) << "this was never packed by xz";
  const auto result = Run({"--captures", folder_.string(), "--methods", "ours", "--csv", Path("csv")});
  EXPECT_EQ(result.exit_code, 1) << result.output;
  EXPECT_NE(result.output.find("dense-1.objects.csv.xz:1: not compressed by xz"), std::string::npos) << result.output;
  EXPECT_FALSE(fs::exists(Path("csv")));
}

}  // namespace
}  // namespace lookout::system_test
