// Between the messages of the odometer and its own types.
#pragma once

#include <optional>
#include <vector>

#include "lookout/lidar_odometry_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/odometer/core/odometer.hpp"

namespace lookout::odometer {

/// The scan out of its parts, with the nearest return of each shot.
///
/// @param parts  all of one scan, at least one, by part_index, each without a fault (messages::FaultOf), agreeing about the scan
/// @return nullopt unless they cover the scan, each column once
std::optional<Scan> ToScan(const std::vector<lidar_scan_t>& parts);

lidar_odometry_t ToMessage(const Motion& motion, const Scan& scan);

}  // namespace lookout::odometer
