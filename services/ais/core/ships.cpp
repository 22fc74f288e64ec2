#include "services/ais/core/ships.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::ais {

namespace {

using std::chrono::seconds;

// Silence after which a ship is no longer shown: some three of the longest intervals of M.1371-5, annex 1, table 1. Class A at anchor and class B
// that lie still report every 3 minutes, class A under way every 10 s and less, class B under way every 30 s, base stations every 10 s, aids every 3
// minutes.
constexpr seconds kSilenceAtRest(600);
constexpr seconds kSilenceUnderWay(120);
constexpr seconds kSilenceOfBase(60);

// Slower ships count as at rest, as in the table.
constexpr double kUnderWayMps = 1.0;

// A latency beyond this is rather a clock that is off, or a ship with a wrong second.
constexpr seconds kMostLatency(20);
// A report may be stamped a little in the future: seconds are rounded, and the two clocks differ.
constexpr seconds kMostFuture(2);

// Standard deviations. A fix that is "accurate" is better than 10 m in 95 % (M.1371: the flag); a receiver of today without it is better than it
// says.
constexpr double kAccurateSdM = 3.0;
constexpr double kUsualSdM = 5.0;
constexpr double kTimeSdS = 0.5;         // the second is rounded
constexpr double kUnknownTimeSdS = 3.0;  // nothing tells the latency
constexpr double kSpeedSdMps = 0.15;
constexpr double kSpeedSdShare = 0.05;
constexpr double kUnknownSpeedSdMps = 2.0;
// How fast ships under way change their speed and course; nearer than a minute it is small beside the error of the fix.
constexpr double kManoeuvreMps2 = 0.04;
constexpr double kMostWaySdM = 200.0;
// A ship at rest swings about her anchor or her lines.
constexpr double kSwingMps = 0.03;
constexpr double kMostSwingM = 3.0;
// The course of a ship is near her bow when she moves.
constexpr double kCourseIsBowMps = 1.5;
// Headings may be wrong: not set, or of a compass that was never swung. Then the hull lies otherwise than expected by this share of the offset.
constexpr double kOffsetShareByHeading = 0.2;
constexpr double kOffsetShareByCourse = 0.3;

// Farther in so short a time no ship goes: 200 m, and 60 m/s (a fast ferry does 25, a race boat 60).
constexpr double kJumpM = 200.0;
constexpr double kJumpMps = 60.0;
constexpr int kNumAgreeing = 3;

constexpr double kEarthRadiusM = 6'371'000.0;

double DistanceM(const PositionReport& one, const PositionReport& other) {
  const double north_m = DegToRad(other.latitude_deg - one.latitude_deg) * kEarthRadiusM;
  const double east_m = WrapToPi(DegToRad(other.longitude_deg - one.longitude_deg)) * kEarthRadiusM * Cos(DegToRad(one.latitude_deg));
  return Hypot(north_m, east_m);
}

bool IsVessel(Sender sender) { return sender == Sender::kClassA || sender == Sender::kClassB; }

bool IsUnderWay(const Ship& ship) { return ship.fix && ship.fix->report.speed_mps > kUnderWayMps; }

seconds LongestSilence(const Ship& ship) {
  if (ship.sender == Sender::kBase) return kSilenceOfBase;
  return IsUnderWay(ship) || ship.sender == Sender::kAircraft ? kSilenceUnderWay : kSilenceAtRest;
}

// The second of a report is of the minute before its arrival.
Ship::Fix TimedFix(const PositionReport& report, Utime arrival) {
  Ship::Fix fix{report, arrival, arrival - Ships::kUsualLatency, false};
  if (report.second < 0 || report.second >= kSecondUnknown) return fix;
  Utime time = std::chrono::floor<std::chrono::minutes>(arrival) + seconds(report.second);
  if (time > arrival + kMostFuture) time -= std::chrono::minutes(1);
  if (arrival - time >= std::chrono::minutes(1) - kMostFuture) time += std::chrono::minutes(1);
  if (arrival - time > kMostLatency) return fix;
  fix.time = std::min(time, arrival);
  fix.is_time_known = true;
  return fix;
}

// North and east at a place, along the axes of the map.
struct Directions {
  Eigen::Vector2d north;
  Eigen::Vector2d east;
};

Directions DirectionsAt(const LocalFrame& map, const GeodeticPlace& place) {
  const LocalFrame here(place);
  const Eigen::Matrix3d R_map_here = map.TransformFrom(here).linear();
  return {R_map_here.col(1).head<2>(), R_map_here.col(0).head<2>()};
}

// The way from the antenna to the middle of the hull: forward, to starboard.
Eigen::Vector2d OffsetOf(const Dimensions& dimensions) {
  if (!dimensions.has_reference) return Eigen::Vector2d::Zero();
  return {0.5 * (dimensions.bow_m - dimensions.stern_m), 0.5 * (dimensions.starboard_m - dimensions.port_m)};
}

double FixVariance(const PositionReport& report) {
  const double sd_m = report.is_accurate ? kAccurateSdM : kUsualSdM;
  return sd_m * sd_m + report.resolution_m * report.resolution_m / 12.0;
}

// Covariance of the way since the fix: errors of the fix's time, of speed and course, and manoeuvres of the ship meanwhile.
Eigen::Matrix2d WayCovariance(const Ship::Fix& fix, const Eigen::Vector2d& velocity_mps, double age_s) {
  if (!velocity_mps.allFinite()) {
    const double sd_m = std::min(kUnknownSpeedSdMps * (age_s + kUnknownTimeSdS), kMostWaySdM);
    return Eigen::Matrix2d::Identity() * (sd_m * sd_m);
  }
  const double time_sd_s = fix.is_time_known ? kTimeSdS : kUnknownTimeSdS;
  Eigen::Matrix2d covariance_m2 = velocity_mps * velocity_mps.transpose() * (time_sd_s * time_sd_s);
  const double speed_mps = velocity_mps.norm();
  double sd_m = std::min(kSwingMps * age_s, kMostSwingM);
  if (speed_mps > kUnderWayMps) {
    const double drift_m = (kSpeedSdMps + kSpeedSdShare * speed_mps) * age_s;
    const double manoeuvre_m = 0.5 * kManoeuvreMps2 * age_s * age_s;
    sd_m = std::min(Hypot(drift_m, manoeuvre_m), kMostWaySdM);
  }
  covariance_m2 += Eigen::Matrix2d::Identity() * (sd_m * sd_m);
  return covariance_m2;
}

void PlaceHull(const Ship& ship, const Directions& directions, PredictedShip& predicted) {
  const auto& report = ship.fix->report;
  double bow_rad = report.heading_rad;
  predicted.is_bow_measured = !std::isnan(bow_rad);
  if (!predicted.is_bow_measured && report.speed_mps > kCourseIsBowMps) bow_rad = report.course_rad;
  predicted.center_map_m = predicted.antenna_map_m;
  const auto offset_m = OffsetOf(ship.dimensions);
  predicted.offset_m = offset_m.norm();
  double offset_sd_m = predicted.offset_m;
  if (!std::isnan(bow_rad)) {
    const auto [sin, cos] = SinCosOf(bow_rad);
    const Eigen::Vector2d bow = cos * directions.north + sin * directions.east;
    const Eigen::Vector2d starboard(bow.y(), -bow.x());
    predicted.center_map_m += offset_m.x() * bow + offset_m.y() * starboard;
    predicted.bow_rad = WrapTo2Pi(bow_rad);
    predicted.bow_map = bow;
    offset_sd_m *= predicted.is_bow_measured ? kOffsetShareByHeading : kOffsetShareByCourse;
  }
  // Where the antenna is on the hull is not known: anywhere along it.
  if (!ship.dimensions.has_reference) offset_sd_m = std::isnan(ship.dimensions.length_m()) ? 3.0 : ship.dimensions.length_m() / std::sqrt(12.0);
  predicted.covariance_m2 += Eigen::Matrix2d::Identity() * (offset_sd_m * offset_sd_m);
}

}  // namespace

bool Ship::has_usable_position() const {
  return fix && fix->report.has_position() && fix->report.second != kSecondManual && fix->report.second != kSecondInoperative;
}

GeodeticPlace PropagatedPlace(const Ship::Fix& fix, Utime time) {
  const GeodeticPlace place{fix.report.latitude_deg, fix.report.longitude_deg, 0.0};
  if (std::isnan(fix.report.speed_mps) || std::isnan(fix.report.course_rad)) return place;
  const double way_m = fix.report.speed_mps * ToSeconds(std::max(time - fix.time, std::chrono::microseconds(0)));
  const auto [sin, cos] = SinCosOf(fix.report.course_rad);
  return LocalFrame(place).Reverse({way_m * sin, way_m * cos, 0.0});
}

std::optional<PredictedShip> Predict(const Ship& ship, const LocalFrame& map, Utime time) {
  if (!ship.has_usable_position()) return std::nullopt;
  const auto& fix = *ship.fix;
  const GeodeticPlace place{fix.report.latitude_deg, fix.report.longitude_deg, 0.0};
  const auto directions = DirectionsAt(map, place);
  PredictedShip predicted;
  predicted.age_s = ToSeconds(std::max(time - fix.time, std::chrono::microseconds(0)));
  const double speed_mps = fix.report.speed_mps;
  if (!std::isnan(speed_mps) && !std::isnan(fix.report.course_rad)) {
    const auto [sin, cos] = SinCosOf(fix.report.course_rad);
    predicted.velocity_map_mps = speed_mps * (cos * directions.north + sin * directions.east);
  } else if (speed_mps < 0.3) {
    predicted.velocity_map_mps.setZero();  // at rest there is no course
  }
  predicted.antenna_map_m = map.Forward(place).head<2>();
  if (predicted.velocity_map_mps.allFinite()) {
    predicted.antenna_map_m += predicted.age_s * predicted.velocity_map_mps;
    predicted.velocity_sd_mps = kSpeedSdMps + kSpeedSdShare * speed_mps + (speed_mps > kUnderWayMps ? kManoeuvreMps2 * predicted.age_s : 0.0);
  }
  predicted.covariance_m2 = Eigen::Matrix2d::Identity() * FixVariance(fix.report) + WayCovariance(fix, predicted.velocity_map_mps, predicted.age_s);
  PlaceHull(ship, directions, predicted);
  return predicted;
}

void Ships::Add(const Message& message, bool is_own, Utime arrival) {
  if (is_own) {
    ++counts_["reports_own"];
    // A base station tells its own reports by VDO, too, and a line of another's receiver may come once.
    if (!IsVessel(message.sender)) return;
    told_own_mmsi_ = message.mmsi;
    own_heard_ = arrival;
    if (configured_own_mmsi_ == 0) ships_.erase(message.mmsi);
    return;
  }
  // The own ship as others relay it, or as a receiver beside the own transponder hears it.
  if (message.mmsi == own_mmsi()) {
    ++counts_["reports_own"];
    return;
  }
  auto found = ships_.find(message.mmsi);
  if (found == ships_.end()) {
    if (ships_.size() >= kMostShips) {
      ++counts_["ships_over_limit"];
      // First those without a place.
      const auto oldest =
          std::ranges::min_element(ships_, {}, [](const auto& entry) { return std::pair(entry.second.fix.has_value(), entry.second.heard); });
      doubted_.erase(oldest->first);
      ships_.erase(oldest);
    }
    found = ships_.emplace(message.mmsi, Ship{}).first;
    found->second.mmsi = message.mmsi;
  }
  auto& ship = found->second;
  ship.heard = arrival;
  // Ships are what their positions say; a message of another kind under the number of a vessel does not make her a base station.
  const bool is_kept = IsVessel(ship.sender) && (!message.position || !IsVessel(message.sender));
  if (message.sender != Sender::kUnknown && !is_kept) ship.sender = message.sender;
  if (message.sender == Sender::kAid) ship.is_virtual = message.is_virtual;
  // "Not available" takes nothing back that was known.
  const auto& facts = message.facts;
  if (facts.name && !facts.name->empty()) ship.name = *facts.name;
  if (facts.call_sign && !facts.call_sign->empty()) ship.call_sign = *facts.call_sign;
  if (facts.ship_type && *facts.ship_type != 0) ship.ship_type = *facts.ship_type;
  if (facts.dimensions && !std::isnan(facts.dimensions->length_m())) ship.dimensions = *facts.dimensions;
  if (message.position) AddPosition(ship, *message.position, arrival);
}

void Ships::AddPosition(Ship& ship, const PositionReport& report, Utime arrival) {
  if (!report.has_position()) {
    ++counts_["reports_without_position"];
    return;
  }
  const auto fix = TimedFix(report, arrival);
  // Relayed late, or heard by two receivers. The long-range message is coarse: it says nothing beside the others.
  const bool is_coarser = ship.fix && report.resolution_m > ship.fix->report.resolution_m && arrival - ship.fix->arrival < LongestSilence(ship);
  if (is_coarser || (ship.fix && fix.is_time_known && ship.fix->is_time_known && fix.time <= ship.fix->time)) {
    ++counts_["reports_old"];
    return;
  }
  if (!IsBelieved(ship, fix)) {
    ++counts_["reports_jumped"];
    return;
  }
  ++counts_["reports_taken"];
  ship.fix = fix;
}

bool Ships::IsBelieved(const Ship& ship, const Ship::Fix& fix) {
  const auto is_reachable = [](const Ship::Fix& from, const Ship::Fix& to) {
    const double duration_s = ToSeconds(std::chrono::abs(to.arrival - from.arrival));
    return DistanceM(from.report, to.report) <= kJumpM + kJumpMps * duration_s + to.report.resolution_m + from.report.resolution_m;
  };
  if (!ship.fix || is_reachable(*ship.fix, fix)) {
    doubted_.erase(ship.mmsi);
    return true;
  }
  auto& doubted = doubted_[ship.mmsi];
  const bool is_agreeing = doubted.num_agreeing > 0 && is_reachable(doubted.fix, fix);
  doubted = {fix, is_agreeing ? doubted.num_agreeing + 1 : 1};
  if (doubted.num_agreeing < kNumAgreeing) return false;
  ++counts_["ships_moved"];
  doubted_.erase(ship.mmsi);
  return true;
}

void Ships::AdvanceTo(Utime time) {
  const auto num_silent = std::erase_if(ships_, [&](const auto& entry) {
    if (time - entry.second.heard <= LongestSilence(entry.second)) return false;
    doubted_.erase(entry.first);
    return true;
  });
  counts_["ships_silent"] += static_cast<std::int64_t>(num_silent);
  // A ship that still sends other messages keeps an old position no longer than a silent ship.
  for (auto& [mmsi, ship] : ships_) {
    if (!ship.fix || time - ship.fix->arrival <= LongestSilence(ship)) continue;
    ++counts_["positions_silent"];
    ship.fix.reset();
    doubted_.erase(mmsi);
  }
  if (own_heard_ && time - *own_heard_ > kSilenceAtRest) {
    told_own_mmsi_ = 0;
    own_heard_.reset();
  }
}

void Ships::Clear() {
  ships_.clear();
  doubted_.clear();
  told_own_mmsi_ = 0;
  own_heard_.reset();
}

}  // namespace lookout::ais
