// The contract of the wire: names, members and fingerprints of all types stand still.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/schema.hpp"
#include "tests/support/files.hpp"

namespace lookout {
namespace {

const std::filesystem::path kRoot = support::kSources;
const std::filesystem::path kGolden = "tests/golden/fingerprints.txt";

using support::ReadFile;

// Names of the files lcmtypes/*.lcm, without ending.
std::set<std::string> TypeFiles() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kRoot / "lcmtypes")) {
    if (entry.path().extension() == ".lcm") names.insert(entry.path().stem().string());
  }
  return names;
}

std::string CurrentTable() {
  std::ostringstream table;
  for (const auto& [type, fingerprint, has_seq] : bus::TypeFingerprints()) {
    table << type << ' ' << std::hex << std::setfill('0') << std::setw(16) << fingerprint << '\n';
  }
  return table.str();
}

// Members of a type as they stand in its file: "int32_t num_cells;int16_t range[num_cells];..." without comments, constants and line ends.
std::string MembersOf(const std::string& type) {
  std::istringstream file(ReadFile(kRoot / "lcmtypes" / (type + ".lcm")));
  std::string members;
  bool is_inside = false;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line.substr(0, line.find("//")));
    std::string member;
    for (std::string word; words >> word;) member += (member.empty() ? "" : " ") + word;
    if (is_inside && member.find(';') != std::string::npos && !member.starts_with("const ")) members += member;
    is_inside = (is_inside || member.find('{') != std::string::npos) && member.find('}') == std::string::npos;
  }
  EXPECT_FALSE(members.empty()) << type;
  return members;
}

TEST(Fingerprints, AreThoseOfTheFirstRecording) {
  const std::string golden = ReadFile(kRoot / kGolden);
  EXPECT_EQ(golden, CurrentTable())
      << "The fingerprint of a wire type has changed: logs and programs of before cannot be read any more.\n"
      << "Right is, for a type that has been recorded: leave it as it was and add a type with a new name beside it.\n"
      << "Only for a type that is new, or that no log holds yet: put its line (above) into " << kGolden
      << ",\nlines by name, in a commit of its own that says why. Never change the line of a type that stands in a log.";
}

TEST(Fingerprints, HaveNoTwins) {
  std::map<std::uint64_t, std::string> by_fingerprint;
  for (const auto& [type, fingerprint, has_seq] : bus::TypeFingerprints()) {
    const auto [twin, is_new] = by_fingerprint.emplace(fingerprint, type);
    EXPECT_TRUE(is_new) << type << " and " << twin->second << " would decode as each other";
  }
}

TEST(WireTypes, HaveNoTwoWithTheSameMembers) {
  std::map<std::string, std::string> by_members;
  for (const auto& type : TypeFiles()) {
    const auto [twin, is_new] = by_members.emplace(MembersOf(type), type);
    EXPECT_TRUE(is_new) << type << " and " << twin->second << " have the same members";
  }
}

TEST(WireTypes, StandInTheGoldenTableAndInTheReadme) {
  const auto files = TypeFiles();
  ASSERT_FALSE(files.empty());
  std::set<std::string> golden;
  std::istringstream table(ReadFile(kRoot / kGolden));
  for (std::string type, fingerprint; table >> type >> fingerprint;) golden.insert(type);
  EXPECT_EQ(golden, files);
  const auto readme = ReadFile(kRoot / "lcmtypes/README.md");
  for (const auto& type : files) {
    EXPECT_NE(readme.find("| " + type + " |"), std::string::npos) << type << " has no line in lcmtypes/README.md";
  }
}

TEST(WireTypes, AreOnAChannelOrAPartOfOneThatIs) {
  const auto files = TypeFiles();
  const auto readme = ReadFile(kRoot / "lcmtypes/README.md");
  for (const auto& type : files) {
    const bool is_part = std::ranges::any_of(
        files, [&type](const std::string& other) { return (";" + MembersOf(other)).find(";" + type + " ") != std::string::npos; });
    const auto channel = std::ranges::find(bus::kChannels, type, &bus::Channel::type);
    // Acknowledgements and orders are both: ALERTS repeat those that were taken.
    const bool may_be_both = type == "alert_ack_t" || type == "order_t";
    EXPECT_EQ(channel != bus::kChannels.end(), !is_part || may_be_both)
        << type << ": on a channel, or a part of another type, not both and not neither";
    if (channel != bus::kChannels.end()) {
      EXPECT_NE(readme.find("| " + type + " | " + std::string(channel->name) + " |"), std::string::npos)
          << type << " with its channel in lcmtypes/README.md";
    }
  }
  for (const auto& channel : bus::kChannels) EXPECT_TRUE(files.contains(std::string(channel.type))) << channel.name;
}

TEST(WireTypes, BeginWithTheTimeOfMeasurementWhereTheyAreOnAChannel) {
  for (const auto& channel : bus::kChannels) {
    const auto members = MembersOf(std::string(channel.type));
    EXPECT_TRUE(members.starts_with("int64_t utime_us;int64_t seq;")) << channel.type << ": " << members.substr(0, 60);
  }
}

TEST(GeneratedDecoders, CheckEveryCountBeforeTheyResize) {
  int num_resizes = 0;
  for (const auto& type : TypeFiles()) {
    std::istringstream header(ReadFile(std::filesystem::path(LOOKOUT_WIRE_DIR) / (type + ".hpp")));
    std::string before;
    for (std::string line; std::getline(header, line); before = line) {
      const auto resize = line.find(".resize(");
      if (resize == std::string::npos) continue;
      ++num_resizes;
      const auto begin = resize + std::string(".resize(").size();
      const std::string count = line.substr(begin, line.find(')', begin) - begin);
      ASSERT_TRUE(count.starts_with("this->")) << type << ".hpp: " << line;
      EXPECT_NE(before.find("if (" + count + " < 0 || " + count + " > maxlen - pos) return -1;"), std::string::npos)
          << type << ".hpp: " << line << "\nstands without the guard of lcmtypes/guard_counts.cmake";
    }
  }
  EXPECT_GT(num_resizes, 20);  // else the generator writes them otherwise, and this test sees none
}

TEST(GeneratedDecoders, CheckTheLengthOfEveryStringBeforeTheyTakeIt) {
  int num_strings = 0;
  for (const auto& type : TypeFiles()) {
    std::istringstream header(ReadFile(std::filesystem::path(LOOKOUT_WIRE_DIR) / (type + ".hpp")));
    std::string before;
    for (std::string line; std::getline(header, line); before = line) {
      if (line.find(".assign(") == std::string::npos) continue;
      ++num_strings;
      const auto begin = before.find("if (__");
      ASSERT_NE(begin, std::string::npos) << type << ".hpp: " << line;
      const std::string length = before.substr(begin + 4, before.find(' ', begin + 4) - begin - 4);
      EXPECT_NE(line.find(", " + length + " -"), std::string::npos) << type << ".hpp: " << line;
      EXPECT_NE(before.find("if (" + length + " < 1 || " + length + " > maxlen - pos) return -1;"), std::string::npos)
          << type << ".hpp: " << line << "\nstands without the guard of lcmtypes/guard_counts.cmake";
    }
  }
  EXPECT_GT(num_strings, 10);
}

}  // namespace
}  // namespace lookout
