// lookout-eval --in: a log against the truth.
#pragma once

#include <string>

namespace lookout::eval {

struct LogOptions {
  std::string log_file;
  std::string truth_folder;      // empty = without truth
  std::string true_boat_folder;  // holds the boat.txtpb of the simulated boat; empty = the one in the log
  int min_num_returns = 3;
  std::string figures_file;  // empty = none
  bool is_forced = false;    // replace it
};

/// Prints the tables of a log to stdout. @return exit code. @throws std::runtime_error for files that cannot be read, config::ConfigError
int EvaluateLog(const LogOptions& options);

}  // namespace lookout::eval
