// The peers in one run: methods of others, on their published defaults and tuned on our scenes. All are written by us from the papers.
#pragma once

#include "lab/eval/methods/method.hpp"
#include "services/segmenter/core/returns.hpp"

namespace lookout::eval {

/// @param filter  as the segmenter of the boat uses it, so that all methods look at the same returns
/// @return Euclidean clustering, depth clustering and F3D, each first on its defaults, then tuned. Values and their sources: README.md beside this.
Methods MakePeers(const segmenter::ReturnFilter& filter);

}  // namespace lookout::eval
