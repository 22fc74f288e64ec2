// The packets of the VLP-16 family: sizes, offsets, bytes with a meaning, timing, beams. Constants only: the decoder reads by them and the simulator
// writes by them. Source, where nothing else is said: Velodyne VLP-16 User Manual 63-9243 Rev E, chapter 9 "Sensor Data" (here: the manual).
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace lookout::vlp16::format {

using namespace std::chrono_literals;

// Data packet: 12 blocks of 100 bytes, then stamp, return mode, product. All numbers are little-endian.
inline constexpr int kDataPort = 2368;  // as delivered
inline constexpr std::size_t kDataPacketSizeBytes = 1206;
inline constexpr int kNumBlocks = 12;
inline constexpr std::size_t kBlockSizeBytes = 100;
inline constexpr std::size_t kBlockFlagOffset = 0;     // u16, kBlockFlag
inline constexpr std::size_t kBlockAzimuthOffset = 2;  // u16, 0.01 deg clockwise seen from above, 0 to 35999
inline constexpr std::size_t kBlockReturnsOffset = 4;  // 2 sequences x 16 lasers x kReturnSizeBytes, in order of laser id
inline constexpr std::size_t kReturnSizeBytes = 3;     // u16 range in kRangeUnitM (0 = no return), u8 reflectivity
inline constexpr std::size_t kStampOffset = 1200;      // u32, microseconds past the hour, of the first shot of the packet
inline constexpr std::size_t kReturnModeOffset = 1204;
inline constexpr std::size_t kProductOffset = 1205;

inline constexpr std::uint16_t kBlockFlag = 0xEEFF;   // the bytes 0xFF 0xEE as a little-endian number
inline constexpr int kAzimuthsPerRevolution = 36000;  // 0.01 deg
inline constexpr double kRangeUnitM = 0.002;
inline constexpr std::uint8_t kModeStrongest = 0x37;
inline constexpr std::uint8_t kModeLast = 0x38;
inline constexpr std::uint8_t kModeDual = 0x39;       // blocks in pairs of one azimuth: first the last returns, then the strongest
inline constexpr std::uint8_t kProductHdl32e = 0x21;  // some early VLP-16 say so too
inline constexpr std::uint8_t kProductVlp16 = 0x22;   // also Puck LITE
inline constexpr std::uint8_t kProductPuckHiRes = 0x24;

// Firing: 16 lasers one after the other, then recharge; a block holds two such sequences.
inline constexpr int kNumLasers = 16;
inline constexpr int kSequencesPerBlock = 2;
inline constexpr std::chrono::nanoseconds kLaserPeriod = 2304ns;
inline constexpr std::chrono::nanoseconds kRechargeTime = 18432ns;
inline constexpr std::chrono::nanoseconds kSequencePeriod = 55296ns;
inline constexpr std::chrono::nanoseconds kBlockPeriod = kSequencesPerBlock * kSequencePeriod;
inline constexpr int kSequencesPerPacketSingle = kNumBlocks * kSequencesPerBlock;
inline constexpr int kSequencesPerPacketDual = kSequencesPerPacketSingle / 2;
inline constexpr std::chrono::nanoseconds kPacketPeriodSingle = kSequencesPerPacketSingle * kSequencePeriod;
inline constexpr std::chrono::nanoseconds kPacketPeriodDual = kSequencesPerPacketDual * kSequencePeriod;
static_assert(kNumLasers * kLaserPeriod + kRechargeTime == kSequencePeriod);
static_assert(kPacketPeriodSingle == 1'327'104ns && kPacketPeriodDual == 663'552ns);
static_assert(kBlockReturnsOffset + std::size_t{kSequencesPerBlock} * kNumLasers * kReturnSizeBytes == kBlockSizeBytes);
static_assert(kNumBlocks * kBlockSizeBytes == kStampOffset);
// HDL-32E User Manual 63-9113: 32 lasers in 46.08 us, a sequence per block. In single return its packets come this far apart.
inline constexpr std::chrono::nanoseconds kHdl32ePacketPeriodSingle = kNumBlocks * 46080ns;

// The manual: 300 to 1200 rpm.
inline constexpr double kMinRpm = 300.0;
inline constexpr double kMaxRpm = 1200.0;

// Data and position packets are stamped in microseconds past the hour of UTC (of the sensor's own start where it has no PPS).
inline constexpr std::int64_t kMicrosecondsPerHour = 3'600'000'000;

// Position packet ("telemetry packet"); bytes that are not named are unused or of no meaning here. The bytes of temperatures and of the thermal state
// are zero in older firmware (the manual, 9.4; the same offsets are in lidar-utils and in velodyne_decoder).
inline constexpr int kPositionPort = 8308;  // as delivered
inline constexpr std::size_t kPositionPacketSizeBytes = 512;
inline constexpr std::size_t kTopBoardTemperatureOffset = 187;     // u8, degrees Celsius
inline constexpr std::size_t kBottomBoardTemperatureOffset = 188;  // u8, degrees Celsius
inline constexpr std::size_t kPositionStampOffset = 198;           // u32, microseconds past the hour
inline constexpr std::size_t kPpsOffset = 202;
inline constexpr std::size_t kThermalStateOffset = 203;         // kThermalShutdown while the lasers are off for their temperature
inline constexpr std::size_t kShutdownTemperatureOffset = 204;  // u8, degrees Celsius, of the last shutdown
inline constexpr std::size_t kPowerUpTemperatureOffset = 205;   // u8, degrees Celsius
inline constexpr std::uint8_t kThermalShutdown = 1;
inline constexpr std::size_t kSentenceOffset = 206;  // NMEA 0183, ended by CR LF NUL
inline constexpr std::uint8_t kPpsAbsent = 0;
inline constexpr std::uint8_t kPpsSynchronising = 1;
inline constexpr std::uint8_t kPpsLocked = 2;
inline constexpr std::uint8_t kPpsError = 3;

// Beams by laser id: table 9-1 of the manual (elevation above the x-y plane, and height at which the beam starts).
inline constexpr std::array<double, kNumLasers> kElevationDegVlp16{-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
inline constexpr std::array<double, kNumLasers> kElevationDegPuckHiRes{-10.00, 0.67, -8.67, 2.00, -7.33, 3.33, -6.00, 4.67,
                                                                       -4.67,  6.00, -3.33, 7.33, -2.00, 8.67, -0.67, 10.00};
inline constexpr std::array<double, kNumLasers> kOriginHeightMmVlp16{11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1,
                                                                     5.1,  -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2};
inline constexpr std::array<double, kNumLasers> kOriginHeightMmPuckHiRes{7.4, -0.9, 6.5, -1.8, 5.5, -2.7, 4.6, -3.7,
                                                                         3.7, -4.6, 2.7, -5.5, 1.8, -6.5, 0.9, -7.4};

}  // namespace lookout::vlp16::format
