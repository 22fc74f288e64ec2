#include "services/tracker/core/turning.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <vector>

#include "common/core/angles.hpp"
#include "services/tracker/core/normal.hpp"
#include "services/tracker/core/outline.hpp"

namespace lookout::tracker {

namespace {

constexpr std::chrono::milliseconds kLongestGap{1000};
constexpr double kLeastSpeedMps = 0.5;
// Mean further change of heading. Chosen: an avoiding action is 30 to 60 deg, the corner of a channel or a round turn 90 to 180.
constexpr double kMeanRestRad = DegToRad(60.0);
// Changes of heading at which a tenth, three tenths ... of the turns have ended, in units of the mean: -ln(1 - q).
constexpr std::array kEnds{0.10536, 0.35667, 0.69315, 1.20397, 2.30259};
constexpr std::size_t kMedian = 2;
constexpr double kStepRad = DegToRad(10.0);
constexpr double kMostTurnStepS = 0.5;
constexpr double kLeastTurnStepS = 0.1;
constexpr double kLeastSdM = 0.05;

// Over a second headings of a filter err by 0.3 deg, and courses by 2 deg at the speed of a walk; a helmsman who holds a course wanders by less than
// 1 deg/s over three seconds. The end of a turn shows in the heading first.
constexpr TurnLook kQuickTurn{std::chrono::milliseconds(1000), std::chrono::milliseconds(800), std::chrono::milliseconds(400), DegToRad(3.0)};
constexpr TurnLook kSlowTurn{std::chrono::milliseconds(3000), std::chrono::milliseconds(2800), std::chrono::milliseconds(1000), DegToRad(1.5)};

Eigen::Vector2d Middle(const std::vector<Eigen::Vector2d>& corners_m) {
  Eigen::Vector2d from = corners_m.front();
  Eigen::Vector2d to = corners_m.front();
  for (const auto& corner : corners_m) {
    from = from.cwiseMin(corner);
    to = to.cwiseMax(corner);
  }
  return 0.5 * (from + to);
}

double RadiusOf(const std::vector<Eigen::Vector2d>& corners_m) {
  const Eigen::Vector2d middle = Middle(corners_m);
  double radius2_m2 = 0.0;
  for (const auto& corner : corners_m) radius2_m2 = std::max(radius2_m2, (corner - middle).squaredNorm());
  return std::sqrt(radius2_m2);
}

RelativeCovariance After(const RelativeCovariance& covariance, double time_s) {
  RelativeCovariance step = RelativeCovariance::Identity();
  step(0, 2) = step(1, 3) = time_s;
  return step * covariance * step.transpose();
}

double GreatestSdM(const RelativeCovariance& covariance) {
  const double sum = covariance(0, 0) + covariance(1, 1);
  const double root = Hypot(covariance(0, 0) - covariance(1, 1), 2.0 * covariance(0, 1));
  return std::max(kLeastSdM, std::sqrt(std::max(0.0, 0.5 * (sum + root))));
}

// Least distance on the way, and when.
struct Nearest {
  double distance_m = std::numeric_limits<double>::infinity();
  double time_s = 0.0;
  double sd_m = kLeastSdM;
};

}  // namespace

double TurnWatch::Update(Utime time, double heading_rad, const Eigen::Vector2d& velocity_mps) {
  if (!looks_.empty() && (time <= looks_.back().time || time - looks_.back().time > kLongestGap)) looks_.clear();
  const bool has_course = velocity_mps.norm() >= kLeastSpeedMps;  // false where it is NaN
  looks_.push_back({time, heading_rad, has_course ? Atan2(velocity_mps.x(), velocity_mps.y()) : kNan});
  while (looks_.size() > 2 && time - looks_[1].time >= kSlowTurn.over) looks_.pop_front();
  const double quick_radps = RateOf(kQuickTurn);
  return quick_radps != 0.0 ? quick_radps : RateOf(kSlowTurn);
}

double TurnWatch::RateOf(const TurnLook& look) const {
  const auto since = [this](std::chrono::milliseconds longest) {
    return std::ranges::find_if(looks_, [&](const Look& one) { return looks_.back().time - one.time <= longest; });
  };
  const auto& now = looks_.back();
  const auto& before = *since(look.over);
  if (now.time - before.time < look.least_over || std::isnan(before.course_rad) || std::isnan(now.course_rad)) return 0.0;
  const auto rate = [&now](const Look& then, double Look::*angle_rad) {
    return now.time > then.time ? WrapToPi(now.*angle_rad - then.*angle_rad) / ToSeconds(now.time - then.time) : 0.0;
  };
  const std::array rates_radps{rate(before, &Look::heading_rad), rate(before, &Look::course_rad), rate(*since(look.lately), &Look::heading_rad)};
  const auto least = *std::ranges::min_element(rates_radps, {}, [](double radps) { return std::fabs(radps); });
  const bool is_one_way = std::ranges::all_of(rates_radps, [least](double radps) { return radps * least > 0.0; });
  return is_one_way && std::fabs(least) >= look.least_radps ? least : 0.0;
}

Moving AfterTurn(const Moving& moving, double time_s) {
  const double rate_radps = moving.turn_rate_radps;
  const Eigen::Vector2d& velocity_mps = moving.velocity_mps;
  const Eigen::Vector2d right_mps(velocity_mps.y(), -velocity_mps.x());
  const auto [sine, cosine] = SinCosOf(rate_radps * time_s);
  Moving after{{}, cosine * velocity_mps + sine * right_mps, rate_radps};
  const Eigen::Vector2d way_m =
      rate_radps == 0.0 ? Eigen::Vector2d(time_s * velocity_mps) : Eigen::Vector2d((sine * velocity_mps + (1.0 - cosine) * right_mps) / rate_radps);
  const Eigen::Vector2d middle_m = Middle(moving.hull_m);
  for (const auto& corner : moving.hull_m) {
    const Eigen::Vector2d off = corner - middle_m;
    after.hull_m.emplace_back(middle_m + way_m + Eigen::Vector2d(cosine * off.x() + sine * off.y(), cosine * off.y() - sine * off.x()));
  }
  return after;
}

double MedianTurnS(double turn_rate_radps) { return kEnds[kMedian] * kMeanRestRad / std::fabs(turn_rate_radps); }

ClosestApproach ApproachInTurns(const Moving& own, const Moving& other, const RelativeCovariance& covariance, const EncounterParams& params) {
  const double rate_radps = std::max(std::fabs(own.turn_rate_radps), std::fabs(other.turn_rate_radps));
  const auto straight = [](Moving moving) {
    moving.turn_rate_radps = 0.0;
    return moving;
  };
  auto approach = ClosestApproachOf(straight(own), straight(other), covariance, params);  // distance and drift are those of now
  const double radii_m = RadiusOf(own.hull_m) + RadiusOf(other.hull_m);
  const double speeds_mps = own.velocity_mps.norm() + other.velocity_mps.norm();
  const double middles_m = (Middle(own.hull_m) - Middle(other.hull_m)).norm();
  const double sd_m = GreatestSdM(After(covariance, params.look_ahead_s));
  if (middles_m - radii_m - speeds_mps * params.look_ahead_s > params.limit_m + 4.0 * sd_m) return approach;  // out of reach, whatever the turn

  const double most_step_s = std::min(std::clamp(params.limit_m / speeds_mps, kLeastTurnStepS, kMostTurnStepS), kStepRad / rate_radps);
  Nearest nearest{approach.distance_m, 0.0, GreatestSdM(covariance)};  // on the arc so far
  double time_s = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < kEnds.size(); ++i) {
    const double end_s = std::min(params.look_ahead_s, kEnds[i] * kMeanRestRad / rate_radps);
    const int num_steps = std::max(1, static_cast<int>(std::ceil((end_s - time_s) / most_step_s)));
    const double step_s = (end_s - time_s) / num_steps;
    for (int k = 1; k <= num_steps; ++k) {
      const double at_s = k == num_steps ? end_s : time_s + k * step_s;
      const auto here = AfterTurn(own, at_s);
      const auto there = AfterTurn(other, at_s);
      if ((Middle(here.hull_m) - Middle(there.hull_m)).norm() - radii_m > nearest.distance_m) continue;
      const double distance_m = GapOf(here.hull_m, there.hull_m).distance_m;
      if (distance_m < nearest.distance_m) nearest = {distance_m, at_s, GreatestSdM(After(covariance, at_s))};
    }
    time_s = end_s;
    const auto rest = ClosestApproachOf(straight(AfterTurn(own, end_s)), straight(AfterTurn(other, end_s)), After(covariance, end_s),
                                        {params.limit_m, std::max(0.0, params.look_ahead_s - end_s)});
    sum += std::max(rest.probability, NormalAt((params.limit_m - nearest.distance_m) / nearest.sd_m).below);
    if (i != kMedian) continue;
    const bool is_later = rest.cpa_m < nearest.distance_m;
    approach.cpa_m = is_later ? rest.cpa_m : nearest.distance_m;
    approach.tcpa_s = is_later ? end_s + rest.tcpa_s : nearest.time_s;
  }
  approach.probability = sum / kEnds.size();
  return approach;
}

}  // namespace lookout::tracker
