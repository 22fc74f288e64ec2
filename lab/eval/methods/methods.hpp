// The methods by name: ours, the paper's, and the peers.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "services/segmenter/core/segmenter.hpp"

namespace lookout::eval {

/// The segmenter of the boat. Labels and time come from its undivided run; its stages are then measured in a second pass: project (sort out
/// returns and place them in the image), search, cluster, measure.
class SegmenterMethod final : public Method {
 public:
  SegmenterMethod(std::string name, const segmenter::Params& params) : name_(std::move(name)), params_(params), segmenter_(params) {}

  std::string name() const override { return name_; }
  bool knows_doubt() const override { return params_.method == segmenter::Method::kLookout; }
  Labelling Segment(const segmenter::Scan& scan) override;

 private:
  std::string name_;
  segmenter::Params params_;
  segmenter::Segmenter segmenter_;
};

/// The paper's method at this width of its image, with the boat's own crop box and the paper's thresholds.
segmenter::Params PaperParams(const segmenter::Params& boat, int image_columns);

/// Every return a component by itself, so that clustering has all the work: no pair of neighbours has beta above 90 degrees, or a distance below 0.
segmenter::Params WithoutSearch(segmenter::Params params);

/// Widths of the paper's image: 512 is its setting in real time.
inline constexpr int kPaperColumns[] = {512, 1024, 1800};
inline constexpr int kPaperFullColumns = 1800;

/// @param boat       params of the boat's segmenter
/// @param selection  names of methods, or of groups: all, ours, paper, peers. Ours are those whose name begins with "ours", and so for the paper
/// @return the methods that are named, in the order of the tables
/// @throws std::invalid_argument for a name that is none; it says which there are
Methods MakeMethods(const segmenter::Params& boat, std::span<const std::string> selection);

}  // namespace lookout::eval
