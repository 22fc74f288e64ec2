// What a look-out says, live or in a log, as the messages that Foxglove and Lichtblick draw.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/bytes.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"

namespace google::protobuf {
class Descriptor;
class Message;
}  // namespace google::protobuf

namespace lookout::viewer {

enum class FoxgloveTopic { kPoints, kObstacles, kTracks, kPlaces, kLocation, kMotion, kTransforms, kLog };

struct FoxgloveChannel {
  FoxgloveTopic topic;
  std::string_view name;
  std::string_view schema;  // "foxglove.PointCloud"
};

inline constexpr std::array kFoxgloveChannels{FoxgloveChannel{FoxgloveTopic::kPoints, "/lidar/points", "foxglove.PointCloud"},
                                              FoxgloveChannel{FoxgloveTopic::kObstacles, "/obstacles", "foxglove.SceneUpdate"},
                                              FoxgloveChannel{FoxgloveTopic::kTracks, "/tracks", "foxglove.SceneUpdate"},
                                              FoxgloveChannel{FoxgloveTopic::kPlaces, "/tracks/map", "foxglove.GeoJSON"},
                                              FoxgloveChannel{FoxgloveTopic::kLocation, "/location", "foxglove.LocationFix"},
                                              FoxgloveChannel{FoxgloveTopic::kMotion, "/motion", "lookout.viewer.Motion"},
                                              FoxgloveChannel{FoxgloveTopic::kTransforms, "/tf", "foxglove.FrameTransforms"},
                                              FoxgloveChannel{FoxgloveTopic::kLog, "/alerts", "foxglove.Log"}};

/// Whether messages of the topic are drawn out of those of a channel of the bus.
bool IsDrawnFrom(FoxgloveTopic topic, std::string_view channel);

/// A FileDescriptorSet with the files of a schema and all that these need, each behind what it needs. @throws std::logic_error for an unknown one
std::string FoxgloveDescriptors(std::string_view schema);

/// Frames: map (east, north; z is up from calm water, on which POSE places the boat), vessel, lidar.
class FoxgloveMessages {
 public:
  using Write = std::function<void(FoxgloveTopic topic, const std::string& bytes)>;

  /// @param boat  nullopt: the boat of the last RUN_INFO; else RUN_INFO changes nothing
  explicit FoxgloveMessages(Write write, std::optional<config::BoatFacts> boat = std::nullopt)
      : write_(std::move(write)), boat_(std::move(boat)), is_boat_given_(boat_.has_value()) {}

  /// Takes a message of the bus. What does not decode, or contradicts itself, gives nothing.
  void Take(std::string_view channel, Bytes bytes);

  /// The last scan, where its last part did not come.
  void Finish();

  std::int64_t num_unused() const { return num_unused_; }

 private:
  void OnScan(const lidar_scan_t& message);
  void OnObstacles(const obstacles_t& message);
  void OnTracks(const tracks_t& message);
  void OnPose(const pose_t& message);
  void OnAlerts(const alerts_t& message);
  double reference_point_above_water_m() const { return boat_ ? boat_->reference_point_above_water_m : 0.0; }
  void WriteCloud();
  void Send(FoxgloveTopic topic, const google::protobuf::Message& message);

  Write write_;
  std::optional<config::BoatFacts> boat_;
  bool is_boat_given_;
  // The cloud under way: of one scan, part by part.
  std::optional<std::int64_t> cloud_seq_;
  std::int64_t cloud_utime_us_ = 0;
  std::int32_t cloud_part_ = -1;  // the last
  std::string points_;
  nlohmann::ordered_json features_ = nlohmann::ordered_json::array();  // of the parts of TRACKS so far
  std::map<std::int64_t, std::array<std::int32_t, 3>> told_;           // alerts: level, state, end
  std::int64_t num_unused_ = 0;
};

}  // namespace lookout::viewer
