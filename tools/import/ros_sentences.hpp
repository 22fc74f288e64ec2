// Positions and velocities of ROS as the sentences of NMEA 0183 that a receiver would have sent. A value that the message does not hold is an empty
// field.
#pragma once

#include <string>

#include "common/core/utime.hpp"
#include "tools/import/ros_message.hpp"

namespace lookout::importer {

/// GGA. Latitude and longitude to 1e-8 minutes (0.02 mm). The height of NavSatFix is above the ellipsoid: it stands as the height above mean sea
/// level with a geoid separation of 0, since the sum of both is what is known. Quality: 0 no fix, 1 fix, 2 with SBAS or GBAS. Satellites and HDOP are
/// empty.
///
/// @return empty where latitude or longitude is no place, or there is no fix: then of the place nothing is known but that
std::string GgaOf(const RosNavSatFix& fix, Utime time);

/// GST with the deviations of latitude, longitude and height. @return empty where the message has no covariance, or one that is none
std::string GstOf(const RosNavSatFix& fix, Utime time);

/// VTG. The velocity is along east and north, as drivers of receivers give it. @return empty where it is not finite or beyond 100 m/s
std::string VtgOf(const RosTwist& twist);

/// PASHR, without accuracies. Precondition: finite; heading in [0, 2 pi), clockwise from north; roll positive starboard down, pitch positive bow up
std::string PashrSentence(double heading_rad, double roll_rad, double pitch_rad, Utime time);

}  // namespace lookout::importer
