// The metadata of an Ouster sensor: the layout of its packets and the directions of its beams. The packets do not hold these.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::lidar {

/// The content of a pixel; the maker's udp_profile_lidar.
enum class OusterProfile {
  kLegacy,
  kSingle,        // RNG19_RFL8_SIG16_NIR16
  kDual,          // RNG19_RFL8_SIG16_NIR16_DUAL
  kLowBandwidth,  // RNG15_RFL8_NIR8
  kFusaDual,      // FUSA_RNG15_RFL8_NIR8_DUAL
};

/// @return the maker's name of it
std::string_view NameOf(OusterProfile profile);

/// The start from which the stamps of columns count.
enum class OusterClock {
  kUnknown,             // not said
  kInternalOscillator,  // since power-on
  kSyncPulse,           // pulses since power-on, or UTC by NMEA
  kPtp,                 // the clock of the network: UTC or TAI
};

/// Which echoes of a shot are sent, and in which order: from firmware 3.1 on; before that, and where it is not said, the strongest.
enum class OusterReturnOrder { kStrongestToWeakest, kNearestToFarthest, kFarthestToNearest };

struct OusterMetadata {
  std::string product;                         // "OS-1-128"; empty where the metadata do not say it, as all texts here
  std::optional<std::uint64_t> serial_number;  // as packets carry it
  std::string firmware;                        // "v2.3.0"
  std::optional<std::uint32_t> init_id;        // anew at each initialisation of the sensor

  int columns_per_frame = 0;  // a frame is one turn
  int frames_per_s = 0;
  OusterProfile profile = OusterProfile::kLegacy;
  int pixels_per_column = 0;
  int columns_per_packet = 0;
  int first_column = 0;  // of the window in which the sensor fires; the window may go over the end of the frame
  int last_column = 0;   // inclusive
  OusterClock clock = OusterClock::kUnknown;
  OusterReturnOrder return_order = OusterReturnOrder::kStrongestToWeakest;

  // [pixels_per_column] by channel. NaN: it has no beam; an OS1 with 16 or 32 beams sends 64 channels by firmware 1.13 and before.
  std::vector<double> elevation_rad;
  std::vector<double> azimuth_offset_rad;  // [pixels_per_column] clockwise
  double beam_origin_m = 0.0;              // n: from the lidar's origin to where beams begin; ranges are from the origin
  double beam_origin_height_m = 0.0;       // height of the places where beams begin above the origin

  std::optional<Eigen::Isometry3d> T_sensor_lidar;
  std::optional<Eigen::Isometry3d> T_sensor_imu;
  std::optional<int> lidar_port;
  std::optional<int> imu_port;

  /// "Ouster OS1-128"; "Ouster with 64 rings" where the product is not said.
  std::string ModelName() const;
};

/// Reads the metadata of firmware 1.12 to 3.1: flat, or nested as GET /api/v1/sensor/metadata gives it. A field that firmware did not have yet gets
/// its value of then; all else that is missing, contradictory or out of bounds is refused.
///
/// @throws std::runtime_error "field: reason"; any text may come
OusterMetadata ParseOusterMetadata(std::string_view json);

}  // namespace lookout::lidar
