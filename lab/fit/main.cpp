// lookout-fit: evidence of the lookout method, fitted on simulated scenes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "common/config/boat_folder.hpp"
#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/runtime/version.hpp"
#include "lab/fit/fit_command.hpp"

namespace {

using namespace lookout;

constexpr int kExitUsage = 2;

// Exits here for --help, --version and wrong lines.
fit::Options ParseOptions(int argc, char** argv) {
  fit::Options options;
  options.command = fmt::format("lookout-fit {}", fmt::join(argv + 1, argv + argc, " "));
  CLI::App app("Fits the evidence of the lookout method on simulated scenes, and writes it as a file that segmenter.txtpb can name.", "lookout-fit");
  app.add_option("--config", options.config_folder, "folder of the boat's *.txtpb files")
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault)
      ->required();
  app.add_option("--scenes", options.scenes, "families, all (scenes that are no families), or names of scenes or .txtpb files")
      ->delimiter(',')
      ->required();
  app.add_option("--lidar", options.lidars, "heads that look at the scenes, in turn from seed to seed (default: as the scenes say, vlp16)")
      ->delimiter(',');
  app.add_option("--without", options.without, "names of scenes that are not fitted on; their IoU is shown beside that of the others")
      ->delimiter(',');
  app.add_option("--hold-out", options.hold_out, "names of scenes that only say when trees are enough: where their loss is least")->delimiter(',');
  app.add_option("--seeds", options.num_seeds, "of each scene")->check(CLI::Range(1, 100))->capture_default_str();
  app.add_option("--first-seed", options.first_seed, "the others follow it; seeds above 100 are refused: tables are made on them")
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "of each scene and seed")->check(CLI::Range(0.2, 3600.0))->capture_default_str();
  app.add_option("--trees", options.num_trees, "of each sum, at most")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--drop-feature", options.dropped, "names of features that no tree may ask for: what they are worth")->delimiter(',');
  app.add_option("--out", options.out, "file to write, NAME.txtpb; without it only the tables are shown");
  app.add_flag("--force", options.is_forced, "replace a file that is there");
  app.set_version_flag("--version", "lookout-fit " + runtime::Version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) try { return fit::FitScenes(ParseOptions(argc, argv)); } catch (const std::invalid_argument& error) {
  std::cerr << "lookout-fit: " << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const config::ConfigError& error) {
  std::cerr << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const std::exception& error) {
  std::cerr << "lookout-fit: " << lookout::PrintableLines(error.what()) << '\n';
  return EXIT_FAILURE;
}
