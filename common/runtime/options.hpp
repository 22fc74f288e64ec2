// The command line that every service has.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace lookout::runtime {

struct Options {
  std::filesystem::path config_folder;  // --config DIR
  bool check_only = false;              // --check: print the effective values and exit
  std::string lcm_url;                  // --lcm-url URL; else LCM_DEFAULT_URL, else LCM's default group on this computer
};

/// Reads the command line; --help and --version print and exit here, with 0. A wrong line prints what is wrong and exits with 2.
///
/// @param program  "lookout-segmenter"
/// @param purpose  one line for --help
Options ParseOptions(int argc, char** argv, const std::string& program, const std::string& purpose);

/// Version of Lookout, from the build.
std::string Version();

}  // namespace lookout::runtime
