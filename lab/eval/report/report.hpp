// The tables of lookout-eval.
#pragma once

#include <ostream>

#include "lab/eval/report/evaluation.hpp"
#include "lab/eval/report/machine.hpp"

namespace lookout::eval {

void PrintObstacles(std::ostream& out, const Evaluation& evaluation, bool has_truth);
void PrintAccuracy(std::ostream& out, const Evaluation& evaluation);
/// Prints the places of obstacles against the true centres of the parts that were seen.
void PrintSeen(std::ostream& out, const Evaluation& evaluation);
void PrintSegmentation(std::ostream& out, const Evaluation& evaluation, int min_num_returns);
void PrintMachine(std::ostream& out, const Machine& machine);

}  // namespace lookout::eval
