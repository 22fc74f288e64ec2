// What a log says of the boat: the config in RUN_INFO.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/core/bytes.hpp"
#include "tools/export/sink.hpp"

namespace lookout::exporter {

struct BoatOfLog {
  Eigen::Isometry3d T_vessel_lidar;
  Eigen::AlignedBox3d own_vessel_box_m;  // vessel frame
};

/// Takes a message of RUN_INFO; one without a whole boat.txtpb changes nothing.
Taken TakeRunInfo(Bytes bytes, std::optional<BoatOfLog>& boat);

}  // namespace lookout::exporter
