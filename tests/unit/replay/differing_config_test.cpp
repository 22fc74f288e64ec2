// Which files of a config are not those of a log, by RUN_INFO of both.
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "lookout/run_info_t.hpp"
#include "tools/replay/input.hpp"

namespace lookout::replay {
namespace {

run_info_t InfoOf(const std::vector<std::pair<std::string, std::string>>& files) {
  run_info_t info{};
  for (const auto& [name, text] : files) {
    info.file_name.push_back(name);
    info.file_text.push_back(text);
  }
  info.num_files = static_cast<std::int32_t>(info.file_name.size());
  return info;
}

using Names = std::vector<std::string>;

TEST(DifferingConfigFiles, AreThoseWithOtherValues) {
  const auto a = InfoOf({{"boat.txtpb", "name: \"a\"\n"}, {"page.txtpb", "port: 1\n"}, {"machine.txt", "x"}});
  const auto b = InfoOf({{"boat.txtpb", "name: \"b\"\n"}, {"page.txtpb", "port: 1\n"}, {"machine.txt", "y"}});
  EXPECT_EQ(DifferingConfigFiles(a, a), Names{});
  EXPECT_EQ(DifferingConfigFiles(a, b), Names{"boat.txtpb"});
}

// RUN_INFO of before told of files alone that were there; what is absent has its defaults.
TEST(DifferingConfigFiles, AreNotThoseThatAreAbsentOrNothingButDefaults) {
  const auto before = InfoOf({{"boat.txtpb", "name: \"a\"\n"}});
  const auto defaults = InfoOf({{"boat.txtpb", "name: \"a\"\n"}, {"odometer.txtpb", "max_range_m: 100  # default\nmin_range_m: 1  # default\n"}});
  const auto other = InfoOf({{"boat.txtpb", "name: \"a\"\n"}, {"odometer.txtpb", "max_range_m: 80\nmin_range_m: 1  # default\n"}});
  EXPECT_EQ(DifferingConfigFiles(before, defaults), Names{});
  EXPECT_EQ(DifferingConfigFiles(defaults, before), Names{});
  EXPECT_EQ(DifferingConfigFiles(before, other), Names{"odometer.txtpb"});
  EXPECT_EQ(DifferingConfigFiles(defaults, other), Names{"odometer.txtpb"});
}

}  // namespace
}  // namespace lookout::replay
