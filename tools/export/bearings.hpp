// What a log says of the boat around one turn: its heading (POSE) and the mounting of its lidar (config in RUN_INFO).
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <optional>

#include "common/core/bytes.hpp"
#include "tools/export/sink.hpp"

namespace lookout::exporter {

struct BoatOfLog {
  Eigen::Isometry3d T_vessel_lidar;
  Eigen::AlignedBox3d own_vessel_box_m;  // vessel frame
};

class Bearings {
 public:
  /// Takes a message of POSE. Keeps only those around `turn_utime_us`, the time of the turn that is looked at now.
  Taken TakePose(Bytes bytes, std::int64_t turn_utime_us);

  /// Takes a message of RUN_INFO; one without a whole boat.txtpb changes nothing.
  Taken TakeRunInfo(Bytes bytes);

  /// @return heading at a time, from true north clockwise; nullopt when no pose within kMaxDistanceUs holds one
  std::optional<double> HeadingAt(std::int64_t utime_us) const;

  const std::optional<BoatOfLog>& boat() const { return boat_; }

 private:
  // POSE comes on a grid of 20 ms: five of them may be missing.
  static constexpr std::int64_t kMaxDistanceUs = 100'000;

  struct Heading {
    std::int64_t utime_us;
    double heading_rad;
  };
  std::deque<Heading> headings_;
  std::optional<BoatOfLog> boat_;
};

}  // namespace lookout::exporter
