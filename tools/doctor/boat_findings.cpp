// Mounting, guard zone and disk.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "common/config/boat.hpp"
#include "common/core/angles.hpp"
#include "services/lidar/core/vlp16/model.hpp"
#include "services/tracker/params_text.hpp"
#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kMountingSubject = "mounting";
constexpr const char* kGuardZoneSubject = "zone";
constexpr const char* kDiskSubject = "disk";

// Half the height of the VLP-16's field of view: leaning more, one side sees only sky or only water.
constexpr double kMaxLeanDeg = 15.0;
constexpr double kExampleM = 10.0;
// The rate of recording where it was not heard: the simulated lake at 10 scans a second (README, "Figures").
constexpr double kUsualRateBytesPerS = 2.9e6;
constexpr double kLeastHours = 1.0;
constexpr double kDayHours = 10.0;  // a day on the water

// The nearest of eight directions in the vessel's plane.
std::string Facing(const Eigen::Vector3d& direction) {
  static constexpr std::array kNames{"forward", "forward and to port",  "to port",      "aft and to port",
                                     "aft",     "aft and to starboard", "to starboard", "forward and to starboard"};
  const double eighth = std::numbers::pi / 4.0;
  return kNames.at(static_cast<std::size_t>(WrapTo2Pi(std::atan2(direction.y(), direction.x()) + eighth / 2.0) / eighth) % kNames.size());
}

// Where the lidar sees a point of the vessel frame.
std::string SeenByLidar(const config::BoatFacts& boat, const Eigen::Vector3d& p_vessel_m) {
  const Eigen::Vector3d p_lidar_m = boat.T_vessel_lidar.inverse() * p_vessel_m;
  const double azimuth_rad = WrapTo2Pi(-std::atan2(p_lidar_m.y(), p_lidar_m.x()));
  const double elevation_rad = std::atan2(p_lidar_m.z(), p_lidar_m.head<2>().norm());
  return fmt::format("azimuth {} deg, elevation {} deg and range {} m", Fixed(RadToDeg(azimuth_rad), 1), Fixed(RadToDeg(elevation_rad), 1),
                     Fixed(p_lidar_m.norm(), 2));
}

Finding CheckLidarDirection(const config::BoatFacts& boat) {
  const Eigen::Matrix3d rotation = boat.T_vessel_lidar.linear();
  const double bow_up_deg = RadToDeg(std::asin(rotation(2, 0)));
  const double left_up_deg = RadToDeg(std::asin(rotation(2, 1)));
  const bool is_upside_down = rotation(2, 2) < 0.0;
  const auto text =
      fmt::format("the lidar looks {} (its azimuth 0 is {} deg to {} of the bow); its azimuth 0 points {} deg {}, its left side is {} deg {}{}",
                  Facing(rotation.col(0)), Fixed(std::abs(RadToDeg(std::atan2(rotation(1, 0), rotation(0, 0)))), 1),
                  rotation(1, 0) < 0.0 ? "starboard" : "port", Fixed(std::abs(bow_up_deg), 1), bow_up_deg < 0.0 ? "down" : "up",
                  Fixed(std::abs(left_up_deg), 1), left_up_deg < 0.0 ? "down" : "up", is_upside_down ? "; it hangs upside down" : "");
  if (is_upside_down) return Warning(kMountingSubject, text, "if it does not hang so: lidar.roll_deg and lidar.pitch_deg in boat.txtpb");
  if (std::max(std::abs(bow_up_deg), std::abs(left_up_deg)) > kMaxLeanDeg) {
    return Warning(kMountingSubject, text,
                   "it leans so far that one side sees only sky or only water: level it, or correct the angles in boat.txtpb");
  }
  if (!boat.own_vessel_box_m.contains(boat.T_vessel_lidar.translation())) {
    return Warning(kMountingSubject, text + "; it stands outside of own_vessel, so that its own mast may count as an obstacle",
                   "the signs of lidar in boat.txtpb, or make own_vessel larger");
  }
  return Ok(kMountingSubject, text);
}

// nullopt: the beams are the sensor's to tell, and it is not asked here.
std::optional<double> LowestBeamRad(const ConfigSeen& config) {
  if (config.lidar && config.lidar->other) {
    if (config.lidar->other->beam_text.empty() && lidar::RowOf(config.lidar->other->model).needs_beam_file) return std::nullopt;
    return lidar::MakeReader(config.lidar->other->model, config.lidar->other->beam_text)->head().beams.front().elevation_rad;
  }
  const bool is_hi_res = config.lidar && config.lidar->decoder.model == vlp16::ModelChoice::kPuckHiRes;
  return vlp16::BeamsOf(is_hi_res ? vlp16::Model::kPuckHiRes : vlp16::Model::kVlp16).elevation_rad.front();
}

}  // namespace

Findings CheckMounting(const ConfigSeen& config) {
  if (!config.boat) return {};  // the config's lines of the file say why
  const auto& boat = *config.boat;
  Findings findings{CheckLidarDirection(boat)};
  const double lidar_z_m = boat.T_vessel_lidar.translation().z();
  findings.push_back(
      Ok(kMountingSubject, fmt::format("an object at the lidar's height, 10 m ahead of the reference point, is at {} in the lidar's frame; one "
                                       "10 m to starboard at {}",
                                       SeenByLidar(boat, {kExampleM, 0.0, lidar_z_m}), SeenByLidar(boat, {0.0, -kExampleM, lidar_z_m}))));
  for (const auto& remark : config::RemarksOnBoat(boat)) {
    const auto grade = remark.is_under_water ? Grade::kFault : remark.cure.empty() ? Grade::kOk : Grade::kWarning;
    findings.push_back({grade, kMountingSubject, remark.words, remark.cure});
  }
  const auto lowest_rad = LowestBeamRad(config);
  const double height_m = lidar_z_m + boat.reference_point_above_water_m;
  if (height_m > 0.0 && lowest_rad && *lowest_rad < 0.0) {
    findings.push_back(
        Ok(kMountingSubject, fmt::format("with the boat level on calm water the lowest beam meets the water {} m from the lidar: what lies below "
                                         "that beam is not seen",
                                         Fixed(height_m / std::tan(-*lowest_rad), 1))));
  }
  return findings;
}

Findings CheckGuardZone(const Observations& seen) {
  const auto& config = seen.config;
  if (!config.tracker) return {};  // the config's lines of the file say why
  if (!seen.zone_unseen.empty()) {
    return {Warning(
        kGuardZoneSubject, seen.zone_unseen,
        "the field of view on the lidar's own web page; guard_zone in tracker.txtpb; ranges and field of view in segmenter.txtpb; what stands "
        "before the lidar or sticks to it; keep a look-out by eye there")};
  }
  Findings findings;
  for (const auto& remark : tracker::RemarksOnZone(*config.tracker)) {
    findings.push_back({remark.cure.empty() ? Grade::kOk : Grade::kWarning, kGuardZoneSubject, remark.words, remark.cure});
  }
  return findings;
}

Findings CheckDisk(const DiskSeen& disk) {
  if (!disk.other_host.empty()) {
    return {Ok(kDiskSubject, "lookout-recorder runs on " + disk.other_host + ": ask lookout-doctor there about its disk")};
  }
  if (disk.folder.empty()) return {};  // the config's lines of the file say why
  const auto folder = disk.folder.string();
  if (disk.free_bytes < 0) {
    return {Fault(kDiskSubject, "the log folder " + folder + " cannot be read", "correct log_folder in recorder.txtpb, or mount the disk")};
  }
  const double rate_bytes_per_s = disk.rate_bytes_per_s.value_or(kUsualRateBytesPerS);
  const double hours = static_cast<double>(disk.free_bytes) / rate_bytes_per_s / 3600.0;
  const std::string text =
      fmt::format("{}: {} GB free beyond the reserve, {} hours at {} MB/s ({}){}", folder, Fixed(static_cast<double>(disk.free_bytes) / 1e9, 1),
                  Fixed(hours, 1), Fixed(rate_bytes_per_s / 1e6, 2), disk.rate_bytes_per_s ? "heard on the bus" : "the usual rate",
                  disk.is_guessed ? "; log_folder is relative to this folder: start the recorder here too" : "");
  if (!disk.is_writable) {
    return {
        Fault(kDiskSubject, text + "; it cannot be written", "make the user of lookout-recorder its owner, or give that user the right to write")};
  }
  if (hours < kDayHours) {
    return {{hours < kLeastHours ? Grade::kFault : Grade::kWarning, kDiskSubject, text, "move old logs away: lookout-recorder deletes nothing"}};
  }
  return {Ok(kDiskSubject, text)};
}

}  // namespace lookout::doctor
