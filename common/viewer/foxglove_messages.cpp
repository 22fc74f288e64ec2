#include "common/viewer/foxglove_messages.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/core/append_bytes.hpp"
#include "common/core/frames.hpp"
#include "common/core/printable.hpp"
#include "common/messages/checks.hpp"
#include "common/messages/pose_message.hpp"
#include "common/messages/returns.hpp"
#include "common/messages/words.hpp"
#include "common/viewer/boat_of_run_info.hpp"
#include "common/viewer/foxglove.pb.h"
#include "common/viewer/motion.pb.h"

namespace lookout::viewer {

namespace {

constexpr std::int64_t kUsPerS = 1'000'000;
constexpr std::size_t kPointStride = 4 + 4 + 4 + 1 + 1;  // x, y, z, reflectivity, ring
constexpr std::int64_t kLocationPeriodUs = 200'000;

using Rgb = std::array<double, 3>;
constexpr Rgb kSureRgb{1.0, 0.55, 0.0};
constexpr Rgb kTentativeRgb{0.6, 0.6, 0.6};
constexpr Rgb kLandRgb{0.45, 0.33, 0.2};
constexpr Rgb kTrackRgb{0.1, 0.6, 1.0};

template <typename Stamp>
void SetTime(std::int64_t utime_us, Stamp* stamp) {
  auto seconds = utime_us / kUsPerS;
  auto rest_us = utime_us % kUsPerS;
  if (rest_us < 0) {
    rest_us += kUsPerS;
    --seconds;
  }
  stamp->set_seconds(seconds);
  stamp->set_nanos(static_cast<std::int32_t>(rest_us * 1000));
}

template <typename Vector>
void SetVector(const Eigen::Vector3d& value, Vector* vector) {
  vector->set_x(value.x());
  vector->set_y(value.y());
  vector->set_z(value.z());
}

void SetRotation(const Eigen::Matrix3d& rotation, foxglove::Quaternion* quaternion) {
  const Eigen::Quaterniond value(rotation);
  quaternion->set_x(value.x());
  quaternion->set_y(value.y());
  quaternion->set_z(value.z());
  quaternion->set_w(value.w());
}

void SetPose(const Eigen::Vector3d& position_m, const Eigen::Matrix3d& rotation, foxglove::Pose* pose) {
  SetVector(position_m, pose->mutable_position());
  SetRotation(rotation, pose->mutable_orientation());
}

void SetColor(const Rgb& rgb, double opacity, foxglove::Color* color) {
  color->set_r(rgb[0]);
  color->set_g(rgb[1]);
  color->set_b(rgb[2]);
  color->set_a(opacity);
}

// An outline of corners, at a height.
void AddLine(const std::vector<float>& x_m, const std::vector<float>& y_m, double z_m, bool is_closed, const Rgb& rgb, double opacity,
             foxglove::SceneEntity* entity) {
  if (x_m.empty()) return;
  auto* line = entity->add_lines();
  line->set_type(is_closed ? foxglove::LinePrimitive::LINE_LOOP : foxglove::LinePrimitive::LINE_STRIP);
  SetPose(Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(), line->mutable_pose());
  line->set_thickness(2.0);
  line->set_scale_invariant(true);
  for (std::size_t i = 0; i < x_m.size(); ++i) SetVector({x_m[i], y_m[i], z_m}, line->add_points());
  SetColor(rgb, opacity, line->mutable_color());
}

void AddText(const std::string& words, const Eigen::Vector3d& place_m, const Rgb& rgb, foxglove::SceneEntity* entity) {
  auto* text = entity->add_texts();
  SetPose(place_m, Eigen::Matrix3d::Identity(), text->mutable_pose());
  text->set_billboard(true);
  text->set_font_size(14.0);
  text->set_scale_invariant(true);
  SetColor(rgb, 1.0, text->mutable_color());
  text->set_text(words);
}

void AddPair(const std::string& key, const std::string& value, foxglove::SceneEntity* entity) {
  auto* pair = entity->add_metadata();
  pair->set_key(key);
  pair->set_value(value);
}

// What was drawn of the scan before goes first, once in its parts.
foxglove::SceneUpdate BeginScene(std::int64_t utime_us, std::int32_t part_index) {
  foxglove::SceneUpdate scene;
  if (part_index > 0) return scene;
  auto* deletion = scene.add_deletions();
  SetTime(utime_us, deletion->mutable_timestamp());
  deletion->set_type(foxglove::SceneEntityDeletion::ALL);
  return scene;
}

foxglove::SceneEntity* AddEntity(std::int64_t utime_us, std::string_view frame, const std::string& id, foxglove::SceneUpdate& scene) {
  auto* entity = scene.add_entities();
  SetTime(utime_us, entity->mutable_timestamp());
  entity->set_frame_id(std::string(frame));
  entity->set_id(id);
  // Where no scan comes any more nothing stays on the screen.
  entity->mutable_lifetime()->set_seconds(2);
  return entity;
}

void AddTransform(std::int64_t utime_us, const char* parent, const char* child, const Eigen::Vector3d& translation_m, const Eigen::Matrix3d& rotation,
                  foxglove::FrameTransforms& transforms) {
  auto* transform = transforms.add_transforms();
  SetTime(utime_us, transform->mutable_timestamp());
  transform->set_parent_frame_id(parent);
  transform->set_child_frame_id(child);
  SetVector(translation_m, transform->mutable_translation());
  SetRotation(rotation, transform->mutable_rotation());
}

// A file behind all that it needs.
void AddFile(const google::protobuf::FileDescriptor& file, std::set<std::string>& taken, google::protobuf::FileDescriptorSet& set) {
  if (!taken.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) AddFile(*file.dependency(i), taken, set);
  file.CopyTo(set.add_file());
}

// Numbers that do not exist stand in no JSON.
nlohmann::ordered_json NumberOrNull(double value) { return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(); }

}  // namespace

bool IsDrawnFrom(FoxgloveTopic topic, std::string_view channel) {
  switch (topic) {
    case FoxgloveTopic::kPoints:
      return channel == bus::kLidarScan.name;
    case FoxgloveTopic::kObstacles:
      return channel == bus::kObstacles.name;
    case FoxgloveTopic::kTracks:
    case FoxgloveTopic::kPlaces:
      return channel == bus::kTracks.name;
    case FoxgloveTopic::kLocation:
    case FoxgloveTopic::kMotion:
      return channel == bus::kPose.name;
    case FoxgloveTopic::kTransforms:
      return channel == bus::kPose.name || channel == bus::kLidarScan.name;
    case FoxgloveTopic::kLog:
      return channel == bus::kAlerts.name;
  }
  return false;
}

std::string FoxgloveDescriptors(std::string_view schema) {
  const auto* const type = google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(std::string(schema));
  if (type == nullptr) throw std::logic_error("no schema " + std::string(schema));
  google::protobuf::FileDescriptorSet set;
  std::set<std::string> taken;
  AddFile(*type->file(), taken, set);
  return set.SerializeAsString();
}

void FoxgloveMessages::Send(FoxgloveTopic topic, const google::protobuf::Message& message) { write_(topic, message.SerializeAsString()); }

void FoxgloveMessages::Take(std::string_view channel, Bytes bytes) {
  const auto take = [&]<typename Message>(const std::optional<Message>& message, auto handler) {
    if (message && messages::IsWellFormed(*message)) return (this->*handler)(*message);
    ++num_unused_;
  };
  if (channel == bus::kLidarScan.name) return take(bus::Decode<lidar_scan_t>(bytes), &FoxgloveMessages::OnScan);
  if (channel == bus::kObstacles.name) return take(bus::Decode<obstacles_t>(bytes), &FoxgloveMessages::OnObstacles);
  if (channel == bus::kTracks.name) return take(bus::Decode<tracks_t>(bytes), &FoxgloveMessages::OnTracks);
  if (channel == bus::kRunInfo.name) {
    if (is_boat_given_) return;
    if (const auto info = bus::Decode<run_info_t>(bytes)) TakeBoat(*info, boat_);
  } else if (channel == bus::kPose.name) {
    const auto pose = bus::Decode<pose_t>(bytes);
    if (pose && UtimeFromWire(pose->utime_us)) return OnPose(*pose);
    ++num_unused_;
  } else if (channel == bus::kAlerts.name) {
    const auto alerts = bus::Decode<alerts_t>(bytes);
    if (alerts && UtimeFromWire(alerts->end_utime_us)) return OnAlerts(*alerts);
    ++num_unused_;
  }
}

void FoxgloveMessages::OnScan(const lidar_scan_t& message) {
  // A part that comes again, or out of order, begins a cloud of its own.
  if (cloud_seq_ != message.seq || cloud_utime_us_ != message.utime_us || message.part_index <= cloud_part_) {
    WriteCloud();
    cloud_seq_ = message.seq;
    cloud_utime_us_ = message.utime_us;
  }
  cloud_part_ = message.part_index;
  messages::ForEachReturn(message, nullptr, [this](const messages::Return& one) {
    for (int axis = 0; axis < 3; ++axis) AppendFloat(one.p_lidar_m[axis], points_);
    points_.push_back(static_cast<char>(one.reflectivity));
    points_.push_back(static_cast<char>(one.ring));
  });
  if (message.part_index + 1 == message.num_parts) WriteCloud();
}

void FoxgloveMessages::WriteCloud() {
  if (!cloud_seq_) return;
  foxglove::PointCloud cloud;
  SetTime(cloud_utime_us_, cloud.mutable_timestamp());
  cloud.set_frame_id("lidar");
  SetPose(Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(), cloud.mutable_pose());
  cloud.set_point_stride(kPointStride);
  const auto add_field = [&cloud](const char* name, std::uint32_t offset, foxglove::PackedElementField::NumericType type) {
    auto* field = cloud.add_fields();
    field->set_name(name);
    field->set_offset(offset);
    field->set_type(type);
  };
  add_field("x", 0, foxglove::PackedElementField::FLOAT32);
  add_field("y", 4, foxglove::PackedElementField::FLOAT32);
  add_field("z", 8, foxglove::PackedElementField::FLOAT32);
  add_field("reflectivity", 12, foxglove::PackedElementField::UINT8);
  add_field("ring", 13, foxglove::PackedElementField::UINT8);
  cloud.set_data(std::move(points_));
  Send(FoxgloveTopic::kPoints, cloud);
  points_.clear();
  cloud_seq_.reset();
  cloud_part_ = -1;
  if (!boat_) return;
  foxglove::FrameTransforms transforms;
  AddTransform(cloud_utime_us_, "vessel", "lidar", boat_->T_vessel_lidar.translation(), boat_->T_vessel_lidar.linear(), transforms);
  Send(FoxgloveTopic::kTransforms, transforms);
}

void FoxgloveMessages::Finish() { WriteCloud(); }

void FoxgloveMessages::OnObstacles(const obstacles_t& message) {
  auto scene = BeginScene(message.end_utime_us, message.part_index);
  for (const auto& obstacle : message.obstacles) {
    const bool is_placed = obstacle.status == obstacle_t::STATUS_OK;
    const bool is_land = obstacle.kind == obstacle_t::KIND_LAND;
    const bool is_sure = obstacle.confidence == obstacle_t::CONFIDENCE_SURE;
    const auto& rgb = is_land ? kLandRgb : is_sure ? kSureRgb : kTentativeRgb;
    auto* entity = AddEntity(message.end_utime_us, is_placed ? "map" : "vessel", "obstacle " + std::to_string(obstacle.id), scene);
    AddPair("confidence", std::string(words::WordOf(words::kConfidence, obstacle.confidence)), entity);
    AddPair("kind", std::string(words::WordOf(words::kKind, obstacle.kind)), entity);
    AddPair("range_m", fmt::format("{}", obstacle.range_m), entity);
    AddPair("returns", std::to_string(obstacle.num_points), entity);
    const double opacity = is_sure ? 1.0 : 0.5;
    const double water_z_m = is_placed ? 0.0 : -reference_point_above_water_m();
    if (is_land && obstacle.num_waterline > 0) {
      AddLine(is_placed ? obstacle.waterline_east_m : obstacle.waterline_vessel_x_m,
              is_placed ? obstacle.waterline_north_m : obstacle.waterline_vessel_y_m, water_z_m, false, rgb, opacity, entity);
    } else {
      AddLine(is_placed ? obstacle.footprint_east_m : obstacle.footprint_vessel_x_m,
              is_placed ? obstacle.footprint_north_m : obstacle.footprint_vessel_y_m, water_z_m, true, rgb, opacity, entity);
    }
  }
  Send(FoxgloveTopic::kObstacles, scene);
}

void FoxgloveMessages::OnTracks(const tracks_t& message) {
  constexpr double kArrowS = 10.0;  // the way of so long
  constexpr double kMostMps = 1000.0;
  auto scene = BeginScene(message.end_utime_us, message.part_index);
  if (message.part_index == 0) features_.clear();
  for (const auto& track : message.tracks) {
    if (track.status == track_t::STATUS_TENTATIVE || track.status == track_t::STATUS_LOST) continue;
    const Eigen::Vector2d velocity_mps(track.velocity_map_mps[0], track.velocity_map_mps[1]);
    const double speed_mps = std::sqrt(velocity_mps.squaredNorm());
    if (!std::isfinite(track.position_map_m[0]) || !std::isfinite(track.position_map_m[1]) || !(speed_mps < kMostMps)) continue;
    const auto kind = std::string(words::WordOf(words::kTrackKind, track.kind));
    const auto name = kind + " " + std::to_string(track.id);
    const Eigen::Vector3d place_m(track.position_map_m[0], track.position_map_m[1], 0.0);
    auto* entity = AddEntity(message.end_utime_us, "map", "track " + std::to_string(track.id), scene);
    AddPair("status", std::string(words::WordOf(words::kTrackStatus, track.status)), entity);
    AddPair("kind", kind, entity);
    AddPair("cpa_m", fmt::format("{}", track.cpa_m), entity);
    AddPair("tcpa_s", fmt::format("{}", track.tcpa_s), entity);
    AddLine(track.outline_east_m, track.outline_north_m, 0.0, true, kTrackRgb, track.status == track_t::STATUS_COASTING ? 0.5 : 1.0, entity);
    AddText(name, place_m + Eigen::Vector3d(0.0, 0.0, 1.0), kTrackRgb, entity);
    if (speed_mps > 0.1) {
      auto* arrow = entity->add_arrows();
      Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
      rotation.col(0) = Eigen::Vector3d(velocity_mps.x() / speed_mps, velocity_mps.y() / speed_mps, 0.0);
      rotation.col(1) = Eigen::Vector3d(-rotation(1, 0), rotation(0, 0), 0.0);
      SetPose(place_m, rotation, arrow->mutable_pose());
      arrow->set_shaft_length(speed_mps * kArrowS);
      arrow->set_shaft_diameter(0.3);
      arrow->set_head_length(1.0);
      arrow->set_head_diameter(0.8);
      SetColor(kTrackRgb, 1.0, arrow->mutable_color());
    }
    if (!std::isfinite(track.latitude_deg) || !std::isfinite(track.longitude_deg)) continue;
    features_.push_back(
        {{"type", "Feature"},
         {"geometry", {{"type", "Point"}, {"coordinates", {track.longitude_deg, track.latitude_deg}}}},
         {"properties", {{"name", name}, {"speed_mps", NumberOrNull(track.speed_mps)}, {"course_deg", NumberOrNull(RadToDeg(track.course_rad))}}}});
  }
  Send(FoxgloveTopic::kTracks, scene);
  if (message.part_index + 1 < message.num_parts) return;  // a collection takes the place of the one before
  foxglove::GeoJSON places;
  places.set_geojson(nlohmann::ordered_json{{"type", "FeatureCollection"}, {"features", features_}}.dump());
  features_ = nlohmann::ordered_json::array();
  Send(FoxgloveTopic::kPlaces, places);
}

void FoxgloveMessages::OnPose(const pose_t& message) {
  const auto checked = messages::ToPose(message);
  if (const auto* pose = std::get_if<Pose>(&checked); pose != nullptr && pose->is_placed) {
    // Its axes differ from the map's only away from the datum.
    PoseHistory history;
    history.Add(*pose);
    const auto& here = *history.newest();
    // Outlines have no height: they are drawn on the water, so the boat floats on it, whatever GNSS says of heights.
    Eigen::Vector3d place_m = here.position_map_m;
    place_m.z() = reference_point_above_water_m() + (std::isfinite(message.heave_m) ? message.heave_m : 0.0);
    foxglove::FrameTransforms transforms;
    AddTransform(message.utime_us, "map", "vessel", place_m, here.R_map_here * RotationMapVessel(here.heading_rad, here.pitch_rad, here.roll_rad),
                 transforms);
    Send(FoxgloveTopic::kTransforms, transforms);
  }
  if (message.utime_us % kLocationPeriodUs != 0) return;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Motion motion;
  SetTime(message.utime_us, motion.mutable_timestamp());
  motion.set_velocity_east_mps(message.velocity_map_mps[0]);
  motion.set_velocity_north_mps(message.velocity_map_mps[1]);
  motion.set_speed_mps(std::sqrt(Eigen::Vector2d(message.velocity_map_mps[0], message.velocity_map_mps[1]).squaredNorm()));
  motion.set_heading_deg(message.heading_source == pose_t::HEADING_NONE ? kUnknown : RadToDeg(message.heading_rad));
  motion.set_roll_deg(message.has_attitude != 0 ? RadToDeg(message.roll_rad) : kUnknown);
  motion.set_pitch_deg(message.has_attitude != 0 ? RadToDeg(message.pitch_rad) : kUnknown);
  Send(FoxgloveTopic::kMotion, motion);
  if (!std::isfinite(message.latitude_deg) || !std::isfinite(message.longitude_deg)) return;
  foxglove::LocationFix fix;
  SetTime(message.utime_us, fix.mutable_timestamp());
  fix.set_frame_id("vessel");
  fix.set_latitude(message.latitude_deg);
  fix.set_longitude(message.longitude_deg);
  fix.set_altitude(message.ellipsoid_height_m);
  bool is_known = true;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      fix.add_position_covariance(message.covariance[row][column]);
      is_known = is_known && std::isfinite(message.covariance[row][column]);
    }
  }
  fix.set_position_covariance_type(is_known ? foxglove::LocationFix::KNOWN : foxglove::LocationFix::UNKNOWN);
  Send(FoxgloveTopic::kLocation, fix);
}

// A line when an alert comes up, changes or ends.
void FoxgloveMessages::OnAlerts(const alerts_t& message) {
  std::map<std::int64_t, std::array<std::int32_t, 3>> now;
  for (const auto& alert : message.alerts) {
    const std::array state{alert.level, alert.state, alert.end};
    now.emplace(alert.id, state);
    const auto before = told_.find(alert.id);
    if (before != told_.end() && before->second == state) continue;
    const bool is_over = alert.state == alert_t::STATE_RECTIFIED || alert.state == alert_t::STATE_CLEARED;
    foxglove::Log log;
    SetTime(message.end_utime_us, log.mutable_timestamp());
    log.set_level(is_over ? foxglove::Log::INFO : alert.level == alert_t::LEVEL_WARNING ? foxglove::Log::ERROR : foxglove::Log::WARNING);
    log.set_message(PrintableLines(alert.text) + " (" + std::string(words::WordOf(words::kAlertState, alert.state)) + ")");
    log.set_name("alert " + std::to_string(alert.id));
    Send(FoxgloveTopic::kLog, log);
  }
  told_ = std::move(now);
}

}  // namespace lookout::viewer
