// The pages and the prose in the code: short enough to read, in the project's terms, and true to the files that they name.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/files.hpp"

namespace {

namespace fs = std::filesystem;

using lookout::support::kSources;
using lookout::support::ReadFile;

std::vector<fs::path> FilesWithEnding(const std::vector<std::string>& endings) {
  std::vector<fs::path> files;
  const auto add = [&](const fs::path& file) {
    if (std::ranges::find(endings, file.extension().string()) != endings.end()) files.push_back(file);
  };
  for (const auto& entry : fs::directory_iterator(kSources)) add(entry.path());
  for (const auto& folder : {"common", "config", "deploy", "lcmtypes", "logs", "services", "tests", "tools", "lab"}) {
    for (auto entry = fs::recursive_directory_iterator(kSources / folder); entry != fs::recursive_directory_iterator(); ++entry) {
      // Packages of npm, and what is built of them, are written by others.
      if (entry->path().filename() == "node_modules" || entry->path().filename() == "vendor") {
        entry.disable_recursion_pending();
      } else {
        add(entry->path());
      }
    }
  }
  std::ranges::sort(files);
  return files;
}

// The lines of a page that are prose: no table, no block of code, no block that a tool fills.
std::vector<std::string> ProseOf(const fs::path& page) {
  std::vector<std::string> prose;
  std::istringstream text(ReadFile(page));
  bool is_code = false;
  bool is_filled = false;
  for (std::string line; std::getline(text, line);) {
    const bool is_fence = line.find("```") != std::string::npos;
    if (is_fence) is_code = !is_code;
    if (line.starts_with("<!-- figures:")) is_filled = true;
    if (!is_code && !is_fence && !is_filled && !line.starts_with("|")) prose.push_back(line);
    if (line.starts_with("<!-- end -->")) is_filled = false;
  }
  return prose;
}

TEST(Pages, OfAReadmeHaveAtMost150LinesApartFromTables) {
  int num_pages = 0;
  for (const auto& page : FilesWithEnding({".md"})) {
    if (page.filename() != "README.md") continue;
    EXPECT_LE(ProseOf(page).size(), 150U) << page;
    ++num_pages;
  }
  EXPECT_GT(num_pages, 15);
}

TEST(Pages, TheFirstPageFitsOnTwoScreens) {
  std::istringstream text(ReadFile(kSources / "README.md"));
  int num_lines = 0;
  for (std::string line; std::getline(text, line);) ++num_lines;
  EXPECT_LE(num_lines, 120);
}

TEST(Pages, HaveNoLongLineOutsideOfTables) {
  for (const auto& page : FilesWithEnding({".md"})) {
    for (const auto& line : ProseOf(page)) EXPECT_LE(line.size(), 160U) << page << ": " << line;
  }
}

// Words of a dialect that only its authors spoke; CONTRIBUTING.md has the terms.
TEST(Pages, AndCodeUseTheTermsOfTheField) {
  const std::regex dialect(
      R"(way of the data|throng|what is of it|the order of nothing|of no even stream|TellWhatIsKnown|CarryOn\b|lookout_room|)"
      R"((whole|partial|half a|per|each|every) turn\b|turns? of the (lidar|sensor|head|scanner)\b|TurnGatherer|TurnCollector|TurnPicker)",
      std::regex::icase);
  for (const auto& file : FilesWithEnding({".md", ".cpp", ".hpp", ".java", ".proto", ".lcm", ".txt", ".cmake", ".txtpb", ".in"})) {
    if (file.filename() == "pages_test.cpp" || file.filename() == "CONTRIBUTING.md" || file.filename() == "CHANGELOG.md") continue;
    std::istringstream text(ReadFile(file));
    int number = 0;
    for (std::string line; std::getline(text, line);) {
      ++number;
      std::smatch match;
      EXPECT_FALSE(std::regex_search(line, match, dialect)) << file << ":" << number << ": " << match.str();
    }
  }
}

// Tables of CONTRIBUTING.md, as "From packet to alert": each row of three columns names a file, and something that stands in it.
TEST(Pages, TheWalkForNewcomersNamesWhatIsThere) {
  const std::regex row(R"(^\| ([^|]+) \| `([^`]+)` \| `([^`]+)` \|$)");
  std::istringstream page(ReadFile(kSources / "CONTRIBUTING.md"));
  int num_rows = 0;
  for (std::string line; std::getline(page, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, row)) continue;
    const fs::path file = kSources / match[2].str();
    ASSERT_TRUE(fs::exists(file)) << file;
    EXPECT_TRUE(std::regex_search(ReadFile(file), std::regex("\\b" + match[3].str() + "\\b"))) << file << " has no " << match[3];
    ++num_rows;
  }
  EXPECT_GE(num_rows, 10);
}

}  // namespace
