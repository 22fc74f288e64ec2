// From a scan to its obstacles, by the lookout method or by that of Jeong and Quattrini Li (IROS 2021), with a label for every return.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/groups.hpp"
#include "services/segmenter/core/lookout/lookout_method.hpp"
#include "services/segmenter/core/measure.hpp"
#include "services/segmenter/core/numbering.hpp"
#include "services/segmenter/core/paper/component_clustering.hpp"
#include "services/segmenter/core/paper/component_labelling.hpp"
#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter {

enum class Method { kLookout, kPaper };

/// Defaults are those of config/schema/segmenter.proto, which says where they come from.
struct Params {
  ReturnFilter filter;
  Method method = Method::kLookout;
  LookoutParams lookout;
  // The paper's.
  LabellingParams labelling;
  bool component_clustering = true;
  ClusteringParams clustering;
  int min_segment_points = 1;
};

struct Segments {
  std::vector<std::int16_t> label;  // [cells] id of the segment; 0 = no return; minus the reason where a return is in none
  // [cells] where a label is above 0 the piece, from 1, that its segment is made of; else 0. Each piece is of one segment; numbers may have gaps.
  // Of the lookout method its tight pieces, of the paper's its components (where labels of 16 bits number no more: the segment's id).
  std::vector<std::int16_t> piece;
  std::vector<Segment> segments;    // by id
  std::int32_t num_too_small = 0;   // left out for having too few returns
  std::int32_t num_over_limit = 0;  // left out, the smallest, because labels of 16 bits number no more
  std::int64_t num_repeats = 0;     // returns that repeat another of their shot: labelled as that one, and in no segment's numbers
};

/// Segments one scan after the other. The result depends on that scan alone; only memory is kept.
class Segmenter {
 public:
  explicit Segmenter(const Params& params);

  /// The same scan gives the same segments, to the bit. The result holds until the next call.
  ///
  /// Cost: about proportional to the returns; figures in the README. The lookout method allocates nothing once it has seen a scan of that size.
  const Segments& Segment(const Scan& scan);

 private:
  void GroupAsThePaper(const Scan& scan);
  void LabelReturns();
  void NumberPieces();
  void DescribeSegments(const Scan& scan);

  Params params_;
  ReturnClassifier classifier_;
  LookoutMethod method_;
  Numbering numbering_;
  Measurer measurer_;
  Groups components_;  // the paper's
  std::vector<std::int32_t> cluster_of_component_;
  Segments result_;
};

/// One scan by itself.
Segments SegmentScan(const Scan& scan, const Params& params);

}  // namespace lookout::segmenter
