// An lcm-log of a boat whose lidar has no simulated packets: NAV_RAW and LIDAR_SCAN. A replay begins at LIDAR_SCAN.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/bus/log_file.hpp"
#include "common/io/output_file.hpp"
#include "lab/sim/head_simulation.hpp"
#include "lookout/run_info_t.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::sim {

class LogSink {
 public:
  /// @param model    of LIDAR_SCAN
  /// @param program  how the log was made, for RUN_INFO
  /// @throws config::ConfigError; std::runtime_error as io::OutputFile
  LogSink(const std::filesystem::path& file, const std::filesystem::path& config_folder, std::string model, const std::string& program,
          const io::OutputOptions& options);

  void Send(const HeadSimulation::Event& event);

  /// @return the file, complete, for io::CommitAll. @throws std::runtime_error when the write fails
  io::OutputFile& Finish();

 private:
  void WriteRunInfo(Utime time);

  std::string model_;
  run_info_t run_info_;
  io::OutputFile file_;
  bus::LogWriter log_;
  replay::Chain navigator_;  // makes NAV_RAW
  std::optional<Utime> last_;
};

}  // namespace lookout::sim
