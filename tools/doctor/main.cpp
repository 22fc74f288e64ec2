// lookout-doctor: is this boat ready to cast off? Checks, reports, changes nothing.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/config/boat.hpp"
#include "common/config/boat_folder.hpp"
#include "common/config/text_config.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "common/runtime/version.hpp"
#include "services/odometer/params.hpp"
#include "services/tracker/params_text.hpp"
#include "tools/calibrate/recording.hpp"
#include "tools/doctor/cable.hpp"
#include "tools/doctor/findings.hpp"
#include "tools/doctor/machine.hpp"
#include "tools/doctor/mounting_watch.hpp"
#include "tools/doctor/watch.hpp"

namespace {

namespace doctor = lookout::doctor;

// Less shows no rate, and a receiver that gives a fix a second may be missed.
constexpr int kMinSeconds = 2;
constexpr int kMaxSeconds = 3600;
constexpr int kUsualSeconds = 5;
constexpr int kUsualMountingSeconds = 60;

struct Options {
  std::filesystem::path config_folder;
  bool check_only = false;
  std::string lcm_url;
  int seconds = kUsualSeconds;
  std::vector<std::filesystem::path> captures;
  bool looks_at_mounting = false;
};

Options ParseOptions(int argc, char** argv) {
  Options options;
  CLI::App app("Checks whether a boat is ready to cast off: config, bus, lidar, clocks, GNSS, heading, mounting, disk, processes.", "lookout-doctor");
  auto* const config = app.add_option("--config", options.config_folder, "folder of the boat's *.txtpb files; not needed with --in")
                           ->check(CLI::ExistingDirectory)
                           ->check(lookout::config::BoatFolderFault);
  auto* const seconds =
      app.add_option("--seconds", options.seconds, "listen for so long")->check(CLI::Range(kMinSeconds, kMaxSeconds))->capture_default_str();
  app.add_flag("--check", options.check_only, "check the config of every process, print the values in force or every fault, exit");
  app.add_option("--lcm-url", options.lcm_url, "LCM address (else the environment's LCM_DEFAULT_URL, else this computer only)");
  app.add_option("--in", options.captures, "capture: which lidars speak in it, and what the config makes of them; nothing else is checked (several)")
      ->check(CLI::ExistingFile);
  app.add_flag(
      "--mounting", options.looks_at_mounting,
      "compare the lidar's mounting with what stands around the boat while it turns: listens for 60 s; with --in logs or captures, this alone");
  app.set_version_flag("--version", "lookout-doctor " + lookout::runtime::Version());
  app.footer("Exit code: 0 no fault; 1 a fault; 2 wrong command line, or with --check a wrong config.");
  try {
    app.parse(argc, argv);
    if (config->count() == 0 && options.captures.empty()) throw CLI::RequiredError("--config");
    if (options.looks_at_mounting && config->count() == 0) throw CLI::RequiredError("--mounting needs --config");
    if (options.check_only && config->count() == 0) throw CLI::RequiredError("--check needs --config");
  } catch (const CLI::ParseError& error) {
    // --help and --version come here too, with code 0.
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : 2);
  }
  if (options.looks_at_mounting && seconds->count() == 0) options.seconds = kUsualMountingSeconds;
  if (options.lcm_url.empty()) options.lcm_url = lookout::bus::DefaultLcmUrl();
  return options;
}

// Observes the mounting in a recording.
doctor::Observations ObserveMounting(const Options& options) {
  doctor::Observations seen;
  const auto recording = lookout::calibrate::ReadRecording(options.config_folder, options.captures, {});
  seen.mounting =
      doctor::CompareMounting(recording, {lookout::config::LoadBoat(options.config_folder), lookout::odometer::LoadParams(options.config_folder)});
  return seen;
}

doctor::Observations Observe(const Options& options) {
  doctor::Observations seen;
  if (!options.captures.empty()) {
    if (!options.config_folder.empty()) seen.config = doctor::ReadConfig(options.config_folder);
    doctor::ReadCaptures(options.captures, seen);
    return seen;
  }
  seen.config = doctor::ReadConfig(options.config_folder);
  seen.bus = doctor::ReadBus(options.lcm_url);
  seen.buffers = doctor::ReadBuffers(seen.config);
  // Not where the config is wrong: other findings say so.
  std::optional<doctor::MountingWatch> mounting;
  if (options.looks_at_mounting && seen.config.boat && seen.config.odometer && seen.config.navigation) mounting.emplace(*seen.config.navigation);
  doctor::Watch(seen, std::chrono::seconds(options.seconds), mounting ? &*mounting : nullptr);
  if (mounting) seen.mounting = doctor::CompareMounting(mounting->recording(), {*seen.config.boat, *seen.config.odometer});
  seen.port = doctor::ReadPort(seen.bus);
  seen.interfaces = doctor::ReadInterfaces();
  seen.is_host_clock_set = doctor::IsHostClockSet();
  seen.disk = doctor::ReadDisk(seen);
  seen.page = doctor::ReadPage(seen.config);
  return seen;
}

}  // namespace

int main(int argc, char** argv) {
  const auto options = ParseOptions(argc, argv);
  bool has_fault = false;
  const int code = lookout::runtime::RunMain("doctor", [&] {
    if (options.check_only) {
      // The faults that each process would find at its start, of all files at once.
      lookout::config::FaultList faults;
      for (const auto& [file, lines] : doctor::ReadConfig(options.config_folder).files) {
        for (const auto& fault : lines) faults.Add(fault);
      }
      faults.ThrowIfAny();
      std::cout << lookout::runtime::EffectiveConfig(options.config_folder)
                << lookout::tracker::ZoneRemarksAsComments(lookout::tracker::LoadParams(options.config_folder));
      return;
    }
    const bool is_mounting_alone = options.looks_at_mounting && !options.captures.empty();
    const auto seen = is_mounting_alone ? ObserveMounting(options) : Observe(options);
    const auto findings = is_mounting_alone          ? doctor::CheckMountingSeen(seen)
                          : options.captures.empty() ? doctor::CheckAll(seen)
                                                     : doctor::CheckCaptures(seen);
    // no-color.org
    const bool has_colours = isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
    std::cout << doctor::ToReport(findings, has_colours);
    has_fault = doctor::HasFault(findings);
  });
  return code == EXIT_SUCCESS && has_fault ? EXIT_FAILURE : code;
}
