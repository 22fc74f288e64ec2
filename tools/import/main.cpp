// lookout-import: recordings of others as lcm-logs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string_view>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/config/boat_folder.hpp"
#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_kind.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/run_info.hpp"
#include "common/runtime/version.hpp"
#include "tools/import/autoferry.hpp"
#include "tools/log/log_output.hpp"

namespace {

using namespace lookout;
namespace fs = std::filesystem;

constexpr int kExitUsage = 2;

struct Options {
  fs::path config_folder;
  fs::path input;
  fs::path output;
  bool force = false;
};

// Exits here for --help, --version and wrong lines.
Options ParseOptions(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Makes an lcm-log of a recording of others: lidar detections of the Autoferry data set (scenarioN_lidar_detections.json) as OBSTACLES, and "
      "POSE "
      "of its ferry.",
      "lookout-import");
  app.add_option("--config", options.config_folder, "folder of the boat's *.txtpb files, for RUN_INFO")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault);
  app.add_option("--in", options.input, "recording")->required()->check(CLI::ExistingPath);
  app.add_option("--out", options.output, "lcm-log to write: as FILE.partial until it is whole; one that exists is refused")->required();
  app.add_flag("--force", options.force, "replace an existing --out");
  app.set_version_flag("--version", "lookout-import " + runtime::Version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

template <typename Message>
void Write(log::LogOutput& output, const bus::Channel& channel, const Message& message) {
  output.Write(Utime(std::chrono::microseconds(message.utime_us)), channel.name, bus::Encode(message));
}

void Import(const Options& options) {
  auto inputs = io::FilesIn(options.config_folder);
  inputs.push_back(options.input);
  log::LogOutput output(options.output, {.force = options.force, .inputs = std::move(inputs), .tell = [](const std::string& line) {
                                           std::cerr << "lookout-import: " << line << '\n';
                                         }});
  if (const auto reason = io::WhyNot(options.input, io::Wanted::kDetections); !reason.empty()) throw std::runtime_error(reason);
  if (!importer::IsFerryScans(options.input)) {
    throw std::runtime_error(options.input.string() +
                             ": is no recording that is known here: lidar detections of Autoferry (scenarioN_lidar_detections.json)");
  }
  const auto scans = importer::ReadFerryScans(options.input);
  const auto poses = importer::ToPoses(scans);
  auto run_info = runtime::MakeRunInfo("import", options.config_folder);
  run_info.utime_us = poses.front().utime_us;
  Write(output, bus::kRunInfo, run_info);
  std::size_t num_obstacles = 0;
  auto pose = poses.begin();
  // In the order of time, as they would have come.
  for (const auto& obstacles : importer::ToObstacles(scans)) {
    for (; pose != poses.end() && pose->utime_us <= obstacles.utime_us; ++pose) Write(output, bus::kPose, *pose);
    Write(output, bus::kObstacles, obstacles);
    num_obstacles += obstacles.obstacles.size();
  }
  for (; pose != poses.end(); ++pose) Write(output, bus::kPose, *pose);
  auto& out = output.IsStandardOutput() ? std::cerr : std::cout;
  output.Commit();
  out << fmt::format("{} scans, {} obstacles, {} poses, {:.1f} s\n", scans.size(), num_obstacles, poses.size(),
                     static_cast<double>(scans.back().utime_us - scans.front().utime_us) * 1e-6);
}

}  // namespace

int main(int argc, char** argv) try {
  io::CatchStopSignals();
  Import(ParseOptions(argc, argv));
  return EXIT_SUCCESS;
} catch (const config::ConfigError& error) {
  std::cerr << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const std::exception& error) {
  std::cerr << "lookout-import: " << lookout::PrintableLines(error.what()) << '\n';
  return EXIT_FAILURE;
}
