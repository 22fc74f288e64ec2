// The GNSS receiver, the compass, the attitude sensor, the IMU and the lidar's position packets of the simulated boat.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "common/config/boat.hpp"
#include "lab/sim/datagram.hpp"
#include "lab/sim/fault_plan.hpp"
#include "lab/sim/imu.hpp"
#include "lab/sim/lidar_clock.hpp"
#include "lab/sim/nmea.hpp"
#include "lab/sim/random.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

/// The defaults are a receiver with RTK and a compass of two antennas; StandaloneNavigation has another set.
struct NavigationParams {
  int gnss_rate_hz = 5;               // of RMC, GGA, VTG and GST: a divisor of 20
  bool has_heading = true;            // else a receiver alone: no HDT, ROT, PASHR, VNIMU
  double gnss_sd_m = 0.02;            // per axis
  double gnss_time_constant_s = 0.0;  // as in MeasurementError
  double velocity_sd_mps = 0.02;      // per axis
  double heading_sd_deg = 0.2;
  double heading_time_constant_s = 0.0;
  double tilt_sd_deg = 0.1;  // roll and pitch, each
  ImuErrors imu;
  // As in navigator.txtpb: how compass and attitude sensor are turned in the boat.
  double heading_offset_deg = 0.0;
  double pitch_offset_deg = 0.0;
  double roll_offset_deg = 0.0;
  int nmea_port = 10110;
  int position_port = 8308;
};

/// A receiver without corrections and a magnetic compass.
NavigationParams StandaloneNavigation();

class Navigation {
 public:
  /// @param start  the scene's time 0
  /// @param plan   outlives this
  Navigation(const Scene& scene, const config::BoatFacts& boat, const NavigationParams& params, const FaultPlan& plan, Utime start,
             std::uint64_t seed);

  /// When the next measurements are made.
  Utime next_time() const;

  /// @return datagrams of the measurements at next_time(), each with its latency; by time
  std::vector<Datagram> Next();

 private:
  struct Heading {
    double heading_deg = 0.0;
    double rate_degpmin = 0.0;  // positive to starboard
  };

  OwnState StateAfter(Utime time, double offset_s) const;
  GnssMeasurement MeasureGnss(Utime time, std::chrono::microseconds since_last);
  Heading MeasureHeading(Utime time);
  AttitudeMeasurement MeasureAttitude(Utime time);
  void AddGnss(std::vector<Datagram>& datagrams);
  void AddImu(std::vector<Datagram>& datagrams);
  std::optional<Datagram> PositionPacket();
  std::string LidarSentence(Utime time) const;
  Datagram Line(std::chrono::microseconds latency, const std::string& sentence);

  OwnMotion own_motion_;
  config::BoatFacts boat_;
  NavigationParams params_;
  const FaultPlan& plan_;
  LidarClock clock_;
  GeographicLib::LocalCartesian map_;
  Utime start_;
  Random gnss_random_;
  Random attitude_random_;
  Random latency_random_;
  std::array<MeasurementError, 3> gnss_error_m_;  // east, north, up
  MeasurementError heading_error_deg_;
  Imu imu_;
  Utime next_epoch_;
  Utime next_position_packet_;
  std::deque<GnssMeasurement> whole_seconds_;  // whose RMC the lidar gets
  std::optional<Heading> frozen_heading_;
};

}  // namespace lookout::sim
