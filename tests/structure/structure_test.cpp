// The house rules that a compiler does not check: what code may do, and pages that must agree with it.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/services.hpp"
#include "tests/structure/sources.hpp"
#include "tests/support/files.hpp"

namespace {

namespace fs = std::filesystem;

using lookout::structure_test::SourcesBelow;
using lookout::support::kSources;
using lookout::support::ReadFile;

// A file that is written in another way can overwrite a recording, or stand half written under its name.
TEST(Structure, OutputsAreWrittenByOneClass) {
  const std::regex exempt("common/io/(output_file|file_lock)\\.cpp|common/bus/log_file\\.cpp|services/recorder/io/disk_writer\\.cpp");
  const std::regex writes(R"(ofstream|\bfopen\(|freopen|pcap_dump_open\(|lcm_eventlog_create|O_CREAT|std::fstream)");
  for (const auto& folder : {"common", "services", "tools", "lab"}) {
    for (const auto& file : SourcesBelow(kSources / folder)) {
      const std::string path = fs::relative(file, kSources).string();
      if (std::regex_match(path, exempt)) continue;
      std::smatch match;
      const std::string text = ReadFile(file);
      EXPECT_FALSE(std::regex_search(text, match, writes)) << path << " writes a file by " << match.str() << ", not through io::OutputFile";
    }
  }
}

// Names in logs, texts of messages and of configs reach the log of a process: no control character may pass to a terminal.
TEST(Structure, LinesOfTheLogAreMadePrintable) {
  for (const auto& folder : {"common", "services", "tools", "lab"}) {
    for (const auto& file : SourcesBelow(kSources / folder)) {
      const std::string path = fs::relative(file, kSources).string();
      const std::string text = ReadFile(file);
      EXPECT_EQ(text.find("spdlog::set_pattern"), std::string::npos) << path << ": use runtime::SetLogPattern";
      EXPECT_FALSE(std::regex_search(text, std::regex(R"(cerr[^;]*<< *error\.what\(\))"))) << path << " prints what() as it is: use PrintableLines";
    }
  }
}

TEST(Structure, OnlyMainIoAndRuntimeReadTheClock) {
  // The bus takes times of its handlers for HEALTH; they decide nothing.
  const std::regex exempt("common/runtime/.*|common/bus/bus\\.cpp|common/io/.*|services/[^/]+/(main\\.cpp|io/.*)");
  const std::regex clock(R"(_clock::now|\bHostNow\(|gettimeofday|clock_gettime|\btime\(nullptr\))");
  for (const auto& folder : {"common", "services"}) {
    for (const auto& file : SourcesBelow(kSources / folder)) {
      const std::string path = fs::relative(file, kSources).string();
      if (std::regex_match(path, exempt)) continue;
      EXPECT_FALSE(std::regex_search(ReadFile(file), clock)) << path << " reads a clock";
    }
  }
}

// A program that takes the user's locale writes a decimal comma where that locale has one, and reads none.
TEST(Structure, NoProgramTakesTheUsersLocale) {
  const std::regex locale(R"(\b(set|new|use)locale\s*\(|std::locale\b(?!::classic))");
  int num_checked = 0;
  for (const auto& folder : {"common", "services", "tools", "lab"}) {
    for (const auto& file : SourcesBelow(kSources / folder)) {
      EXPECT_FALSE(std::regex_search(ReadFile(file), locale)) << fs::relative(file, kSources).string() << " takes a locale";
      ++num_checked;
    }
  }
  EXPECT_GT(num_checked, 100);
}

// Functions whose results IEEE 754 does not fix differ between processors and C libraries. common/core/elementary.hpp has them. Eigen's angles call
// them too.
TEST(Structure, NothingThatReachesAMessageCallsFunctionsThatDependOnTheProcessor) {
  const std::regex call(
      R"re(\b(std::)?(a?(sin|cos|tan)h?|atan2|exp2?|expm1|log(2|10|1p)?|pow|hypot|cbrt|erfc?|lgamma|tgamma|fma|lerp|polar)f?\(|AngleAxis|\.slerp\(|angularDistance|eulerAngles|Rotation2D|std::complex|_distribution)re");
  int num_checked = 0;
  for (const auto& folder : {"common", "services", "tools/replay"}) {
    for (const auto& file : SourcesBelow(kSources / folder)) {
      std::istringstream text(ReadFile(file));
      int number = 0;
      for (std::string line; std::getline(text, line);) {
        ++number;
        const std::string code = line.substr(0, line.find("//"));
        EXPECT_FALSE(std::regex_search(code, call)) << fs::relative(file, kSources).string() << ":" << number << ": " << line;
        ++num_checked;
      }
    }
  }
  EXPECT_GT(num_checked, 10'000);
}

// Without these options sums are fused or taken in another order on another computer, and no test that runs on one computer notices.
TEST(Structure, AllThatReachesAMessageIsCompiledForTheSameBytes) {
  EXPECT_STREQ(LOOKOUT_WITHOUT_SAME_BYTES, "")
      << "these libraries are compiled without -ffp-contract=off or EIGEN_DONT_VECTORIZE (cmake/Targets.cmake)";
#if !defined(EIGEN_DONT_VECTORIZE)
  ADD_FAILURE() << "Eigen's kernels are on";
#endif
#if defined(__FAST_MATH__)
  ADD_FAILURE() << "the compiler may change the order of sums";
#endif
}

TEST(Structure, ReadmeOfTheTypesHoldsTheChannelTable) {
  const std::string readme = ReadFile(kSources / "lcmtypes/README.md");
  for (const auto& channel : lookout::bus::kChannels) {
    std::ostringstream row;
    row << "| " << channel.name << " | " << channel.type << " | " << channel.publisher << " | " << channel.max_rate_hz << " | " << channel.queue_depth
        << " |";
    EXPECT_NE(readme.find(row.str()), std::string::npos) << "lcmtypes/README.md lacks or differs from: " << row.str();
  }
}

TEST(Structure, ReadmeNamesEveryProgram) {
  const std::string readme = ReadFile(kSources / "README.md");
  for (const auto& folder : {"services", "tools", "lab"}) {
    for (const auto& entry : fs::directory_iterator(kSources / folder)) {
      if (!entry.is_directory()) continue;
      const std::string program = "lookout-" + entry.path().filename().string();
      const bool is_program = ReadFile(entry.path() / "CMakeLists.txt").find("lookout_program(") != std::string::npos;
      if (is_program) {
        EXPECT_NE(readme.find(program), std::string::npos) << "README.md does not name " << program;
      }
      EXPECT_TRUE(fs::exists(entry.path() / "README.md")) << entry.path() << " has no README.md";
    }
  }
}

std::vector<std::string_view> InputsOf(const lookout::bus::ServiceRow& service) {
  std::vector<std::string_view> names;
  for (const auto* channel : service.inputs) {
    if (channel != nullptr) names.push_back(channel->name);
  }
  return names;
}

std::vector<std::string_view> OutputsOf(const lookout::bus::ServiceRow& service) {
  std::vector<std::string_view> names;
  for (const auto& channel : lookout::bus::kChannels) {
    if (lookout::bus::Publishes(service, channel)) names.push_back(channel.name);
  }
  return names;
}

TEST(Structure, ReadmeOfDeployHoldsTheServiceTable) {
  const std::string readme = ReadFile(kSources / "deploy/README.md");
  for (const auto& service : lookout::bus::kServices) {
    std::ostringstream row;
    row << "| " << service.name << " | " << service.purpose << " | " << service.state << " | " << service.hangup << " | " << service.watchdog_s
        << " |";
    EXPECT_NE(readme.find(row.str()), std::string::npos) << "deploy/README.md lacks or differs from: " << row.str();
  }
}

TEST(Structure, ReadmeSaysWhatEachServiceReadsAndPublishes) {
  std::istringstream readme(ReadFile(kSources / "README.md"));
  std::size_t num_rows = 0;
  for (std::string line; std::getline(readme, line);) {
    for (const auto& service : lookout::bus::kServices) {
      if (!line.starts_with("| [lookout-" + std::string(service.name) + "](services/")) continue;
      ++num_rows;
      for (const auto& names : {InputsOf(service), OutputsOf(service)}) {
        for (const auto name : names) EXPECT_NE(line.find(name), std::string::npos) << "README.md, " << service.name << " lacks " << name;
      }
    }
  }
  EXPECT_EQ(num_rows, lookout::bus::kServices.size());
}

// It handles SIGHUP for each.
TEST(Structure, EachServiceUsesTheSharedMain) {
  for (const auto& service : lookout::bus::kServices) {
    EXPECT_NE(ReadFile(kSources / "services" / service.name / "main.cpp").find("runtime::ServiceMain<"), std::string::npos) << service.name;
  }
}

TEST(Structure, TheServiceTableSaysWhatSighupDoes) {
  for (const auto& service : lookout::bus::kServices) {
    const std::string main = ReadFile(kSources / "services" / service.name / "main.cpp");
    const bool begins_run = main.find("Hangup::kNewRun") != std::string::npos;
    const bool has_handler = main.find("OnHangup(") != std::string::npos;
    EXPECT_EQ(service.hangup, begins_run ? "new config, new run" : has_handler ? "new log" : "checks the config") << service.name;
  }
}

// Readers start first: what they read, but for answers to what they publish, is published by a service above them.
TEST(Structure, TheServiceTableIsInTheOrderOfTheData) {
  std::vector<std::string_view> above;
  for (const auto& service : lookout::bus::kServices) {
    for (const auto* input : service.inputs) {
      if (input == nullptr || input->is_raw) continue;
      EXPECT_NE(std::ranges::find(above, input->publisher), above.end()) << service.name << " reads " << input->name;
    }
    above.push_back(service.role);
  }
}

// A channel has one publisher: who takes the place of another takes its row.
TEST(Structure, EachRoleIsFilledByOneService) {
  for (const auto& service : lookout::bus::kServices) {
    EXPECT_EQ(std::ranges::count(lookout::bus::kServices, service.role, &lookout::bus::ServiceRow::role), 1) << service.role;
  }
  for (const auto& channel : lookout::bus::kChannels) {
    const bool is_filled =
        std::ranges::find(lookout::bus::kServices, channel.publisher, &lookout::bus::ServiceRow::role) != lookout::bus::kServices.end();
    EXPECT_TRUE(is_filled || lookout::bus::HasSeveralPublishers(channel) || channel.publisher == "sim")
        << channel.name << " of " << channel.publisher;
  }
}

// A README says what a folder is and how to use it; why it became so stands beside it, with dates.
TEST(Structure, DecisionsStandBesideTheReadmeAndBeginWithADate) {
  const std::regex dated(R"(^(\*\*)?20[0-9]{2}-[0-9]{2}-[0-9]{2}[.,: *])");
  int num_files = 0;
  for (const auto& folder : {"common", "config", "deploy", "lcmtypes", "services", "tests", "tools", "lab"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kSources / folder)) {
      const std::string path = fs::relative(entry.path(), kSources).string();
      if (entry.path().filename() == "README.md") {
        EXPECT_EQ(ReadFile(entry.path()).find("\n## Decisions"), std::string::npos) << path << ": decisions stand in DECISIONS.md";
      }
      if (entry.path().filename() != "DECISIONS.md") continue;
      ++num_files;
      const std::string text = ReadFile(entry.path());
      EXPECT_EQ(text.rfind("# Decisions", 0), 0U) << path << " has no heading";
      const auto first = text.find_first_not_of('\n', std::min(text.find('\n'), text.size()));
      ASSERT_NE(first, std::string::npos) << path << " is empty";
      EXPECT_TRUE(std::regex_search(text.substr(first, 20), dated)) << path << " does not begin with a date";
      const fs::path readme = entry.path().parent_path() / "README.md";
      if (!fs::exists(readme)) continue;
      EXPECT_NE(ReadFile(readme).find("(DECISIONS.md)"), std::string::npos) << path << " is not named in the README beside it";
    }
  }
  EXPECT_GT(num_files, 15);
}

// As the usual viewers make it of a heading: lower case, blanks as "-", no punctuation.
std::string AnchorOf(const std::string& heading) {
  std::string anchor;
  for (const char letter : heading) {
    const auto byte = static_cast<unsigned char>(letter);
    if (std::isalnum(byte) != 0 || letter == '-' || letter == '_') anchor += static_cast<char>(std::tolower(byte));
    if (letter == ' ') anchor += '-';
  }
  return anchor;
}

std::vector<fs::path> Pages() {
  std::vector<fs::path> pages;
  for (const auto& entry : fs::directory_iterator(kSources)) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  for (const auto& folder : {"config", "deploy", "lcmtypes", "logs", "services", "tests", "tools", "lab"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kSources / folder)) {
      const bool is_ours = entry.path().string().find("/node_modules/") == std::string::npos;
      if (is_ours && entry.path().extension() == ".md") pages.push_back(entry.path());
    }
  }
  std::ranges::sort(pages);
  return pages;
}

TEST(Structure, LinksBetweenPagesLeadSomewhere) {
  const std::regex link(R"(\]\(([^)#]*)(#([^)]*))?\))");
  const std::regex heading(R"((^|\n)#+ ([^\n]*))");
  int num_links = 0;
  for (const auto& page : Pages()) {
    const std::string text = ReadFile(page);
    for (std::sregex_iterator match(text.begin(), text.end(), link), end; match != end; ++match) {
      const std::string target = (*match)[1];
      if (target.rfind("http", 0) == 0) continue;
      const fs::path file = target.empty() ? page : page.parent_path() / target;
      ASSERT_TRUE(fs::exists(file)) << page << " leads to " << target << ", which is not there";
      ++num_links;
      const std::string anchor = (*match)[3];
      if (anchor.empty()) continue;
      const std::string other = ReadFile(file);
      bool is_there = false;
      for (std::sregex_iterator found(other.begin(), other.end(), heading); found != end; ++found) is_there |= AnchorOf((*found)[2]) == anchor;
      EXPECT_TRUE(is_there) << page << " leads to " << target << "#" << anchor << ", and there is no such heading";
    }
  }
  EXPECT_GT(num_links, 30);
}

// Messages that a user looks up are those that the programs print. "..." stands for what differs.
TEST(Structure, TroubleshootingCitesMessagesOfTheCode) {
  std::string code;
  for (const auto& folder : {"common", "services", "tools", "lab"}) {
    for (const auto& file : SourcesBelow(kSources / folder)) code += ReadFile(file);
  }
  code += ReadFile(kSources / "deploy/lookout-up.in");
  const std::regex joints("\"\\s*\"");  // a literal that goes on in the next line
  code = std::regex_replace(code, joints, "");
  code += " has no field named ";  // Protobuf's
  std::istringstream page(ReadFile(kSources / "TROUBLESHOOTING.md"));
  const std::regex quoted("`([^`]*)`");
  int num_pieces = 0;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("| ", 0) != 0) continue;
    const std::string cell = line.substr(2, line.find(" | ", 2) - 2);
    for (std::sregex_iterator match(cell.begin(), cell.end(), quoted), end; match != end; ++match) {
      std::string message = (*match)[1];
      for (std::size_t from = 0; from < message.size();) {
        const auto to = std::min(message.find("...", from), message.size());
        const std::string piece = message.substr(from, to - from);
        if (piece.size() > 2) {
          EXPECT_NE(code.find(piece), std::string::npos) << "no program says: " << piece;
          ++num_pieces;
        }
        from = to + 3;
      }
    }
  }
  EXPECT_GT(num_pieces, 50);
}

// A promise that no test holds is none.
TEST(Structure, EachPromiseOfThePageOnSecurityNamesTestsThatAreThere) {
  std::string tests;
  std::string lists;
  for (const auto& file : SourcesBelow(kSources / "tests")) tests += ReadFile(file);
  for (const auto& entry : fs::recursive_directory_iterator(kSources / "tests")) {
    if (entry.path().filename() == "CMakeLists.txt") lists += ReadFile(entry.path());
  }
  std::istringstream page(ReadFile(kSources / "SECURITY.md"));
  const std::regex quoted("`([^`]*)`");
  bool is_in_table = false;
  int num_named = 0;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| promise ")) is_in_table = true;
    if (!line.starts_with("|")) is_in_table = false;
    if (!is_in_table || line.starts_with("| promise ") || line.starts_with("|-")) continue;
    const auto cell = line.substr(line.find(" | ") + 1);
    int num_of_promise = 0;
    for (std::sregex_iterator match(cell.begin(), cell.end(), quoted), end; match != end; ++match, ++num_of_promise) {
      const std::string name = (*match)[1];
      const auto dot = name.find('.');
      const auto is_in = [](const std::string& text, const std::vector<std::string>& pieces) {
        return std::ranges::any_of(pieces, [&text](const std::string& piece) { return text.find(piece) != std::string::npos; });
      };
      if (dot == std::string::npos) {
        EXPECT_TRUE(is_in(lists, {"NAME " + name + " ", "NAME " + name + "\n"})) << "no test program: " << name;
      } else {
        const auto arguments = "(" + name.substr(0, dot) + ", " + name.substr(dot + 1) + ")";
        EXPECT_TRUE(is_in(tests, {"TEST" + arguments, "TEST_F" + arguments, "TEST_P" + arguments})) << "no test: " << name;
      }
    }
    EXPECT_GT(num_of_promise, 0) << "held by no test: " << line;
    num_named += num_of_promise;
  }
  EXPECT_GT(num_named, 30);
}

// What is not in the table is neither in systemd's units nor started by lookout-up.
TEST(Structure, TheServiceTableNamesEveryService) {
  std::vector<std::string> in_table = lookout::bus::StartOrder();
  std::vector<std::string> in_folder;
  for (const auto& entry : fs::directory_iterator(kSources / "services")) {
    if (entry.is_directory()) in_folder.push_back(entry.path().filename().string());
  }
  std::ranges::sort(in_table);
  std::ranges::sort(in_folder);
  EXPECT_EQ(in_table, in_folder);
}

}  // namespace
