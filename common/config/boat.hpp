// boat.txtpb as checked values, for the services that need facts of the boat; and its numbers in words, for a person on the boat.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/core/frames.hpp"
#include "common/core/geodesy.hpp"

namespace lookout::config {

/// Over all.
struct HullSize {
  double length_m = 0.0;
  double beam_m = 0.0;
};

struct BoatFacts {
  std::string name;
  lookout::Mounting lidar;  // not the schema's message of that name
  Eigen::Isometry3d T_vessel_lidar;
  std::optional<lookout::Mounting> lidar_2;  // nullopt: the boat has one lidar
  Eigen::Vector3d p_vessel_antenna_m;
  Eigen::Vector3d p_vessel_imu_m = Eigen::Vector3d::Zero();  // the reference point where the file does not say
  double reference_point_above_water_m = 0.0;
  Eigen::AlignedBox3d own_vessel_box_m;  // vessel frame
  std::optional<HullSize> hull_m;
  std::optional<GeodeticPlace> datum;  // origin of the map frame
};

class Boat;

/// @param file  of the message, for faults
/// @throws ConfigError
BoatFacts ToFacts(const Boat& boat, const std::filesystem::path& file);

/// @param folder  the boat's folder, holding boat.txtpb
/// @throws ConfigError
BoatFacts LoadBoat(const std::filesystem::path& folder);

struct BoatRemark {
  std::string words;
  std::string cure;  // advice; empty where nothing is doubtful
  bool is_under_water = false;
};

/// The box of own returns, and where lidar and antenna are. Doubtful is a box that is larger than the hull by more than 1 m in any direction, a lidar
/// or an antenna that is under water or more than 2 m outside of the hull (of the box, where the size of the hull is not set), and a hull whose size
/// is not set.
std::vector<BoatRemark> RemarksOnBoat(const BoatFacts& boat);

/// These remarks as comments of a text config, a line each: "# boat.txtpb: ...", "# boat.txtpb: warning: ...".
std::string RemarksAsComments(const BoatFacts& boat);

}  // namespace lookout::config
