// lookout-eval: how good the obstacles of a log are, against the truth of a simulation; and how good methods of segmentation are, on simulated
// scenes or on recordings of others.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "common/config/boat_folder.hpp"
#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/runtime/version.hpp"
#include "lab/eval/comparison_command.hpp"
#include "lab/eval/log_command.hpp"
#include "lab/eval/navigation/navigation_command.hpp"
#include "lab/eval/sensor_command.hpp"
#include "lab/eval/tracks/alert_command.hpp"
#include "lab/eval/tracks/track_autoferry.hpp"
#include "lab/eval/tracks/track_command.hpp"
#include "lab/sim/heads.hpp"

namespace {

using namespace lookout;

constexpr int kExitUsage = 2;
constexpr double kSecondsOfTracks = 20.0;  // of each scene and seed
constexpr double kSecondsOfAlerts = 60.0;
constexpr double kSecondsOfNavigation = 80.0;  // the gap of 60 s, and what is before and behind it

struct Options {
  eval::LogOptions log;
  eval::ComparisonOptions comparison;
  std::string autoferry_folder;   // empty = none
  bool has_tracks = false;        // trackers on runs, in place of methods on scans
  bool has_ablation = false;      // of these
  bool is_without_earth = false;  // of these
  bool has_alerts = false;        // alerts on runs, in place of methods on scans
  bool has_navigation = false;    // own motion and POSE on runs, in place of methods on scans
  std::vector<std::filesystem::path> captures;
  std::filesystem::path list_file;
  std::optional<double> berth_seconds;
  bool has_kiss_icp = false;  // of these
  std::filesystem::path kept_folder;
  bool are_figures_long = false;
  std::size_t num_jobs = 1;
};

// Exits here for --help, --version and wrong lines.
Options ParseOptions(int argc, char** argv) {
  Options options;
  auto& log = options.log;
  auto& comparison = options.comparison;
  comparison.command = fmt::format("lookout-eval {}", fmt::join(argv + 1, argv + argc, " "));
  CLI::App app(
      "Holds a log against the truth of lookout-sim (--in), or compares methods of segmentation on simulated scenes (--config with --scenes, "
      "--captures, --sweep, --test or --points).",
      "lookout-eval");
  auto* in = app.add_option("--in", log.log_file, "lcm-log with OBSTACLES");
  auto* truth = app.add_option("--truth", log.truth_folder, "folder that lookout-sim --truth wrote")->needs(in);
  app.add_option("--boat", log.true_boat_folder,
                 "folder with the boat.txtpb of the simulation, where the log was computed with another mounting of the lidar")
      ->check(CLI::ExistingDirectory)
      ->needs(truth);
  app.add_option("--min-returns", log.min_num_returns, "an object with fewer returns in a scan does not count for recall")
      ->check(CLI::Range(1, 1'000'000))
      ->needs(in)
      ->capture_default_str();

  app.add_option("--figures", log.figures_file, "write the figures of a log against the truth, one a row, as a CSV file: figure, value")
      ->needs(truth);

  auto* config = app.add_option("--config", comparison.config_folder, "folder of the boat's *.txtpb files")
                     ->check(CLI::ExistingDirectory)
                     ->check(lookout::config::BoatFolderFault)
                     ->excludes(in);
  const auto needs_config = [config](CLI::Option* option) { return option->needs(config); };
  needs_config(app.add_option("--scenes", comparison.scenes, "all, families (all of them), or names of scenes or .txtpb files"))->delimiter(',');
  auto* weights = needs_config(app.add_option("--weights", comparison.weights_folder, "folder of evidence: without-FAMILY.txtpb and all.txtpb"))
                      ->check(CLI::ExistingDirectory);
  needs_config(app.add_option("--network", comparison.network_folder, "folder of the weights of SqueezeSeg (default: lab/learned/weights)"))
      ->check(CLI::ExistingDirectory);
  auto* left_out = app.add_option("--leave-out", comparison.left_out, "families, or names of some: ours with evidence fitted without them, too")
                       ->delimiter(',')
                       ->needs(weights);
  weights->needs(left_out);
  needs_config(app.add_option("--points", comparison.points, "scans out of files: .pcd, or .bin (KITTI) with a .label beside it"))
      ->check(CLI::ExistingFile);
  needs_config(app.add_option(
      "--captures", options.captures,
      "folder of captures with truth: NAME-SEED.pcap.xz, .truth.csv.xz, .objects.csv.xz, boat.txtpb (with --tracks and --alerts several)"));
  auto* autoferry = app.add_option("--autoferry", options.autoferry_folder,
                                   "trackers on the Autoferry data set: folder of its files (--config: of the boat's tracker)")
                        ->check(CLI::ExistingDirectory);
  needs_config(app.add_option("--seeds", comparison.num_seeds, "of each scene"))->check(CLI::Range(1, 100'000))->capture_default_str();
  needs_config(app.add_option("--first-seed", comparison.first_seed,
                              "the others follow it (default: 101 for methods and tests, 1 for --sweep and --tuning; the other range is refused)"));
  needs_config(app.add_flag("--tuning", comparison.is_tuning, "methods on seeds of tuning; no file is written"));
  auto* seconds = needs_config(app.add_option("--seconds", comparison.seconds, "of each scene and seed (with --tracks 20, with --alerts 60)"));
  seconds->check(CLI::Range(0.3, 3600.0))->capture_default_str();
  needs_config(
      app.add_option("--lidar", comparison.lidars,
                     "heads that look at the scenes (lookout-sim --lidar), or all: methods in a table by sensor; with --tracks each a world"))
      ->delimiter(',');
  needs_config(app.add_option("--methods", comparison.methods, "all, ours, paper, peers, or names; without --sweep and --test the default is all"))
      ->delimiter(',');
  needs_config(app.add_option("--sweep", comparison.sweeps, "FIELD=FROM:TO:STEP, a number of the segmenter's config (e1, e2, e3 for short)"));
  needs_config(app.add_option("--test", comparison.tests, "tests of the paper: 1, 2, 3"))->delimiter(',')->check(CLI::Range(1, 3));
  needs_config(app.add_option("--csv", comparison.csv_folder, "write each table as a CSV file to this folder"));
  needs_config(app.add_option("--html", comparison.html_file, "write the report as one page"));
  needs_config(app.add_option("--lost", comparison.lost_file,
                              "write each thing that was lost (with --tracks: missed, false, switch of each scan), as a row of a CSV file"));
  auto* pictures =
      needs_config(app.add_option("--pictures", comparison.pictures_folder, "draw the worst scans of each method and scene into this folder"));
  app.add_option("--worst", comparison.num_worst, "pictures of each method and scene")
      ->check(CLI::Range(1, 100))
      ->needs(pictures)
      ->capture_default_str();
  app.add_option("--blocks", comparison.block_files, "README files in whose marked blocks the figures are written")
      ->check(CLI::ExistingFile)
      ->excludes(in);
  app.add_flag("--force", comparison.is_forced, "replace files that are there");
  auto* tracks = needs_config(app.add_flag("--tracks", options.has_tracks, "trackers on runs of all services, in place of methods on scans"));
  auto* alerts = needs_config(app.add_flag("--alerts", options.has_alerts, "alerts on runs of all services, in place of methods on scans"));
  app.add_option("--list", options.list_file, "with --alerts: write each alert and each danger, as a row of a CSV file")->needs(alerts);
  app.add_option("--berth-seconds", options.berth_seconds,
                 "with --alerts: of each seed of scenes in which the own boat lies still (default: --seconds)")
      ->check(CLI::Range(1.0, 36'000.0))
      ->needs(alerts);
  auto* navigation =
      needs_config(app.add_flag("--navigation", options.has_navigation, "own motion by the lidar and POSE with it, in place of methods on scans"));
  navigation->excludes(tracks)->excludes(alerts);
  app.add_option("--keep", options.kept_folder,
                 "with --alerts: keep there what the tracker reads in simulated runs, and use it the next time; with --navigation: LIDAR_ODOMETRY");
  app.add_flag("--kiss-icp", options.has_kiss_icp, "with --navigation: own motion alone, beside KISS-ICP on the same scans")
      ->needs(navigation)
      ->excludes(app.get_option("--keep"));
  app.add_flag("--long", options.are_figures_long, "with --alerts and --blocks: fill the blocks of long runs (long_alerts_...)")->needs(alerts);
  app.add_option("--jobs", options.num_jobs, "with --alerts: runs at once; the figures are the same")
      ->check(CLI::Range(1, 256))
      ->needs(alerts)
      ->capture_default_str();
  for (const char* other : {"--lost", "--tracks"}) alerts->excludes(app.get_option(other));
  auto* ablation = app.add_flag("--ablation", options.has_ablation, "with --tracks: the boat's tracker without each of its parts, in one table");
  ablation->needs(tracks)->excludes(left_out);
  app.add_flag("--without-earth", options.is_without_earth,
               "with --tracks and --scenes: boats have neither receiver nor compass, so tracks are in the relative frame of POSE")
      ->needs(tracks)
      ->excludes(left_out)
      ->excludes(app.get_option("--captures"));
  alerts->excludes(left_out);
  autoferry->excludes(left_out);
  auto* lidar = app.get_option("--lidar");
  for (const char* other : {"--captures", "--leave-out", "--sweep", "--test", "--points", "--html", "--pictures", "--alerts"}) {
    lidar->excludes(app.get_option(other));
  }
  for (const char* other : {"--methods", "--sweep", "--test", "--points", "--html", "--pictures"}) {
    tracks->excludes(app.get_option(other));
    alerts->excludes(app.get_option(other));
    navigation->excludes(app.get_option(other));
    autoferry->excludes(app.get_option(other));
  }
  for (const char* other : {"--captures", "--lost", "--blocks"}) navigation->excludes(app.get_option(other));
  for (const char* other : {"--in", "--scenes", "--captures", "--tracks", "--alerts", "--csv", "--lost"}) autoferry->excludes(app.get_option(other));
  app.set_version_flag("--version", "lookout-eval " + runtime::Version());
  try {
    app.parse(argc, argv);
    if (log.log_file.empty() && comparison.config_folder.empty() && options.autoferry_folder.empty())
      throw CLI::RequiredError("one of --in LOG, --config DIR, --autoferry DIR");
    if (!options.kept_folder.empty() && !options.has_alerts && !options.has_navigation)
      throw CLI::RequiredError("--alerts or --navigation, for --keep");
    if (!options.has_alerts && !options.has_tracks) {
      if (options.captures.size() > 1) throw CLI::ValidationError("--captures", "several folders are for --tracks and --alerts alone");
      if (!options.captures.empty()) comparison.captures = options.captures.front();
    }
    if (!comparison.config_folder.empty() && !((options.has_alerts || options.has_tracks) && !options.captures.empty())) {
      const bool has_scans = !comparison.scenes.empty() || !comparison.points.empty() || !comparison.captures.empty();
      if (!has_scans && comparison.tests.empty() && options.autoferry_folder.empty())
        throw CLI::RequiredError("with --config, one of --scenes, --captures, --points, --test, --autoferry");
      if (comparison.scenes.empty() && !comparison.sweeps.empty()) throw CLI::RequiredError("--scenes, for --sweep");
      if (!has_scans && !comparison.methods.empty()) throw CLI::RequiredError("--scenes, --captures or --points, for --methods");
      if (comparison.methods.empty() &&
          ((comparison.sweeps.empty() && comparison.tests.empty()) || !comparison.points.empty() || !comparison.captures.empty()))
        comparison.methods = {"all"};
    }
    if (options.has_tracks && seconds->count() == 0) comparison.seconds = kSecondsOfTracks;
    if (options.has_alerts && seconds->count() == 0) comparison.seconds = kSecondsOfAlerts;
    if (options.has_navigation && seconds->count() == 0) comparison.seconds = kSecondsOfNavigation;
    if (comparison.lidars == std::vector<std::string>{"all"}) comparison.lidars = sim::HeadNames();
    eval::CheckLidars(comparison.lidars);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

eval::RunOptions RunsOf(const eval::ComparisonOptions& options) {
  const auto use = options.is_tuning ? eval::SeedUse::kTuning : eval::SeedUse::kTables;
  return {options.config_folder, eval::PlanOf(options, use), options.is_tuning, options.csv_folder, options.is_forced, options.block_files};
}

}  // namespace

int main(int argc, char** argv) try {
  const auto options = ParseOptions(argc, argv);
  if (!options.log.log_file.empty()) {
    auto log = options.log;
    log.is_forced = options.comparison.is_forced;
    return eval::EvaluateLog(log);
  }
  if (!options.autoferry_folder.empty()) {
    return eval::EvaluateAutoferry({options.autoferry_folder, options.comparison.config_folder, options.comparison.block_files});
  }
  const auto& comparison = options.comparison;
  if (options.has_alerts) {
    return eval::EvaluateAlerts({RunsOf(comparison), options.berth_seconds.value_or(comparison.seconds), options.captures, options.num_jobs,
                                 options.kept_folder, options.list_file, options.are_figures_long});
  }
  if (options.has_navigation) {
    eval::NavigationOptions navigation;
    static_cast<eval::RunOptions&>(navigation) = RunsOf(comparison);
    navigation.kept_folder = options.kept_folder;
    navigation.has_kiss_icp = options.has_kiss_icp;
    return eval::EvaluateNavigation(navigation);
  }
  if (options.has_tracks) {
    return eval::EvaluateTracks({RunsOf(comparison), options.captures, comparison.lost_file, options.has_ablation, eval::LeftOutOf(comparison),
                                 options.is_without_earth, comparison.weights_folder});
  }
  return comparison.lidars.empty() ? eval::CompareMethods(comparison) : eval::CompareSensors(comparison);
} catch (const std::invalid_argument& error) {
  std::cerr << "lookout-eval: " << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const config::ConfigError& error) {
  std::cerr << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const std::exception& error) {
  std::cerr << "lookout-eval: " << lookout::PrintableLines(error.what()) << '\n';
  return EXIT_FAILURE;
}
