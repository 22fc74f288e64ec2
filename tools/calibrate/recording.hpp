// The parts of a recording that the calibration uses: scans, and the poses of the boat, both computed from the raw channels as lookout-replay does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/odometer/core/standing.hpp"
#include "tools/calibrate/pose_track.hpp"

namespace lookout::calibrate {

using odometer::Scan;

struct Recording {
  std::vector<Scan> scans;  // increasing in time
  PoseTrack track;          // poses with position, heading by a sensor, roll and pitch, in one map frame
  /// Poses that do not serve, by reason.
  int num_poses = 0;
  int num_course_alone = 0;  // the heading is the course over ground
  int num_no_attitude = 0;   // roll and pitch are not measured
  int num_no_place = 0;      // no position or no heading
};

struct Stretch {
  double begin_s = 0.0;  // after the first scan
  double seconds = 300.0;
};

/// @param files  lcm-logs or captures, as lookout-replay takes them; read in their order
/// @throws std::runtime_error when one cannot be read; config::ConfigError
Recording ReadRecording(const std::filesystem::path& config_folder, const std::vector<std::filesystem::path>& files, const Stretch& stretch);

}  // namespace lookout::calibrate
