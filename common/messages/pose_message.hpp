// From POSE to the pose of the vessel, checked.
#pragma once

#include <array>
#include <variant>

#include "common/core/pose.hpp"
#include "common/messages/checks.hpp"
#include "lookout/pose_t.hpp"

namespace lookout::messages {

inline constexpr Fault kPoseTime = "pose_refused_time";              // a time that does not exist, or is not on the grid
inline constexpr Fault kPoseStatus = "pose_refused_status";          // a status that does not exist
inline constexpr Fault kPoseNumber = "pose_refused_number";          // a value that the status says is known is not, or is not a place on earth
inline constexpr Fault kPoseCovariance = "pose_refused_covariance";  // not a covariance

inline constexpr std::array kPoseFaults{kPoseTime, kPoseStatus, kPoseNumber, kPoseCovariance};

/// Position and heading are known in a frame that is not on the earth.
constexpr bool IsRelative(const pose_t& pose) {
  return pose.status == pose_t::STATUS_RELATIVE || pose.status == pose_t::STATUS_RELATIVE_COASTING || pose.status == pose_t::STATUS_RELATIVE_TO_BOAT;
}
/// Position and heading are known on the earth.
constexpr bool IsOnEarth(const pose_t& pose) { return pose.status == pose_t::STATUS_OK || pose.status == pose_t::STATUS_COASTING; }
/// In either.
constexpr bool IsPlaced(const pose_t& pose) { return IsOnEarth(pose) || IsRelative(pose); }

/// The whole message is valid, or it is refused.
std::variant<Pose, Fault> ToPose(const pose_t& message);

}  // namespace lookout::messages
