// The outputs of a config, with their links.
#pragma once

#include <memory>
#include <vector>

#include "services/plotter/io/links.hpp"
#include "services/plotter/output.hpp"
#include "services/plotter/params.hpp"

namespace lookout::plotter {

/// In the language that `output` names.
std::unique_ptr<Output> MakeOutput(const Params& params, const OutputParams& output, std::unique_ptr<Link> link);

/// @param links  outlives the result
/// @throws std::runtime_error naming the output: an address is not numeric, or a request cannot hold its path or token
std::vector<std::unique_ptr<Output>> OpenOutputs(const Params& params, Links& links);

}  // namespace lookout::plotter
