// The main() that all services share: command line, --check, config, bus, the run, SIGHUP.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "common/runtime/process.hpp"

namespace lookout::runtime {

/// Behaviour of a service on SIGHUP, after it has checked the new config. A wrong config is logged, by file and line, and changes nothing.
enum class Hangup {
  kNewRun,      // ends its run, and starts anew in place with the new config
  kKeepConfig,  // keeps the old config until its next start, and says so
};

template <typename Params>
struct ServiceProgram {
  std::string name;     // "segmenter": program lookout-segmenter, config segmenter.txtpb
  std::string purpose;  // one line for --help
  Hangup hangup = Hangup::kKeepConfig;
  std::function<Params(const std::filesystem::path& config_folder)> load = {};  // throws ConfigError
  std::function<void(Process&, const Params&)> run = {};                        // may set another OnHangup
  std::function<std::string(const Params&)> remarks = {};                       // words of --check besides the values
  // On SIGHUP: throws std::runtime_error where the sources of the next config cannot be opened beside the running ones.
  std::function<void(const Params& next, const Params& running)> try_sources = {};
};

/// The same for params of any type.
using AnyParams = std::shared_ptr<const void>;
int RunService(int argc, char** argv, const ServiceProgram<AnyParams>& program);

/// @return exit code: 0 fine, 1 failed, 2 wrong config or command line
template <typename Params>
int ServiceMain(int argc, char** argv, const ServiceProgram<Params>& program) {
  const auto in = [](const AnyParams& params) -> const Params& { return *static_cast<const Params*>(params.get()); };
  ServiceProgram<AnyParams> any{.name = program.name, .purpose = program.purpose, .hangup = program.hangup};
  any.load = [&](const auto& config_folder) { return std::make_shared<const Params>(program.load(config_folder)); };
  any.run = [&](Process& process, const AnyParams& params) { program.run(process, in(params)); };
  if (program.remarks) any.remarks = [&](const AnyParams& params) { return program.remarks(in(params)); };
  if (program.try_sources) any.try_sources = [&](const AnyParams& next, const AnyParams& running) { program.try_sources(in(next), in(running)); };
  return RunService(argc, argv, any);
}

}  // namespace lookout::runtime
