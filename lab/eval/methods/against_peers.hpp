// How ours stands against the best of the peers, scene by scene.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lab/eval/methods/results.hpp"

namespace lookout::eval {

/// The peer of the greatest mIoU; of equals the first of the tables. Shares from 0 to 1.
struct BestPeer {
  std::string name;
  double iou = 0.0;             // the peer's mIoU
  double false_segments = 0.0;  // a scan
  /// (1 - our mIoU) / (1 - its mIoU): below 1 ours is better; NaN where the peer's mIoU is 100.0 % as printed.
  double error_share = 0.0;
};

/// One scene, or the mean over the scenes.
struct AgainstPeers {
  std::string scene;
  double our_iou = 0.0;    // mIoU of ours with all its segments, as all segments of a peer count
  double our_false = 0.0;  // false segments a scan, of the same row
  std::optional<BestPeer> tuned;
  BestPeer of_all;
};

/// @param name  of the row that is held against the peers, without its operating point
/// @return scenes with objects in the order of the results, and then "mean": the peer of the greatest mean over the scenes, and the means. Empty
///         without that row or without peers
std::vector<AgainstPeers> CompareWithPeers(const Results& results, std::string_view name = "ours");

}  // namespace lookout::eval
