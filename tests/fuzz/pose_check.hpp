// What holds of each pose, whatever was read.
#pragma once

#include <cmath>
#include <cstdlib>
#include <span>

#include "services/navigator/core/pose.hpp"

namespace lookout::navigator {

inline void CheckPoses(std::span<const Pose> poses) {
  for (const auto& pose : poses) {
    const bool is_on_earth = pose.status == PoseStatus::kOk || pose.status == PoseStatus::kCoasting || pose.status == PoseStatus::kNoHeading;
    if (is_on_earth && !(std::isfinite(pose.latitude_deg) && pose.p_map_m.allFinite() && pose.covariance(0, 0) >= 0.0)) std::abort();
    if (std::isinf(pose.p_map_m.sum()) || std::isinf(pose.velocity_map_mps.sum())) std::abort();
    if (pose.heading_source != HeadingSource::kNone && !std::isfinite(pose.heading_rad)) std::abort();
  }
}

}  // namespace lookout::navigator
