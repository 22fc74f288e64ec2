// How ours stands against the best of the peers, scene by scene.
#pragma once

#include <string>
#include <vector>

#include "tools/eval/results.hpp"

namespace lookout::eval {

/// One scene, or the mean over the scenes. Shares from 0 to 1.
struct AgainstPeer {
  std::string scene;
  double our_iou = 0.0;     // mIoU of ours with all its segments, as all segments of a peer count
  double our_false = 0.0;   // false segments a scan, of the same row
  std::string peer;         // of the greatest mIoU there; of equals the first of the tables
  double peer_iou = 0.0;    // its mIoU
  double peer_false = 0.0;  // its false segments a scan
  /// (1 - our mIoU) / (1 - its mIoU): below 1 ours is better; NaN where the peer's mIoU is 100.0 % as printed.
  double error_share = 0.0;
};

/// @param is_tuned_only  look at peers that were tuned, else at all
/// @return scenes with objects in the order of the results, and then "mean": the peer of the greatest mean over the scenes, and the means. Empty
///         without ours or without such a peer
std::vector<AgainstPeer> CompareWithPeers(const Results& results, bool is_tuned_only);

}  // namespace lookout::eval
