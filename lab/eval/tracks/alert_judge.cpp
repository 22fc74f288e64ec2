#include "lab/eval/tracks/alert_judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// An alert takes some scans to come up: a state that was true in one of them counts.
constexpr std::int64_t kLooksUs = 500'000;
// A danger may be out of sight, or above the limit, for some scans.
constexpr std::int64_t kGapUs = 400'000;
// Margins to each side of the zone's sector: edges of a sector are no edges of a danger.
constexpr double kRightBesideRad = DegToRad(5.0);
constexpr double kFarBesideRad = DegToRad(15.0);
constexpr double kOtherSideRad = DegToRad(60.0);
constexpr double kNearerThanHalf = 0.5;
constexpr double kOutlineGateM = 1.0;
constexpr double kInsideM = 1e-6;
// More than scans can be apart.
constexpr double kMostStepS = 1.0;
// So much later than the look-ahead an alert is still about what will be.
constexpr double kLenientS = 3.0;
// Of the causes of false alerts: what swings at its mooring stands; a piece is less than so much of its thing; a course is another by more than that.
constexpr double kStandsForAlertsMps = 0.3;
constexpr double kPieceShare = 0.6;
constexpr double kSameVelocityMps = 0.5;
constexpr double kSameVelocityShare = 0.3;

double SecondsOf(std::int64_t us) { return 1e-6 * static_cast<double>(us); }

Vector2d ForwardOf(double bearing_rad) { return {std::sin(bearing_rad), std::cos(bearing_rad)}; }

Sector Widened(const Sector& sector, double by_rad) { return {WrapTo2Pi(sector.start_rad - by_rad), sector.width_rad + 2.0 * by_rad}; }

double BearingOf(const AlertOwnBoat& own, const Vector2d& p_m) {
  const Vector2d offset_m = p_m - own.reference_m;
  return WrapTo2Pi(std::atan2(offset_m.x(), offset_m.y()) - own.heading_rad);
}

bool Stands(const AlertOwnBoat& own) { return own.motion.velocity_mps.norm() < kStandsBelowMps; }

double SideOf(double one_rad, double other_rad) { return std::abs(WrapToPi(one_rad - other_rad)); }

Polygon InVesselFrame(const AlertOwnBoat& own, const Polygon& corners_m) {
  const Vector2d forward = ForwardOf(own.heading_rad);
  const Vector2d port(-forward.y(), forward.x());
  Polygon seen_m;
  seen_m.reserve(corners_m.size());
  for (const auto& corner_m : corners_m) {
    const Vector2d offset_m = corner_m - own.reference_m;
    seen_m.emplace_back(offset_m.dot(forward), offset_m.dot(port));
  }
  return seen_m;
}

double NearestIn(const Sector& sector, const Polygon& corners_vessel_m) {
  const auto nearest = NearestWithin(sector, corners_vessel_m, corners_vessel_m.size() > 2);
  return nearest ? nearest->range_m : kInfinite;
}

// Where an alert without a track says that it is: of an approach the distance is from the hull.
Vector2d PlaceTold(const AlertOwnBoat& own, const JudgedAlert& alert) {
  const Vector2d direction = ForwardOf(own.heading_rad + alert.bearing_rad);
  double from_reference_m = alert.distance_m;
  if (!alert.is_of_zone) {
    double hull_m = 0.0;
    for (const auto& corner_m : own.hull_m) hull_m = std::max(hull_m, (corner_m - own.reference_m).dot(direction));
    from_reference_m += hull_m;
  }
  return own.reference_m + from_reference_m * direction;
}

const char* CauseOf(const JudgedAlert& alert) {
  if (alert.is_of_zone) return alert.is_of_approach ? "zone+approach" : "zone";
  return "approach";
}

}  // namespace

bool AlertJudge::Span::Hold(std::int64_t now_us) {
  const bool is_new = !has_begun || now_us - last_us > kGapUs;
  if (is_new) start_us = now_us;
  has_begun = true;
  last_us = now_us;
  return is_new;
}

bool AlertJudge::Span::HasLasted(std::int64_t now_us) const {
  return has_begun && last_us == now_us && SecondsOf(now_us - start_us) >= kDangerLastsS - 1e-6;
}

AlertJudge::Evaluated AlertJudge::Evaluate(const AlertScan& scan, const AlertThing& thing) const {
  const auto& own = scan.own;
  Evaluated result{&thing, {scan.utime_us, {}, kInfinite, kInfinite}, BearingOf(own, thing.outline_m->NearestPoint(own.reference_m))};
  const ApproachQuestion question{rules_.cpa_limit_m, rules_.look_ahead_s, rules_.look_ahead_s + kLenientS};
  result.look.approach = ApproachWithin(question, own.hull_m, own.motion, *thing.outline_m, thing.motion);
  const double far_m = rules_.zone.range_m + kFarBeyondM;
  if (rules_.zone.range_m > 0.0 && thing.outline_m->Distance(own.reference_m, far_m) <= far_m) {
    const auto corners_m = InVesselFrame(own, thing.outline_m->corners_m());
    result.look.zone_m = NearestIn(Widened(rules_.zone.bearing, kRightBesideRad), corners_m);
    result.look.wide_zone_m = NearestIn(Widened(rules_.zone.bearing, kFarBesideRad), corners_m);
  }
  return result;
}

const AlertJudge::Evaluated* AlertJudge::FindThing(const AlertScan& scan, const JudgedAlert& alert) const {
  const auto nearest_to = [this](double gate_m, const auto& distance_of) {
    const Evaluated* nearest = nullptr;
    double least_m = gate_m;
    for (const auto& one : evaluated_) {
      const double distance_m = distance_of(*one.thing->outline_m);
      if (distance_m > gate_m || (nearest != nullptr && distance_m >= least_m)) continue;
      nearest = &one;
      least_m = distance_m;
    }
    return nearest;
  };
  if (!alert.track) {
    const Vector2d place_m = PlaceTold(scan.own, alert);
    if (!place_m.allFinite()) return nullptr;
    return nearest_to(kAlertGateM, [&](const HullOutline& outline_m) { return outline_m.Distance(place_m, kAlertGateM); });
  }
  const auto* at_position =
      nearest_to(kAlertGateM, [&](const HullOutline& outline_m) { return outline_m.Distance(alert.track->position_m, kAlertGateM); });
  if (at_position != nullptr || alert.track->outline_m.empty()) return at_position;
  // The middle of a long or bent thing may lie in the water.
  return nearest_to(kOutlineGateM, [&](const HullOutline& outline_m) { return outline_m.Gap(alert.track->outline_m, kOutlineGateM); });
}

AlertVerdict AlertJudge::VerdictOf(const AlertScan& scan, const JudgedAlert& alert, const Evaluated* found) const {
  if (found == nullptr) return AlertVerdict::kNothing;
  bool is_right = false;
  bool is_far = true;
  for (const auto& look : looks_.at(found->thing->id)) {
    if (alert.is_of_zone) {
      is_right = is_right || look.zone_m <= rules_.zone.range_m + kRightWithinM;
      is_far = is_far && look.wide_zone_m > rules_.zone.range_m + kFarBeyondM;
    }
    if (alert.is_of_approach || !alert.is_of_zone) {
      is_right = is_right || look.approach.least_m <= rules_.cpa_limit_m + kRightWithinM;
      is_far = is_far && look.approach.least_m > rules_.cpa_limit_m + kFarBeyondM;
    }
  }
  if (is_far) return AlertVerdict::kFar;
  if (IsRepeated(alert, *found->thing, scan.utime_us)) return AlertVerdict::kRepeated;
  return is_right ? AlertVerdict::kRight : AlertVerdict::kBorder;
}

bool AlertJudge::IsRepeated(const JudgedAlert& alert, const AlertThing& thing, std::int64_t now_us) const {
  bool is_told = false;
  bool is_much_nearer = true;
  bool is_on_other_side = true;
  for (const auto& told : told_) {
    if (told.group != thing.group || SecondsOf(now_us - told.last_us) >= kOneDangerS) continue;
    is_told = true;
    is_much_nearer = is_much_nearer && alert.distance_m < kNearerThanHalf * told.first_distance_m;
    is_on_other_side = is_on_other_side && SideOf(alert.bearing_rad, told.bearing_rad) > kOtherSideRad;
  }
  // Land goes on for long: one alert of it does not tell where it comes near next.
  const bool is_news = !thing.is_in_water && (is_much_nearer || is_on_other_side);
  return is_told && !is_news;
}

// The look-out's belief about the thing that made it speak.
AlertFault AlertJudge::FaultOf(const JudgedAlert& alert, const Evaluated* found, AlertVerdict verdict) const {
  if (verdict == AlertVerdict::kRight || verdict == AlertVerdict::kBorder) return AlertFault::kNone;
  if (found == nullptr) return AlertFault::kNothingThere;
  const auto& thing = *found->thing;
  if (alert.track) {
    const Vector2d true_mps = thing.motion.velocity_mps;
    const Vector2d told_mps = alert.track->velocity_mps;
    const bool is_moved = !told_mps.isZero(0.0);
    if (is_moved && true_mps.norm() < kStandsForAlertsMps) {
      const double true_m = thing.outline_m->box_m().diagonal().norm();
      Eigen::AlignedBox2d told_box_m;
      for (const auto& corner_m : alert.track->outline_m) told_box_m.extend(corner_m);
      const double told_m = told_box_m.isEmpty() ? 0.0 : told_box_m.diagonal().norm();
      return told_m < kPieceShare * true_m ? AlertFault::kPieceMoves : AlertFault::kStandingMoves;
    }
    if ((told_mps - true_mps).norm() > std::max(kSameVelocityMps, kSameVelocityShare * true_mps.norm())) return AlertFault::kOtherCourse;
  }
  if (verdict == AlertVerdict::kFar) return AlertFault::kTooNear;
  const bool is_told_now = std::ranges::any_of(
      told_, [&](const Told& told) { return told.group == thing.group && told.alert_id != alert.id && newest_us_ - told.last_us <= kLooksUs; });
  return is_told_now ? AlertFault::kTwoTracks : AlertFault::kToldAgain;
}

AlertEvent AlertJudge::EventOf(const AlertScan& scan, const JudgedAlert& alert, const Evaluated* found, AlertVerdict verdict) const {
  AlertEvent event;
  event.second = SecondsOf(scan.utime_us - *first_us_);
  event.what = NameOf(verdict);
  event.cause = CauseOf(alert);
  event.alert_id = alert.id;
  event.track_id = alert.track_id;
  event.told_distance_m = alert.distance_m;
  event.told_bearing_rad = alert.bearing_rad;
  event.text = alert.text;
  event.fault = FaultOf(alert, found, verdict);
  if (alert.track) {
    event.told_speed_mps = alert.track->velocity_mps.norm();
    event.existence_probability = alert.track->existence_probability;
  }
  if (found == nullptr) return event;
  event.thing = found->thing->name;
  event.kind = found->thing->kind;
  event.distance_m = found->thing->outline_m->Gap(scan.own.hull_m);
  event.approach_m = found->look.approach.least_m;
  event.true_speed_mps = found->thing->motion.velocity_mps.norm();
  return event;
}

void AlertJudge::Raise(const AlertScan& scan, const JudgedAlert& alert, const Evaluated* found) {
  const auto verdict = VerdictOf(scan, alert, found);
  episodes_[alert.id] = {verdict, EventOf(scan, alert, found, verdict), alert.is_warning, Stands(scan.own)};
}

void AlertJudge::Tell(const AlertScan& scan, const JudgedAlert& alert, const Evaluated* found) {
  std::optional<Vector2d> place_m;
  if (const Vector2d told_m = PlaceTold(scan.own, alert); !alert.track && told_m.allFinite()) place_m = told_m;
  for (const auto& one : evaluated_) {
    const auto& thing = *one.thing;
    const bool is_same_land =
        found != nullptr && !thing.is_in_water && thing.group == found->thing->group && SideOf(one.bearing_rad, alert.bearing_rad) <= kOtherSideRad;
    const bool is_at_place = place_m && thing.outline_m->Distance(*place_m, kAlertGateM) <= kAlertGateM;
    if (&one == found || is_same_land || is_at_place) teller_of_.try_emplace(thing.id, alert.id);
  }
  if (found == nullptr) return;
  const int group = found->thing->group;
  const auto known = std::ranges::find_if(told_, [&](const Told& told) { return told.alert_id == alert.id && told.group == group; });
  if (known == told_.end()) {
    told_.push_back({alert.id, group, scan.utime_us, alert.distance_m, alert.bearing_rad});
  } else {
    known->last_us = scan.utime_us;
    known->bearing_rad = alert.bearing_rad;
  }
}

void AlertJudge::Add(const AlertScan& scan) {
  const bool is_first = !first_us_;
  if (is_first) {
    first_us_ = scan.utime_us;
    scores_.num_runs = 1;
  }
  const double passed_s = is_first ? 0.0 : std::clamp(SecondsOf(scan.utime_us - newest_us_), 0.0, kMostStepS);
  has_run_in_ = has_run_in_ || std::ranges::any_of(scan.things, [&](const AlertThing& thing) {
                  return thing.outline_m->Distance(scan.own.reference_m, kInsideM) < kInsideM;
                });
  newest_us_ = scan.utime_us;
  if (has_run_in_) {
    scores_.run_in_s += passed_s;
    return;
  }
  now_us_ = scan.utime_us;
  ++scores_.num_scans;
  scores_.seconds += passed_s;
  if (Stands(scan.own)) scores_.berth_s += passed_s;

  evaluated_.clear();
  evaluated_.reserve(scan.things.size());
  for (const auto& thing : scan.things) {
    evaluated_.push_back(Evaluate(scan, thing));
    auto& looks = looks_[thing.id];
    looks.push_back(evaluated_.back().look);
    while (scan.utime_us - looks.front().utime_us > kLooksUs) looks.pop_front();
  }
  std::erase_if(told_, [&](const Told& told) { return SecondsOf(scan.utime_us - told.last_us) >= kOneDangerS; });
  teller_of_.clear();
  std::map<std::int64_t, Episode> before;
  before.swap(episodes_);
  for (const auto& alert : scan.alerts) {
    if (!alert.holds) continue;
    const auto* found = FindThing(scan, alert);
    const auto known = before.find(alert.id);
    if (known == before.end()) {
      Raise(scan, alert, found);
    } else {
      known->second.is_warning = known->second.is_warning || alert.is_warning;
      episodes_.insert(before.extract(known));
    }
    Tell(scan, alert, found);
  }
  for (auto& [id, episode] : before) CloseEpisode(std::move(episode));
  CountStanding(scan, passed_s);
  FollowDangers(scan);
}

void AlertJudge::CountStanding(const AlertScan& scan, double passed_s) {
  std::int64_t num_standing = 0;
  std::int64_t num_warnings = 0;
  bool sounds = false;
  bool warns = false;
  bool rings = false;
  bool rings_for_warning = false;
  for (const auto& alert : scan.alerts) {
    if (!alert.holds) continue;
    ++num_standing;
    if (alert.is_warning) ++num_warnings;
    sounds = sounds || alert.is_open;
    warns = warns || (alert.is_open && alert.is_warning);
    rings = rings || alert.sounds;
    rings_for_warning = rings_for_warning || (alert.sounds && alert.is_warning);
  }
  scores_.standing.Add(static_cast<double>(num_standing));
  scores_.standing_warnings.Add(static_cast<double>(num_warnings));
  scores_.most_standing = std::max(scores_.most_standing, num_standing);
  scores_.has_warning.Add(num_warnings > 0 ? 1.0 : 0.0);
  if (sounds) scores_.sound_s += passed_s;
  if (warns) scores_.warning_sound_s += passed_s;
  if (rings) scores_.sounding_s += passed_s;
  if (rings_for_warning) scores_.warning_sounding_s += passed_s;
}

void AlertJudge::FollowDangers(const AlertScan& scan) {
  for (const auto& one : evaluated_) FollowDanger(scan, one, watched_[one.thing->id]);
  // Dangers of things that the truth no longer knows are closed, too.
  for (auto& [id, watched] : watched_) {
    if (watched.danger && SecondsOf(scan.utime_us - watched.wanted.last_us) > kOneDangerS) CloseDanger(watched, scan.utime_us);
  }
}

void AlertJudge::FollowDanger(const AlertScan& scan, const Evaluated& one, Watched& watched) {
  const auto& approach = one.look.approach;
  const double below_m = rules_.cpa_limit_m - kDangerBelowLimitM;
  const bool is_seen = one.thing->num_returns >= kDangerReturns;
  const bool is_wanted = is_seen && approach.greatest_m < below_m;
  std::optional<Teller> teller;
  if (const auto told = teller_of_.find(one.thing->id); told != teller_of_.end()) {
    teller = Teller{scan.utime_us, told->second, approach.until_limit_s};
  }
  if (is_wanted) {
    if (watched.wanted.Hold(scan.utime_us)) {
      watched.told_in_span.reset();
      watched.first = {};
      watched.first.second = SecondsOf(scan.utime_us - *first_us_);
      watched.first.is_danger = true;
      watched.first.thing = one.thing->name;
      watched.first.kind = one.thing->kind;
      watched.first.distance_m = one.thing->outline_m->Gap(scan.own.hull_m);
      watched.first.approach_m = approach.greatest_m;
      watched.first.told_bearing_rad = one.bearing_rad;
    }
    if (!watched.told_in_span) watched.told_in_span = teller;
    if (!watched.danger && watched.wanted.HasLasted(scan.utime_us)) {
      watched.danger = Danger{watched.first, watched.wanted.start_us, watched.told_in_span};
    }
  }
  if (watched.danger && !watched.danger->told && (is_wanted || SecondsOf(scan.utime_us - watched.danger->start_us) <= kInTimeS)) {
    watched.danger->told = teller;
  }
  if (is_seen && !is_wanted && approach.straight_m < below_m) {
    if (watched.turning.has_begun && SecondsOf(scan.utime_us - watched.turning.last_us) > kOneDangerS) watched.is_turning_counted = false;
    watched.turning.Hold(scan.utime_us);
    if (watched.turning.HasLasted(scan.utime_us) && !watched.is_turning_counted) {
      ++scores_.num_turning_dangers;
      watched.is_turning_counted = true;
    }
  }
}

void AlertJudge::CloseEpisode(Episode episode) {
  ++scores_.num_alerts.at(episode.is_warning ? 1 : 0).at(static_cast<std::size_t>(episode.verdict));
  if (episode.event.fault != AlertFault::kNone) {
    ++scores_.num_faults.at(static_cast<std::size_t>(episode.verdict)).at(static_cast<std::size_t>(episode.event.fault));
  }
  const bool is_false = episode.verdict == AlertVerdict::kFar || episode.verdict == AlertVerdict::kNothing;
  if (is_false && episode.is_in_berth) ++scores_.num_false_in_berth;
  episode.event.level = episode.is_warning ? "warning" : "caution";
  scores_.events.push_back(std::move(episode.event));
}

void AlertJudge::CloseDanger(Watched& watched, std::int64_t now_us) {
  auto danger = std::move(*watched.danger);
  watched.danger.reset();
  if (!danger.told && SecondsOf(now_us - danger.start_us) <= kInTimeS) {
    ++scores_.num_open_dangers;
    return;
  }
  auto verdict = DangerVerdict::kMissed;
  danger.event.delay_s = kInfinite;
  if (danger.told) {
    danger.event.delay_s = SecondsOf(danger.told->utime_us - danger.start_us);
    danger.event.alert_id = danger.told->alert_id;
    const bool is_in_time = danger.event.delay_s <= kInTimeS || danger.told->until_limit_s >= rules_.time_to_act_s;
    verdict = is_in_time ? DangerVerdict::kInTime : DangerVerdict::kLate;
  }
  danger.event.what = NameOf(verdict);
  ++scores_.num_dangers.at(static_cast<std::size_t>(verdict));
  scores_.delay_s.Add(danger.event.delay_s);
  scores_.events.push_back(std::move(danger.event));
}

void AlertJudge::Finish() {
  for (auto& [id, episode] : episodes_) CloseEpisode(std::move(episode));
  episodes_.clear();
  for (auto& [id, watched] : watched_) {
    if (watched.danger) CloseDanger(watched, now_us_);
  }
  watched_.clear();
  std::ranges::stable_sort(scores_.events, {}, &AlertEvent::second);
}

}  // namespace lookout::eval
