#include "common/runtime/machine.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <gnu/libc-version.h>
#include <sstream>
#include <string_view>

namespace lookout::runtime {

namespace {

// Of the hundred and more that an x86 names.
constexpr std::array<std::string_view, 14> kFeaturesThatMatter{"sse2", "ssse3", "sse4_1", "sse4_2",  "avx",      "avx2",     "fma",
                                                               "fma4", "bmi1",  "bmi2",   "avx512f", "avx512vl", "avx512dq", "avx512bw"};

// Of the first line "name  : value"; empty when there is none.
std::string ValueOf(const std::string& cpuinfo, std::string_view name) {
  std::istringstream lines(cpuinfo);
  for (std::string line; std::getline(lines, line);) {
    const auto colon = line.find(':');
    if (colon == std::string::npos || line.compare(0, name.size(), name) != 0) continue;
    if (line.find_first_not_of(" \t", name.size()) != colon) continue;
    const auto begin = line.find_first_not_of(" \t", colon + 1);
    return begin == std::string::npos ? std::string() : line.substr(begin);
  }
  return {};
}

std::string OrUnknown(const std::string& text) { return text.empty() ? "unknown" : text; }

}  // namespace

std::string ProcessorText(const std::string& cpuinfo) {
  std::string processor = ValueOf(cpuinfo, "model name");
  if (processor.empty()) {
    const std::string implementer = ValueOf(cpuinfo, "CPU implementer");
    if (!implementer.empty()) processor = "implementer " + implementer + ", part " + OrUnknown(ValueOf(cpuinfo, "CPU part"));
  }
  std::string features;
  std::istringstream flags(ValueOf(cpuinfo, "flags"));
  for (std::string flag; flags >> flag;) {
    if (std::ranges::find(kFeaturesThatMatter, flag) == kFeaturesThatMatter.end()) continue;
    features += (features.empty() ? "" : " ") + flag;
  }
  if (features.empty()) features = ValueOf(cpuinfo, "Features");
  return "processor: " + OrUnknown(processor) + "\nprocessor_features: " + OrUnknown(features) + "\n";
}

std::string MachineText() {
  utsname system{};
  const bool is_known = uname(&system) == 0;
  std::ifstream file("/proc/cpuinfo");
  std::ostringstream cpuinfo;
  cpuinfo << file.rdbuf();
  const char* tunables = std::getenv("GLIBC_TUNABLES");
  return "architecture: " + OrUnknown(is_known ? system.machine : "") + "\nkernel: " + OrUnknown(is_known ? system.release : "") + "\n" +
         ProcessorText(cpuinfo.str()) + "c_library: glibc " + gnu_get_libc_version() +
         "\nglibc_tunables: " + (tunables == nullptr ? "none" : tunables) + "\ncompiler: " +
#ifdef __clang__
         "" __VERSION__ "\n";
#else
         "GCC " __VERSION__ "\n";
#endif
}

}  // namespace lookout::runtime
