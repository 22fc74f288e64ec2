#include "tools/import/autoferry.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "tools/import/file_bytes.hpp"

namespace lookout::importer {
namespace {

using nlohmann::json;

constexpr double kMaxPlaceM = 1e5;  // from the origin
constexpr double kMaxTimeS = 4e9;   // the year 2096
constexpr std::int64_t kPosePeriodUs = 20'000;
constexpr std::int64_t kLeadUs = 1'000'000;  // POSE before the first scan
constexpr std::int64_t kMaxFerryStepUs = 60'000'000;
constexpr std::int64_t kMaxFerrySpanUs = 86'400'000'000;

json ReadJson(const std::filesystem::path& file) { return json::parse(ReadFileBytes(file)); }

double NumberOf(const json& value, double greatest) {
  const double number = value.get<double>();
  if (!(std::abs(number) <= greatest)) throw std::runtime_error("a number is out of range");
  return number;
}

std::int64_t TimeOf(const json& value) {
  const double time_s = NumberOf(value, kMaxTimeS);
  if (time_s < 0.0) throw std::runtime_error("a time before 1970");
  return std::llround(time_s * 1e6);
}

// From north and east.
Eigen::Vector2d PlaceOf(const json& north, const json& east) { return {NumberOf(east, kMaxPlaceM), NumberOf(north, kMaxPlaceM)}; }

std::vector<Eigen::Vector2d> DetectionsOf(const json& measurement) {
  std::vector<Eigen::Vector2d> detections_m;
  if (measurement.empty()) return detections_m;
  const auto& north = measurement.at(0);
  const auto& east = measurement.at(1);
  if (measurement.size() != 2 || north.size() != east.size() || north.is_array() != east.is_array()) {
    throw std::runtime_error("a measurement is neither [north, east] nor [[north ...], [east ...]]");
  }
  if (!north.is_array()) return {PlaceOf(north, east)};
  for (std::size_t i = 0; i < north.size(); ++i) detections_m.push_back(PlaceOf(north[i], east[i]));
  return detections_m;
}

// The message of a parser, or our own, about a file, with its name.
template <typename Read>
auto Named(const std::filesystem::path& file, const Read& read) {
  try {
    return read();
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    throw std::runtime_error(reason.starts_with(file.string()) ? reason : file.string() + ": " + reason);
  }
}

// The message of a parser, or our own, about a scan. Its text is not told: it may be long, and deeper than can be written.
template <typename Read>
auto OfScan(std::int64_t utime_us, const Read& read) {
  try {
    return read();
  } catch (const std::exception& error) {
    throw std::runtime_error("scan at " + std::to_string(static_cast<double>(utime_us) * 1e-6) + " s: " + error.what());
  }
}

// Poses stand at every 20 ms between scans: a few scans far apart must not cost the memory of years.
std::string TimeFaultOf(const std::vector<FerryScan>& scans, std::int64_t utime_us) {
  if (scans.empty()) return "";
  if (utime_us <= scans.back().utime_us) return "time does not grow";
  if (utime_us - scans.back().utime_us > kMaxFerryStepUs) return "more than 60 s behind the scan before";
  return utime_us - scans.front().utime_us > kMaxFerrySpanUs ? "more than a day behind the first scan" : "";
}

// The ferry between scans.
class Way {
 public:
  explicit Way(const std::vector<FerryScan>& scans) : scans_(scans) {}

  Eigen::Vector2d At(std::int64_t utime_us) const {
    const auto after = Following(utime_us);
    return scans_[after - 1].own_m + VelocityBetween(after - 1, after) * Seconds(utime_us - scans_[after - 1].utime_us);
  }

  // Over about 2 s, since places are rounded and scans short.
  Eigen::Vector2d VelocityAt(std::int64_t utime_us) const {
    constexpr std::size_t kScansAside = 2;
    const auto after = Following(utime_us);
    const auto first = after > kScansAside ? after - kScansAside : 0;
    return VelocityBetween(first, std::min(after + kScansAside - 1, scans_.size() - 1));
  }

 private:
  static double Seconds(std::int64_t duration_us) { return static_cast<double>(duration_us) * 1e-6; }

  // From 1 on.
  std::size_t Following(std::int64_t utime_us) const {
    const auto after = std::ranges::upper_bound(scans_, utime_us, {}, &FerryScan::utime_us);
    return std::clamp<std::size_t>(static_cast<std::size_t>(after - scans_.begin()), 1, scans_.size() - 1);
  }

  Eigen::Vector2d VelocityBetween(std::size_t first, std::size_t last) const {
    return (scans_[last].own_m - scans_[first].own_m) / Seconds(scans_[last].utime_us - scans_[first].utime_us);
  }

  const std::vector<FerryScan>& scans_;
};

double CourseOf(const Eigen::Vector2d& along) { return WrapTo2Pi(Atan2(along.x(), along.y())); }

// By time, as the poses have it.
class Heading {
 public:
  Heading(const std::vector<FerryScan>& scans, const Way& way) : way_(way) {
    constexpr double kMetre = 1.0;
    const auto moved = std::ranges::find_if(scans, [&](const FerryScan& scan) { return (scan.own_m - scans.front().own_m).norm() > kMetre; });
    if (moved != scans.end()) last_rad_ = CourseOf(moved->own_m - scans.front().own_m);
  }

  // Times do not go back.
  double At(std::int64_t utime_us) {
    constexpr double kStandMps = 0.2;
    const auto velocity_mps = way_.VelocityAt(utime_us);
    if (velocity_mps.norm() > kStandMps) last_rad_ = CourseOf(velocity_mps);
    return last_rad_;
  }

 private:
  const Way& way_;
  double last_rad_ = 0.0;
};

obstacle_t ToObstacle(int id, const FerryScan& scan, const Eigen::Vector2d& detection_m, double heading_rad) {
  static const LocalFrame kMap(kAutoferryDatum);
  obstacle_t obstacle{};
  obstacle.utime_us = scan.utime_us;
  obstacle.id = id;
  obstacle.status = obstacle_t::STATUS_OK;
  obstacle.confidence = obstacle_t::CONFIDENCE_SURE;
  obstacle.kind = obstacle_t::KIND_OBSTACLE;
  obstacle.thing_probability = std::numeric_limits<float>::quiet_NaN();
  const auto place = kMap.Reverse({detection_m.x(), detection_m.y(), 0.0});
  obstacle.latitude_deg = place.latitude_deg;
  obstacle.longitude_deg = place.longitude_deg;
  const double relative_m2 = kAutoferryDetectionSdM * kAutoferryDetectionSdM;
  for (int i = 0; i < 2; ++i) {
    obstacle.position_map_m[i] = detection_m[i];
    obstacle.covariance_m2[2 * i] = relative_m2 + kAutoferryOwnSdM * kAutoferryOwnSdM;
    obstacle.covariance_relative_m2[2 * i] = relative_m2;
  }
  // Forward is (sin, cos) of heading in east and north, port is (-cos, sin).
  const Eigen::Vector2d relative_m = detection_m - scan.own_m;
  const Eigen::Vector2d forward(Sin(heading_rad), Cos(heading_rad));
  const Eigen::Vector2d vessel_m(forward.dot(relative_m), -forward.y() * relative_m.x() + forward.x() * relative_m.y());
  for (int i = 0; i < 2; ++i) {
    obstacle.center_vessel_m[i] = static_cast<float>(vessel_m[i]);
    obstacle.nearest_vessel_m[i] = static_cast<float>(vessel_m[i]);
  }
  obstacle.range_m = static_cast<float>(relative_m.norm());
  const auto bearing_rad = static_cast<float>(WrapTo2Pi(CourseOf(relative_m) - heading_rad));
  obstacle.bearing_rad = static_cast<double>(bearing_rad) < kTwoPi ? bearing_rad : 0.0F;
  obstacle.num_points = kAutoferryReturns;
  obstacle.seen_share = 1.0F;
  obstacle.num_footprint = 1;
  obstacle.footprint_vessel_x_m = {obstacle.center_vessel_m[0]};
  obstacle.footprint_vessel_y_m = {obstacle.center_vessel_m[1]};
  obstacle.num_map = 1;
  obstacle.footprint_east_m = {static_cast<float>(detection_m.x())};
  obstacle.footprint_north_m = {static_cast<float>(detection_m.y())};
  return obstacle;
}

}  // namespace

bool IsFerryScans(const std::filesystem::path& file) {
  constexpr std::size_t kLooked = 4096;
  std::ifstream in(file, std::ios::binary);
  std::string begin(kLooked, '\0');
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(in.gcount()));
  const auto first = begin.find_first_not_of(" \t\r\n");
  return first != std::string::npos && begin[first] == '[' && begin.find("\"ownshipPosition\"") != std::string::npos;
}

std::vector<FerryScan> ReadFerryScans(const std::filesystem::path& file) {
  return Named(file, [&] {
    std::vector<FerryScan> scans;
    for (const auto& one : ReadJson(file)) {
      FerryScan scan;
      scan.utime_us = TimeOf(one.at("time"));
      OfScan(scan.utime_us, [&] {
        if (const auto fault = TimeFaultOf(scans, scan.utime_us); !fault.empty()) throw std::runtime_error(fault);
        scan.own_m = PlaceOf(one.at("ownshipPosition").at(0), one.at("ownshipPosition").at(1));
        scan.detections_m = DetectionsOf(one.at("measurement"));
      });
      for (auto& detection_m : scan.detections_m) detection_m += scan.own_m;
      scans.push_back(std::move(scan));
    }
    if (scans.size() < 2) throw std::runtime_error("fewer than two scans");
    return scans;
  });
}

FerryTruth ReadFerryTruth(const std::filesystem::path& file) {
  return Named(file, [&] {
    FerryTruth truth;
    for (const auto& moment : ReadJson(file)) {
      for (const auto& target : moment) {
        const auto& position = target.at("position");
        truth[target.at("targetID").get<int>()][TimeOf(target.at("time"))] = PlaceOf(position.at(0), position.at(1));
      }
    }
    if (truth.empty()) throw std::runtime_error("no target");
    return truth;
  });
}

std::vector<obstacles_t> ToObstacles(const std::vector<FerryScan>& scans) {
  const Way way(scans);
  Heading heading(scans, way);
  std::vector<obstacles_t> messages;
  for (const auto& scan : scans) {
    auto& message = messages.emplace_back();
    message.utime_us = scan.utime_us;
    message.seq = static_cast<std::int64_t>(messages.size()) - 1;
    message.end_utime_us = scan.utime_us;
    message.num_parts = 1;
    message.datum_latitude_deg = kAutoferryDatum.latitude_deg;
    message.datum_longitude_deg = kAutoferryDatum.longitude_deg;
    message.datum_ellipsoid_height_m = kAutoferryDatum.ellipsoid_height_m;
    const double heading_rad = heading.At(scan.utime_us);
    for (const auto& detection_m : scan.detections_m) {
      message.obstacles.push_back(ToObstacle(static_cast<int>(message.obstacles.size()) + 1, scan, detection_m, heading_rad));
    }
    message.num_obstacles = static_cast<std::int32_t>(message.obstacles.size());
  }
  return messages;
}

std::vector<pose_t> ToPoses(const std::vector<FerryScan>& scans) {
  constexpr double kVelocitySdMps = 0.2;            // drawn: 0.5 m over 2 s, twice
  constexpr double kHeadingSdRad = DegToRad(15.0);  // drawn: the ferry has thrusters at both ends, and need not go where it points
  const LocalFrame map(kAutoferryDatum);
  const Way way(scans);
  Heading heading(scans, way);
  std::vector<pose_t> poses;
  const std::int64_t begin_us = (scans.front().utime_us - kLeadUs) / kPosePeriodUs * kPosePeriodUs;
  for (std::int64_t utime_us = begin_us; utime_us < scans.back().utime_us + kPosePeriodUs; utime_us += kPosePeriodUs) {
    auto& pose = poses.emplace_back();
    pose.utime_us = utime_us;
    pose.seq = static_cast<std::int64_t>(poses.size()) - 1;
    pose.status = pose_t::STATUS_OK;
    pose.heading_source = pose_t::HEADING_COURSE;
    pose.datum_latitude_deg = kAutoferryDatum.latitude_deg;
    pose.datum_longitude_deg = kAutoferryDatum.longitude_deg;
    pose.datum_ellipsoid_height_m = kAutoferryDatum.ellipsoid_height_m;
    const auto own_m = way.At(utime_us);
    const auto place = map.Reverse({own_m.x(), own_m.y(), 0.0});
    pose.latitude_deg = place.latitude_deg;
    pose.longitude_deg = place.longitude_deg;
    pose.ellipsoid_height_m = kNan;
    const auto velocity_mps = way.VelocityAt(utime_us);
    for (int i = 0; i < 2; ++i) {
      pose.position_map_m[i] = own_m[i];
      pose.velocity_map_mps[i] = velocity_mps[i];
      pose.covariance[i][i] = kAutoferryOwnSdM * kAutoferryOwnSdM;
      pose.covariance[3 + i][3 + i] = kVelocitySdMps * kVelocitySdMps;
    }
    pose.heading_rad = heading.At(utime_us);
    for (const int unknown : {2, 5, 6, 7}) pose.covariance[unknown][unknown] = kNan;
    pose.covariance[8][8] = kHeadingSdRad * kHeadingSdRad;
  }
  return poses;
}

}  // namespace lookout::importer
