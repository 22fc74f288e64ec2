#include <gtest/gtest.h>

#include "common/runtime/run_info.hpp"

namespace lookout::runtime {
namespace {

TEST(ProcessorText, NamesTheFeaturesOfAnX86ThatMatter) {
  EXPECT_EQ(ProcessorText("processor\t: 0\nmodel\t\t: 7\nmodel name\t: Some CPU @ 2 GHz\nflags\t\t: fpu sse2 avx2x avx2 fma nx\nvmx flags\t: avx\n\n"
                          "processor\t: 1\nmodel name\t: Another\nflags\t\t: avx\n"),
            "processor: Some CPU @ 2 GHz\nprocessor_features: sse2 avx2 fma\n");
}

TEST(ProcessorText, NamesAllFeaturesOfAnArm) {
  EXPECT_EQ(ProcessorText("processor\t: 0\nFeatures\t: fp asimd crc32\nCPU implementer\t: 0x41\nCPU part\t: 0xd0b\n"),
            "processor: implementer 0x41, part 0xd0b\nprocessor_features: fp asimd crc32\n");
}

TEST(ProcessorText, SaysWhatIsUnknown) {
  for (const char* cpuinfo : {"", "\n", "model name", "model name:", "flags:\n"}) {
    EXPECT_EQ(ProcessorText(cpuinfo), "processor: unknown\nprocessor_features: unknown\n") << cpuinfo;
  }
}

TEST(MachineText, HasALineForEach) {
  const std::string text = "\n" + MachineText();
  for (const char* name : {"architecture", "kernel", "processor", "processor_features", "c_library", "glibc_tunables", "compiler"}) {
    EXPECT_NE(text.find("\n" + std::string(name) + ": "), std::string::npos) << text;
  }
  EXPECT_EQ(text.back(), '\n');
}

}  // namespace
}  // namespace lookout::runtime
