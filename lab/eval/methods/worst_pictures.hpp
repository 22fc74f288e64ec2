// Pictures (SVG) of the scans that went worst, truth and prediction side by side, with the fates of lost things.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lab/eval/methods/results.hpp"
#include "lab/eval/methods/run_plan.hpp"

namespace lookout::eval {

/// From above, the lidar's x axis up: the truth at the left, the segments at the right, each with its colours. Land is brown, what belongs to no
/// object or segment grey. Circles number the things that were lost; below, what became of them. The view ends a little behind the farthest of these.
std::string PictureOf(const std::string& title, const LabelledScan& truth, const std::vector<std::int32_t>& label);

/// For each row of the tables and each scene the scans of least mIoU; at most one of ten scans (1 s) of a seed, since neighbours look alike.
class WorstPictures {
 public:
  explicit WorstPictures(std::size_t num_per_scene) : num_per_scene_(num_per_scene) {}

  void Add(const std::string& method, const ScanPlace& place, const LabelledScan& truth, const std::vector<std::int32_t>& label, const Score& score);

  /// Writes METHOD/SCENE/RANK-seed-SEED-scan-SCAN.svg into the folder, and makes it.
  ///
  /// @param force  replace existing files: pictures of the same methods and scenes are removed
  /// @throws std::runtime_error when a file is there, or cannot be written
  void Write(const std::filesystem::path& folder, bool force) const;

 private:
  struct Picture {
    std::uint64_t seed;
    int index;  // of the scan
    double iou;
    std::string svg;
  };

  std::size_t num_per_scene_;
  std::map<std::pair<std::string, std::string>, std::vector<Picture>> pictures_;  // by method and scene, worst first
};

}  // namespace lookout::eval
