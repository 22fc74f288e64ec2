// lookout-calibrate: how the lidar is mounted, and how late heading and attitude are, out of a recording.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/config/boat.hpp"
#include "common/config/boat_folder.hpp"
#include "common/core/bytes.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/progress.hpp"
#include "common/runtime/version.hpp"
#include "services/odometer/params.hpp"
#include "tools/calibrate/boat_file.hpp"
#include "tools/calibrate/calibration.hpp"
#include "tools/calibrate/picture.hpp"
#include "tools/calibrate/recording.hpp"
#include "tools/calibrate/report.hpp"

namespace {

namespace calibrate = lookout::calibrate;
namespace fs = std::filesystem;

struct Options {
  fs::path config_folder;
  std::vector<fs::path> inputs;
  calibrate::Stretch stretch;
  bool writes = false;
  fs::path picture;
  fs::path pairs;
  bool prints_figures = false;
  bool force = false;
};

constexpr int kExitUsage = 2;

Options ParseOptions(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Finds how the lidar is mounted, and how late heading and attitude are, out of a recording of turns near what stands. Writes nothing unasked.",
      "lookout-calibrate");
  app.add_option("--config", options.config_folder, "folder of the boat's *.txtpb files")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault);
  app.add_option("--in", options.inputs, "lcm-log or capture; several are read in their order")->required()->check(CLI::ExistingPath);
  app.add_option("--begin", options.stretch.begin_s, "seconds after the first scan at which to begin")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--seconds", options.stretch.seconds, "so much of the recording is looked at; 1 MB of memory each, 5 MB of 128 rings by 2048")
      ->check(CLI::Range(10.0, 3600.0))
      ->capture_default_str();
  app.add_flag("--write", options.writes, "write the angles into boat.txtpb; the old file stays as boat.txtpb.old, and one that exists is refused");
  app.add_option("--picture", options.picture, "SVG to write: what stands, on the map, before and after");
  app.add_option("--pairs", options.pairs, "CSV to write: the pairs of scans of the last fit, for checks by other programs");
  app.add_flag("--figures", options.prints_figures, "print a line 'name value deviation' a number instead of the report");
  app.add_flag("--force", options.force, "replace existing files of --picture and --pairs");
  app.set_version_flag("--version", "lookout-calibrate " + lookout::runtime::Version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    std::exit(code == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

using Output = std::optional<lookout::io::OutputFile>;

// Opened before all work: what cannot be written is told at once.
void Open(const fs::path& file, const Options& options, Output& output) {
  if (!file.empty()) output.emplace(file, lookout::io::OutputOptions{.force = options.force, .inputs = options.inputs});
}

void Finish(Output& output, const std::string& text) {
  if (!output) return;
  output->Write(text);
  output->Commit();
}

// @return whether the mounting was found
bool Run(const Options& options) {
  const calibrate::CalibrationParams params{lookout::config::LoadBoat(options.config_folder), lookout::odometer::LoadParams(options.config_folder)};
  const auto old = options.config_folder / "boat.txtpb.old";
  if (options.writes && fs::exists(old))
    throw std::runtime_error(old.string() + ": exists already; move it away, then --write keeps the present file there");
  Output picture;
  Output pairs;
  Open(options.picture, options, picture);
  Open(options.pairs, options, pairs);
  const auto recording = calibrate::ReadRecording(options.config_folder, options.inputs, options.stretch);
  const auto calibration = calibrate::Calibrate(recording, params, [](const std::string& step) { spdlog::info("{}", step); });
  fmt::print("{}", options.prints_figures ? calibrate::FiguresOf(calibration) : calibrate::ReportOf(calibration, params.boat));
  if (calibration.has_fit) {
    if (picture) Finish(picture, calibrate::PictureOf(recording, calibration, params));
    if (pairs) Finish(pairs, calibrate::PairsCsv(calibration, recording.track));
  }
  if (calibration.IsRefused()) {
    if (options.prints_figures) spdlog::error("refused: {}", calibration.refusal);
    return false;
  }
  if (options.prints_figures && !calibration.turned_in_words.empty()) {
    spdlog::warn("the lidar is not mounted as boat.txtpb says: {}", calibration.turned_in_words);
  }
  if (options.writes) {
    calibrate::WriteAngles(options.config_folder, calibration.angles);
    fmt::print("written to {}; the old file is boat.txtpb.old\n", (options.config_folder / "boat.txtpb").string());
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  lookout::io::CatchStopSignals();
  const Options options = ParseOptions(argc, argv);
  spdlog::set_default_logger(spdlog::stderr_color_st("calibrate"));
  bool is_found = false;
  const int code = lookout::runtime::RunMain("calibrate", [&] {
    lookout::runtime::SetLogPattern("%^%l%$ calibrate: %v");
    is_found = Run(options);
  });
  return code == EXIT_SUCCESS && !is_found ? EXIT_FAILURE : code;
}
