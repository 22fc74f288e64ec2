// Config of the georeferencer process (boat.txtpb, georeferencer.txtpb) as checked values.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "services/georeferencer/core/placement.hpp"

namespace lookout::georeferencer {

struct Params {
  PlacementParams placement;
  std::chrono::microseconds pose_timeout{0};
  std::optional<GeodeticPlace> datum =
      std::nullopt;  // of boat.txtpb, to check the first POSE by; nullopt: nothing to check, the first fix is the datum of POSE
  std::optional<Eigen::Isometry3d> T_vessel_lidar_2 = std::nullopt;  // nullopt: the boat has one lidar
};

/// @param config_folder  the boat's folder, holding boat.txtpb and georeferencer.txtpb
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::georeferencer
