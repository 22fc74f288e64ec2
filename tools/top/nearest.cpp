#include "tools/top/nearest.hpp"

#include <algorithm>
#include <cmath>
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

// Sorted; memory stays small whatever a message holds.
void KeepNearest(std::vector<ObstacleLine>& lines) {
  std::ranges::sort(lines, IsNearer);
  lines.resize(std::min(lines.size(), Nearest::kMaxLines));
  lines.shrink_to_fit();
}

}  // namespace

void Nearest::Take(const obstacles_t& part, TimePoint now) {
  Part kept{part.utime_us, part.seq, part.part_index, part.num_parts, {}};
  auto& nearest = kept.nearest;
  nearest.time = now;
  for (const auto& obstacle : part.obstacles) {
    ObstacleLine line{obstacle};
    for (auto* numbers : {&line.footprint_vessel_x_m, &line.footprint_vessel_y_m, &line.footprint_east_m, &line.footprint_north_m,
                          &line.waterline_vessel_x_m, &line.waterline_vessel_y_m, &line.waterline_east_m, &line.waterline_north_m}) {
      *numbers = {};
    }
    if (const auto heading_rad = headings_.At(obstacle.utime_us); heading_rad && std::isfinite(line.bearing_rad)) {
      line.true_bearing_rad = WrapTo2Pi(*heading_rad + line.bearing_rad);
    }
    nearest.lines.push_back(line);
    if (line.confidence == obstacle_t::CONFIDENCE_SURE) nearest.sure_lines.push_back(line);
  }
  nearest.num_obstacles = static_cast<std::int64_t>(nearest.lines.size());
  nearest.num_sure = static_cast<std::int64_t>(nearest.sure_lines.size());
  KeepNearest(nearest.lines);
  KeepNearest(nearest.sure_lines);
  const auto ended = assembler_.Add(std::move(kept));
  if (!ended.incomplete.empty()) newest_ = ToNearest(ended.incomplete);
  if (!ended.whole.empty()) newest_ = ToNearest(ended.whole);
}

NearestObstacles Nearest::ToNearest(const std::vector<Part>& parts) {
  NearestObstacles nearest;
  nearest.num_parts_missing = parts.front().num_parts - static_cast<std::int64_t>(parts.size());
  for (const auto& [utime_us, seq, part_index, num_parts, part] : parts) {
    nearest.lines.insert(nearest.lines.end(), part.lines.begin(), part.lines.end());
    nearest.sure_lines.insert(nearest.sure_lines.end(), part.sure_lines.begin(), part.sure_lines.end());
    nearest.num_obstacles += part.num_obstacles;
    nearest.num_sure += part.num_sure;
    nearest.time = std::max(nearest.time, part.time);
  }
  KeepNearest(nearest.lines);
  KeepNearest(nearest.sure_lines);
  return nearest;
}

}  // namespace lookout::top
