#include "tools/calibrate/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/core/angles.hpp"
#include "tools/calibrate/coarse_search.hpp"
#include "tools/calibrate/surroundings.hpp"
#include "tools/calibrate/turn_rate.hpp"

namespace lookout::calibrate {

namespace {

double FarthestCornerM(const Eigen::AlignedBox3d& box_m, const Eigen::Vector3d& from_m) {
  if (box_m.isEmpty()) return 0.0;
  return (from_m - box_m.center()).cwiseAbs().operator+(0.5 * box_m.sizes()).norm();
}

}  // namespace

Calibration Calibrate(const Recording& recording, const CalibrationParams& params) {
  Calibration result;
  Assumed assumed;
  assumed.T_vessel_lidar = params.boat.T_vessel_lidar;
  const Eigen::Vector3d p_lidar_m = assumed.T_vessel_lidar.translation();
  assumed.min_range_m = std::max(1.0, FarthestCornerM(params.boat.own_vessel_box_m, p_lidar_m));
  assumed.reference_point_above_water_m = params.boat.reference_point_above_water_m;
  assumed.own_vessel_box_m = params.boat.own_vessel_box_m;
  const auto coarse = SearchCoarsely(recording.scans, recording.track, assumed);
  if (!coarse) { result.refusal = "nothing"; return result; }
  auto show = [](const char* name, const Eigen::Matrix3d& R) {
    const auto a = AnglesOf(R);
    std::fprintf(stderr, "%s roll %.3f pitch %.3f yaw %.3f\n", name, RadToDeg(a.roll_rad), RadToDeg(a.pitch_rad), RadToDeg(a.yaw_rad));
  };
  std::fprintf(stderr, "min range %.2f share %.3f next %.3f\n", assumed.min_range_m, coarse->share, coarse->next_share);
  show("coarse", coarse->R_vessel_lidar);
  assumed.T_vessel_lidar.linear() = coarse->R_vessel_lidar;
  auto odo = params.odometer;
  odo.standing.T_vessel_lidar = assumed.T_vessel_lidar;
  const auto motions = OdometryOf(recording.scans, odo);
  if (const auto turn = LatencyByTurning(motions, recording.track)) {
    std::fprintf(stderr, "turn latency %.4f sd %.4f n %zu\n", turn->latency_s, turn->sd_s, turn->num_motions);
    assumed.latency_s = turn->latency_s;
  }
  for (int pass = 0; pass < 4; ++pass) {
    PairParams pairs;
    if (pass == 0) {
      pairs.lags = {1, 2, 4, 8};
      pairs.search_m = 3.0;
    } else {
      assumed.min_height_m = 0.4;
      pairs.search_m = pass == 1 ? 1.5 : 0.7;
    }
    const auto seen = MotionsPast(recording.scans, recording.track, assumed, pairs);
    HandEyeParams hand_eye;
    Correction start;
    start.latency_s = assumed.latency_s;
    hand_eye.wants_deviations = pass > 1;
    const auto fit = SolveHandEye(seen, recording.track, p_lidar_m, start, hand_eye);
    if (!fit) { std::fprintf(stderr, "pass %d: %zu pairs\n", pass, seen.size()); result.refusal = "few"; return result; }
    assumed.T_vessel_lidar.linear() = RotationBy(fit->correction.rotation_rad) * assumed.T_vessel_lidar.linear();
    assumed.latency_s = fit->correction.latency_s;
    std::fprintf(stderr, "pass %d pairs %zu rms %.3f m %.3f deg lat %.4f sd %.4f place %.3f %.3f %.3f\n", pass, fit->num_pairs, fit->displacement_rms_m, RadToDeg(fit->rotation_rms_rad),
                 assumed.latency_s, fit->sd[3], fit->correction.place_m.x(), fit->correction.place_m.y(), fit->correction.place_m.z());
    std::fprintf(stderr, "  sd %.3f %.3f %.3f formal %.3f %.3f %.3f lat %.4f\n", RadToDeg(fit->sd[0]), RadToDeg(fit->sd[1]), RadToDeg(fit->sd[2]), RadToDeg(fit->formal_sd[0]), RadToDeg(fit->formal_sd[1]), RadToDeg(fit->formal_sd[2]), fit->formal_sd[3]);
    show("  now", assumed.T_vessel_lidar.linear());
  }
  return result;
}

}  // namespace lookout::calibrate
