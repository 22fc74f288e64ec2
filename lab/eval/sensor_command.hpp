// lookout-eval --lidar: the methods on the same scenes, seen by other lidars.
#pragma once

#include "lab/eval/comparison_command.hpp"

namespace lookout::eval {

/// One table: a row for each head of options.lidars and each method. @return exit code
/// @throws as CompareMethods
int CompareSensors(const ComparisonOptions& options);

}  // namespace lookout::eval
