// lookout-import: recordings of others as lcm-logs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

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
#include "tools/import/import_recording.hpp"
#include "tools/import/topic_map.hpp"
#include "tools/log/log_output.hpp"

namespace {

using namespace lookout;
namespace fs = std::filesystem;

constexpr int kExitUsage = 2;
constexpr int kExitDamaged = 3;

struct Options {
  fs::path config_folder;
  std::vector<fs::path> inputs;
  fs::path output;
  fs::path topic_map;
  fs::path truth;
  fs::path labels;
  bool lists = false;
  bool force = false;
};

// Exits here for --help, --version and wrong lines.
Options ParseOptions(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Makes an lcm-log of a recording of others: ROS 1 bags, rosbag2 (SQLite, MCAP), MCAP files, folders of scans (PCD, KITTI), and lidar "
      "detections of the Autoferry data set "
      "(scenarioN_lidar_detections.json).",
      "lookout-import");
  app.add_option("--config", options.config_folder, "folder of the boat's *.txtpb files, for RUN_INFO and the lidar's ports")
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault);
  app.add_option("--in", options.inputs,
                 "recording, or folder of a rosbag2 or of scans; may be given several times: the parts of one recording, in this order")
      ->required()
      ->allow_extra_args(false)
      ->check(CLI::ExistingPath);
  app.add_option("--out", options.output, "lcm-log to write: as FILE.partial until it is whole; one that exists is refused");
  app.add_option("--topics", options.topic_map,
                 "text file, a line for each topic: TOPIC USE [time=auto|stamp|recorded]; without it they are guessed. Uses: " + importer::UseWords())
      ->check(CLI::ExistingFile);
  auto* truth = app.add_option("--truth", options.truth, "write the labels of the scans to this folder, as lookout-eval --truth reads them");
  app.add_option("--labels", options.labels, "text file, a line for each class of labels: CLASS water|land|obstacle|none [NAME]")
      ->check(CLI::ExistingFile)
      ->needs(truth);
  app.add_flag("--list", options.lists, "print the topics and what they would become, as a file for --topics, and exit");
  app.add_flag("--force", options.force, "replace an existing --out, and files of --truth");
  app.set_version_flag("--version", "lookout-import " + runtime::Version());
  app.footer("Exit code: 0 done; 1 failed; 2 wrong command line or config; 3 the log is written, but the recording is damaged.");
  try {
    app.parse(argc, argv);
    if (!options.lists && (options.config_folder.empty() || options.output.empty()))
      throw CLI::RequiredError("--config and --out are required", CLI::ExitCodes::RequiredError);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

template <typename Message>
void Write(log::LogOutput& output, const bus::Channel& channel, const Message& message) {
  output.Write(Utime(std::chrono::microseconds(message.utime_us)), channel.name, bus::Encode(message));
}

void ImportDetections(const Options& options, const fs::path& input, log::LogOutput& output) {
  if (options.inputs.size() > 1) throw std::runtime_error(input.string() + ": detections are read one file at a time");
  const auto scans = importer::ReadFerryScans(input);
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

bool IsRecording(const fs::path& file) {
  if (fs::is_directory(file)) return true;
  const auto kind = io::FileKindOf(file);
  return kind == io::FileKind::kRosBag || kind == io::FileKind::kMcap || kind == io::FileKind::kSqlite;
}

// @return the exit code
int Import(const Options& options) {
  std::vector<fs::path> files;
  for (const auto& input : options.inputs) {
    for (auto& file : importer::FilesOfRecording(input)) files.push_back(std::move(file));
  }
  for (const auto& file : files) {
    if (fs::is_directory(file)) continue;  // of scans
    if (const auto reason = io::WhyNot(file, io::Wanted::kImport); !reason.empty()) throw std::runtime_error(reason);
  }
  const bool is_recording = IsRecording(files.front());
  if (!is_recording && !importer::IsFerryScans(files.front())) {
    throw std::runtime_error(files.front().string() +
                             ": is no recording that is known here: ROS bag, rosbag2, MCAP, folder of scans, or lidar detections of Autoferry "
                             "(scenarioN_lidar_detections.json)");
  }
  if (options.lists) {
    if (!is_recording) throw std::runtime_error(files.front().string() + ": has no topics");
    const auto topics = importer::TopicsOf(files);
    std::cout << importer::TopicMapText(topics, importer::GuessTopics(topics));
    return EXIT_SUCCESS;
  }
  auto inputs = io::FilesIn(options.config_folder);
  for (const auto& file : files) {
    if (!fs::is_directory(file)) inputs.push_back(file);
    if (fs::is_directory(file)) std::ranges::move(io::FilesIn(file), std::back_inserter(inputs));
  }
  log::LogOutput output(options.output, {.force = options.force, .inputs = std::move(inputs), .tell = [](const std::string& line) {
                                           std::cerr << "lookout-import: " << line << '\n';
                                         }});
  if (!is_recording) {
    if (!options.truth.empty()) throw std::runtime_error(files.front().string() + ": has no labels");
    ImportDetections(options, files.front(), output);
    return EXIT_SUCCESS;
  }
  const auto given = [](const fs::path& path) { return path.empty() ? std::nullopt : std::optional(path); };
  const bool is_whole = importer::ImportRecording(
      {options.config_folder, files, given(options.topic_map), given(options.truth), given(options.labels), options.force}, output, std::cerr);
  output.Commit();
  return is_whole ? EXIT_SUCCESS : kExitDamaged;
}

}  // namespace

int main(int argc, char** argv) try {
  io::CatchStopSignals();
  return Import(ParseOptions(argc, argv));
} catch (const config::ConfigError& error) {
  std::cerr << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const std::exception& error) {
  std::cerr << "lookout-import: " << lookout::PrintableLines(error.what()) << '\n';
  return EXIT_FAILURE;
}
