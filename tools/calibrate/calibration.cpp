#include "tools/calibrate/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"
#include "tools/calibrate/coarse_search.hpp"
#include "tools/calibrate/manoeuvres.hpp"
#include "tools/calibrate/turn_rate.hpp"

namespace lookout::calibrate {

namespace {

constexpr std::size_t kLeastScans = 100;
constexpr std::size_t kLeastPairs = 50;
// Returns this high above the water do not come from water.
constexpr double kStandingM = 0.4;
// A fit whose pairs disagree by more has found nothing.
constexpr double kMostAfterM = 1.0;
const double kMostAfterRad = DegToRad(2.0);
// Most scans that the odometer reads: they give the latency to some hundredths of a second, which is enough to begin with.
constexpr std::size_t kMostOdometryScans = 600;

double FarthestCornerM(const Eigen::AlignedBox3d& box_m, const Eigen::Vector3d& from_m) {
  if (box_m.isEmpty()) return 0.0;
  const Eigen::Vector3d corner_m = (from_m - box_m.center()).cwiseAbs() + 0.5 * box_m.sizes();
  return corner_m.norm();
}

Assumed AssumedOf(const CalibrationParams& params) {
  Assumed assumed;
  assumed.T_vessel_lidar = params.boat.T_vessel_lidar;
  constexpr double kNearestM = 1.0;
  assumed.min_range_m = std::max(kNearestM, FarthestCornerM(params.boat.own_vessel_box_m, assumed.T_vessel_lidar.translation()));
  assumed.max_range_m = params.odometer.standing.max_range_m;
  assumed.reference_point_above_water_m = params.boat.reference_point_above_water_m;
  assumed.own_vessel_box_m = params.boat.own_vessel_box_m;
  return assumed;
}

// Why the recording cannot serve at all; empty where it may.
std::string FaultOf(const Recording& recording) {
  if (recording.scans.size() < kLeastScans)
    return fmt::format("the recording holds {} whole scans of the lidar; {} are needed", recording.scans.size(), kLeastScans);
  const auto num_of_use = static_cast<int>(recording.track.poses().size());
  if (num_of_use > 0 && 2 * num_of_use > recording.num_poses) return "";
  const int most = std::max({recording.num_course_alone, recording.num_no_attitude, recording.num_no_place});
  if (recording.num_poses == 0)
    return "the recording holds no POSE: without position, heading, roll and pitch there is nothing to compare the lidar with";
  if (most == recording.num_course_alone) {
    return "the heading is the course over ground alone: current and leeway would be taken for yaw. A compass or a pair of GNSS antennas is needed";
  }
  if (most == recording.num_no_attitude) return "roll and pitch are not measured: without an attitude sensor the lidar has nothing to be level with";
  return "position or heading are not known for most of the recording";
}

constexpr int kNumPasses = 3;

// Parameters of the pairs of a pass: from wide to narrow.
PairParams PairsOfPass(int pass) {
  PairParams pairs;
  pairs.both_ways = pass + 1 == kNumPasses;
  if (pass == 0) {
    pairs.lags = {1, 2, 4, 8};
    pairs.search_m = 2.5;
  } else {
    pairs.search_m = pass == 1 ? 1.5 : 0.7;
  }
  return pairs;
}

// Errors that the residuals do not show, since they are equal in all pairs: edges that look wider from afar, hulls that lean. Found with seeds 1 and
// 2 of the simulator.
const double kSystematicYawRad = DegToRad(0.05);
const double kSystematicTiltRad = DegToRad(0.03);
constexpr double kSystematicLatencyS = 0.0007;
constexpr double kSystematicTiltLatencyS = 0.005;

Found FoundOf(double value, double sd, double systematic_sd, double most_sd) {
  const double whole_sd = std::hypot(sd, systematic_sd);
  return {value, whole_sd, std::isfinite(whole_sd) && whole_sd <= most_sd};
}

// Deviations of roll, pitch and yaw from the covariance of a rotation about the axes of the vessel.
Eigen::Vector3d AngleSds(const Eigen::Matrix3d& R_vessel_lidar, const Eigen::Matrix3d& rotation_covariance) {
  constexpr double kStep = 1e-5;
  Eigen::Matrix3d jacobian;
  const Angles here = AnglesOf(R_vessel_lidar);
  for (int i = 0; i < 3; ++i) {
    const Angles there = AnglesOf(RotationBy(kStep * Eigen::Vector3d::Unit(i)) * R_vessel_lidar);
    jacobian.col(i) =
        Eigen::Vector3d(WrapToPi(there.roll_rad - here.roll_rad), there.pitch_rad - here.pitch_rad, WrapToPi(there.yaw_rad - here.yaw_rad)) / kStep;
  }
  return (jacobian * rotation_covariance * jacobian.transpose()).diagonal().cwiseSqrt();
}

struct Disagreement {
  double rms_m = 0.0;
  double rms_rad = 0.0;
};

// Root of the mean of the squares, without the worst twentieth: pairs that were registered wrongly.
double RootMeanSquare(std::vector<double> squares) {
  std::ranges::sort(squares);
  squares.resize(squares.size() * 19 / 20);
  double sum = 0.0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / std::max(1.0, static_cast<double>(squares.size())));
}

// How much pairs disagree after a correction.
Disagreement DisagreementOf(const std::vector<RelativeMotion>& motions, const PoseTrack& track, const Eigen::Vector3d& p_lidar_m,
                            const Correction& correction) {
  std::vector<double> squares_m2;
  std::vector<double> squares_rad2;
  squares_m2.reserve(motions.size());
  squares_rad2.reserve(motions.size());
  for (const auto& motion : motions) {
    const auto residual = Residual(motion, track, p_lidar_m, correction);
    if (!residual) continue;
    squares_m2.push_back(residual->head<3>().squaredNorm());
    squares_rad2.push_back(residual->tail<3>().squaredNorm());
  }
  return {RootMeanSquare(std::move(squares_m2)), RootMeanSquare(std::move(squares_rad2))};
}

void Conclude(const Recording& recording, const CalibrationParams& params, const HandEyeResult& fit, Calibration& result) {
  const Eigen::Vector3d p_lidar_m = params.boat.T_vessel_lidar.translation();
  result.has_fit = true;
  result.num_pairs = fit.num_pairs;
  result.boat_place_m = p_lidar_m;
  result.place_m = fit.correction.place_m;
  const Eigen::Matrix3d R = result.found.T_vessel_lidar.linear();
  result.angles = AnglesOf(R);
  const Eigen::Vector3d sds = AngleSds(R, fit.rotation_covariance);
  // Which of roll and pitch is about the bow depends on the yaw: both are judged by the axes of the vessel.
  const bool is_level_found = std::max(fit.sd[0], fit.sd[1]) <= DegToRad(kMaxTiltSdDeg);
  result.roll = FoundOf(result.angles.roll_rad, sds[0], kSystematicTiltRad, DegToRad(kMaxTiltSdDeg));
  result.pitch = FoundOf(result.angles.pitch_rad, sds[1], kSystematicTiltRad, DegToRad(kMaxTiltSdDeg));
  result.roll.is_found = result.roll.is_found && is_level_found;
  result.pitch.is_found = result.pitch.is_found && is_level_found;
  result.yaw = FoundOf(result.angles.yaw_rad, sds[2], kSystematicYawRad, DegToRad(kMaxYawSdDeg));
  result.turned_rad = RotationVectorOf(R * params.boat.T_vessel_lidar.linear().transpose());
  const Eigen::Vector3d systematic_rad(kSystematicTiltRad, kSystematicTiltRad, kSystematicYawRad);
  result.turned_sd_rad = (fit.sd.head<3>().cwiseAbs2() + systematic_rad.cwiseAbs2()).cwiseSqrt();
  result.latency = FoundOf(fit.correction.latency.heading_s, fit.sd[3], kSystematicLatencyS, kMaxLatencySdS);
  result.tilt_latency = FoundOf(fit.correction.latency.tilt_s, fit.sd[4], kSystematicTiltLatencyS, kMaxLatencySdS);
  const auto after = DisagreementOf(result.motions, recording.track, p_lidar_m, result.motions_correction);
  result.after_m = after.rms_m;
  result.after_rad = after.rms_rad;
  Correction of_boat;
  of_boat.rotation_rad = RotationVectorOf(params.boat.T_vessel_lidar.linear() * result.motions_R_vessel_lidar.transpose());
  const auto before = DisagreementOf(result.motions, recording.track, p_lidar_m, of_boat);
  result.before_m = before.rms_m;
  result.before_rad = before.rms_rad;
  result.height = HeightAboveWater(recording.scans, recording.track, result.found);
  if (result.after_m > kMostAfterM || result.after_rad > kMostAfterRad) {
    result.refusal =
        fmt::format("what stands does not agree with POSE: scans disagree by {:.2f} m and {:.1f} deg", result.after_m, RadToDeg(result.after_rad));
  } else if (result.manoeuvres.turned_rad < kLeastTurnRad) {
    // Boats that drift together bend a straight way by a constant angle, in which no residual shows.
    result.refusal = "the boat turned too little: what drifts cannot be told from what stands";
  } else if (!result.yaw.is_found || !result.roll.is_found || !result.pitch.is_found) {
    result.refusal = "the recording shows too little of the mounting";
    result.is_only_weak = true;
  }
}

}  // namespace

Calibration Calibrate(const Recording& recording, const CalibrationParams& params, const std::function<void(const std::string&)>& tell) {
  const auto say = [&tell](const std::string& step) {
    if (tell) tell(step);
  };
  Calibration result;
  const auto refuse = [&result](const std::string& why) {
    result.refusal = why;
    result.missing = MissingMotions(result);
    return result;
  };
  result.refusal = FaultOf(recording);
  if (result.IsRefused()) return result;
  result.manoeuvres = ManoeuvresOf(recording, {});
  Assumed assumed = AssumedOf(params);
  const Eigen::Vector3d p_lidar_m = assumed.T_vessel_lidar.translation();

  say("orientation");
  const auto coarse = SearchCoarsely(recording.scans, recording.track, assumed);
  if (!coarse) return refuse("hardly anything that stands is in sight");
  if (!coarse->is_clear) return refuse("more than one orientation of the lidar fits what is in sight");
  const Eigen::Matrix3d turned = coarse->R_vessel_lidar * assumed.T_vessel_lidar.linear().transpose();
  assumed.T_vessel_lidar.linear() = coarse->R_vessel_lidar;

  say("rate of turn");
  auto odometer_params = params.odometer;
  odometer_params.standing.T_vessel_lidar = assumed.T_vessel_lidar;
  const std::vector<Scan> first(recording.scans.begin(),
                                recording.scans.begin() + static_cast<std::ptrdiff_t>(std::min(recording.scans.size(), kMostOdometryScans)));
  const auto motions = OdometryOf(first, odometer_params);
  result.manoeuvres = ManoeuvresOf(recording, motions);
  if (const auto turning = LatencyByTurning(motions, recording.track)) {
    result.latency_by_turning_s = turning->latency_s;
    assumed.latency = {turning->latency_s, turning->latency_s};
  }

  std::optional<HandEyeResult> fit;
  for (int pass = 0; pass < kNumPasses; ++pass) {
    say(fmt::format("pass {} of {}", pass + 1, kNumPasses));
    if (pass > 0) assumed.min_height_m = kStandingM;
    result.motions = MotionsPast(recording.scans, recording.track, assumed, PairsOfPass(pass));
    result.motions_R_vessel_lidar = assumed.T_vessel_lidar.linear();
    Correction start;
    start.latency = assumed.latency;
    HandEyeParams hand_eye;
    hand_eye.wants_deviations = pass + 1 == kNumPasses;
    fit = result.motions.size() < kLeastPairs ? std::nullopt : SolveHandEye(result.motions, recording.track, p_lidar_m, start, hand_eye);
    if (!fit) {
      return refuse(fmt::format("too little that stands is seen from more than one place: {} pairs of scans fit, {} are needed",
                                result.motions.size(), kLeastPairs));
    }
    result.motions_correction = fit->correction;
    result.weights = fit->weights;
    assumed.T_vessel_lidar.linear() = RotationBy(fit->correction.rotation_rad) * assumed.T_vessel_lidar.linear();
    assumed.latency = fit->correction.latency;
  }
  result.found = assumed;
  Conclude(recording, params, *fit, result);
  result.missing = MissingMotions(result);
  if (!result.IsRefused()) result.turned_in_words = TurnInWords(NearestCubeRotation(turned));
  return result;
}

}  // namespace lookout::calibrate
