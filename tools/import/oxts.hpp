// Records of KITTI's OXTS receiver as sentences and a sample of the IMU.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/utime.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::importer {

struct OxtsItems {
  std::vector<std::string> sentences;                  // GST, GGA, VTG and PASHR, as far as the record has their values
  std::optional<navigator::StrapdownSample> imu = {};  // to the axes of the boat
};

/// A line of 30 numbers: latitude, longitude (deg), altitude (m); roll, pitch, yaw (rad); velocity north, east, forward, left, up (m/s); acceleration
/// x y z and forward left up (m/s2); angular rate x y z and forward left up (rad/s); accuracy of position (m) and velocity (m/s); states. x is
/// forward, y left, z up; yaw 0 is east, counter-clockwise; roll is positive left side up, pitch positive front down. Source: dataformat.txt of the
/// raw data of KITTI
///
/// @return nullopt where there are fewer than 25 numbers, or a word is no number; values that are not finite or out of range are left out
std::optional<OxtsItems> ParseOxts(std::string_view text, Utime time);

}  // namespace lookout::importer
