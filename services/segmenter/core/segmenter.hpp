// From a turn to its obstacles: the method of Jeong and Quattrini Li (IROS 2021), with a label for every return.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/paper/component_clustering.hpp"
#include "services/segmenter/core/paper/component_labelling.hpp"
#include "services/segmenter/core/measure.hpp"
#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter {

/// Defaults are those of config/schema/segmenter.proto, which says where they come from.
struct Params {
  ReturnFilter filter;
  LabellingParams labelling;
  bool component_clustering = true;
  ClusteringParams clustering;
  int min_segment_points = 1;
};

struct Segments {
  std::vector<std::int16_t> label;  // [cells] id of the segment; 0 = no return; minus the reason where a return is in none
  std::vector<Segment> segments;    // by id
  std::int32_t num_too_small = 0;   // left out for having too few returns
  std::int32_t num_over_limit = 0;  // left out, the smallest, because labels of 16 bits number no more
  std::int64_t num_repeats = 0;     // returns that repeat another of their shot: labelled as that one, and in no segment's numbers
};

/// Pure: the same scan gives the same segments, to the bit.
///
/// Cost: about proportional to the returns; figures in the README.
Segments SegmentScan(const Scan& scan, const Params& params);

/// Joins the components of a cluster, leaves out what is too small, and numbers the rest in the order of their first return.
struct NumberedSegments {
  Groups groups;
  std::int32_t num_too_small = 0;
  std::int32_t num_over_limit = 0;
};
NumberedSegments NumberSegments(const Groups& components, std::span<const std::int32_t> cluster_of_component, int min_points,
                                std::int32_t max_segments);

}  // namespace lookout::segmenter
