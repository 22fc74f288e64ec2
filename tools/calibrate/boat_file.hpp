// The angles of the lidar in the text of boat.txtpb.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tools/calibrate/orientation.hpp"

namespace lookout::calibrate {

/// "roll_deg: 1.02 pitch_deg: -0.48 yaw_deg: 4.97"
std::string AngleLines(const Angles& angles);

/// The text with other angles in its block `lidar { ... }`; comments, order and all else stay.
///
/// @return nullopt where the block or one of the three angles is not found, each once
std::optional<std::string> WithAngles(const std::string& text, const Angles& angles);

/// Changes boat.txtpb of a folder. The old file stays as boat.txtpb.old.
///
/// @throws std::runtime_error when boat.txtpb.old exists, the angles are not found in the text, or a file cannot be read or written
void WriteAngles(const std::filesystem::path& config_folder, const Angles& angles);

}  // namespace lookout::calibrate
