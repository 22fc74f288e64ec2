// The georeferencer process without its clock: SEGMENTS and POSE in, OBSTACLES out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "common/core/input_watch.hpp"
#include "common/core/recently.hpp"
#include "common/core/utime.hpp"
#include "common/messages/pose_message.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/segments_t.hpp"
#include "services/georeferencer/core/georeferencer.hpp"
#include "services/georeferencer/params.hpp"
#include "services/georeferencer/wire.hpp"

namespace lookout::georeferencer {

class Service {
 public:
  Service(bus::Bus& bus, const Params& params);

  /// Live only: host time has come so far. Segments that have waited too long for POSE are sent without it.
  void AdvanceTo(Utime host_time);

  /// End of input: waiting segments are sent with the poses that are there.
  void Finish();

  /// Messages of SEGMENTS that wait for POSE.
  std::int64_t num_waiting() const { return georeferencer_.num_waiting(); }

  HealthReport Report() const;

 private:
  void OnSegments(const segments_t& message);
  void OnSecond(const segments_t& message);
  void OnPose(const pose_t& message);
  void Publish(const std::vector<ObstaclePart>& parts);
  void CheckDatum(const Pose& pose);

  bus::Bus& bus_;
  Georeferencer georeferencer_;
  std::optional<GeodeticPlace> datum_;  // of boat.txtpb
  std::optional<Datum> checked_datum_;
  std::string datum_complaint_;
  Counts<messages::kSegmentsFaults> segments_refused_;
  Counts<messages::kPoseFaults> poses_refused_;
  std::int64_t num_split_ = 0;
  std::optional<std::int32_t> newest_pose_status_;  // of pose_t
  // Host time, live only.
  std::optional<Utime> now_;
  InputWatch segments_watch_{bus::kSegments.name};
  std::optional<InputWatch> second_watch_;  // where there is a second lidar
  PassedTime passed_{std::chrono::seconds(2)};
  Recently untimely_;
  InputWatch pose_watch_{bus::kPose.name};
};

}  // namespace lookout::georeferencer
