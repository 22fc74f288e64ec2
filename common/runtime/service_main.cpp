#include "common/runtime/service_main.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <spdlog/spdlog.h>
#include <stdexcept>
#include <vector>

#include "common/bus/lcm_url.hpp"
#include "common/config/boat_folder.hpp"
#include "common/config/text_config.hpp"
#include "common/runtime/run_info.hpp"
#include "common/runtime/version.hpp"

namespace lookout::runtime {

namespace {

struct Options {
  std::filesystem::path config_folder;  // --config DIR
  bool check_only = false;              // --check: print the effective values and exit
  std::string lcm_url;                  // --lcm-url URL; else LCM_DEFAULT_URL, else LCM's default group on this computer
};

// --help and --version print and exit here, with 0. A wrong line prints its fault and exits with 2.
Options ParseOptions(int argc, char** argv, const std::string& program, const std::string& purpose) {
  Options options;
  std::string config_folder;
  CLI::App app(purpose, program);
  app.add_option("--config", config_folder, "folder of the boat's *.txtpb files")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->check(lookout::config::BoatFolderFault);
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

struct Checked {
  AnyParams params;
  std::string text;  // the values in force
};

// @throws config::ConfigError with the faults of both files
Checked CheckConfig(const ServiceProgram<AnyParams>& program, const std::filesystem::path& config_folder) {
  config::FaultList faults;
  const auto params = faults.Take([&] { return program.load(config_folder); });
  const std::vector<std::string> files{"boat.txtpb", program.name + ".txtpb"};
  const auto text = faults.Take([&] { return EffectiveConfig(config_folder, files); });
  faults.ThrowIfAny();
  return {*params, *text};
}

bool IsConfigRight(const ServiceProgram<AnyParams>& program, const std::filesystem::path& config_folder, const AnyParams& running) {
  try {
    const auto next = CheckConfig(program, config_folder);
    if (program.try_sources) program.try_sources(next.params, running);
    return true;
  } catch (const config::ConfigError& error) {
    for (const auto& fault : error.faults()) spdlog::error("{}", fault);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
  spdlog::error("SIGHUP: the new config is wrong; the old one stays in force");
  return false;
}

// Names of before go on working for a while.
void TellOldNames(const std::filesystem::path& called, const std::string& name, const std::filesystem::path& config_folder) {
  const auto own = "lookout-" + name;
  if (called.filename() == "lookout-vlp16") spdlog::warn("lookout-vlp16 is the old name of {}; it will go", own);
  if (const auto old = config::OldConfigFile(config_folder / (name + ".txtpb"))) {
    spdlog::warn("{} is the old name of {}.txtpb, and is read in its place for now: rename it", old->string(), name);
  }
}

// Descriptors that libraries opened without O_CLOEXEC must not pile up from start to start. Where they cannot be closed the look-out goes on all the
// same.
void CloseAllAtExecution() {
  constexpr int kFirstAfterStandardError = 3;
  constexpr unsigned int kLast = ~0U;
  if (close_range(kFirstAfterStandardError, kLast, CLOSE_RANGE_CLOEXEC) == 0) return;
  // Before Linux 5.11.
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const std::string name = entry.path().filename().string();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (descriptor >= kFirstAfterStandardError) fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  }
}

// Replaces the process by a fresh start of its own program: same process id, same command line, nothing of the old state. Signals that wait stay
// waiting: they reach the new start, as they are blocked here and are blocked there. @throws std::runtime_error: nothing has changed then
[[noreturn]] void ExecuteAgain(char** argv) {
  const std::string self = "/proc/self/exe";
  // By its own path, so that ps shows its name; by the link, when the file was replaced meanwhile.
  std::error_code error;
  std::string program = std::filesystem::read_symlink(self, error).string();
  if (error || access(program.c_str(), X_OK) != 0) program = self;

  std::cout.flush();
  spdlog::default_logger()->flush();
  CloseAllAtExecution();
  execv(program.c_str(), argv);
  throw std::runtime_error("cannot start " + program + " again: " + std::strerror(errno));
}

}  // namespace

int RunService(int argc, char** argv, const ServiceProgram<AnyParams>& program) {
  BlockStopSignals();
  const auto options = ParseOptions(argc, argv, "lookout-" + program.name, program.purpose);
  bool starts_again = false;
  const int code = RunMain(program.name, [&] {
    if (options.check_only) {
      const auto checked = CheckConfig(program, options.config_folder);
      std::cout << checked.text << (program.remarks ? program.remarks(checked.params) : "");
      return;
    }
    const auto params = program.load(options.config_folder);
    TellOldNames(argv[0], program.name, options.config_folder);
    Process process(program.name, options.lcm_url);
    process.OnHangup([&] {
      if (!IsConfigRight(program, options.config_folder, params)) return;
      if (program.hangup == Hangup::kKeepConfig) {
        spdlog::info("SIGHUP: the config in the folder is right; it takes effect at the next start, until then the old one stays in force");
        return;
      }
      spdlog::info("SIGHUP: starts again with the new config");
      starts_again = true;
      process.Stop();
    });
    program.run(process, params);
  });
  if (code != EXIT_SUCCESS || !starts_again) return code;
  return RunMain(program.name, [argv] { ExecuteAgain(argv); });
}

}  // namespace lookout::runtime
