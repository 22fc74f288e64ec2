#include "common/runtime/run_info.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <gnu/libc-version.h>
#include <sstream>
#include <string_view>
#include <utility>

#include "common/bus/schema.hpp"
#include "common/config/boat.hpp"
#include "common/config/boat_sections.hpp"
#include "common/config/text_config.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/version.hpp"

namespace lookout::runtime {

namespace {

constexpr std::string_view kBoatFile = "boat.txtpb";

// The makers' files about a lidar's beams (beam_file in lidar.txtpb): without them its packets cannot be read. Other files may lie in the folder,
// too: what cannot be read, or does not fit into a message, is left out.
void AddBeamFiles(const std::filesystem::path& config_folder, run_info_t& message) {
  constexpr std::size_t kMaxTextBytes = 100'000;  // of all files: RUN_INFO is one message
  std::size_t num_bytes = 0;
  for (const auto& text : message.file_text) num_bytes += text.size();
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(config_folder, error)) {
    const auto extension = entry.path().extension();
    if (extension == ".json" || extension == ".csv") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const auto& file : files) {
    try {
      auto text = config::ReadConfigFile(file);
      if (num_bytes + text.size() > kMaxTextBytes) continue;
      num_bytes += text.size();
      message.file_name.push_back(file.filename().string());
      message.file_text.push_back(std::move(text));
    } catch (const config::ConfigError&) {
      continue;
    }
  }
}

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

std::string Version() { return LOOKOUT_VERSION; }

run_info_t MakeRunInfo(const std::string& program, const std::filesystem::path& config_folder) {
  run_info_t message{};
  message.program = program;
  message.version = Version();
  message.host = HostName();
  message.schema = bus::SchemaDigest();
  config::FaultList faults;
  for (const auto& name : config::FilesInForce(config_folder)) {
    faults.Try([&] { message.file_text.push_back(config::EffectiveTextOf(config_folder, name)); });
    message.file_name.push_back(name);
  }
  faults.ThrowIfAny();
  message.file_name.emplace_back("machine.txt");
  message.file_text.push_back(MachineText());
  for (const auto& type : bus::TypeTexts()) {
    message.file_name.push_back(type.file_name);
    message.file_text.push_back(type.text);
  }
  AddBeamFiles(config_folder, message);
  message.num_files = static_cast<std::int32_t>(message.file_name.size());
  return message;
}

std::string EffectiveConfig(const std::filesystem::path& config_folder, std::vector<std::string> file_names) {
  if (file_names.empty()) file_names = config::FilesInForce(config_folder);
  std::string text;
  config::FaultList faults;
  for (const auto& name : file_names) {
    faults.Try([&] { text += "# " + name + "\n" + config::EffectiveTextOf(config_folder, name); });
    // The service checks relations between fields; here are words alone.
    config::FaultList untold;
    if (name == kBoatFile) untold.Try([&] { text += config::RemarksAsComments(config::LoadBoat(config_folder)); });
  }
  faults.ThrowIfAny();
  return text;
}

}  // namespace lookout::runtime
