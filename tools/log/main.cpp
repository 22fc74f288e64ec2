// lookout-log: describes a log, writes a part of it, and makes a damaged one readable.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "common/core/log_time.hpp"
#include "common/core/printable.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "common/runtime/version.hpp"
#include "tools/log/commands.hpp"

namespace {

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

}  // namespace

int main(int argc, char** argv) {
  namespace log = lookout::log;
  lookout::io::CatchStopSignals();
  CLI::App app("Shows, cuts and mends lcm-logs.", "lookout-log");
  app.set_version_flag("--version", "lookout-log " + lookout::runtime::Version());
  app.require_subcommand(1);
  app.footer("Exit code: 0 fine; 1 a log cannot be read, holds nothing of it, or cannot be written; 2 wrong command line.");

  std::vector<std::filesystem::path> logs;
  auto* info = app.add_subcommand("info", "channels, types, rates, gaps, size, span, version, damage");
  info->add_option("LOG", logs, "lcm-log; several are read in this order, as one")->required();

  const CLI::Validator is_given([](std::string& text) { return text.empty() ? std::string("no time is given") : std::string(); }, "");
  log::SliceRequest request;
  auto* slice = app.add_subcommand("slice", "the events of a time and of some channels");
  slice->add_option("--in", request.inputs, "lcm-log; may be given several times, read in this order")->required()->allow_extra_args(false);
  slice->add_option("--out", request.output, "lcm-log to write: as FILE.partial until it is whole; one that exists is refused")->required();
  slice->add_flag("--force", request.force, "replace an existing --out");
  slice->add_option("--from", request.from, std::string("first time of the slice: ") + lookout::kTimeForms)->check(is_given);
  slice->add_option("--to", request.to, "the same; the first time that is not in it")->check(is_given);
  slice->add_option("--channel", request.channels, "this channel only; may be given several times")->allow_extra_args(false);

  std::filesystem::path damaged;
  std::filesystem::path mended;
  auto* repair = app.add_subcommand("repair", "every whole event of a damaged log, and what was lost");
  repair->add_option("IN", damaged, "lcm-log")->required();
  repair->add_option("OUT", mended, "lcm-log to write: as OUT.partial until it is whole; one that exists is refused")->required();
  bool force = false;
  repair->add_flag("--force", force, "replace an existing OUT");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // --help and --version come here too, with code 0.
    return app.exit(error) == 0 ? EXIT_SUCCESS : kExitUsage;
  }
  std::FILE* const progress = lookout::runtime::OnlyTerminal(stderr);
  try {
    if (info->parsed()) {
      log::Info(logs, std::cout, progress);
    } else if (slice->parsed()) {
      log::Slice(request, std::cout, std::cerr, progress);
    } else {
      log::Repair(damaged, mended, force, std::cout, std::cerr, progress);
    }
    std::cout.flush();
    if (!std::cout) throw std::runtime_error("standard output could not be written");
    return EXIT_SUCCESS;
  } catch (const log::UsageError& error) {
    std::cerr << "lookout-log: " << lookout::PrintableLines(error.what()) << "\n";
    return kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << "lookout-log: " << lookout::PrintableLines(error.what()) << "\n";
    return kExitFailed;
  }
}
