// The receiver, the attitude sensor and the lidar's position packets of the simulated boat.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <string>
#include <vector>

#include "common/config/boat.hpp"
#include "tools/sim/datagram.hpp"
#include "tools/sim/nmea.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/scene.hpp"

namespace lookout::sim {

struct NavigationParams {
  int gnss_rate_hz = 10;    // of RMC, GGA and VTG: a divisor of 20
  bool has_heading = true;  // else a receiver alone: no HDT, no PASHR
  double gnss_sd_m = 0.02;  // per axis; a receiver with RTK
  // As in navigator.txtpb: how the attitude sensor is turned in the boat.
  double heading_offset_deg = 0.0;
  double pitch_offset_deg = 0.0;
  double roll_offset_deg = 0.0;
  int nmea_port = 10110;
  int position_port = 8308;
};

/// Origin of the map where boat.txtpb holds no datum: a lake in New Hampshire; west of Greenwich, so that a wrong sign shows.
inline constexpr config::BoatDatum kLakeDatum{43.6300, -72.1500, 201.0};

/// @return the map frame of the simulation; up is 0 on the calm water
GeographicLib::LocalCartesian MapFrame(const config::BoatFacts& boat);

class Navigation {
 public:
  /// @param start  the scene's time 0
  Navigation(const Scene& scene, const config::BoatFacts& boat, const NavigationParams& params, Utime start, std::uint64_t seed);

  /// When the next measurements are made.
  Utime next_time() const;

  /// @return datagrams of the measurements at next_time(), each with its latency; by time
  std::vector<Datagram> Next();

 private:
  GnssMeasurement MeasureGnss(Utime time);
  AttitudeMeasurement MeasureAttitude(Utime time);
  void AddGnss(std::vector<Datagram>& datagrams);
  void AddAttitude(std::vector<Datagram>& datagrams);
  Datagram PositionPacket();
  Datagram Line(Utime measured, std::chrono::microseconds latency, const std::string& sentence);
  double SceneTimeS(Utime time) const;

  OwnMotion own_motion_;
  config::BoatFacts boat_;
  NavigationParams params_;
  GeographicLib::LocalCartesian map_;
  Utime start_;
  Random random_;
  Utime next_epoch_;
  Utime next_position_packet_;
  Utime next_rmc_;  // when the lidar has the next RMC
  std::string lidar_rmc_;
};

}  // namespace lookout::sim
