// A sample of a lidar's IMU as the sentence in which the navigator knows such samples.
#pragma once

#include <Eigen/Core>
#include <string>

#include "services/lidar/core/models/ouster.hpp"

namespace lookout::lidar {

/// $VNIMU of VectorNav (User Manual UM001): specific force (m/s2) and rate (rad/s) along forward, starboard, down; no magnetic field, temperature and
/// pressure of 0. With its checksum, without CR LF.
///
/// @param R_vessel_imu  from the axes of the IMU to those of the vessel (forward, port, up)
std::string ImuSentence(const OusterImu& sample, const Eigen::Matrix3d& R_vessel_imu);

}  // namespace lookout::lidar
