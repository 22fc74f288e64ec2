// Without a multicast route: the error names the line that mends it. Runs in a network namespace that has only loopback.
#include <filesystem>
#include <gtest/gtest.h>

#include "tests/system/child.hpp"

namespace lookout::system_test {
namespace {

TEST(WithoutMulticastRoute, AServiceEndsAndNamesTheRoute) {
  const auto output = (std::filesystem::temp_directory_path() / ("lookout_no_route_" + std::to_string(getpid()))).string();
  const auto result =
      RunProgram({std::string(LOOKOUT_BIN_DIR) + "/lookout-segmenter", "--config", std::string(LOOKOUT_SOURCE_DIR) + "/config/demo"}, output);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("ip route add 239.255.76.0/24 dev lo"), std::string::npos) << result.output;
  std::filesystem::remove(output);
}

}  // namespace
}  // namespace lookout::system_test
