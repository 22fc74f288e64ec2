#include "tools/top/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/core/angles.hpp"

namespace lookout::top {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// POSE comes every 20 ms of message time: ten seconds of it hold any wait of the georeferencer.
constexpr std::size_t kMaxHeadings = 500;
// A boat turns by less than a degree within so long, at the 10 deg/s of a hard turn.
constexpr std::uint64_t kMaxHeadingAgeUs = 100'000;

// As unsigned, so that no pair of times out of corrupt messages overflows.
std::uint64_t DistanceUs(std::int64_t a, std::int64_t b) {
  const auto [low, high] = std::minmax(a, b);
  return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
}

bool IsNearer(const ObstacleLine& a, const ObstacleLine& b) {
  const auto key = [](const ObstacleLine& line) {
    return std::tuple(!std::isfinite(line.range_m), std::isfinite(line.range_m) ? line.range_m : 0.0, line.id);
  };
  return key(a) < key(b);
}

void Insert(std::vector<ObstacleLine>& lines, const ObstacleLine& line) {
  lines.insert(std::ranges::lower_bound(lines, line, IsNearer), line);
  if (lines.size() > Nearest::kMaxLines) lines.pop_back();
}

}  // namespace

void Nearest::Take(const pose_t& pose) {
  if (headings_.size() == kMaxHeadings) headings_.pop_front();
  headings_.push_back({pose.utime_us, pose.heading_rad});
}

double Nearest::HeadingAt(std::int64_t utime_us) const {
  const auto nearest = std::ranges::min_element(headings_, {}, [&](const Heading& heading) { return DistanceUs(heading.utime_us, utime_us); });
  if (nearest == headings_.end() || DistanceUs(nearest->utime_us, utime_us) > kMaxHeadingAgeUs) return kUnknown;
  return nearest->heading_rad;
}

void Nearest::Take(const obstacles_t& part, TimePoint now) {
  const bool goes_on =
      gathering_ && part.seq == gathering_->seq && part.utime_us == gathering_->utime_us && part.part_index > gathering_->last_part_index;
  if (!goes_on) {
    // A turn without its last part shows when the next one begins.
    if (gathering_ && gathering_->num_parts_to_come > 0) {
      newest_ = gathering_->obstacles;
      newest_->num_parts_missing += gathering_->num_parts_to_come;
    }
    gathering_ = Gathering{part.utime_us, part.seq, -1, 0, {}};
  }
  auto& obstacles = gathering_->obstacles;
  obstacles.num_parts_missing += std::max<std::int64_t>(0, std::int64_t{part.part_index} - gathering_->last_part_index - 1);
  gathering_->last_part_index = part.part_index;
  obstacles.num_obstacles += static_cast<std::int64_t>(part.obstacles.size());
  obstacles.time = now;
  for (const auto& obstacle : part.obstacles) {
    ObstacleLine line;
    line.id = obstacle.id;
    line.status = obstacle.status;
    line.confidence = obstacle.confidence;
    line.kind = obstacle.kind;
    line.range_m = obstacle.range_m;
    line.bearing_rad = obstacle.bearing_rad;
    line.latitude_deg = obstacle.latitude_deg;
    line.longitude_deg = obstacle.longitude_deg;
    line.length_m = obstacle.length_m;
    line.width_m = obstacle.width_m;
    line.height_m = obstacle.height_m;
    const double true_bearing_rad = HeadingAt(obstacle.utime_us) + line.bearing_rad;
    line.true_bearing_rad = std::isfinite(true_bearing_rad) ? WrapTo2Pi(true_bearing_rad) : kUnknown;
    Insert(obstacles.lines, line);
    if (line.confidence == obstacle_t::CONFIDENCE_SURE) {
      ++obstacles.num_sure;
      Insert(obstacles.sure_lines, line);
    }
  }
  gathering_->num_parts_to_come = std::int64_t{part.num_parts} - part.part_index - 1;
  if (gathering_->num_parts_to_come <= 0) newest_ = obstacles;
}

}  // namespace lookout::top
