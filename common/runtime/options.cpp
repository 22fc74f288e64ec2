#include "common/runtime/options.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "common/bus/lcm_url.hpp"

namespace lookout::runtime {

std::string Version() { return LOOKOUT_VERSION; }

Options ParseOptions(int argc, char** argv, const std::string& program, const std::string& purpose) {
  Options options;
  std::string config_folder;
  CLI::App app(purpose, program);
  app.add_option("--config", config_folder, "folder of the boat's *.txtpb files")->required()->check(CLI::ExistingDirectory);
  app.add_flag("--check", options.check_only, "check the config, print the values in force, exit");
  app.add_option("--lcm-url", options.lcm_url, "LCM address (else the environment's LCM_DEFAULT_URL, else this computer only)");
  app.set_version_flag("--version", program + " " + Version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // --help and --version come here too, with code 0.
    const int code = app.exit(error);
    std::exit(code == 0 ? EXIT_SUCCESS : 2);
  }
  options.config_folder = config_folder;
  if (options.lcm_url.empty()) options.lcm_url = bus::DefaultLcmUrl();
  if (const auto fault = bus::LcmUrlFault(options.lcm_url); !fault.empty()) {
    std::cerr << program << ": " << fault << "\n";
    std::exit(2);
  }
  return options;
}

}  // namespace lookout::runtime
