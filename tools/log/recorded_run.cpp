#include "tools/log/recorded_run.hpp"

#include <sstream>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"

namespace lookout::log {

std::optional<run_info_t> RunInfoOf(const bus::LogEvent& event) {
  if (event.channel != bus::kRunInfo.name) return std::nullopt;
  return bus::Decode<run_info_t>(event.bytes);
}

std::string MachineOf(const run_info_t& run_info) {
  std::string machine;
  for (std::size_t i = 0; i < run_info.file_name.size(); ++i) {
    if (run_info.file_name[i] != "machine.txt") continue;
    std::istringstream lines(run_info.file_text[i]);
    for (std::string line; std::getline(lines, line);) {
      const auto colon = line.find(": ");
      if (colon == std::string::npos) continue;
      const auto value = line.substr(colon + 2);
      const bool needs_name = line.starts_with("glibc_tunables") || line.starts_with("compiler") || line.starts_with("kernel") || value == "unknown";
      machine += (machine.empty() ? "" : ", ") + (needs_name ? line : value);
    }
  }
  return machine;
}

}  // namespace lookout::log
