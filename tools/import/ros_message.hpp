// The messages of ROS that are used, out of the bytes of ROS 1 or of CDR.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "tools/import/recording.hpp"

namespace lookout::importer {

/// Where a message is, and whose: of type std_msgs/Header.
struct RosHeader {
  std::int64_t stamp_ns = 0;  // 0: none
  std::string frame;
};

struct RosPacket {
  std::int64_t stamp_ns = 0;  // 0: none
  Bytes payload;
};

/// sensor_msgs/Imu, without orientation and covariances.
struct RosImu {
  RosHeader header;
  std::array<double, 3> angular_velocity_radps{};
  std::array<double, 3> linear_acceleration_mps2{};
};

/// sensor_msgs/NavSatFix.
struct RosNavSatFix {
  static constexpr int kNoFix = -1, kFix = 0, kSbasFix = 1, kGbasFix = 2;
  RosHeader header;
  int status = kNoFix;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double ellipsoid_height_m = 0.0;
  std::array<double, 3> variance_m2{};  // east, north, up
  bool has_variance = false;
};

/// geometry_msgs/TwistStamped, or TwistWithCovarianceStamped.
struct RosTwist {
  RosHeader header;
  std::array<double, 3> linear_mps{};
};

/// nmea_msgs/Sentence; std_msgs/String, which has no header.
struct RosSentence {
  RosHeader header;
  std::string_view text;
};

/// sensor_msgs/PointField.
struct RosPointField {
  static constexpr std::uint8_t kInt8 = 1, kUint8 = 2, kInt16 = 3, kUint16 = 4, kInt32 = 5, kUint32 = 6, kFloat32 = 7, kFloat64 = 8;
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t type = 0;
  std::uint32_t count = 0;
};

/// sensor_msgs/PointCloud2. All sizes agree: `height` rows of `row_step` bytes, in each `width` points of `point_step` bytes.
struct RosPointCloud {
  RosHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<RosPointField> fields;
  bool is_big_endian = false;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  Bytes data;
  std::vector<std::uint8_t> made = {};  // bytes that `data` views where the message holds the points in another form
};

/// A cloud has at most as many points as a scan of LIDAR_SCAN has cells.
inline constexpr std::uint64_t kMaxRosPoints = std::uint64_t{1} << 21;

/// Types that the Parse... functions know; they must not be called for other types. Packets of a lidar as they came.
inline constexpr std::string_view kTypeVelodyneScan = "velodyne_msgs/VelodyneScan";
inline constexpr std::string_view kTypePandarScan = "pandar_msgs/PandarScan";
inline constexpr std::string_view kTypeNebulaPackets = "nebula_msgs/NebulaPackets";
/// One packet, without a stamp; of the lidar or of its IMU.
inline constexpr std::array<std::string_view, 3> kTypesOusterPacket{"ouster_sensor_msgs/PacketMsg", "ouster_ros/PacketMsg", "ouster_msgs/PacketMsg"};
inline constexpr std::string_view kTypePointCloud = "sensor_msgs/PointCloud2";
/// Points of a Livox with their lines and times.
inline constexpr std::array<std::string_view, 2> kTypesLivox{"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg"};
/// Messages made of files, as sensor_msgs/PointCloud2 (point_message.hpp).
inline constexpr std::string_view kTypePcd = "pcl/PCD";
inline constexpr std::string_view kTypeKittiPoints = "kitti/Points";
inline constexpr std::string_view kTypeOxts = "kitti/Oxts";
inline constexpr std::string_view kTypeImu = "sensor_msgs/Imu";
inline constexpr std::string_view kTypeNavSatFix = "sensor_msgs/NavSatFix";
inline constexpr std::string_view kTypeSentence = "nmea_msgs/Sentence";
inline constexpr std::string_view kTypeString = "std_msgs/String";
inline constexpr std::string_view kTypeTwist = "geometry_msgs/TwistStamped";
inline constexpr std::string_view kTypeTwistWithCovariance = "geometry_msgs/TwistWithCovarianceStamped";
inline constexpr std::string_view kTypeOdometry = "nav_msgs/Odometry";

/// @return nullopt when the bytes are too few, too many, of a CDR that is not known, or contradict themselves. Views are into `bytes`.
/// @param type  one of the types of packets
std::optional<std::vector<RosPacket>> ParsePackets(Encoding encoding, std::string_view type, Bytes bytes);
std::optional<RosPointCloud> ParsePointCloud(Encoding encoding, Bytes bytes);
/// A cloud that owns its points: it may be moved, but not copied.
std::optional<RosPointCloud> ParseLivoxPoints(Encoding encoding, Bytes bytes);
std::optional<RosImu> ParseImu(Encoding encoding, Bytes bytes);
std::optional<RosNavSatFix> ParseNavSatFix(Encoding encoding, Bytes bytes);
std::optional<RosTwist> ParseTwist(Encoding encoding, Bytes bytes, bool has_covariance);
std::optional<RosSentence> ParseSentenceMessage(Encoding encoding, Bytes bytes, bool has_header);

}  // namespace lookout::importer
