// lookout-learned: labelled pixels of simulated scenes, on which SqueezeSeg is trained.
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "common/config/boat_folder.hpp"
#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/runtime/version.hpp"
#include "lab/learned/export_command.hpp"

namespace {

using namespace lookout;

constexpr int kExitUsage = 2;

// Exits here for --help, --version and wrong lines.
learned::Options ParseOptions(int argc, char** argv) {
  learned::Options options;
  CLI::App app("Writes simulated scans with the class of each return, as images for the training of SqueezeSeg.", "lookout-learned");
  app.add_option("--config", options.config_folder, "folder of the boat's *.txtpb files")
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault)
      ->required();
  app.add_option("--scenes", options.scenes, "families, all (scenes that are no families), or names of scenes or .txtpb files")
      ->delimiter(',')
      ->required();
  app.add_option("--seeds", options.num_seeds, "of each scene")->check(CLI::Range(1, 100))->capture_default_str();
  app.add_option("--first-seed", options.first_seed, "the others follow it; seeds above 100 are refused: tables are made on them")
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "of each scene and seed")->check(CLI::Range(0.2, 3600.0))->capture_default_str();
  app.add_option("--weights", options.weights, "NAME.json of a trained network: its probabilities are written, too")->check(CLI::ExistingFile);
  app.add_option("--out", options.out, "folder of scans.csv and returns.bin")->check(CLI::ExistingDirectory)->required();
  app.add_flag("--force", options.is_forced, "replace files that are there");
  app.set_version_flag("--version", "lookout-learned " + runtime::Version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) try { return learned::ExportScenes(ParseOptions(argc, argv)); } catch (const std::invalid_argument& error) {
  std::cerr << "lookout-learned: " << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const config::ConfigError& error) {
  std::cerr << lookout::PrintableLines(error.what()) << '\n';
  return kExitUsage;
} catch (const std::exception& error) {
  std::cerr << "lookout-learned: " << lookout::PrintableLines(error.what()) << '\n';
  return EXIT_FAILURE;
}
