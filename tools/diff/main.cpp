// Two logs in, what differs out.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "common/core/printable.hpp"
#include "common/runtime/progress.hpp"
#include "common/runtime/version.hpp"
#include "tools/diff/diff.hpp"

int main(int argc, char** argv) {
  namespace diff = lookout::diff;
  diff::Request request;
  std::vector<std::string> tolerances;

  CLI::App app("Compares two lcm-logs, message by message: counts, and the first difference by channel, time and field.", "lookout-diff");
  app.add_option("A", request.a, "lcm-log")->required();
  app.add_option("B", request.b, "lcm-log")->required();
  app.add_option("--channel", request.channels,
                 "compare this channel only; may be given several times (without it: all but HEALTH, RUN_INFO and LCM_SELF_TEST)")
      ->allow_extra_args(false);
  app.add_option("--tolerance", tolerances,
                 "FIELD=VALUE or CHANNEL:FIELD=VALUE: numbers of that field may lie so far apart; FIELD is its name, or the end of its path "
                 "(segments.centroid_m); may be given several times")
      ->allow_extra_args(false);
  app.set_version_flag("--version", "lookout-diff " + lookout::runtime::Version());
  app.footer("Exit code: 0 equal; 1 different; 2 a log cannot be read, or wrong command line.");
  try {
    app.parse(argc, argv);
    // Tolerances for every channel first: they also hold on channels that have their own.
    for (const bool has_channel : {false, true}) {
      for (const auto& tolerance : tolerances) {
        if ((tolerance.find(':') < tolerance.find('=')) == has_channel) diff::AddTolerance(tolerance, request);
      }
    }
  } catch (const CLI::ParseError& error) {
    // --help and --version come here too, with code 0.
    return app.exit(error) == 0 ? EXIT_SUCCESS : diff::kExitUnreadable;
  } catch (const std::exception& error) {
    std::cerr << lookout::PrintableLines(error.what()) << "\n";
    return diff::kExitUnreadable;
  }
  request.progress = lookout::runtime::OnlyTerminal(stderr);
  const int code = diff::Run(request, std::cout, std::cerr);
  std::cout.flush();
  if (!std::cout) {
    std::cerr << "lookout-diff: standard output could not be written\n";
    return diff::kExitUnreadable;
  }
  return code;
}
