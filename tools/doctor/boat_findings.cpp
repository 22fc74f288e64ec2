// Mounting in words, and the disk.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "common/config/boat.hpp"
#include "common/core/angles.hpp"
#include "services/vlp16/core/model.hpp"
#include "tools/doctor/findings.hpp"
#include "tools/doctor/words.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kMountingSubject = "mounting";
constexpr const char* kDiskSubject = "disk";

// Half the height of the VLP-16's field of view: leaning more, one side sees only sky or only water.
constexpr double kMaxLeanDeg = 15.0;
constexpr double kExampleM = 10.0;
// What recording takes where it was not heard: the simulated lake at 10 turns a second (README, "Figures").
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

// "0.50 m forward and 0.10 m to starboard of the reference point"
std::string PlaceOnBoat(const Eigen::Vector3d& p_vessel_m) {
  const auto part = [](double length_m, const char* positive, const char* negative) {
    return Text(std::abs(length_m), 2) + " m " + (length_m < 0.0 ? negative : positive);
  };
  return part(p_vessel_m.x(), "forward", "aft") + " and " + part(p_vessel_m.y(), "to port", "to starboard") + " of the reference point";
}

// Where the lidar would see a point of the vessel frame.
std::string SeenByLidar(const config::BoatFacts& boat, const Eigen::Vector3d& p_vessel_m) {
  const Eigen::Vector3d p_lidar_m = boat.T_vessel_lidar.inverse() * p_vessel_m;
  const double azimuth_rad = WrapTo2Pi(-std::atan2(p_lidar_m.y(), p_lidar_m.x()));
  const double elevation_rad = std::atan2(p_lidar_m.z(), p_lidar_m.head<2>().norm());
  return "azimuth " + Text(RadToDeg(azimuth_rad), 1) + " deg, elevation " + Text(RadToDeg(elevation_rad), 1) + " deg and range " +
         Text(p_lidar_m.norm(), 2) + " m";
}

Finding JudgeLidarMounting(const config::BoatFacts& boat) {
  const Eigen::Vector3d place_m = boat.T_vessel_lidar.translation();
  const Eigen::Matrix3d rotation = boat.T_vessel_lidar.linear();
  const double above_water_m = place_m.z() + boat.reference_point_above_water_m;
  const double bow_up_deg = RadToDeg(std::asin(rotation(2, 0)));
  const double left_up_deg = RadToDeg(std::asin(rotation(2, 1)));
  const bool is_upside_down = rotation(2, 2) < 0.0;
  std::string words =
      "the lidar looks " + Facing(rotation.col(0)) + " (its azimuth 0 is " + Text(std::abs(RadToDeg(std::atan2(rotation(1, 0), rotation(0, 0)))), 1) +
      " deg to " + (rotation(1, 0) < 0.0 ? "starboard" : "port") + " of the bow), " + Text(above_water_m, 2) + " m above the water, " +
      PlaceOnBoat(place_m) + "; its azimuth 0 points " + Text(std::abs(bow_up_deg), 1) + " deg " + (bow_up_deg < 0.0 ? "down" : "up") +
      ", its left side is " + Text(std::abs(left_up_deg), 1) + " deg " + (left_up_deg < 0.0 ? "down" : "up");
  if (is_upside_down) words += "; it hangs upside down";
  if (above_water_m <= 0.0) {
    return {Grade::kFault, kMountingSubject, words,
            "boat.txtpb puts the lidar under water: look at the sign of lidar.z_m (up is positive) and at reference_point_above_water_m"};
  }
  if (is_upside_down) return {Grade::kWarning, kMountingSubject, words, "if it does not hang so: lidar.roll_deg and lidar.pitch_deg in boat.txtpb"};
  if (std::max(std::abs(bow_up_deg), std::abs(left_up_deg)) > kMaxLeanDeg) {
    return {Grade::kWarning, kMountingSubject, words,
            "it leans so far that one side sees only sky or only water: level it, or mend the angles in boat.txtpb"};
  }
  if (!boat.own_vessel_box_m.contains(place_m)) {
    return {
        Grade::kWarning, kMountingSubject, words,
        "it stands outside of own_vessel, so that its own mast may count as an obstacle: look at the signs in boat.txtpb, or make own_vessel larger"};
  }
  return {Grade::kOk, kMountingSubject, words, {}};
}

}  // namespace

Findings JudgeMounting(const ConfigSeen& config) {
  if (!config.boat) return {};  // the config's own lines say why
  const auto& boat = *config.boat;
  Findings findings{JudgeLidarMounting(boat)};
  const double lidar_z_m = boat.T_vessel_lidar.translation().z();
  findings.push_back({Grade::kOk,
                      kMountingSubject,
                      "an object at the lidar's height, 10 m ahead of the reference point, is at " + SeenByLidar(boat, {kExampleM, 0.0, lidar_z_m}) +
                          " in the lidar's frame; one 10 m to starboard at " + SeenByLidar(boat, {0.0, -kExampleM, lidar_z_m}),
                      {}});
  for (const auto& remark : config::RemarksOnBoat(boat)) {
    findings.push_back({remark.cure.empty() ? Grade::kOk : Grade::kWarning, kMountingSubject, remark.words, remark.cure});
  }
  const double antenna_above_water_m = boat.p_vessel_antenna_m.z() + boat.reference_point_above_water_m;
  Finding antenna{Grade::kOk,
                  kMountingSubject,
                  "the GNSS antenna is " + Text(antenna_above_water_m, 2) + " m above the water, " + PlaceOnBoat(boat.p_vessel_antenna_m),
                  {}};
  if (antenna_above_water_m <= 0.0) {
    antenna.grade = Grade::kFault;
    antenna.cure = "boat.txtpb puts it under water: look at the sign of gnss_antenna.z_m (up is positive) and at reference_point_above_water_m";
  }
  findings.push_back(antenna);
  const auto model = config.lidar && config.lidar->decoder.model == vlp16::ModelChoice::kPuckHiRes ? vlp16::Model::kPuckHiRes : vlp16::Model::kVlp16;
  const double lowest_rad = vlp16::BeamsOf(model).elevation_rad.front();
  const double height_m = lidar_z_m + boat.reference_point_above_water_m;
  if (height_m > 0.0) {
    findings.push_back({Grade::kOk,
                        kMountingSubject,
                        "with the boat level on calm water the lowest beam meets the water " + Text(height_m / std::tan(-lowest_rad), 1) +
                            " m from the lidar: what lies below that beam is not seen",
                        {}});
  }
  return findings;
}

Findings JudgeDisk(const DiskSeen& disk) {
  if (!disk.other_host.empty()) {
    return {{Grade::kOk, kDiskSubject, "lookout-recorder runs on " + disk.other_host + ": ask lookout-doctor there about its disk", {}}};
  }
  if (disk.folder.empty()) return {};  // the config's own lines say why
  const auto folder = disk.folder.string();
  if (disk.free_bytes < 0) {
    return {{Grade::kFault, kDiskSubject, "the log folder " + folder + " cannot be looked at", "log_folder in recorder.txtpb, or mount the disk"}};
  }
  const double rate_bytes_per_s = disk.rate_bytes_per_s.value_or(kUsualRateBytesPerS);
  const double hours = static_cast<double>(disk.free_bytes) / rate_bytes_per_s / 3600.0;
  const std::string words = folder + ": " + Text(static_cast<double>(disk.free_bytes) / 1e9, 1) + " GB free beyond the reserve, " + Text(hours, 1) +
                            " hours at " + Text(rate_bytes_per_s / 1e6, 2) + " MB/s (" +
                            (disk.rate_bytes_per_s ? "heard on the bus" : "the usual rate") + ")" +
                            (disk.is_guessed ? "; log_folder is relative, and taken from here: start the recorder in this folder too" : "");
  if (!disk.is_writable) {
    return {{Grade::kFault, kDiskSubject, words + "; it cannot be written", "give its owner or its rights to who runs lookout-recorder"}};
  }
  if (hours < kDayHours) {
    return {{hours < kLeastHours ? Grade::kFault : Grade::kWarning, kDiskSubject, words, "move old logs away: lookout-recorder deletes nothing"}};
  }
  return {{Grade::kOk, kDiskSubject, words, {}}};
}

}  // namespace lookout::doctor
