// Figures of README files: a block shows what the run has made, and nothing else.
#include "lab/eval/methods/figures.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <regex>

#include "tests/support/files.hpp"
#include "tests/unit/eval_report/made_up.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;

using support::kSources;
using support::ReadFile;

const std::vector<ReadmeFigure> kFigures = [] {
  Table table({"method", "%"});
  table.Add({"ours", "1.5"});
  table.Add({"a, \"b\"|c", "2"});
  return std::vector<ReadmeFigure>{{"main", {"Caption.", "More."}, table}};
}();

std::string Fill(const std::string& text) { return FillBlocks(text, kFigures, "README.md"); }

std::string Fault(const std::string& text) {
  try {
    Fill(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

constexpr const char* kFilled =
    "<!-- figures: main -->\n| method | % |\n|---|---|\n| ours | 1.5 |\n| a, \"b\"\\|c | 2 |\n\nCaption.\nMore.\n<!-- end -->\n";

TEST(Figures, ABlockIsFilledAndAllElseStays) {
  EXPECT_EQ(Fill("Text 1.\n\n<!-- figures: main -->\nold\n| x |\n<!-- end -->\nText 2."), std::string("Text 1.\n\n") + kFilled + "Text 2.");
  EXPECT_EQ(Fill(kFilled), kFilled);
  EXPECT_EQ(Fill("<!-- figures: main -->\n<!-- end -->\n"), kFilled);
  EXPECT_EQ(Fill("no block\n"), "no block\n");
  EXPECT_EQ(Fill("<!-- another comment -->\n"), "<!-- another comment -->\n");
  EXPECT_EQ(Fill(""), "");
}

TEST(Figures, ABlockOfAFigureThatTheRunHasNotMadeStays) {
  const std::string sweeps = "<!-- figures: sweeps -->\nold\n<!-- end -->";
  EXPECT_EQ(Fill(sweeps), sweeps);
  EXPECT_EQ(Fill(sweeps + "\n<!-- figures: main -->\nold\n<!-- end -->\n"), sweeps + "\n" + kFilled);
}

TEST(Figures, ABlockThatIsNotWholeIsRefusedWithItsLine) {
  EXPECT_EQ(Fault("\n<!-- figures: main -->\ntext\n"), "README.md:2: this block of figures has no end");
  EXPECT_EQ(Fault("<!-- figures: main -->\n<!-- figures: main -->\n<!-- end -->\n"), "README.md:1: this block of figures has no end");
  EXPECT_EQ(Fault("\n\n<!-- end -->\n"), "README.md:3: the end of a block of figures that does not begin");
  EXPECT_EQ(Fault("<!-- figures: two -->\n<!-- end -->\n"), "README.md:1: there are no figures of this name: two");
  EXPECT_EQ(Fault("<!-- figures: ../main -->\n<!-- end -->\n"), "README.md:1: there are no figures of this name: ../main");
  EXPECT_EQ(Fault("<!-- figures: main\n<!-- end -->\n"), "README.md:1: a block of figures must begin as <!-- figures: NAME -->");
}

TEST(Figures, AreMadeOfTheResults) {
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
  for (const auto& figure : figures) {
    const auto block = "<!-- figures: " + figure.name + " -->\n";
    const auto text = FillBlocks(block + "<!-- end -->\n", figures, "");
    EXPECT_TRUE(text.starts_with(block + "| " + figure.table.header().front() + " |")) << text;
    EXPECT_NE(text.find("\nMeasured 2026-11-22 by"), std::string::npos) << text;
  }
}

// A mean over scenes, whatever table shows it: scenes differ in how many things they hold.
TEST(Figures, OneNameIsOneFigureInAllBlocks) {
  auto results = MadeUpResults();
  results.methods[0].method = "F3D (tuned)";
  results.methods[0].by_scene["rain"].with_segment = {80, 20};
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
TEST(Figures, OfTimesMediansAloneAreShown) {
  for (const auto& figure : FiguresOf(MadeUpResults(), "2026-11-22")) {
    for (const auto& column : figure.table.rows().at(0)) {
      EXPECT_EQ(column.find("p99"), std::string::npos) << figure.name;
      EXPECT_EQ(column.find("percentile"), std::string::npos) << figure.name;
    }
    if (figure.name != "times") continue;
    EXPECT_EQ(figure.table.rows().at(1), (std::vector<std::string>{"ours", "1.250"}));
  }
}

TEST(Figures, AWorldThatIsNotHereIsSaid) {
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

TEST(Figures, ASweepIsARowOfMeansOverItsScenes) {
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

// `./dev figures` fills all blocks: those of one name show the same, and each says when it was measured.
TEST(ReadmeFiles, ShowEachFigureOnceMeasured) {
  const std::regex block("\n<!-- figures: ([^\n]*) -->\n([^]*?)<!-- end -->\n");
  const std::regex measured("\nMeasured 20[0-9-]{8} by `./dev figures`, version [0-9.]+\\.\n");
  std::map<std::string, std::string> shown;
  int num_blocks = 0;
  for (auto entry = fs::recursive_directory_iterator(kSources); entry != fs::recursive_directory_iterator(); ++entry) {
    const auto name = entry->path().filename().string();
    if (entry->is_directory() && (name == "build" || name.starts_with("."))) {
      entry.disable_recursion_pending();
      continue;
    }
    if (!entry->is_regular_file() || entry->path().extension() != ".md") continue;
    const auto text = ReadFile(entry->path());
    ASSERT_NO_THROW(FillBlocks(text, {}, entry->path().string()));
    for (std::sregex_iterator match(text.begin(), text.end(), block), end; match != end; ++match, ++num_blocks) {
      EXPECT_TRUE(std::regex_search((*match)[2].str(), measured)) << entry->path() << ": " << (*match)[1];
      const auto [first, is_new] = shown.try_emplace((*match)[1], (*match)[2]);
      EXPECT_TRUE(is_new || first->second == (*match)[2]) << entry->path() << " shows other figures than another page: " << (*match)[1];
    }
  }
  EXPECT_GE(num_blocks, 5);
}

}  // namespace
}  // namespace lookout::eval
