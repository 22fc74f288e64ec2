// Makes a recording for the calibration out of messages of a replay or of a live bus, in the order in which they come.
#pragma once

#include <optional>

#include "common/core/utime.hpp"
#include "common/messages/part_assembler.hpp"
#include "common/messages/pose_message.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/pose_t.hpp"
#include "tools/calibrate/recording.hpp"

namespace lookout::calibrate {

class Collector {
 public:
  /// @param recording  is filled; outlives this
  Collector(Recording& recording, const Stretch& stretch) : recording_(recording), stretch_(stretch) {}

  /// A part of a scan. Scans that lack a part, or are outside of the stretch, are left out.
  void OnScan(const lidar_scan_t& message);

  /// A pose that was computed without the lidar's motion and without the IMU in it: both are turned by the mounting that is in question.
  void OnPose(const pose_t& message);

 private:
  Recording& recording_;
  Stretch stretch_;
  messages::PartAssembler<lidar_scan_t> assembler_;
  std::optional<Utime> first_;
  std::optional<Datum> datum_;
};

}  // namespace lookout::calibrate
