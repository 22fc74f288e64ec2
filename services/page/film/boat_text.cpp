#include "services/page/film/boat_text.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/config/text_config.hpp"
#include "common/messages/run_info_files.hpp"
#include "config/schema/boat.pb.h"
#include "config/schema/tracker.pb.h"

namespace lookout::page {

namespace {

constexpr const char* kBoatFile = "boat.txtpb";
constexpr const char* kTrackerFile = "tracker.txtpb";

nlohmann::json MountingJson(const config::Mounting& mounting) {
  return {{"x_m", mounting.x_m()},
          {"y_m", mounting.y_m()},
          {"z_m", mounting.z_m()},
          {"roll_deg", mounting.roll_deg()},
          {"pitch_deg", mounting.pitch_deg()},
          {"yaw_deg", mounting.yaw_deg()}};
}

}  // namespace

std::string BoatText(const config::Boat& boat, const config::Tracker& tracker) {
  const auto number_or_null = [](bool has, double number) { return has ? nlohmann::json(number) : nlohmann::json(); };
  const auto& own = boat.own_vessel();
  nlohmann::json zones = nlohmann::json::array();
  if (tracker.has_guard_zone()) {
    const auto& zone = tracker.guard_zone();
    zones.push_back({{"name", "guard zone"}, {"range_m", zone.range_m()}, {"from_deg", zone.from_bearing_deg()}, {"to_deg", zone.to_bearing_deg()}});
  }
  const nlohmann::json json{{"name", boat.name()},
                            {"hull_length_m", number_or_null(boat.has_hull_length_m(), boat.hull_length_m())},
                            {"hull_beam_m", number_or_null(boat.has_hull_beam_m(), boat.hull_beam_m())},
                            {"reference_point_above_water_m", boat.reference_point_above_water_m()},
                            {"lidar", MountingJson(boat.lidar())},
                            {"lidar_2", boat.has_lidar_2() ? MountingJson(boat.lidar_2()) : nlohmann::json()},
                            {"own_vessel",
                             {{"min_x_m", own.min_x_m()},
                              {"max_x_m", own.max_x_m()},
                              {"min_y_m", own.min_y_m()},
                              {"max_y_m", own.max_y_m()},
                              {"min_z_m", own.min_z_m()},
                              {"max_z_m", own.max_z_m()}}},
                            {"guard_zones", zones},
                            {"cpa_limit_m", tracker.cpa_limit_m()}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string BoatTextOfFolder(const std::filesystem::path& folder, std::string& fault) {
  if (!exists(symlink_status(folder / kBoatFile))) return "null";
  const auto boat = config::Load<config::Boat>(folder, kBoatFile);
  config::Tracker tracker;
  try {
    tracker = config::Load<config::Tracker>(folder, kTrackerFile);
  } catch (const config::ConfigError& error) {
    fault = error.what();
  }
  return BoatText(boat, tracker);
}

std::string BoatTextOf(const run_info_t& info) try {
  const auto* const boat_text = messages::FileTextOf(info, kBoatFile);
  const auto* const tracker_text = messages::FileTextOf(info, kTrackerFile);
  if (boat_text == nullptr || tracker_text == nullptr) return "null";
  config::Boat boat;
  config::Tracker tracker;
  config::ParseText(*boat_text, kBoatFile, boat);
  config::ParseText(*tracker_text, kTrackerFile, tracker);
  return BoatText(boat, tracker);
} catch (const config::ConfigError&) {
  return "null";
}

}  // namespace lookout::page
