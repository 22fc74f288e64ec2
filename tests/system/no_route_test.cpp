// Without a multicast route: the error names the line that mends it. Runs in a network namespace that has only loopback.
#include <filesystem>
#include <gtest/gtest.h>

#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

namespace lookout::system_test {
namespace {

using namespace support;

TEST(WithoutMulticastRoute, AServiceEndsAndNamesTheRoute) {
  const TempDir folder;
  const auto output = folder / "output";
  const auto result = RunProgram({Bin("segmenter"), "--config", kDemoConfig.string()}, output);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("ip route add 239.255.76.0/24 dev lo"), std::string::npos) << result.output;
  std::filesystem::remove(output);
}

}  // namespace
}  // namespace lookout::system_test
