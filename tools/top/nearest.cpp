#include "tools/top/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::top {

namespace {

bool IsNearer(const ObstacleLine& a, const ObstacleLine& b) {
  const auto key = [](const ObstacleLine& line) {
    return std::tuple(!std::isfinite(line.range_m), std::isfinite(line.range_m) ? line.range_m : 0.0, line.id);
  };
  return key(a) < key(b);
}

}  // namespace

void Nearest::Take(const obstacles_t& part, TimePoint now) {
  Part kept{part.utime_us, part.seq, part.part_index, part.num_parts, {}, now};
  for (const auto& obstacle : part.obstacles) {
    ObstacleLine line{obstacle};
    for (auto* numbers : {&line.footprint_vessel_x_m, &line.footprint_vessel_y_m, &line.footprint_east_m, &line.footprint_north_m,
                          &line.waterline_vessel_x_m, &line.waterline_vessel_y_m, &line.waterline_east_m, &line.waterline_north_m}) {
      *numbers = {};
    }
    if (const auto heading_rad = headings_.At(obstacle.utime_us); heading_rad && std::isfinite(line.bearing_rad)) {
      line.true_bearing_rad = WrapTo2Pi(*heading_rad + line.bearing_rad);
    }
    kept.lines.push_back(line);
  }
  const auto ended = assembler_.Add(std::move(kept));
  if (!ended.incomplete.empty()) newest_ = ToNearest(ended.incomplete);
  if (!ended.whole.empty()) newest_ = ToNearest(ended.whole);
}

NearestObstacles Nearest::ToNearest(const std::vector<Part>& parts) {
  NearestObstacles nearest;
  nearest.num_parts_missing = parts.front().num_parts - static_cast<std::int64_t>(parts.size());
  for (const auto& part : parts) {
    nearest.lines.insert(nearest.lines.end(), part.lines.begin(), part.lines.end());
    nearest.time = std::max(nearest.time, part.time);
  }
  nearest.num_obstacles = static_cast<std::int64_t>(nearest.lines.size());
  std::ranges::sort(nearest.lines, IsNearer);
  std::ranges::copy_if(nearest.lines, std::back_inserter(nearest.sure_lines),
                       [](const ObstacleLine& line) { return line.confidence == obstacle_t::CONFIDENCE_SURE; });
  nearest.num_sure = static_cast<std::int64_t>(nearest.sure_lines.size());
  for (auto* lines : {&nearest.lines, &nearest.sure_lines}) lines->resize(std::min(lines->size(), kMaxLines));
  return nearest;
}

}  // namespace lookout::top
