#include "lab/eval/baselines/peer.hpp"

#include <algorithm>
#include <cstddef>

namespace lookout::eval {

namespace {

// @return for each group the id of its segment; 0 = none, its size is not within the limits
std::vector<std::int32_t> NumberGroups(const segmenter::Groups& groups, const SizeLimits& limits, std::int32_t& num_segments) {
  std::vector<int> size(static_cast<std::size_t>(groups.count), 0);
  for (const auto group : groups.of_return) {
    if (group != segmenter::Groups::kNone) ++size[static_cast<std::size_t>(group)];
  }
  std::vector<std::int32_t> id(size.size(), 0);
  num_segments = 0;
  for (const auto group : groups.of_return) {
    if (group == segmenter::Groups::kNone) continue;
    const auto i = static_cast<std::size_t>(group);
    if (id[i] == 0 && size[i] >= limits.min_returns && size[i] <= limits.max_returns) id[i] = ++num_segments;
  }
  return id;
}

}  // namespace

Labelling Peer::Segment(const segmenter::Scan& scan) {
  StageClock clock;
  const auto classified = segmenter::ClassifyReturns(scan, filter_);
  clock.End("returns");
  const auto groups = grouping_(scan, classified.returns, clock);

  Labelling labelling;
  std::int32_t num_segments = 0;
  const auto id = NumberGroups(groups, limits_, num_segments);
  labelling.label.assign(scan.num_cells(), 0);
  const auto id_of_return = [&](std::size_t index) {
    const auto group = groups.of_return[index];
    return group == segmenter::Groups::kNone ? 0 : id[static_cast<std::size_t>(group)];
  };
  for (std::size_t i = 0; i < classified.returns.size(); ++i) {
    labelling.label[static_cast<std::size_t>(classified.returns[i].cell)] = id_of_return(i);
  }
  for (const auto& repeat : classified.repeats) {
    labelling.label[static_cast<std::size_t>(repeat.cell)] = id_of_return(static_cast<std::size_t>(repeat.of_return));
  }
  labelling.is_sure.assign(static_cast<std::size_t>(num_segments), true);
  clock.End("labels");
  labelling.stages = clock.stages();
  return labelling;
}

}  // namespace lookout::eval
