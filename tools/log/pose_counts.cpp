#include "tools/log/pose_counts.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "common/messages/pose_message.hpp"

namespace lookout::log {

void PoseCounts::Add(const pose_t& pose) {
  ++num_poses;
  if (messages::IsRelative(pose)) {
    ++num_relative;
    std::isfinite(pose.latitude_deg) ? ++num_without_heading : ++num_without_position;
    if (pose.status == pose_t::STATUS_RELATIVE_TO_BOAT) ++num_to_boat;
    return;
  }
  const bool knows_nothing = pose.status == pose_t::STATUS_UNKNOWN;
  if (knows_nothing || pose.status == pose_t::STATUS_NO_HEADING) ++num_without_heading;
  if (knows_nothing || pose.status == pose_t::STATUS_NO_POSITION) ++num_without_position;
  if (pose.status != pose_t::STATUS_OK && pose.status != pose_t::STATUS_COASTING) return;
  if (num_placed++ == 0) first_placed_us = pose.utime_us;
  last_placed_us = pose.utime_us;
  if (pose.heading_source == pose_t::HEADING_COURSE) ++num_by_course;
}

std::string PoseCounts::WhyNotPlaced() const {
  if (num_placed > 0) return "";
  if (num_poses == 0) return "there is no POSE";
  const auto share = [this](std::int64_t count) { return " (" + std::to_string(count) + " of " + std::to_string(num_poses) + " messages)"; };
  if (num_without_position == num_poses && num_without_heading == num_poses) return "POSE knows neither position nor heading" + share(num_poses);
  if (num_without_position == num_poses) return "POSE knows no position" + share(num_poses);
  if (num_without_heading == num_poses) return "POSE knows no heading" + share(num_poses);
  return "POSE knows no position" + share(num_without_position) + " or no heading" + share(num_without_heading);
}

std::string PoseCounts::RelativeInWords() const {
  if (num_relative == 0) return "";
  constexpr double kPoseS = 0.02;
  const auto seconds = [](std::int64_t count) {
    std::array<char, 32> text{};
    const int length = std::snprintf(text.data(), text.size(), "%.1f", static_cast<double>(count) * kPoseS);
    return std::string(text.data(), static_cast<std::size_t>(length));
  };
  return "for " + seconds(num_relative - num_to_boat) + " of " + seconds(num_poses) +
         " s they are in a frame that began where the boat was, its own motion by the lidar; for " + seconds(num_to_boat) +
         " s the lidar did not tell the own motion, and they are relative to the boat";
}

}  // namespace lookout::log
