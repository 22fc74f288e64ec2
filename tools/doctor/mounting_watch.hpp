// Collects what lookout-calibrate needs while the doctor watches, and asks calibrate's own code how the lidar is mounted.
#pragma once

#include "common/bus/bus.hpp"
#include "common/bus/memory_bus.hpp"
#include "services/navigator/params.hpp"
#include "services/navigator/service.hpp"
#include "tools/calibrate/calibration.hpp"
#include "tools/calibrate/collector.hpp"
#include "tools/calibrate/recording.hpp"
#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

/// LIDAR_SCAN and NAV_RAW of a bus. POSE of the bus does not serve: it follows the motion by the lidar, which is turned by the mounting that is in
/// question. So a navigator of the doctor's own reads NAV_RAW, and leaves the lidar out.
class MountingWatch {
 public:
  explicit MountingWatch(const navigator::Params& params);
  MountingWatch(const MountingWatch&) = delete;  // the members refer to each other
  MountingWatch& operator=(const MountingWatch&) = delete;

  void ListenTo(bus::Bus& bus);

  /// The recording of the first 300 s.
  const calibrate::Recording& recording() const { return recording_; }

 private:
  calibrate::Recording recording_;
  calibrate::Collector collector_;
  bus::MemoryBus own_bus_;
  navigator::Service navigator_;
};

/// Takes some 8 s of one core for each minute.
MountingSeen CompareMounting(const calibrate::Recording& recording, const calibrate::CalibrationParams& params);

/// The result of a calibration as an observation. Pure.
MountingSeen MountingOf(const calibrate::Calibration& calibration, const calibrate::PoseTrack& track);

}  // namespace lookout::doctor
