// Figures of README files: a block shows what its CSV file holds, and nothing else.
#include "tools/eval/figures.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

#include "tests/support/files.hpp"
#include "tests/unit/eval_report/made_up.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;

using support::kSources;
using support::ReadFile;

class Figures : public ::testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder_ / "one.csv") << "# Caption.\n# More.\nmethod,%\nours,1.5\n\"a, \"\"b\"\"|c\",2\n"; }

  std::string Fill(const std::string& text) const { return FillBlocks(text, folder_, "README.md"); }
  std::string Fault(const std::string& text) const {
    try {
      Fill(text);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  static constexpr const char* kFilled =
      "<!-- figures: one -->\n| method | % |\n|---|---|\n| ours | 1.5 |\n| a, \"b\"\\|c | 2 |\n\nCaption.\nMore.\n<!-- end -->\n";
  support::TempDir folder_;
};

TEST_F(Figures, ABlockIsFilledAndAllElseStays) {
  EXPECT_EQ(Fill("Text 1.\n\n<!-- figures: one -->\nold\n| x |\n<!-- end -->\nText 2."), std::string("Text 1.\n\n") + kFilled + "Text 2.");
  EXPECT_EQ(Fill(kFilled), kFilled);
  EXPECT_EQ(Fill("<!-- figures: one -->\n<!-- end -->\n"), kFilled);
  EXPECT_EQ(Fill("no block\n"), "no block\n");
  EXPECT_EQ(Fill("<!-- another comment -->\n"), "<!-- another comment -->\n");
  EXPECT_EQ(Fill(""), "");
}

TEST_F(Figures, ABlockThatIsNotWholeIsRefusedWithItsLine) {
  EXPECT_EQ(Fault("\n<!-- figures: one -->\ntext\n"), "README.md:2: this block of figures has no end");
  EXPECT_EQ(Fault("<!-- figures: one -->\n<!-- figures: one -->\n<!-- end -->\n"), "README.md:1: this block of figures has no end");
  EXPECT_EQ(Fault("\n\n<!-- end -->\n"), "README.md:3: the end of a block of figures that does not begin");
  EXPECT_EQ(Fault("<!-- figures: two -->\n<!-- end -->\n"), "README.md:1: there are no figures of this name: two");
  EXPECT_EQ(Fault("<!-- figures: ../one -->\n<!-- end -->\n"), "README.md:1: there are no figures of this name: ../one");
  EXPECT_EQ(Fault("<!-- figures: one\n<!-- end -->\n"), "README.md:1: a block of figures must begin as <!-- figures: NAME -->");
}

TEST_F(Figures, AFileThatIsNoFigureIsRefusedWithItsLine) {
  const auto fault = [](const std::string& csv) -> std::string {
    try {
      ToMarkdown(csv, "x.csv");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(fault("# only a caption\n"), "x.csv: holds no table");
  EXPECT_EQ(fault("a,b\n1\n"), "x.csv:2: not as many cells as the header has");
  EXPECT_EQ(fault("a,b\n1,\"2\n"), "x.csv:2: a quote is not closed");
  EXPECT_EQ(fault("a,b\n# late\n"), "x.csv:2: a caption below the table");
}

TEST_F(Figures, AreMadeOfTheResultsAndReplacedOnlyWhenForced) {
  auto results = MadeUpResults();
  results.methods[0].method = "ours (all segments)";
  auto other = results;
  other.world = "second world";
  results.other_worlds = {other};
  const auto figures = FiguresOf(results, "2026-11-22");
  const auto main = std::ranges::find(figures, "main", &ReadmeFigure::name);
  ASSERT_NE(main, figures.end());
  // Of two scenes with objects; the third counts for false segments.
  EXPECT_EQ(main->table.rows().at(1), (std::vector<std::string>{"ours (all segments)", "85.2", "0.50", "87.5", "-", "85.2", "0.50", "87.5"}));
  EXPECT_EQ(main->table.rows().at(0).at(5), "second world: mIoU, %");
  const auto miou = std::ranges::find(figures, "miou", &ReadmeFigure::name);
  ASSERT_NE(miou, figures.end());
  const auto& header = miou->table.rows().at(0);
  EXPECT_EQ(header.at(1), "mean");
  EXPECT_EQ(header.at(2), "second world: mean") << "side by side";
  EXPECT_EQ(header.at(4), "second world: dense");
  const auto scope = std::ranges::find_if(main->captions, [](const std::string& line) { return line.starts_with("Own simulator: "); });
  ASSERT_NE(scope, main->captions.end());
  EXPECT_NE(scope->find("mean over the 2 with objects (open<water> counts for false segments alone)"), std::string::npos) << *scope;

  WriteFigures(figures, folder_ / "new", false);
  const auto text = ReadFile(folder_ / "new/main.csv");
  EXPECT_NE(text.find("# Measured 2026-11-22 by"), std::string::npos);
  EXPECT_THROW(WriteFigures(figures, folder_ / "new", false), std::runtime_error);
  EXPECT_NO_THROW(WriteFigures(figures, folder_ / "new", true));
  EXPECT_EQ(ReadFile(folder_ / "new/main.csv"), text);
  EXPECT_NE(FillBlocks("<!-- figures: main -->\n<!-- end -->\n", folder_ / "new", "").find("| ours (all segments) | 85.2 |"), std::string::npos);
}

// A mean over scenes, whatever table shows it: scenes differ in how many things they hold.
TEST_F(Figures, OneNameIsOneFigureInAllBlocks) {
  auto results = MadeUpResults();
  results.methods[0].method = "F3D (tuned)";
  auto& rain = results.methods[0].by_scene["rain"];
  rain.num_things = 80;
  rain.num_things_with_segment = 20;
  const auto cell = [figures = FiguresOf(results, "2026-11-22")](const std::string& name, const std::string& column) -> std::string {
    const auto figure = std::ranges::find(figures, name, &ReadmeFigure::name);
    if (figure == figures.end()) return "no " + name;
    const auto& header = figure->table.rows().at(0);
    const auto found = std::ranges::find(header, column);
    if (found == header.end()) return "no " + column;
    return figure->table.rows().at(1).at(static_cast<std::size_t>(found - header.begin()));
  };
  EXPECT_EQ(cell("main", "method"), "F3D (tuned)");
  EXPECT_EQ(cell("with-segment", "mean"), "56.2") << "of 7/8 and 20/80";
  EXPECT_EQ(cell("main", "things with a segment, %"), "56.2");
  EXPECT_EQ(cell("peers", "with_segment_%"), "56.2");
  EXPECT_EQ(cell("main", "mIoU, %"), cell("miou", "mean"));
  EXPECT_EQ(cell("main", "false a scan"), cell("false", "mean"));
}

// On a computer that does other work the slowest scan in a hundred says nothing about the method.
TEST_F(Figures, OfTimesMediansAloneAreShown) {
  for (const auto& figure : FiguresOf(MadeUpResults(), "2026-11-22")) {
    for (const auto& column : figure.table.rows().at(0)) {
      EXPECT_EQ(column.find("p99"), std::string::npos) << figure.name;
      EXPECT_EQ(column.find("percentile"), std::string::npos) << figure.name;
    }
    if (figure.name != "times") continue;
    EXPECT_EQ(figure.table.rows().at(1), (std::vector<std::string>{"ours", "1.250"}));
  }
}

TEST_F(Figures, AWorldThatIsNotHereIsSaid) {
  auto results = MadeUpResults();
  results.methods[0].method = "ours (all segments)";
  results.other_worlds.emplace_back();
  results.other_worlds[0].world = "second world";
  results.other_worlds[0].is_here = false;
  for (const auto& figure : FiguresOf(results, "2026-11-22")) {
    if (figure.name == "tests") continue;  // on scenes of their own
    EXPECT_TRUE(std::ranges::find(figure.captions, "The second world: not here.") != figure.captions.end()) << figure.name;
    if (figure.name == "main" || figure.name == "miou") {
      EXPECT_EQ(figure.table.rows().at(0).back(), "second world");
      EXPECT_EQ(figure.table.rows().at(1).back(), "not here");
    }
  }
}

TEST_F(Figures, ASweepIsARowOfMeansOverItsScenes) {
  Results results;
  Curve curve{"Sweep of link_m", "link_m", "mIoU of all segments, %", {{"a", {{0.2, 90.0}, {0.3, 80.0}}}, {"b", {{0.2, 70.0}, {0.3, 90.0}}}}, ""};
  curve.value_of_boat = "0.3";
  curve.scans_from = "seeds 1 to 4, 0.6 s each";
  results.curves = {curve};
  const auto figures = FiguresOf(results, "2026-11-22");
  ASSERT_EQ(figures.size(), 1U);
  EXPECT_EQ(figures[0].name, "sweeps");
  EXPECT_EQ(figures[0].table.rows().at(1), (std::vector<std::string>{"`link_m`", "0.3", "0.2 / 0.3", "80.0 / 85.0"}));
  EXPECT_NE(figures[0].captions.at(0).find("mean over the 2 scenes with objects, on seeds of tuning (seeds 1 to 4, 0.6 s each)"), std::string::npos);
}

// `./dev figures` writes both; whoever edits one by hand is told here.
TEST(ReadmeFiles, ShowWhatTheCommittedFiguresHold) {
  int num_blocks = 0;
  for (auto entry = fs::recursive_directory_iterator(kSources); entry != fs::recursive_directory_iterator(); ++entry) {
    const auto name = entry->path().filename().string();
    if (entry->is_directory() && (name == "build" || name.starts_with("."))) {
      entry.disable_recursion_pending();
      continue;
    }
    if (!entry->is_regular_file() || entry->path().extension() != ".md") continue;
    const auto text = ReadFile(entry->path());
    for (auto at = text.find("\n<!-- figures: "); at != std::string::npos; at = text.find("\n<!-- figures: ", at + 1)) ++num_blocks;
    std::string filled;
    ASSERT_NO_THROW(filled = FillBlocks(text, kSources / "tools/eval/figures", entry->path().string()));
    EXPECT_TRUE(filled == text) << entry->path() << " shows other figures than tools/eval/figures: run ./dev figures, or lookout-eval --figures "
                                << "tools/eval/figures --blocks " << entry->path().string();
  }
  EXPECT_GE(num_blocks, 5);
}

}  // namespace
}  // namespace lookout::eval
