#include "tools/eval/scoring.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

namespace lookout::eval {
namespace {

struct ObjectInScan {
  std::int32_t id = 0;
  std::int64_t num_returns = 0;
  double nearest_m = std::numeric_limits<double>::infinity();
  double iou = 0.0;
  bool has_segment = false;  // more than half of the returns of some segment are its
  int num_parts = 0;         // segments with a tenth of it or more
};

struct SegmentInScan {
  std::int64_t num_returns = 0;
  std::int64_t num_own_vessel = 0;
  std::int64_t num_none = 0;
  std::int64_t num_of_majority = 0;  // of the object with most returns
  std::int64_t num_of_objects = 0;
  int num_parts = 0;  // objects of which it holds a tenth or more
};

// A return of an object in a segment: index of the segment, index of the object. Sorted, equal pairs lie together.
using Pair = std::pair<std::size_t, std::size_t>;

struct Matches {
  std::vector<ObjectInScan> objects;    // those with a return, by id
  std::vector<SegmentInScan> segments;  // by id - 1; ids that do not occur have no returns
  std::vector<Pair> pairs;              // sorted
};

Matches Count(const LabelledScan& truth, const std::vector<std::int32_t>& label) {
  const auto& range = truth.scan.columns.range;
  if (label.size() != range.size() || truth.object.size() != range.size()) throw std::logic_error("ScoreScan: labels and cells do not agree");
  std::map<std::int32_t, ObjectInScan> by_id;
  std::int32_t max_label = 0;
  for (std::size_t cell = 0; cell < range.size(); ++cell) {
    if (range[cell] == 0 || label[cell] == kNotScored) continue;
    max_label = std::max(max_label, label[cell]);
    if (truth.object[cell] <= 0) continue;
    auto& object = by_id[truth.object[cell]];
    object.id = truth.object[cell];
    ++object.num_returns;
    object.nearest_m = std::min(object.nearest_m, range[cell] * truth.scan.head.range_unit_m);
  }
  Matches scan;
  std::map<std::int32_t, std::size_t> index_of;
  for (const auto& [id, object] : by_id) {
    index_of[id] = scan.objects.size();
    scan.objects.push_back(object);
  }
  scan.segments.resize(static_cast<std::size_t>(max_label));
  for (std::size_t cell = 0; cell < range.size(); ++cell) {
    if (range[cell] == 0 || label[cell] <= 0) continue;
    auto& segment = scan.segments[static_cast<std::size_t>(label[cell] - 1)];
    ++segment.num_returns;
    if (truth.object[cell] > 0) {
      scan.pairs.emplace_back(static_cast<std::size_t>(label[cell] - 1), index_of.at(truth.object[cell]));
    } else {
      ++(truth.object[cell] == kOwnVesselObject ? segment.num_own_vessel : segment.num_none);
    }
  }
  std::ranges::sort(scan.pairs);
  return scan;
}

// Calls for each pair of segment and object that share returns, segment by segment, with their number.
template <typename Handler>
void ForEachOverlap(Matches& scan, Handler handle) {
  for (auto begin = scan.pairs.begin(); begin != scan.pairs.end();) {
    const auto end = std::find_if(begin, scan.pairs.end(), [&](const Pair& pair) { return pair != *begin; });
    const auto [segment, object] = *begin;
    handle(scan.segments[segment], scan.objects[object], static_cast<std::int64_t>(end - begin));
    begin = end;
  }
}

void Compare(Matches& scan) {
  ForEachOverlap(scan, [&](SegmentInScan& segment, ObjectInScan& object, std::int64_t num_both) {
    const double iou = static_cast<double>(num_both) / static_cast<double>(object.num_returns + segment.num_returns - num_both);
    object.iou = std::max(object.iou, iou);
    if (2 * num_both > segment.num_returns) object.has_segment = true;
    if (kLeastPartsOfObject * num_both >= object.num_returns) {
      ++object.num_parts;
      ++segment.num_parts;
    }
    segment.num_of_objects += num_both;
    segment.num_of_majority = std::max(segment.num_of_majority, num_both);
  });
}

template <typename Value>
void AddTo(std::pair<std::int64_t, Value>& count_and_sum, Value value) {
  ++count_and_sum.first;
  count_and_sum.second += value;
}

std::int64_t NumTruePositives(const Matches& scan) {
  std::int64_t count = 0;
  for (const auto& segment : scan.segments) {
    // Of equals the object with the least id takes it; which one it is does not change the number.
    if (segment.num_of_majority >= std::max(segment.num_own_vessel, segment.num_none)) count += segment.num_of_majority;
  }
  return count;
}

}  // namespace

Labelling SureOnly(Labelling labelling) {
  for (auto& label : labelling.label) {
    if (label > 0 && !labelling.is_sure.empty() && !labelling.is_sure.at(static_cast<std::size_t>(label - 1))) label = 0;
  }
  labelling.is_sure.clear();
  return labelling;
}

Score ScoreScan(const LabelledScan& truth, const Labelling& labelling) {
  Matches scan = Count(truth, labelling.label);
  Compare(scan);
  Score score;
  score.num_scans = 1;
  std::int64_t num_water = 0;
  for (const auto& object : scan.objects) {
    const auto& about = truth.objects.at(object.id);
    score.sum_iou += object.iou;
    if (about.is_in_water) {
      score.sum_water_iou += object.iou;
      ++num_water;
    }
    const bool is_found = object.iou >= kFoundIou;
    AddTo(score.iou_by_kind[about.kind], object.iou);
    const int bin = static_cast<int>(object.nearest_m / Score::kRangeBinM);
    AddTo(score.recall_by_range[bin], std::int64_t{is_found});
    AddTo(score.iou_by_range[bin], object.iou);
    if (object.nearest_m < Score::kNearM) {
      auto& recall = score.near_recall_by_kind[about.kind];
      ++recall.num_object_scans;
      recall.num_found += is_found ? 1 : 0;
    }
    if (object.num_returns >= Score::kMinReturnsOfThing) {
      ++score.num_things;
      score.num_things_with_segment += object.has_segment ? 1 : 0;
    }
    score.num_over_segmented += object.num_parts >= 2 ? 1 : 0;
    score.num_returns += object.num_returns;
  }
  score.num_object_scans = static_cast<std::int64_t>(scan.objects.size());
  if (!scan.objects.empty()) {
    score.num_scans_with_object = 1;
    score.sum_iou /= static_cast<double>(scan.objects.size());
  }
  if (num_water > 0) {
    score.num_scans_with_water_object = 1;
    score.sum_water_iou /= static_cast<double>(num_water);
  }
  for (const auto& segment : scan.segments) {
    if (segment.num_returns == 0) continue;
    ++score.num_segments;
    score.num_under_segmented += segment.num_parts >= 2 ? 1 : 0;
    score.num_false_segments += segment.num_of_objects == 0 ? 1 : 0;
  }
  for (std::size_t cell = 0; cell < labelling.label.size(); ++cell) {
    score.num_not_scored += truth.scan.columns.range[cell] != 0 && labelling.label[cell] == kNotScored ? 1 : 0;
  }
  score.num_labelled_returns = NumTruePositives(scan);
  if (labelling.num_components) {
    score.num_scans_with_components = 1;
    score.num_components = *labelling.num_components;
  }
  return score;
}

}  // namespace lookout::eval
