// A boat on an arc whose receiver, compass and lidar tell its motion, with gaps and faults.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "common/core/angles.hpp"
#include "services/navigator/core/filter/pose_filter.hpp"
#include "tests/unit/navigator/filter_measurements.hpp"

namespace lookout::navigator {

inline constexpr double kScanS = 0.1;
inline constexpr double kWaySdM = 0.03;
inline constexpr double kTurnSdRad = DegToRad(0.02);

// A boat on an arc, bow along the course, from the test's place to the north at time 0.
struct ArcBoat {
  double speed_mps = 2.0;
  double turn_radps = 0.0;  // clockwise

  double HeadingRad(double t) const { return turn_radps * t; }
  Eigen::Vector2d PlaceM(double t) const {
    if (turn_radps == 0.0) return {0.0, speed_mps * t};
    const double radius_m = speed_mps / turn_radps;
    return {radius_m * (1.0 - std::cos(HeadingRad(t))), radius_m * std::sin(HeadingRad(t))};
  }
  // Forward, port, turn from one scan to the next.
  OdometryMotion Motion(double end_s) const {
    const double begin_s = end_s - kScanS;
    const Eigen::Vector2d way_m = PlaceM(end_s) - PlaceM(begin_s);
    const double sin = std::sin(HeadingRad(begin_s));
    const double cos = std::cos(HeadingRad(begin_s));
    OdometryMotion motion{NoonPlus(begin_s), NoonPlus(end_s), true};
    motion.displacement_m = {sin * way_m.x() + cos * way_m.y(), -cos * way_m.x() + sin * way_m.y()};
    motion.turn_rad = turn_radps * kScanS;
    motion.covariance = Eigen::Vector3d(1e-5, 1e-5, 1e-8).asDiagonal();
    return motion;
  }
  GnssFix FixAt(double t, double sd_m) const {
    const GeographicLib::LocalCartesian map(kLatitudeDeg, kLongitudeDeg, 0.0);
    auto fix = MovingFix(t, speed_mps, RadToDeg(HeadingRad(t)));
    double height_m = 0.0;
    map.Reverse(PlaceM(t).x(), PlaceM(t).y(), 0.0, fix.position->latitude_deg, fix.position->longitude_deg, height_m);
    fix.horizontal_sd_m = sd_m;
    return fix;
  }
};

struct OdometryRun {
  ArcBoat boat;
  FilterParams params = TestFilterParams();
  double fix_sd_m = 0.02;
  double gap_begin_s = 10.0;
  double gap_end_s = 70.0;
  double end_s = 75.0;
  bool has_odometry = true;
  bool has_compass = true;
  bool has_compass_in_gap = false;
  std::function<double(double)> course_error_rad = [](double) { return 0.0; };
  std::function<void(double, OdometryMotion&)> spoil = [](double, OdometryMotion&) {};

  struct Result {
    std::vector<Pose> poses;  // ten a second
    std::vector<Eigen::Vector2d> errors_m;
    std::vector<double> heading_errors_rad;
    FilterCounts counts;
    bool contradicted = false;
    bool was_carried = false;

    const Pose& At(double t) const { return poses[static_cast<std::size_t>(std::lround(t / kScanS))]; }
    const Eigen::Vector2d& ErrorM(double t) const { return errors_m[static_cast<std::size_t>(std::lround(t / kScanS))]; }
    double HeadingErrorRad(double t) const { return heading_errors_rad[static_cast<std::size_t>(std::lround(t / kScanS))]; }
  };

  Result Sail() const {
    const GeographicLib::LocalCartesian map(kLatitudeDeg, kLongitudeDeg, 0.0);
    PoseFilter filter(params);
    Result result;
    const auto is_gap = [this](double t) { return t > gap_begin_s && t < gap_end_s; };
    for (int i = 0; i * kScanS <= end_s; ++i) {
      const double t = i * kScanS;
      if (has_compass && (!is_gap(t) || has_compass_in_gap)) filter.Add(HeadingSample(t, RadToDeg(boat.HeadingRad(t))));
      if (i % 2 == 0 && !is_gap(t)) {
        auto fix = boat.FixAt(t, fix_sd_m);
        fix.course_rad += course_error_rad(t);
        filter.Add(fix);
      }
      if (has_odometry && i > 0) {
        auto motion = boat.Motion(t);
        spoil(t, motion);
        filter.Add(motion);
      }
      filter.AdvanceTo(NoonPlus(t));
      auto& pose = result.poses.emplace_back(filter.At(NoonPlus(t)));
      Eigen::Vector3d p_m = Eigen::Vector3d::Constant(kNan);
      if (!std::isnan(pose.latitude_deg)) map.Forward(pose.latitude_deg, pose.longitude_deg, 0.0, p_m.x(), p_m.y(), p_m.z());
      result.errors_m.emplace_back(p_m.head<2>() - boat.PlaceM(t));
      result.heading_errors_rad.push_back(WrapToPi(pose.heading_rad - boat.HeadingRad(t)));
      result.contradicted = result.contradicted || filter.contradicts_lidar();
      result.was_carried = result.was_carried || filter.is_carried_by_lidar();
    }
    result.counts = filter.counts();
    return result;
  }
};

}  // namespace lookout::navigator
