// A VLP-16 that looks at a scene: data packets as the sensor makes them, with the truth about each return.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/angles.hpp"
#include "common/core/utime.hpp"
#include "services/vlp16/core/packet_format.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/ray_caster.hpp"
#include "tools/sim/scene.hpp"

namespace lookout::sim {

enum class ReturnMode { kStrongest, kLast, kDual };
enum class LidarModel { kVlp16, kPuckHiRes };

/// A block of the fastest head sweeps 0.8 deg and is not torn: it needs a place in the field of view.
inline constexpr double kMinFieldOfViewRad = DegToRad(2.0);

struct LidarParams {
  ReturnMode mode = ReturnMode::kStrongest;
  LidarModel model = LidarModel::kVlp16;
  Sector field_of_view;  // azimuths of the sensor in which its lasers fire; kMinFieldOfViewRad wide at least
  double rotation_rpm = 600.0;
  bool use_vertical_origin_offsets = false;  // as in vlp16.txtpb
  double stray_probability = 1e-4;           // of a return out of nothing, per shot that meets nothing: 2 to 3 a turn over open water
  // VLP-16 User Manual 63-9243 Rev E: accuracy +/- 3 cm.
  double range_sd_m = 0.025;
};

/// What made a return that is not zero.
struct TrueReturn {
  Utime time;            // its laser's firing as the packet says it, nearest microsecond
  int ring = 0;          // from the lowest beam up
  int return_index = 0;  // place in its pair of blocks: dual 0 last, 1 strongest; else 0
  int object_id = kNoObject;
};

struct LidarPacket {
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
  double AzimuthAt(double time_s) const;

 private:
  struct Measurement {
    std::uint16_t range_2mm = 0;  // 0 = no return
    std::uint8_t reflectivity = 0;
    int object_id = kNoObject;
  };
  struct Shot {
    Measurement strongest;
    Measurement last;
  };
  // By laser id.
  struct Beams {
    std::array<double, vlp16::format::kNumLasers> elevation_deg;
    std::array<double, vlp16::format::kNumLasers> origin_height_mm;
    std::uint8_t product;
  };
  static const Beams& BeamsOf(LidarModel model);

  Shot Fire(std::size_t laser, double azimuth_rad, const Eigen::Isometry3d& T_map_vessel);
  bool FiresFrom(std::int64_t sequence) const;
  Measurement Measure(const Echo& echo);
  Measurement Stray(double max_range_m);

  LidarParams params_;
  const Beams& beams_;
  OwnMotion own_motion_;
  double reference_point_above_water_m_;
  Eigen::Isometry3d T_vessel_lidar_;
  std::vector<Part> own_hull_;
  RayCaster own_caster_;  // vessel frame
  RayCaster caster_;      // map frame
  Random random_;
  std::vector<Wave> rotor_rad_;
  double rotor_phase_rad_ = 0.0;
  double rotor_rate_radps_ = 0.0;
  Utime start_;
  std::int64_t next_sequence_ = 0;  // to be fired, in sequence periods since the start
};

}  // namespace lookout::sim
