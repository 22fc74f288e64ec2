// How the bundler tells packets of the VLP-16 family.
#pragma once

#include "services/lidar/core/driver/bundler.hpp"

namespace lookout::vlp16 {

/// @param cut_azimuth_rad  a bundle ends with the packet in which a scan ends
lidar::Bundler::Form FormOf(double cut_azimuth_rad);

}  // namespace lookout::vlp16
