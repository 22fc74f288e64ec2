// A VLP-16 that looks at a scene: data packets as the sensor makes them, with the truth about each return.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/angles.hpp"
#include "common/core/utime.hpp"
#include "lab/sim/rotor.hpp"
#include "lab/sim/scene.hpp"
#include "lab/sim/shots.hpp"
#include "services/lidar/core/vlp16/model.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::sim {

/// A block of the fastest head sweeps 0.8 deg and is not torn: it needs a place in the field of view.
inline constexpr double kMinFieldOfViewRad = DegToRad(2.0);

/// Facts of the device. Its return mode and its noise are effects of the scene.
struct LidarParams {
  vlp16::Model model = vlp16::Model::kVlp16;
  Sector field_of_view;  // azimuths of the sensor in which its lasers fire; kMinFieldOfViewRad wide at least
  double rotation_rpm = 600.0;
  bool use_vertical_origin_offsets = false;  // as in lidar.txtpb
};

/// The origin of a return that is not zero.
struct TrueReturn {
  Utime time;            // firing of its laser by the packet's stamp, to the nearest microsecond
  int ring = 0;          // from the lowest beam up
  int return_index = 0;  // place in its pair of blocks: dual 0 last, 1 strongest; else 0
  int object_id = kNoObject;
  ReturnReason reason = ReturnReason::kObject;
  int slot = 0;  // place in its packet: block x 32 + sequence in the block x 16 + laser id
  /// Lidar frame, where the beam met what gave the return, without noise. At a mixed edge between the surfaces, along the axis of the beam.
  Eigen::Vector3d p_lidar_m = Eigen::Vector3d::Zero();
};

struct LidarPacket {
  Utime stamp;     // as in the payload: first shot, whole microseconds
  Utime end_time;  // last shot
  std::array<std::uint8_t, vlp16::format::kDataPacketSizeBytes> payload{};
  std::vector<TrueReturn> returns;
};

class Lidar {
 public:
  /// @param scene  outlives this
  /// @param start  of the first shot; the scene's time 0
  Lidar(const Scene& scene, const config::BoatFacts& boat, const LidarParams& params, Utime start, std::uint64_t seed);

  Lidar(const Lidar&) = delete;
  Lidar& operator=(const Lidar&) = delete;

  LidarPacket Next();

  /// Azimuth of the rotor, clockwise, not wrapped. It turns at the mean rate with slow variations about it, so errors do not add up.
  double AzimuthAt(double time_s) const { return rotor_.AzimuthAt(time_s); }

 private:
  bool FiresFrom(std::int64_t sequence) const;

  LidarParams params_;
  const Effects& effects_;
  const vlp16::Beams& beams_;
  Rotor rotor_;
  Shots shots_;
  Utime start_;
  std::int64_t next_sequence_ = 0;  // to be fired, in sequence periods since the start
};

}  // namespace lookout::sim
