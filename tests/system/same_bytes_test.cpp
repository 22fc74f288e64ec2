// Replay gives the same bytes whichever variants of its functions the C library picks for this processor. glibc can be told to leave out those with
// fused multiply-adds and AVX2; so one computer stands for an older one.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;

// The names of glibc 2.33 and later.
const std::string kOlderProcessor = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2";

// Not a test: run by what is below as a process of its own, to see what the C library's functions give there.
TEST(CLibrary, DISABLED_PrintsADigestOfItsFunctions) {
  std::uint64_t digest = 0;
  for (int i = 1; i < 20'000; ++i) {
    const double x = 1e-3 * i;
    for (const double result : {std::sin(x), std::cos(x), std::atan2(x, 3.0), std::exp(-x)}) {
      digest = std::rotl(digest, 1) ^ std::bit_cast<std::uint64_t>(result);
    }
  }
  std::printf("digest %llu\n", static_cast<unsigned long long>(digest));
}

class SameBytes : public ::testing::Test {
 protected:
  TempDir folder_;
  const fs::path data_ = kRecordings;

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  // Lines of the output that begin so.
  static std::string Lines(const std::string& output, const std::string& begin) {
    std::string found;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind(begin, 0) == 0) found += line + "\n";
    }
    return found;
  }

  // The C library gives other results as the older processor: else nothing is shown by a comparison.
  bool SwitchesTheCLibrary() {
    const std::vector<std::string> probe{fs::read_symlink("/proc/self/exe").string(), "--gtest_also_run_disabled_tests", "--gtest_filter=CLibrary.*"};
    std::vector<std::string> older{"env", kOlderProcessor};
    older.insert(older.end(), probe.begin(), probe.end());
    const std::string here = Lines(RunProgram(probe, Path("probe.out")).output, "digest ");
    const std::string there = Lines(RunProgram(older, Path("probe.out")).output, "digest ");
    EXPECT_FALSE(here.empty() || there.empty());
    return here != there;
  }

  // Exit code; name, count and digest of each channel's payloads.
  std::string Digests(const std::vector<std::string>& environment, const std::string& config, const std::string& in) {
    std::vector<std::string> command = environment;
    for (const auto& word : {Bin("replay"), std::string("--config"), config, std::string("--in"), in, std::string("--out"), Path("out.lcmlog")}) {
      command.push_back(word);
    }
    const auto run = RunProgram(command, Path("replay.out"));
    fs::remove(Path("out.lcmlog"));
    std::string digests = "exit code " + std::to_string(run.exit_code) + "\n";
    for (const std::string channel : {"LIDAR_", "SEGMENTS ", "NAV_RAW ", "GNSS_FIX ", "ATTITUDE ", "POSE ", "OBSTACLES ", "TRACKS ", "ALERTS "}) {
      digests += Lines(run.output, channel);
    }
    return digests;
  }

  // Returns what both give.
  std::string ExpectSameDigests(const std::string& config, const std::string& in) {
    SCOPED_TRACE(in + " with " + config);
    const std::string here = Digests({}, config, in);
    EXPECT_EQ(here, Digests({"env", kOlderProcessor}, config, in));
    return here;
  }

  // config/demo with the paper's method.
  std::string ConfigOfThePaper() {
    fs::copy(kDemoConfig.string(), folder_ / "paper");
    std::ofstream(folder_ / "paper/segmenter.txtpb")
        << "# proto-file: config/schema/segmenter.proto\n# proto-message: lookout.config.Segmenter\nmethod: PAPER\n";
    return Path("paper");
  }
};

TEST_F(SameBytes, OfSimulatedScenesByBothMethodsWhateverTheProcessor) {
  if (!SwitchesTheCLibrary()) GTEST_SKIP() << "the C library has no other functions for an older processor than this one";
  const std::string demo = kDemoConfig.string();
  const std::string paper = ConfigOfThePaper();
  // Waves: roll and pitch, foam and spray. Dual: two returns a shot.
  for (const std::string scene : {"waves", "dual"}) {
    const auto sim = RunProgram({Bin("sim"), "--config", demo, "--scene", scene, "--seed", "7", "--seconds", "4", "--pcap", Path(scene + ".pcap")},
                                Path("sim.out"));
    ASSERT_EQ(sim.exit_code, 0) << sim.output;
    for (const auto& config : {demo, paper}) {
      const std::string digests = ExpectSameDigests(config, Path(scene + ".pcap"));
      EXPECT_EQ(digests.rfind("exit code 0\n", 0), 0U) << digests;
      EXPECT_NE(digests.find("OBSTACLES "), std::string::npos) << digests;
      EXPECT_NE(digests.find("TRACKS "), std::string::npos) << digests;
    }
  }
}

TEST_F(SameBytes, OfRecordingsWhateverTheProcessor) {
  if (!fs::exists(data_ / "vlp16")) GTEST_SKIP() << "no recordings at " << data_;
  if (!SwitchesTheCLibrary()) GTEST_SKIP() << "the C library has no other functions for an older processor than this one";
  const std::string catabot = kCatabotConfig.string();
  for (const char* folder : {"vlp16", "nmea"}) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(data_ / folder)) files.push_back(entry.path());
    std::ranges::sort(files);
    // Some text logs tell no date and are refused, by both.
    int num_replayed = 0;
    for (const auto& file : files) num_replayed += ExpectSameDigests(catabot, file.string()).rfind("exit code 0\n", 0) == 0 ? 1 : 0;
    EXPECT_GE(num_replayed, 2) << folder;
  }
}

}  // namespace
}  // namespace lookout::system_test
