// Ways of a boat as POSE would tell them, with a latency, and the motions that a lidar on it would see.
#pragma once

#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "common/core/frames.hpp"
#include "tools/calibrate/hand_eye.hpp"
#include "tools/calibrate/pose_track.hpp"

namespace lookout::calibrate {

inline Utime MadeTime(double time_s) { return Utime(std::chrono::microseconds(1'700'000'000'000'000 + std::llround(time_s * 1e6))); }

/// A round way with rolling, pitching and a swinging bow; or a straight one.
struct MadeWay {
  double turn_radps = 0.1;  // 0: straight
  double speed_mps = 1.5;
  double swing_rad = 0.05;
  double roll_rad = 0.03;

  Eigen::Isometry3d At(double time_s) const {
    const double course_rad = turn_radps * time_s;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    const double heading_rad = course_rad + swing_rad * std::sin(2.0 * std::numbers::pi * time_s / 9.0);
    T.linear() = RotationMapVessel(heading_rad, 0.6 * roll_rad * std::sin(2.3 * time_s + 1.0), roll_rad * std::sin(2.0 * time_s));
    if (turn_radps == 0.0) {
      T.translation() = Eigen::Vector3d(0.0, speed_mps * time_s, 0.0);
    } else {
      const double radius_m = speed_mps / turn_radps;
      T.translation() = radius_m * Eigen::Vector3d(1.0 - std::cos(course_rad), std::sin(course_rad), 0.0);
    }
    return T;
  }
};

/// Poses each 20 ms. POSE tells at t what was so at t - latency.
inline PoseTrack MakeTrack(const MadeWay& way, double seconds, double latency_s) {
  PoseTrack track;
  for (int i = -50; i * 0.02 < seconds + 1.0; ++i) {
    TrackPose pose;
    pose.time = MadeTime(i * 0.02);
    pose.T_map_vessel = way.At(i * 0.02 - latency_s);
    pose.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-7, 1e-7, 1e-7;
    track.Add(pose);
  }
  return track;
}

/// Motions that a lidar sees whose mounting is assumed wrongly: p_vessel = D p_assumed. With noise of these deviations.
inline std::vector<RelativeMotion> MakeMotions(const MadeWay& way, double seconds, const Eigen::Isometry3d& D, double noise_m, double noise_rad,
                                               unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<RelativeMotion> motions;
  for (int begin = 0; begin < static_cast<int>(seconds); ++begin) {
    for (const int lag : {1, 4, 16}) {
      if (begin + lag > seconds) continue;
      RelativeMotion motion;
      motion.begin = MadeTime(begin);
      motion.end = MadeTime(begin + lag);
      const Eigen::Isometry3d B = way.At(begin).inverse() * way.At(begin + lag);
      motion.T_begin_end = D.inverse() * B * D;
      Eigen::Vector3d turn_rad;
      for (int i = 0; i < 3; ++i) {
        motion.T_begin_end.translation()[i] += noise_m * normal(random);
        turn_rad[i] = noise_rad * normal(random);
      }
      motion.T_begin_end.linear() = RotationBy(turn_rad) * motion.T_begin_end.linear();
      motion.information.diagonal().head<3>().setConstant(1.0 / (noise_m * noise_m + 1e-6));
      motion.information.diagonal().tail<3>().setConstant(1.0 / (noise_rad * noise_rad + 1e-8));
      motions.push_back(motion);
    }
  }
  return motions;
}

/// A turn about the lidar.
inline Eigen::Isometry3d TurnAbout(const Eigen::Vector3d& p_m, const Eigen::Vector3d& rotation_rad) {
  Eigen::Isometry3d D = Eigen::Isometry3d::Identity();
  D.linear() = RotationBy(rotation_rad);
  D.translation() = p_m - D.linear() * p_m;
  return D;
}

}  // namespace lookout::calibrate
