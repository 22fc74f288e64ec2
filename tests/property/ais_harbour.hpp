// A made harbour: ships that lie side by side, along a quay and alone, and ships under way, most of them with AIS. What AIS says of them, with errors
// of receivers, latency, and wrong or missing headings and dimensions; what the lidar tracks of them; and which track is which ship.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "common/core/angles.hpp"
#include "services/ais/core/watcher.hpp"
#include "tests/unit/ais/encoder.hpp"

namespace lookout::ais::test {

enum class Place { kSideBySide, kAtQuay, kAlone, kUnderWay, kEncounter };

struct MadeShip {
  Place place = Place::kAlone;
  std::uint32_t mmsi = 0;  // 0: without AIS
  std::int64_t track_id = 0;
  Eigen::Vector2d begin_m;  // middle of the hull at the begin
  double speed_mps = 0.0;
  double course_rad = 0.0;  // from north, clockwise: of the bow, too
  double length_m = 10.0;
  double beam_m = 3.0;
  Hull hull;  // as AIS has it; all 0: not said
  double antenna_ahead_m = 0.0;
  bool is_class_a = false;
  int heading_deg = 511;    // as AIS has it
  double error_sd_m = 3.0;  // of its receiver, per axis
  Eigen::Vector2d error_m = Eigen::Vector2d::Zero();

  Eigen::Vector2d At(double time_s) const { return begin_m + speed_mps * time_s * Eigen::Vector2d(std::sin(course_rad), std::cos(course_rad)); }
};

class MadeHarbour {
 public:
  static constexpr double kBeforeS = 200.0;  // AIS is heard before the first track
  static constexpr double kReachM = 90.0;    // of the lidar
  static constexpr double kErrorS = 120.0;   // for which an error of a receiver lasts
  static constexpr Utime kBegin{std::chrono::seconds(1'782'900'000)};

  explicit MadeHarbour(unsigned seed) : random_(seed) {
    MakeShips();
    MakeReports(kBeforeS + 300.0);
  }

  const std::vector<MadeShip>& ships() const { return ships_; }

  /// Sentences that arrive before a time, each once, in their order.
  std::vector<Item> TakeItems(double time_s) {
    std::vector<Item> taken;
    for (; next_ < items_.size() && items_[next_].time < TimeOf(time_s); ++next_) taken.push_back(items_[next_]);
    return taken;
  }

  TracksOfScan Scan(double time_s) {
    TracksOfScan scan;
    scan.time = TimeOf(time_s - 0.1);
    scan.end_time = TimeOf(time_s);
    scan.datum = kDatum;
    for (const auto& ship : ships_) {
      if (ship.At(time_s).norm() < kReachM) scan.tracks.push_back(TrackOf(ship, time_s));
    }
    std::ranges::sort(scan.tracks, {}, &TrackedThing::id);
    return scan;
  }

  /// The own boat lies still in the middle, its bow to the north.
  Pose OwnPose(double time_s) const {
    Pose pose;
    pose.time = TimeOf(time_s);
    pose.datum = kDatum;
    pose.is_placed = true;
    return pose;
  }

  static Utime TimeOf(double time_s) { return kBegin + std::chrono::microseconds(std::llround(time_s * 1e6)); }

 private:
  static constexpr Datum kDatum{54.3, 10.1, 0.0};

  double Uniform(double least, double most) { return std::uniform_real_distribution<double>(least, most)(random_); }
  double Normal(double sd) { return std::normal_distribution<double>(0.0, sd)(random_); }
  bool Chance(double share) { return Uniform(0.0, 1.0) < share; }

  MadeShip& Add(Place place, const Eigen::Vector2d& begin_m, double course_rad, double length_m) {
    auto& ship = ships_.emplace_back();
    ship.place = place;
    ship.begin_m = begin_m;
    ship.course_rad = course_rad;
    ship.length_m = length_m;
    ship.beam_m = 1.6 + 0.16 * length_m;
    ship.track_id = 0;
    return ship;
  }

  void MakeShips() {
    // A pontoon with ten boats side by side.
    double east_m = -60.0;
    for (int i = 0; i < 10; ++i) {
      const double length_m = Uniform(7.0, 14.0);
      auto& ship = Add(Place::kSideBySide, {east_m, 35.0}, Chance(0.5) ? 0.0 : kPi, length_m);
      ship.begin_m.x() += 0.5 * ship.beam_m;
      east_m += ship.beam_m + Uniform(0.8, 1.6);
    }
    // A quay with ships one behind the other.
    double north_m = -70.0;
    for (int i = 0; i < 4; ++i) {
      const double length_m = Uniform(14.0, 30.0);
      Add(Place::kAtQuay, {60.0, north_m + 0.5 * length_m}, Chance(0.5) ? 0.0 : kPi, length_m);
      north_m += length_m + Uniform(4.0, 10.0);
    }
    // At anchor and at buoys, far from each other.
    for (const Eigen::Vector2d& p_m : {Eigen::Vector2d(-50, -20), Eigen::Vector2d(-20, -60), Eigen::Vector2d(15, -35), Eigen::Vector2d(55, 50),
                                       Eigen::Vector2d(-75, -60), Eigen::Vector2d(20, 75)}) {
      Add(Place::kAlone, p_m + Eigen::Vector2d(Uniform(-4, 4), Uniform(-4, 4)), Uniform(0, kTwoPi), Uniform(6, 18));
    }
    // Under way, at their own times.
    for (int i = 0; i < 8; ++i) {
      const double course_rad = Uniform(0.0, kTwoPi);
      const double speed_mps = Uniform(1.2, 5.0);
      const Eigen::Vector2d direction(std::sin(course_rad), std::cos(course_rad));
      const Eigen::Vector2d aside(direction.y(), -direction.x());
      const Eigen::Vector2d nearest_m = aside * Uniform(-60.0, 60.0);
      auto& ship = Add(Place::kUnderWay, nearest_m - direction * speed_mps * Uniform(20.0, 160.0), course_rad, Uniform(6, 20));
      ship.speed_mps = speed_mps;
    }
    // Two that go the same way, 15 m apart.
    const double course_rad = Uniform(0.0, kTwoPi);
    const double speed_mps = Uniform(1.5, 3.0);
    const Eigen::Vector2d direction(std::sin(course_rad), std::cos(course_rad));
    const Eigen::Vector2d aside(direction.y(), -direction.x());
    for (const double aside_m : {10.0, 25.0}) {
      auto& ship = Add(Place::kEncounter, aside * aside_m - direction * speed_mps * 60.0, course_rad, Uniform(8, 14));
      ship.speed_mps = speed_mps;
    }
    // Numbers that tell nothing of the order of the ships.
    std::vector<std::int64_t> ids;
    for (std::size_t i = 0; i < ships_.size(); ++i) ids.push_back(static_cast<std::int64_t>(i) + 1);
    std::shuffle(ids.begin(), ids.end(), random_);
    for (std::size_t i = 0; i < ships_.size(); ++i) ships_[i].track_id = ids[i];
    std::uint32_t mmsi = 211'000'000;
    for (auto& ship : ships_) {
      mmsi += 1 + static_cast<std::uint32_t>(Uniform(0, 1000));
      if (Chance(0.7) || ship.place == Place::kEncounter) MakeAis(ship, mmsi);
    }
  }

  void MakeAis(MadeShip& ship, std::uint32_t mmsi) {
    ship.mmsi = mmsi;
    ship.is_class_a = ship.length_m > 15.0 || Chance(0.2);
    // Root mean square of the distance: 3 to 10 m.
    ship.error_sd_m = Uniform(3.0, 10.0) / std::sqrt(2.0);
    ship.error_m = {Normal(ship.error_sd_m), Normal(ship.error_sd_m)};
    const double true_deg = RadToDeg(WrapTo2Pi(ship.course_rad));
    if (ship.is_class_a ? Chance(0.9) : Chance(0.3))
      ship.heading_deg = static_cast<int>(Chance(0.1) ? Uniform(0, 359) : std::fmod(true_deg + Uniform(0, 4), 360.0));
    ship.antenna_ahead_m = std::round(Uniform(-0.4, 0.3) * ship.length_m);
    if (Chance(0.25)) return;  // no dimensions
    const double stated_m = Chance(0.05) ? Uniform(5, 30) : ship.length_m;
    const auto bow_m = std::clamp(std::round(0.5 * stated_m - ship.antenna_ahead_m), 0.0, std::round(stated_m));
    const auto beam_m = static_cast<std::uint32_t>(std::max(2.0, std::round(ship.beam_m)));
    ship.hull = {static_cast<std::uint32_t>(bow_m), static_cast<std::uint32_t>(std::round(stated_m) - bow_m), beam_m / 2, beam_m - beam_m / 2};
  }

  void MakeReports(double duration_s) {
    for (auto& ship : ships_) {
      if (ship.mmsi == 0) continue;
      double time_s = -kBeforeS + Uniform(0.0, 10.0);
      double last_s = time_s;
      while (time_s < duration_s - kBeforeS) {
        // The error of the receiver wanders.
        const double kept = std::exp(-(time_s - last_s) / kErrorS);
        const double fresh_m = ship.error_sd_m * std::sqrt(1.0 - kept * kept);
        ship.error_m = kept * ship.error_m + Eigen::Vector2d(Normal(fresh_m), Normal(fresh_m));
        last_s = time_s;
        Report(ship, time_s);
        const bool is_under_way = ship.speed_mps > 1.0;
        time_s += is_under_way ? (ship.is_class_a ? Uniform(4, 10) : 30.0) : 180.0;
      }
    }
    std::ranges::stable_sort(items_, {}, &Item::time);
  }

  void Report(const MadeShip& ship, double time_s) {
    // The second in the report is that of the position.
    const double second_s = std::floor(time_s);
    const Eigen::Vector2d forward(std::sin(ship.course_rad), std::cos(ship.course_rad));
    const Eigen::Vector2d antenna_m = ship.At(second_s) + ship.antenna_ahead_m * forward + ship.error_m;
    const auto place = kDatum.Map().Reverse({antenna_m.x(), antenna_m.y(), 0.0});
    Position position;
    position.latitude_deg = place.latitude_deg;
    position.longitude_deg = place.longitude_deg;
    position.speed_kn = std::max(0.0, (ship.speed_mps + Normal(0.1)) * 3600.0 / 1852.0);
    position.course_deg = std::fmod(RadToDeg(WrapTo2Pi(ship.course_rad + Normal(ship.speed_mps > 1.0 ? 0.05 : 1.0))), 359.9);
    position.heading_deg = ship.heading_deg;
    position.second = static_cast<int>(std::chrono::floor<std::chrono::seconds>(TimeOf(second_s)).time_since_epoch().count() % 60);
    position.status = ship.speed_mps > 0.5 ? 0 : 5;
    const double arrival_s = second_s + Uniform(2.0, 8.0);
    Send(arrival_s, ship.is_class_a ? Lines(ClassA(ship.mmsi, position)) : Lines(ClassB(ship.mmsi, position)));
    const std::string name = "SHIP " + std::to_string(ship.mmsi);
    if (ship.is_class_a) {
      Send(arrival_s, Lines(StaticA(ship.mmsi, name, "CALL", 70, ship.hull), "AIVDM", static_cast<int>(ship.mmsi % 10)));
    } else {
      Send(arrival_s, Lines(StaticBName(ship.mmsi, name)));
      Send(arrival_s, Lines(StaticBHull(ship.mmsi, "CALL", 37, ship.hull)));
    }
  }

  void Send(double arrival_s, const std::vector<std::string>& lines) {
    for (const auto& line : lines) items_.push_back({TimeOf(arrival_s), false, "udp", line});
  }

  TrackedThing TrackOf(const MadeShip& ship, double time_s) {
    TrackedThing track;
    track.id = ship.track_id;
    track.center_map_m = ship.At(time_s) + own_error_m_ + Eigen::Vector2d(Normal(0.2), Normal(0.2));
    track.covariance_m2 = Eigen::Matrix2d::Identity() * (1.5 * 1.5);
    track.velocity_map_mps = ship.speed_mps * Eigen::Vector2d(std::sin(ship.course_rad), std::cos(ship.course_rad));
    if (ship.speed_mps > 0.0) track.velocity_map_mps += Eigen::Vector2d(Normal(0.15), Normal(0.15));
    track.velocity_covariance = Eigen::Matrix2d::Identity() * (0.2 * 0.2);
    track.length_m = ship.length_m * lengths_.try_emplace(ship.track_id, 1.0 + Normal(0.05)).first->second;
    track.width_m = ship.beam_m;
    track.length_bearing_rad = std::fmod(WrapTo2Pi(ship.course_rad + Normal(0.03)), kPi);
    track.seen_share = 0.6;
    const Eigen::Vector2d ahead(std::sin(ship.course_rad), std::cos(ship.course_rad));
    const Eigen::Vector2d aside(-ahead.y(), ahead.x());
    for (const auto& [a, b] : {std::pair(1, 1), std::pair(-1, 1), std::pair(-1, -1), std::pair(1, -1)}) {
      track.outline_map_m.emplace_back(track.center_map_m + 0.5 * a * ship.length_m * ahead + 0.5 * b * ship.beam_m * aside);
    }
    return track;
  }

  std::mt19937 random_;
  std::vector<MadeShip> ships_;
  std::vector<Item> items_;
  std::size_t next_ = 0;
  std::map<std::int64_t, double> lengths_;  // what the tracker takes the length for, over what it is
  Eigen::Vector2d own_error_m_{Normal(1.0), Normal(1.0)};
};

}  // namespace lookout::ais::test
