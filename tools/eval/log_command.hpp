// lookout-eval --in: a log against the truth.
#pragma once

#include <string>

namespace lookout::eval {

struct LogOptions {
  std::string log_file;
  std::string truth_folder;  // empty = without truth
  int min_num_returns = 3;
};

/// Prints the tables of a log to stdout. @return exit code. @throws std::runtime_error for files that cannot be read
int EvaluateLog(const LogOptions& options);

}  // namespace lookout::eval
