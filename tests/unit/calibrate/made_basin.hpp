// A recording of made scans: a basin, a boat that goes round in it, and its poses; and a boat.txtpb that may be wrong.
#pragma once

#include <chrono>
#include <cmath>

#include "common/core/frames.hpp"
#include "tests/unit/odometer/made_scene.hpp"
#include "tools/calibrate/calibration.hpp"
#include "tools/calibrate/orientation.hpp"
#include "tools/calibrate/recording.hpp"

namespace lookout::calibrate {

inline constexpr int kNumScans = 350;

// Round a circle, the bow swinging by 6 deg to either side: what changes the rate of turn tells the latency.
struct SwingingWay {
  odometer::Arc arc{1.2, 0.2};

  double BearingRad(double time_s) const { return arc.BearingRad(time_s) + 0.1 * std::sin(0.9 * time_s); }
  Eigen::Vector2d PlaceM(double time_s) const { return arc.PlaceM(time_s); }
};
inline const SwingingWay kRound;

// Map of the poses: east, north. The made boat starts at the origin with its bow along x, which is east.
inline Recording MakeRecording(double latency_s) {
  Recording recording;
  const auto walls = odometer::Basin();
  for (int i = 0; i < kNumScans; ++i) recording.scans.push_back(odometer::MakeScan(i, walls, kRound));
  const Utime start = recording.scans.front().time;
  for (int i = -50; i < kNumScans * 5 + 50; ++i) {
    TrackPose pose;
    pose.time = start + std::chrono::microseconds(i * 20'000);
    const double time_s = i * 0.02 - latency_s;
    pose.T_map_vessel.linear() = RotationAboutZ(kRound.BearingRad(time_s));
    pose.T_map_vessel.translation().head<2>() = kRound.PlaceM(time_s);
    pose.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-7, 1e-7, 1e-7;
    recording.track.Add(pose);
  }
  recording.num_poses = static_cast<int>(recording.track.poses().size());
  return recording;
}

// A boat.txtpb with a lidar 1.5 m above the water, turned against the true one, which is level and looks ahead.
inline CalibrationParams ParamsWith(const Eigen::Matrix3d& R_vessel_lidar) {
  CalibrationParams params;
  params.odometer = odometer::MadeParams();
  params.boat.T_vessel_lidar = params.odometer.standing.T_vessel_lidar;
  params.boat.T_vessel_lidar.linear() = R_vessel_lidar;
  params.boat.own_vessel_box_m.setEmpty();
  const auto angles = AnglesOf(R_vessel_lidar);
  params.boat.lidar.roll_rad = angles.roll_rad;
  params.boat.lidar.pitch_rad = angles.pitch_rad;
  params.boat.lidar.yaw_rad = angles.yaw_rad;
  return params;
}

inline const Recording& Basin() {
  static const Recording recording = MakeRecording(0.0);
  return recording;
}

}  // namespace lookout::calibrate
