#include "tools/import/ros_message.hpp"

#include <algorithm>
#include <bit>

namespace lookout::importer {

namespace {

constexpr std::int64_t kRosNsPerS = 1'000'000'000;
constexpr std::size_t kVelodynePacketBytes = 1206;
constexpr std::size_t kPandarPacketBytes = 1500;  // room of each packet, whatever its size is
constexpr std::uint32_t kMaxRosFields = 256;
constexpr std::uint32_t kMaxRosPackets = 20'000;  // packets of a scan: a Pandar64 has 12 000 in a second

// Reads values one after the other. ROS 1: little-endian, packed. CDR (XCDR1): of either order, each number at a multiple of its size from behind the
// 4 bytes of encapsulation on, texts with their zero. Behind the first that is not there everything is 0, and Finish says so.
class RosReader {
 public:
  RosReader(Encoding encoding, Bytes bytes) : bytes_(bytes), is_cdr_(encoding == Encoding::kCdr) {
    is_good_ = is_cdr_ || encoding == Encoding::kRos1;
    if (!is_cdr_) return;
    is_good_ = bytes.size() >= kEncapsulationBytes && bytes[0] == 0 && bytes[1] <= 1;
    if (!is_good_) return;
    is_big_endian_ = bytes[1] == 0;
    bytes_ = bytes.subspan(kEncapsulationBytes);
  }

  bool is_good() const { return is_good_; }
  void Fail() { is_good_ = false; }

  std::uint8_t U8() { return static_cast<std::uint8_t>(Number<1>()); }
  std::uint16_t U16() { return static_cast<std::uint16_t>(Number<2>()); }
  std::uint32_t U32() { return static_cast<std::uint32_t>(Number<4>()); }
  std::uint64_t U64() { return Number<8>(); }
  double F64() { return std::bit_cast<double>(Number<8>()); }

  template <std::size_t kCount>
  std::array<double, kCount> F64s() {
    std::array<double, kCount> values{};
    for (auto& value : values) value = F64();
    return values;
  }

  Bytes Take(std::uint64_t count) {
    is_good_ = is_good_ && count <= bytes_.size() - place_;
    if (!is_good_) return {};
    const auto taken = bytes_.subspan(place_, static_cast<std::size_t>(count));
    place_ += taken.size();
    return taken;
  }

  std::string_view Text() {
    auto bytes = Take(U32());
    if (is_cdr_ && !bytes.empty()) {
      is_good_ = is_good_ && bytes.back() == 0;
      bytes = bytes.first(bytes.size() - 1);
    }
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  std::string Name() {
    const auto text = Text();
    if (text.size() > kMaxNameBytes) Fail();
    return is_good_ ? std::string(text) : std::string();
  }

  std::int64_t Stamp() {
    const auto seconds = U32();
    // In ROS 2 seconds have a sign; before 1970 nothing was recorded.
    return static_cast<std::int64_t>(is_cdr_ && seconds > INT32_MAX ? 0 : seconds) * kRosNsPerS + U32();
  }

  RosHeader Header() {
    if (!is_cdr_) U32();  // seq
    RosHeader header;
    header.stamp_ns = Stamp();
    header.frame = Name();
    return header;
  }

  // All was there, and nothing is left but what CDR may fill up with.
  bool IsWhole() const { return is_good_ && bytes_.size() - place_ < (is_cdr_ ? 8U : 1U); }

 private:
  static constexpr std::size_t kEncapsulationBytes = 4;

  template <std::size_t kSize>
  std::uint64_t Number() {
    if (is_cdr_ && place_ % kSize != 0) Take(kSize - place_ % kSize);
    const auto taken = Take(kSize);
    if (!is_good_) return 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < kSize; ++i) value = value << 8 | taken[is_big_endian_ ? i : kSize - 1 - i];
    return value;
  }

  Bytes bytes_;
  bool is_cdr_ = false;
  bool is_big_endian_ = false;
  bool is_good_ = true;
  std::size_t place_ = 0;
};

bool DoSizesAgree(const RosPointCloud& cloud) {
  // Height and width are bounded also in a cloud without points, as its rows are gone through.
  const auto num_points = std::max(std::uint64_t{cloud.height}, std::uint64_t{1}) * std::max(cloud.width, 1U);
  return num_points <= kMaxRosPoints && cloud.row_step >= std::uint64_t{cloud.width} * cloud.point_step &&
         cloud.data.size() >= std::uint64_t{cloud.row_step} * cloud.height;
}

}  // namespace

std::optional<std::vector<RosPacket>> ParsePackets(Encoding encoding, std::string_view type, Bytes bytes) {
  RosReader reader(encoding, bytes);
  std::vector<RosPacket> packets;
  const bool is_one = std::ranges::find(kTypesOusterPacket, type) != kTypesOusterPacket.end();
  if (!is_one) reader.Header();
  const auto num_packets = is_one ? 1 : reader.U32();
  if (num_packets > kMaxRosPackets) reader.Fail();
  for (std::uint32_t i = 0; i < num_packets && reader.is_good(); ++i) {
    auto& packet = packets.emplace_back();
    if (!is_one) packet.stamp_ns = reader.Stamp();
    if (type == kTypeVelodyneScan) {
      packet.payload = reader.Take(kVelodynePacketBytes);
    } else if (type == kTypePandarScan) {
      const auto room = reader.Take(kPandarPacketBytes);
      const auto size = reader.U32();
      if (size > room.size()) reader.Fail();
      if (reader.is_good()) packet.payload = room.first(size);
    } else {
      packet.payload = reader.Take(reader.U32());
    }
  }
  return reader.IsWhole() ? std::optional(std::move(packets)) : std::nullopt;
}

std::optional<RosPointCloud> ParsePointCloud(Encoding encoding, Bytes bytes) {
  RosReader reader(encoding, bytes);
  RosPointCloud cloud;
  cloud.header = reader.Header();
  cloud.height = reader.U32();
  cloud.width = reader.U32();
  const auto num_fields = reader.U32();
  if (num_fields > kMaxRosFields) reader.Fail();
  for (std::uint32_t i = 0; i < num_fields && reader.is_good(); ++i) {
    auto& field = cloud.fields.emplace_back();
    field.name = reader.Name();
    field.offset = reader.U32();
    field.type = reader.U8();
    field.count = reader.U32();
  }
  cloud.is_big_endian = reader.U8() != 0;
  cloud.point_step = reader.U32();
  cloud.row_step = reader.U32();
  cloud.data = reader.Take(reader.U32());
  reader.U8();  // is_dense: places that are not finite are looked for all the same
  return reader.IsWhole() && DoSizesAgree(cloud) ? std::optional(std::move(cloud)) : std::nullopt;
}

std::optional<RosPointCloud> ParseLivoxPoints(Encoding encoding, Bytes bytes) {
  using Field = RosPointField;
  RosReader reader(encoding, bytes);
  RosPointCloud cloud;
  cloud.header = reader.Header();
  reader.U64();    // timebase: the stamp is the same, or by the host's clock
  reader.U32();    // number of points, once more
  reader.Take(4);  // number of the lidar, reserved
  const auto num_points = reader.U32();
  if (num_points > kMaxRosPoints) reader.Fail();
  cloud.fields = {{"offset_time", 0, Field::kUint32, 1}, {"x", 4, Field::kFloat32, 1},           {"y", 8, Field::kFloat32, 1},
                  {"z", 12, Field::kFloat32, 1},         {"reflectivity", 16, Field::kUint8, 1}, {"line", 17, Field::kUint8, 1}};
  cloud.height = 1;
  cloud.width = num_points;
  cloud.point_step = 18;
  cloud.row_step = num_points * cloud.point_step;
  for (std::uint32_t i = 0; i < num_points && reader.is_good(); ++i) {
    for (int k = 0; k < 4; ++k) {
      const auto number = reader.U32();
      for (unsigned shift = 0; shift < 32; shift += 8) cloud.made.push_back(static_cast<std::uint8_t>(number >> shift));
    }
    cloud.made.push_back(reader.U8());
    reader.U8();  // tag
    cloud.made.push_back(reader.U8());
  }
  cloud.data = cloud.made;
  return reader.IsWhole() ? std::optional(std::move(cloud)) : std::nullopt;
}

std::optional<RosImu> ParseImu(Encoding encoding, Bytes bytes) {
  RosReader reader(encoding, bytes);
  RosImu imu;
  imu.header = reader.Header();
  reader.F64s<4 + 9>();
  imu.angular_velocity_radps = reader.F64s<3>();
  reader.F64s<9>();
  imu.linear_acceleration_mps2 = reader.F64s<3>();
  reader.F64s<9>();
  return reader.IsWhole() ? std::optional(std::move(imu)) : std::nullopt;
}

std::optional<RosNavSatFix> ParseNavSatFix(Encoding encoding, Bytes bytes) {
  RosReader reader(encoding, bytes);
  RosNavSatFix fix;
  fix.header = reader.Header();
  const int status = reader.U8();
  fix.status = status < 0x80 ? status : status - 0x100;
  reader.U16();  // service
  fix.latitude_deg = reader.F64();
  fix.longitude_deg = reader.F64();
  fix.ellipsoid_height_m = reader.F64();
  const auto covariance_m2 = reader.F64s<9>();
  fix.variance_m2 = {covariance_m2[0], covariance_m2[4], covariance_m2[8]};
  fix.has_variance = reader.U8() != 0;
  return reader.IsWhole() ? std::optional(std::move(fix)) : std::nullopt;
}

std::optional<RosTwist> ParseTwist(Encoding encoding, Bytes bytes, bool has_covariance) {
  RosReader reader(encoding, bytes);
  RosTwist twist;
  twist.header = reader.Header();
  twist.linear_mps = reader.F64s<3>();
  reader.F64s<3>();
  if (has_covariance) reader.F64s<36>();
  return reader.IsWhole() ? std::optional(std::move(twist)) : std::nullopt;
}

std::optional<RosSentence> ParseSentenceMessage(Encoding encoding, Bytes bytes, bool has_header) {
  RosReader reader(encoding, bytes);
  RosSentence sentence;
  if (has_header) sentence.header = reader.Header();
  sentence.text = reader.Text();
  return reader.IsWhole() ? std::optional(std::move(sentence)) : std::nullopt;
}

}  // namespace lookout::importer
