// Frames of an autopilot: some by another library, others for any values.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "tests/support/mavlink_frames.hpp"

namespace lookout::navigator {

inline std::string FromHex(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) bytes += static_cast<char>(std::stoi(std::string(text.substr(i, 2)), nullptr, 16));
  return bytes;
}

/// Made by node-mavlink 2.3.0: system 1, component 1, MAVLink 2 but for those named 1. ATTITUDE: 123.456 s, roll 0.05, pitch 0.02, yaw -0.25 rad,
/// rates 0.01, -0.02, 0.125 rad/s. GLOBAL_POSITION_INT: 123.460 s, 54.1234567, -10.6543210, 12.345 m, 3 m/s north and 4 m/s west. GPS_RAW_INT:
/// differential, 14 satellites, HDOP 0.9, 43 m of geoid separation, accuracies 0.8 m, 1.5 m, 0.12 m/s, 2.5 deg with a heading of two antennas.
namespace golden {
inline const std::string kAttitude = FromHex("fd1c00000701011e000040e20100cdcc4c3d0ad7a33c000080be0ad7233c0ad7a3bc0000003ec2b4");
inline const std::string kAttitude1 = FromHex("fe1c0801011e40e20100cdcc4c3d0ad7a33c000080be0ad7233c0ad7a3bc0000003ed719");
inline const std::string kPosition = FromHex("fd1c000009010121000044e20100879542209647a6f939300000dc0500002c0170fe05000787f8c8");
inline const std::string kPosition1 = FromHex("fe1c0a01012144e20100879542209647a6f939300000dc0500002c0170fe05000787f653");
inline const std::string kGps =
    FromHex("fd3400000b0101180000d5cf820a8a55060080954220a047a6f90c3000005a008c00f501df77040e04d8000020030000dc0500007800000090d0030028874a9f");
/// Fix of three dimensions without extensions.
inline const std::string kPlainGps = FromHex("fd1e00000d0101180000d5cf820a8a55060080954220a047a6f90c3000005a008c00f501df7703093cdb");
inline const std::string kNoFix = FromHex("fd1d00000e01011800000500000000000000000000000000000000000000ffffffffffffffff01bcef");
/// All zeros but for 7 ms since it was switched on: one byte of payload.
inline const std::string kLevelAttitude = FromHex("fd0100000f01011e000007bb42");
inline const std::string kAttitudeOfSystem42 = FromHex("fd1c0000102a011e000040e20100cdcc4c3d0ad7a33c000080be0ad7233c0ad7a3bc0000003e5a43");
inline const std::string kAttitudeOfComponent196 = FromHex("fd1c00001101c41e000040e20100cdcc4c3d0ad7a33c000080be0ad7233c0ad7a3bc0000003e5ba2");
inline const std::string kSignedAttitude =
    FromHex("fd1c01001201011e000040e20100cdcc4c3d0ad7a33c000080be0ad7233c0ad7a3bc0000003ed0e401e0ba46d0ff2007d698f4d795");
}  // namespace golden

/// Little-endian.
template <typename Number>
std::string Field(Number number) {
  const auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  return {bytes.begin(), bytes.end()};
}

/// Of system 1, component 1. @param payload  zeros at its end are not sent in MAVLink 2
inline std::string MakeFrame(int id, char crc_extra, std::string payload, bool is_second = true) {
  if (is_second) payload.resize(std::max<std::size_t>(payload.find_last_not_of('\0') + 1, 1));
  std::string frame(1, static_cast<char>(payload.size()));
  if (is_second) frame += std::string(2, '\0');
  frame += std::string("\x05\x01\x01", 3) + static_cast<char>(id) + (is_second ? std::string(2, '\0') : std::string()) + payload;
  return (is_second ? '\xFD' : '\xFE') + frame + Field(support::MavlinkCrc(frame + crc_extra));
}

inline std::string AttitudeFrame(std::uint32_t boot_ms, float roll_rad, float pitch_rad, float yaw_rad, float turn_radps = 0.0F) {
  return MakeFrame(30, 39, Field(boot_ms) + Field(roll_rad) + Field(pitch_rad) + Field(yaw_rad) + Field(0.0F) + Field(0.0F) + Field(turn_radps));
}

inline std::string PositionFrame(std::uint32_t boot_ms, double latitude_deg, double longitude_deg, double north_mps = 0.0, double east_mps = 0.0,
                                 std::int32_t height_mm = 0) {
  const auto e7 = [](double angle_deg) { return static_cast<std::int32_t>(std::lround(angle_deg * 1e7)); };
  const auto cmps = [](double speed_mps) { return static_cast<std::int16_t>(std::lround(speed_mps * 100.0)); };
  return MakeFrame(33, 104,
                   Field(boot_ms) + Field(e7(latitude_deg)) + Field(e7(longitude_deg)) + Field(height_mm) + Field(std::int32_t{0}) +
                       Field(cmps(north_mps)) + Field(cmps(east_mps)) + Field(std::int16_t{0}) + Field(std::uint16_t{0xFFFF}));
}

/// Without extensions where the accuracy is 0. @param heading_cdeg  by two antennas; 0 = none
inline std::string GpsFrame(int fix_type, std::uint32_t horizontal_mm = 0, std::uint32_t heading_sd_e5deg = 0, std::uint16_t heading_cdeg = 0,
                            bool is_second = true) {
  std::string payload(20, '\0');
  payload += Field(std::uint16_t{100}) + Field(std::uint16_t{0xFFFF}) + Field(std::uint16_t{0xFFFF}) + Field(std::uint16_t{0xFFFF});
  payload += static_cast<char>(fix_type);
  payload += '\x0C';
  if (is_second) payload += std::string(4, '\0') + Field(horizontal_mm) + std::string(8, '\0') + Field(heading_sd_e5deg) + Field(heading_cdeg);
  return MakeFrame(24, 24, payload, is_second);
}

}  // namespace lookout::navigator
