#include "lab/eval/tracks/track_histories.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/outlines.hpp"
#include "lab/eval/tracks/track_geometry.hpp"

namespace lookout::eval {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kStandingMps = 0.05;
constexpr double kMovingMps = 0.5;
constexpr double kSettledS = 3.0;  // a track has this long to learn how its thing moves
constexpr double kLongThingM = 3.0;
constexpr double kLeastHiddenS = 1.0;
constexpr double kMostHiddenS = 10.0;
constexpr double kFoundAgainS = 1.0;
constexpr double kWarningS = 10.0;
constexpr double kTcpaStepS = 1.0;            // a TCPA that falls by more from one scan to the next does so by a turn
constexpr double kLeastApproachMps = 1.0;     // slower, TCPA says little
constexpr double kTurnRadps = DegToRad(1.5);  // from here on a boat turns
constexpr double kLeastPassMps = 0.3;         // slower, two keep company
// A thing that never had a track counts where it was there for twice the time in which 95 % should have one (1 s, 4 s).
constexpr std::array<double, 2> kLeastSeenS{1.0, 4.0};

double SecondsBetween(std::int64_t from_us, std::int64_t to_us) { return static_cast<double>(to_us - from_us) * 1e-6; }

double LengthOf(const Polygon& outline_m) {
  double length_m = 0.0;
  for (const auto& a_m : outline_m) {
    for (const auto& b_m : outline_m) length_m = std::max(length_m, (a_m - b_m).norm());
  }
  return length_m;
}

// Whether something has kept its course over the last second: its velocity has not turned.
class CourseWatch {
 public:
  bool Keeps(std::int64_t utime_us, const Eigen::Vector2d& velocity_mps) {
    constexpr double kOverS = 1.0;
    velocities_.emplace_back(utime_us, velocity_mps);
    while (velocities_.size() > 1 && SecondsBetween(velocities_[1].first, utime_us) >= kOverS) velocities_.pop_front();
    const auto& [before_us, before_mps] = velocities_.front();
    const double turned_rad = std::atan2(Cross(before_mps, velocity_mps), before_mps.dot(velocity_mps));
    return std::abs(turned_rad) < kTurnRadps * std::max(kOverS, SecondsBetween(before_us, utime_us));
  }

 private:
  std::deque<std::pair<std::int64_t, Eigen::Vector2d>> velocities_;
};

bool IsStanding(const History& history) {
  return std::ranges::all_of(history.moments, [](const auto& one) { return one.thing->velocity_mps.norm() < kStandingMps; });
}

// Which sides of a thing the lidar has had before it. Corners of a true outline keep their order, however it turns.
class SeenSides {
 public:
  void Add(const Polygon& outline_m, const Eigen::Vector2d& from_m) {
    was_seen_.resize(outline_m.size());
    double area_m2 = 0.0;
    ForEachSide(outline_m, [&](std::size_t /*side*/, const auto& a_m, const auto& b_m) { area_m2 += Cross(a_m - from_m, b_m - from_m); });
    ForEachSide(outline_m, [&](std::size_t side, const auto& a_m, const auto& b_m) {
      // Outside of a side of an outline that runs counter-clockwise, both corners are passed clockwise.
      if (Cross(a_m - from_m, b_m - from_m) * area_m2 < 0.0) was_seen_[side] = true;
    });
  }

  // Whether lidar saw at most half of the directions in which the outline lies around its centre.
  bool IsHalf(const Polygon& outline_m, const Eigen::Vector2d& center_m) const {
    constexpr double kRounding = 1e-6;  // two sides of a rectangle are just half
    double seen_rad = 0.0;
    ForEachSide(outline_m, [&](std::size_t side, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) {
      const Eigen::Vector2d a = a_m - center_m;
      const Eigen::Vector2d b = b_m - center_m;
      if (was_seen_[side]) seen_rad += std::abs(std::atan2(Cross(a, b), a.dot(b)));
    });
    return seen_rad <= std::numbers::pi * (1.0 + kRounding);
  }

 private:
  template <typename Function>
  static void ForEachSide(const Polygon& outline_m, const Function& function) {
    for (std::size_t i = 0; i < outline_m.size(); ++i) function(i, outline_m[i], outline_m[(i + 1) % outline_m.size()]);
  }

  std::vector<bool> was_seen_;
};

void ScoreConfirmation(const History& history, TrackScores& scores) {
  if (!history.moments.front().thing->is_in_water) return;
  const auto first = std::ranges::find_if(history.moments, [](const auto& one) { return one.thing->num_returns > 0; });
  if (first == history.moments.end()) return;
  const auto tracked = std::find_if(first, history.moments.end(), [](const auto& one) { return one.track != nullptr; });
  Summary num_returns;
  for (auto one = first; one != history.moments.end() && one <= tracked; ++one) num_returns.Add(one->thing->num_returns);
  if (num_returns.Median() < 1.0) return;  // hidden again
  const std::size_t kind = num_returns.Median() < kMinReturnsOfExpected ? 1 : 0;
  if (tracked != history.moments.end()) {
    scores.confirmed_s.at(kind).Add(SecondsBetween(first->utime_us, tracked->utime_us));
  } else if (SecondsBetween(first->utime_us, history.moments.back().utime_us) >= kLeastSeenS.at(kind)) {
    scores.confirmed_s.at(kind).Add(kInfinity);
  }
}

void ScoreNearBuoy(const History& history, TrackScores& scores) {
  const auto& moments = history.moments;
  if (!moments.front().thing->is_buoy) return;
  const auto is_near = [](const History::Moment& one) {
    constexpr double kNearM = TrackScores::kNearBuoyM;
    return one.scan->own && HullGap({CenterOf(one.scan->own->outline_m)}, one.thing->outline_m, kNearM) <= kNearM;
  };
  const auto first = std::ranges::find_if(moments, is_near);
  bool was_seen = false;
  for (auto one = first; one != moments.end(); ++one) {
    if (SecondsBetween(first->utime_us, one->utime_us) > TrackScores::kNearBuoyS) {
      if (was_seen) scores.near_buoy_tracked.Add(0.0);
      return;
    }
    was_seen = was_seen || one->thing->num_returns > 0;
    if (one->track == nullptr) continue;
    scores.near_buoy_tracked.Add(1.0);
    return;
  }
}

void ScoreHidden(const History& history, TrackScores& scores) {
  const auto& moments = history.moments;
  std::optional<std::size_t> last_seen;
  bool was_hidden = false;
  for (std::size_t n = 0; n < moments.size(); ++n) {
    if (moments[n].thing->num_returns == 0) was_hidden = true;
    if (!IsExpected(*moments[n].thing)) continue;
    const double hidden_s = last_seen ? SecondsBetween(moments[*last_seen].utime_us, moments[n].utime_us) : 0.0;
    const bool is_back = was_hidden && hidden_s >= kLeastHiddenS && hidden_s <= kMostHiddenS;
    if (is_back && moments[*last_seen].track != nullptr) {
      ++scores.num_hidden;
      for (std::size_t k = n; k < moments.size() && SecondsBetween(moments[n].utime_us, moments[k].utime_us) <= kFoundAgainS; ++k) {
        if (moments[k].track == nullptr) continue;
        if (moments[k].track->id == moments[*last_seen].track->id) ++scores.num_found_again;
        break;
      }
    }
    last_seen = n;
    was_hidden = false;
  }
}

// nullopt: not a covariance.
std::optional<double> NeesOf(const Eigen::Vector2d& error, const Eigen::Matrix2d& covariance) {
  if (!covariance.allFinite() || covariance(0, 0) <= 0.0 || covariance.determinant() <= 0.0) return std::nullopt;
  return error.dot(covariance.inverse() * error) / 2.0;
}

void ScoreCovariance(const TrueThing& thing, const TrackState& track, TrackScores& scores) {
  if (track.covariance.hasNaN()) return;
  const auto position_nees = NeesOf(track.position_m - thing.position_m, track.covariance.topLeftCorner<2, 2>());
  if (position_nees) scores.position_nees.Add(*position_nees);
  const auto velocity_nees =
      track.is_moving ? NeesOf(track.velocity_mps - thing.velocity_mps, track.covariance.bottomRightCorner<2, 2>()) : std::optional(0.0);
  if (velocity_nees && track.is_moving) scores.velocity_nees.Add(*velocity_nees);
  if (!position_nees || !velocity_nees) ++scores.num_bad_covariances;
}

// Precondition: it must be tracked, and had time to be learnt.
void ScoreErrors(const TrueThing& thing, const TrackState& track, bool is_half_seen, TrackScores& scores) {
  if (is_half_seen && LengthOf(thing.outline_m) >= kLongThingM) scores.center_error_m.Add((track.position_m - thing.position_m).norm());
  if (thing.velocity_mps.norm() < kMovingMps) return;
  scores.speed_error_mps.Add(std::abs(track.velocity_mps.norm() - thing.velocity_mps.norm()));
  scores.called_standing.Add(track.is_moving ? 0.0 : 1.0);
  if (!track.is_moving) return;
  const double course_rad = std::atan2(track.velocity_mps.x(), track.velocity_mps.y());
  const double true_course_rad = std::atan2(thing.velocity_mps.x(), thing.velocity_mps.y());
  scores.course_error_deg.Add(std::abs(RadToDeg(WrapToPi(course_rad - true_course_rad))));
}

void ScoreMotion(const History& history, TrackScores& scores) {
  const bool is_standing = IsStanding(history);
  bool was_called_moving = false;
  SeenSides seen;
  std::optional<std::int64_t> first_us;
  const auto num_covariances = scores.position_nees.count;
  for (const auto& [utime_us, thing, track, scan, alerts] : history.moments) {
    if (scan->own && IsExpected(*thing)) seen.Add(thing->outline_m, CenterOf(scan->own->outline_m));
    if (track == nullptr || thing->num_returns == 0) continue;
    if (!first_us) first_us = utime_us;
    if (is_standing) {
      scores.standing_speed_mps.Add(track->velocity_mps.norm());
      was_called_moving = was_called_moving || track->is_moving;
      if (track->is_moving) {
        scores.events.push_back(
            {TrackEvent::What::kMoving, utime_us, thing->id, thing->num_returns, track->id, track->position_m, 0, 0.0, track->velocity_mps.norm()});
      }
    }
    if (!IsExpected(*thing)) continue;
    ScoreCovariance(*thing, *track, scores);
    if (SecondsBetween(*first_us, utime_us) < kSettledS) continue;
    const bool is_half_seen = !scan->own || seen.IsHalf(thing->outline_m, thing->position_m);
    ScoreErrors(*thing, *track, is_half_seen, scores);
    if (thing->velocity_mps.norm() >= kMovingMps && !track->is_moving) {
      scores.events.push_back(
          {TrackEvent::What::kStanding, utime_us, thing->id, thing->num_returns, track->id, track->position_m, 0, 0.0, thing->velocity_mps.norm()});
    }
  }
  if (scores.position_nees.count > num_covariances) ++scores.num_things_with_covariance;
  if (!is_standing || !first_us) return;
  ++scores.num_standing;
  if (was_called_moving) ++scores.num_called_moving;
}

void ScoreApproaches(const History& history, const ApproachLimits& limits, TrackScores& scores) {
  double before_s = 0.0;  // 0 = not known
  std::optional<std::int64_t> first_us;
  CourseWatch own_course;
  CourseWatch thing_course;
  for (const auto& [utime_us, thing, track, scan, alerts] : history.moments) {
    if (track != nullptr && !first_us) first_us = utime_us;
    const bool own_keeps = scan->own && own_course.Keeps(utime_us, scan->own->velocity_mps);
    const bool both_keep = thing_course.Keeps(utime_us, thing->velocity_mps) && own_keeps;
    if (!scan->own || !IsExpected(*thing) || (thing->velocity_mps - scan->own->velocity_mps).norm() < kLeastApproachMps) {
      before_s = 0.0;
      continue;
    }
    const auto& own = *scan->own;
    const auto truth = ApproachOf(own.outline_m, own.velocity_mps, thing->outline_m, thing->velocity_mps);
    if (both_keep && truth.tcpa_s > 0.0 && track != nullptr && !std::isnan(track->cpa_probability) &&
        SecondsBetween(*first_us, utime_us) >= kSettledS) {
      const double nearest_m = truth.tcpa_s <= limits.look_ahead_s
                                   ? truth.cpa_m
                                   : GapAfter(limits.look_ahead_s, own.outline_m, own.velocity_mps, thing->outline_m, thing->velocity_mps);
      scores.calibration.Add(track->cpa_probability, nearest_m < limits.limit_m);
    }
    if (thing->velocity_mps.norm() < kMovingMps) {
      before_s = 0.0;
      continue;
    }
    const bool is_warning = before_s > kWarningS && truth.tcpa_s <= kWarningS && before_s - truth.tcpa_s < kTcpaStepS;
    before_s = truth.tcpa_s;
    if (!is_warning) continue;
    if (!both_keep) {
      ++scores.num_crossings_turning;
      continue;
    }
    ++scores.num_crossings;
    if (track == nullptr) {
      ++scores.num_crossings_untracked;
      continue;
    }
    Approach stated{track->cpa_m, track->tcpa_s};
    if (std::isnan(stated.cpa_m)) stated = ApproachOf(own.outline_m, own.velocity_mps, OutlineOf(*track), track->velocity_mps);
    scores.cpa_error_m.Add(std::abs(stated.cpa_m - truth.cpa_m));
    scores.tcpa_error_s.Add(std::abs(stated.tcpa_s - truth.tcpa_s));
    scores.events.push_back({TrackEvent::What::kApproach, utime_us, thing->id, thing->num_returns, track->id, track->position_m, 0,
                             std::abs(stated.cpa_m - truth.cpa_m), (track->velocity_mps - thing->velocity_mps).norm()});
  }
}

// A time during which a thing is nearer than the limit, hull to hull; indices of moments.
struct Pass {
  std::size_t begin = 0;
  std::size_t nearest = 0;
  std::size_t end = 0;  // first one farther off again, or as many as there are
};

// Passes that begin within the run.
std::vector<Pass> PassesOf(const History& history, double limit_m) {
  std::vector<Pass> passes;
  const auto& moments = history.moments;
  double least_m = kInfinity;
  bool is_inside = false;
  bool was_outside = false;
  for (std::size_t n = 0; n < moments.size(); ++n) {
    if (!moments[n].scan->own) continue;
    const double gap_m = HullGap(moments[n].scan->own->outline_m, moments[n].thing->outline_m, limit_m);
    if (gap_m >= limit_m) {
      is_inside = false;
      was_outside = true;
      continue;
    }
    if (!was_outside) continue;
    if (!is_inside) {
      passes.push_back({n, n, n});
      least_m = kInfinity;
    }
    is_inside = true;
    auto& pass = passes.back();
    pass.end = n + 1;
    if (gap_m < least_m) pass.nearest = n;
    least_m = std::min(least_m, gap_m);
  }
  return passes;
}

void ScoreWarnings(const History& history, const ApproachLimits& limits, TrackScores& scores) {
  const auto& moments = history.moments;
  if (moments.front().alerts == nullptr || !moments.front().thing->is_in_water) return;
  std::set<std::int64_t> tracks;  // that were of this thing
  for (const auto& moment : moments) {
    if (moment.track != nullptr) tracks.insert(moment.track->id);
  }
  const auto is_warned = [&](const History::Moment& moment) {
    return std::ranges::any_of(*moment.alerts,
                               [&](const auto& alert) { return alert.is_of_approach && alert.holds && tracks.contains(alert.track_id); });
  };
  const auto seen = std::ranges::find_if(moments, [](const auto& one) { return IsExpected(*one.thing); });
  std::size_t from = 0;
  for (const auto& pass : PassesOf(history, limits.limit_m)) {
    const auto& nearest = moments[pass.nearest];
    const std::size_t searched_from = from;
    from = pass.end;
    if ((nearest.thing->velocity_mps - nearest.scan->own->velocity_mps).norm() < kLeastPassMps) continue;
    if (seen == moments.end() || SecondsBetween(seen->utime_us, nearest.utime_us) < kWarningS) continue;
    std::size_t first = searched_from;
    while (first < pass.nearest && !is_warned(moments[first])) ++first;
    scores.warned_ahead_s.Add(first < pass.nearest ? SecondsBetween(moments[first].utime_us, nearest.utime_us) : -kInfinity);
    std::size_t last = std::min(pass.end, moments.size() - 1);
    const auto passed_us = moments[last].utime_us;
    while (last + 1 < moments.size() && is_warned(moments[last])) ++last;
    scores.warned_after_s.Add(SecondsBetween(passed_us, moments[last].utime_us));
    std::set<std::int64_t> ids;
    for (std::size_t n = searched_from; n <= last; ++n) {
      for (const auto& alert : *moments[n].alerts) {
        if (alert.holds && tracks.contains(alert.track_id)) ids.insert(alert.id);
      }
    }
    scores.alerts_of_pass.Add(static_cast<double>(ids.size()));
  }
}

}  // namespace

std::map<int, History> HistoriesOf(std::span<const TrueScan> truth, std::span<const Matched> run, std::span<const std::vector<StatedAlert>> alerts) {
  std::map<int, History> histories;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    for (const auto& thing : truth[n].things) {
      if (thing.is_land) continue;
      const auto track = run[n].track_of.find(thing.id);
      histories[thing.id].moments.push_back(
          {truth[n].utime_us, &thing, track == run[n].track_of.end() ? nullptr : track->second, &truth[n], alerts.empty() ? nullptr : &alerts[n]});
    }
  }
  return histories;
}

void ScoreHistory(const History& history, const ApproachLimits& limits, TrackScores& scores) {
  ScoreConfirmation(history, scores);
  ScoreNearBuoy(history, scores);
  ScoreHidden(history, scores);
  ScoreMotion(history, scores);
  ScoreApproaches(history, limits, scores);
  ScoreWarnings(history, limits, scores);
}

}  // namespace lookout::eval
