// Who may include whom.
#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/structure/sources.hpp"
#include "tests/support/files.hpp"

namespace {

namespace fs = std::filesystem;

using lookout::structure_test::SourcesBelow;
using lookout::support::kSources;
using lookout::support::ReadFile;

std::vector<std::string> Includes(const fs::path& file) {
  static const std::regex kInclude(R"re(^\s*#include\s*[<"]([^>"]+)[>"])re");
  std::vector<std::string> includes;
  std::istringstream text(ReadFile(file));
  for (std::string line; std::getline(text, line);) {
    std::smatch match;
    if (std::regex_search(line, match, kInclude)) includes.push_back(match[1]);
  }
  return includes;
}

// What an include is: the module of ours, the library, or "std".
std::string KindOf(const std::string& include) {
  static const std::vector<std::pair<std::string, std::string>> kPrefixes{{"lookout/", "wire types"},
                                                                          {"config/schema/", "config types"},
                                                                          {"lcm/", "lcm"},
                                                                          {"google/", "protobuf"},
                                                                          {"boost/", "boost"},
                                                                          {"pcap/", "pcap"},
                                                                          {"pcap.h", "pcap"},
                                                                          {"spdlog/", "spdlog"},
                                                                          {"fmt/", "fmt"},
                                                                          {"CLI/", "cli"},
                                                                          {"openssl/", "openssl"},
                                                                          {"nlohmann/", "nlohmann-json"},
                                                                          {"sqlite3.h", "sqlite"},
                                                                          {"qrencode.h", "qrencode"},
                                                                          {"systemd/", "systemd"},
                                                                          {"Eigen/", "eigen"},
                                                                          {"GeographicLib/", "geographiclib"},
                                                                          {"sys/socket", "socket"},
                                                                          {"netinet/", "socket"},
                                                                          {"arpa/", "socket"}};
  for (const auto& [prefix, kind] : kPrefixes) {
    if (include.rfind(prefix, 0) == 0) return kind;
  }
  if (include.rfind("common/", 0) == 0) return include.substr(0, include.find('/', 7));
  // Folders within a core are parts of it.
  static const std::regex kCore("services/[^/]+/core/");
  if (std::smatch core; std::regex_search(include, core, kCore, std::regex_constants::match_continuous))
    return include.substr(0, static_cast<std::size_t>(core.length()) - 1);
  if (const auto top = include.substr(0, include.find('/')); top == "services" || top == "tools" || top == "lab")
    return include.substr(0, include.rfind('/'));
  return "std";
}

// A module and the kinds that its files may include besides std and Eigen. "OWN" stands for the service's folder.
struct Rule {
  std::string module;  // regular expression of the path below the root
  std::vector<std::string> allowed;
};

const std::vector<Rule>& Rules() {
  static const std::vector<Rule> kRules{
      {"common/core/.*", {"common/core"}},
      {"common/io/.*", {"common/core", "common/io", "socket"}},
      {"common/bus/.*", {"common/core", "common/bus", "common/io", "lcm", "openssl", "socket"}},
      {"common/messages/.*", {"common/core", "common/messages", "wire types"}},
      {"common/config/.*", {"common/core", "common/config", "config types", "protobuf", "fmt"}},
      // What viewers of others draw, in their messages.
      {"common/viewer/.*",
       {"common/core", "common/bus", "common/messages", "common/config", "common/viewer", "wire types", "config types", "protobuf", "nlohmann-json",
        "fmt"}},
      {"common/runtime/.*", {"common/core", "common/bus", "common/config", "common/io", "common/runtime", "wire types", "spdlog", "cli", "systemd"}},
      {"services/navigator/core/.*", {"common/core", "OWN/core", "OWN/core/filter"}},
      // What a maker says of a sensor is JSON.
      {"services/lidar/core/.*", {"common/core", "OWN/core", "nlohmann-json"}},
      // What it makes is text.
      {"services/plotter/core/.*", {"common/core", "OWN/core", "fmt", "nlohmann-json"}},
      // What a browser says and is told is JSON, and names channels.
      {"services/page/core/.*", {"common/core", "common/bus", "OWN/core", "nlohmann-json"}},
      {"services/page/io/.*", {"common/core", "common/io", "OWN/core", "OWN/io", "boost"}},
      // Logs as an index, and the boat out of the config in RUN_INFO.
      {"services/page/film/boat_text\\..pp", {"common/config", "common/messages", "OWN/film", "config types", "nlohmann-json"}},
      {"services/page/film/.*",
       {"common/core", "common/bus", "common/messages", "common/io", "OWN/core", "OWN/film", "wire types", "fmt", "nlohmann-json"}},
      {"services/[^/]+/core/.*", {"common/core", "OWN/core"}},
      {"services/plotter/io/.*", {"common/core", "common/io", "OWN/core", "OWN/io", "boost", "socket"}},
      {"services/lidar/io/sensor_request\\..pp", {"OWN/io", "boost"}},
      {"services/[^/]+/io/.*", {"common/core", "common/io", "OWN/core", "OWN/io", "pcap", "socket"}},
      {"services/[^/]+/wire\\..pp", {"common/core", "OWN/core", "OWN", "wire types", "common/bus", "common/messages"}},
      // It knows what an address is.
      {"services/[^/]+/(params(_text)?|evidence_text)\\..pp",
       {"common/core", "common/config", "common/io", "OWN/core", "OWN", "config types", "fmt"}},
      // Opens what params name.
      {"services/[^/]+/sources\\..pp", {"common/core", "common/config", "common/io", "common/runtime", "OWN", "OWN/core", "OWN/io", "spdlog", "fmt"}},
      {"services/lidar/(decoders|survey)\\..pp", {"common/core", "OWN", "OWN/core"}},
      // Asks the sensor for what params name.
      {"services/lidar/sensor_beams\\..pp", {"common/core", "OWN", "OWN/core", "OWN/io"}},
      // A part of the service that knows the host's time, as the core must not.
      {"services/tracker/watch\\..pp", {"common/core", "OWN", "OWN/core", "fmt"}},
      // A file that one process leaves to the next.
      {"services/tracker/handover\\..pp", {"common/core", "common/io", "common/bus", "common/messages", "OWN", "OWN/core", "wire types"}},
      {"services/plotter/revision_file\\..pp", {"common/core", "common/io", "OWN", "OWN/core", "fmt"}},
      {"services/tracker/alert_text\\..pp", {"common/core", "OWN", "OWN/core", "fmt"}},
      // One language each, over a link.
      {"services/plotter/surroundings\\..pp", {"common/core", "common/bus", "common/messages", "OWN", "OWN/core", "wire types"}},
      {"services/plotter/([a-z0-9_]+_)?outputs?\\..pp", {"common/core", "OWN", "OWN/core", "OWN/io"}},
      // The page: messages to browsers go by its own server.
      {"services/page/service\\..pp", {"common/core", "common/bus", "OWN", "OWN/core", "OWN/io", "wire types"}},
      {"services/page/tiles\\..pp", {"common/core", "OWN", "OWN/io", "fmt", "nlohmann-json", "sqlite"}},
      // From the bus to viewers, by a server of its own.
      {"services/page/foxglove_feed\\..pp", {"common/core", "common/bus", "common/config", "common/viewer", "OWN", "OWN/core", "OWN/io"}},
      {"services/page/token\\..pp", {"common/core", "common/io", "OWN", "fmt"}},
      {"services/page/announcement\\..pp", {"common/core", "OWN", "fmt", "qrencode"}},
      {"services/page/(assets|server_link)\\.hpp", {"common/core", "OWN/io"}},
      {"services/page/(main|film_mode)\\..pp",
       {"common/core", "common/bus", "common/config", "common/runtime", "common/io", "OWN", "OWN/core", "OWN/io", "OWN/film", "spdlog", "fmt",
        "cli"}},
      // What the recorder's method gives is files: its service drives its own io.
      {"services/recorder/service\\..pp", {"common/core", "common/bus", "OWN", "OWN/io", "wire types"}},
      {"services/[^/]+/service\\..pp", {"common/core", "common/bus", "common/messages", "OWN", "OWN/core", "wire types", "fmt"}},
      {"services/[^/]+/main\\.cpp",
       {"common/core", "common/bus", "common/config", "common/runtime", "common/io", "OWN", "OWN/core", "OWN/io", "spdlog", "fmt"}},
  };
  return kRules;
}

TEST(Structure, ModulesIncludeOnlyWhatTheyMay) {
  int num_checked = 0;
  for (const auto& folder : {"common", "services"}) {
    for (const auto& file : SourcesBelow(kSources / folder)) {
      const std::string path = fs::relative(file, kSources).string();
      const auto rule = std::ranges::find_if(Rules(), [&](const Rule& candidate) { return std::regex_match(path, std::regex(candidate.module)); });
      ASSERT_NE(rule, Rules().end()) << path << " is in no module that the rules name";
      const std::string own = path.substr(0, path.find('/', path.find('/') + 1));
      for (const auto& include : Includes(file)) {
        const std::string kind = KindOf(include);
        const bool is_allowed = kind == "std" || kind == "eigen" || std::ranges::any_of(rule->allowed, [&](std::string allowed) {
                                  if (allowed.rfind("OWN", 0) == 0) allowed.replace(0, 3, own);
                                  return allowed == kind;
                                });
        EXPECT_TRUE(is_allowed) << path << " may not include " << include << " (" << kind << ")";
        ++num_checked;
      }
    }
  }
  EXPECT_GT(num_checked, 100);
}

// What sails and what measures: tools are for the boat and its logs, the laboratory uses them, and nothing uses the laboratory.
TEST(Structure, NothingThatSailsIncludesTheLaboratory) {
  int num_checked = 0;
  for (const auto& folder : {"common", "services", "tools"}) {
    for (const auto& file : SourcesBelow(kSources / folder)) {
      for (const auto& include : Includes(file)) {
        EXPECT_NE(include.rfind("lab/", 0), 0U) << fs::relative(file, kSources).string() << " includes " << include;
        ++num_checked;
      }
    }
  }
  EXPECT_GT(num_checked, 1000);
}

// Data and the simulator know nothing of what is measured on them.
TEST(Structure, FoldersOfTheLaboratoryIncludeOnlyWhatTheyMay) {
  const std::map<std::string, std::regex> allowed{{"data", std::regex("common/.*|services/segmenter/core/.*|tools/import/.*|lab/data/.*")},
                                                  // Of others the form of a scan, and NAV_RAW as the navigator makes it: for heads without packets.
                                                  {"sim", std::regex("common/.*|services/lidar/.*|lab/sim/.*|services/segmenter/core/scan[.]hpp|"
                                                                     "lab/data/scan_message[.]hpp|tools/replay/chain[.]hpp")},
                                                  {"eval", std::regex("common/.*|services/.*|tools/.*|lab/(data|sim|eval|learned)/.*")},
                                                  {"eval/methods", std::regex("(?!lab/eval/(tracks|report)).*")},
                                                  {"eval/tracks", std::regex("(?!lab/eval/report).*")},
                                                  {"fit", std::regex("common/.*|services/segmenter/.*|lab/(data|sim|eval|fit)/.*")},
                                                  {"learned", std::regex("common/.*|services/segmenter/core/.*|lab/(sim|eval|learned)/.*")}};
  const std::regex ours("(common|services|tools|lab)/.*");
  int num_checked = 0;
  for (const auto& file : SourcesBelow(kSources / "lab")) {
    const auto path = fs::relative(file, kSources / "lab");
    for (const auto& include : Includes(file)) {
      if (!std::regex_match(include, ours)) continue;
      EXPECT_TRUE(std::regex_match(include, allowed.at(path.begin()->string()))) << "lab/" << path.string() << " may not include " << include;
      const auto part = allowed.find(path.parent_path().string());
      EXPECT_TRUE(part == allowed.end() || std::regex_match(include, part->second)) << "lab/" << path.string() << " may not include " << include;
      ++num_checked;
    }
  }
  EXPECT_GT(num_checked, 300);
}

}  // namespace
