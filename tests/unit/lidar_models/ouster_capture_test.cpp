// Captures of real Ouster sensors with truth: every return by itself, the sums of the whole, the digest that the maker publishes.
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <openssl/evp.h>
#include <tuple>

#include "common/core/angles.hpp"
#include "lab/data/csv_file.hpp"
#include "lab/data/xz_file.hpp"
#include "services/lidar/core/models/ouster.hpp"
#include "tests/support/files.hpp"

namespace lookout::lidar::ouster_capture_test {
namespace {

using Json = nlohmann::json;
using Payload = std::vector<std::uint8_t>;

const std::filesystem::path kLidars = support::kRecordings / "lidars";
constexpr std::uint16_t kLidarPort = 7502;
constexpr std::uint16_t kImuPort = 7503;

std::uint16_t BigEndian16(Bytes bytes, std::size_t offset) { return static_cast<std::uint16_t>(bytes[offset] << 8 | bytes[offset + 1]); }

Payload UnpackXz(const std::filesystem::path& file) {
  data::XzFile xz(file, std::uint64_t{1} << 30);
  Payload bytes;
  Payload block(std::size_t{1} << 20);
  while (const auto count = xz.Read(block)) bytes.insert(bytes.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(count));
  return bytes;
}

// Joins the fragments of IPv4 datagrams that come in order.
class FragmentJoiner {
 public:
  /// @param ip  header and what follows. @return the payload of IP, where it is whole
  std::optional<Payload> Add(Bytes ip) {
    const std::size_t header_bytes = static_cast<std::size_t>(ip[0] & 0x0F) * 4;
    const std::size_t total_bytes = std::min<std::size_t>(BigEndian16(ip, 2), ip.size());
    const int flags = BigEndian16(ip, 6);
    const bool has_more = (flags & 0x2000) != 0;
    const auto offset = static_cast<std::size_t>(flags & 0x1FFF) * 8;
    const Bytes body = ip.first(total_bytes).subspan(header_bytes);
    const auto key = std::tuple(ReadU32LittleEndian(ip, 12), ReadU32LittleEndian(ip, 16), BigEndian16(ip, 4));
    auto& parts = parts_[key];
    if (offset == 0) parts.clear();
    if (parts.size() != offset) return std::nullopt;
    parts.insert(parts.end(), body.begin(), body.end());
    if (has_more) return std::nullopt;
    auto whole = std::move(parts);
    parts_.erase(key);
    return whole;
  }

 private:
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint16_t>, Payload> parts_;
};

// UDP payloads of a little-endian capture of Ethernet, by destination.
std::vector<Payload> PayloadsTo(const Payload& capture, std::uint16_t port) {
  constexpr std::size_t kFileHeaderBytes = 24;
  constexpr std::size_t kRecordHeaderBytes = 16;
  constexpr std::size_t kEthernetBytes = 14;
  constexpr std::size_t kUdpBytes = 8;
  std::vector<Payload> payloads;
  FragmentJoiner joiner;
  const Bytes bytes(capture);
  for (std::size_t at = kFileHeaderBytes; at + kRecordHeaderBytes <= bytes.size();) {
    const std::size_t size = ReadU32LittleEndian(bytes, at + 8);
    const Bytes frame = bytes.subspan(at + kRecordHeaderBytes, size);
    at += kRecordHeaderBytes + size;
    if (BigEndian16(frame, 12) != 0x0800) continue;
    const auto udp = joiner.Add(frame.subspan(kEthernetBytes));
    if (udp && BigEndian16(*udp, 2) == port) payloads.emplace_back(udp->begin() + kUdpBytes, udp->end());
  }
  return payloads;
}

TEST(FragmentJoiner, JoinsADatagramOfThreeFragments) {
  const auto fragment = [](std::uint16_t flags, Payload body) {
    Payload ip{
        0x45, 0, 0, static_cast<std::uint8_t>(20 + body.size()), 0, 7, static_cast<std::uint8_t>(flags >> 8), static_cast<std::uint8_t>(flags)};
    ip.resize(20);
    ip.insert(ip.end(), body.begin(), body.end());
    return ip;
  };
  FragmentJoiner joiner;
  EXPECT_FALSE(joiner.Add(fragment(0x2000, Payload(8, 1))));
  EXPECT_FALSE(joiner.Add(fragment(0x2001, Payload(8, 2))));
  const auto whole = joiner.Add(fragment(2, Payload(3, 3)));
  ASSERT_TRUE(whole);
  EXPECT_EQ(*whole, (Payload{1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 3, 3, 3}));
  EXPECT_FALSE(joiner.Add(fragment(0x2000, Payload(8, 1))));
  EXPECT_FALSE(joiner.Add(fragment(2, Payload(3, 3)))) << "the second is lost";
}

std::string Md5(const void* bytes, std::size_t size) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int digest_bytes = 0;
  if (EVP_Digest(bytes, size, digest.data(), &digest_bytes, EVP_md5(), nullptr) != 1) throw std::runtime_error("no MD5");
  std::string text;
  for (unsigned int i = 0; i < digest_bytes; ++i) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    text += kDigits[digest[i] >> 4];
    text += kDigits[digest[i] & 15];
  }
  return text;
}

template <typename T>
std::string Md5(const std::vector<T>& values) {
  return Md5(values.data(), values.size() * sizeof(T));
}

struct Recording {
  std::string name;
  Json truth;
  std::vector<Payload> packets;
  std::vector<Payload> imu;
  std::unique_ptr<OusterReader> reader;
  OusterMetadata metadata;
};

// A return as truth and reader both have it.
struct Found {
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
  double range_m = 0.0;
  int reflectivity = 0;
  double time_us = 0.0;
  Eigen::Vector3d p_lidar_m = Eigen::Vector3d::Zero();
};

class OusterCapture : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    recording_.name = GetParam();
    const auto capture = kLidars / (recording_.name + ".pcap.xz");
    if (!std::filesystem::exists(capture)) GTEST_SKIP() << "no recording " << capture;
    recording_.truth = Json::parse(support::ReadFile(kLidars / "truth" / (recording_.name + ".json")));
    recording_.metadata = ParseOusterMetadata(support::ReadFile(kLidars / recording_.truth["meta"].get<std::string>()));
    const auto bytes = UnpackXz(capture);
    recording_.packets = PayloadsTo(bytes, kLidarPort);
    recording_.imu = PayloadsTo(bytes, kImuPort);
    recording_.reader = std::make_unique<OusterReader>(recording_.metadata);
  }

  // Every return of a packet by (column, channel, return).
  std::map<std::tuple<int, int, int>, Found> Returns(const Packet& packet) const {
    std::map<std::tuple<int, int, int>, Found> returns;
    const auto& head = recording_.reader->head();
    std::size_t cell = 0;
    for (std::size_t column = 0; column < packet.columns.size(); ++column) {
      for (const auto& beam : head.beams) {
        for (std::size_t i = 0; i < head.returns.size(); ++i, ++cell) {
          if (packet.range[cell] == 0) continue;
          const double range_m = packet.range[cell] * head.range_unit_m;
          const double azimuth_rad = WrapTo2Pi(packet.columns[column].azimuth_rad + beam.azimuth_offset_rad);
          const double level_m = range_m * std::cos(beam.elevation_rad);
          returns[{static_cast<int>(column), beam.channel, static_cast<int>(i)}] = {
              .azimuth_deg = RadToDeg(azimuth_rad),
              .elevation_deg = RadToDeg(beam.elevation_rad),
              .range_m = range_m,
              .reflectivity = packet.reflectivity[cell],
              .time_us = static_cast<double>((packet.columns[column].time + beam.time_offset).count()) / 1000.0,
              .p_lidar_m = {level_m * std::cos(azimuth_rad), -level_m * std::sin(azimuth_rad),
                            range_m * std::sin(beam.elevation_rad) + beam.origin_height_m}};
        }
      }
    }
    return returns;
  }

  Recording recording_;
};

TEST_P(OusterCapture, GivesEveryReturnOfTheTruth) {
  data::CsvFile csv(
      kLidars / recording_.truth["truth"].get<std::string>(),
      {"packet", "block", "channel", "return_index", "azimuth_deg", "elevation_deg", "range_m", "reflectivity", "time_us", "x_m", "y_m", "z_m"});
  std::int64_t packet_index = -1;
  std::map<std::tuple<int, int, int>, Found> returns;
  std::int64_t num_compared = 0;
  double worst_azimuth_deg = 0.0;
  double worst_time_us = 0.0;
  double worst_level_m = 0.0;
  double worst_height_m = 0.0;
  Packet packet;
  while (csv.Next()) {
    const auto of_packet = csv.WholeNumber(0, 0, 1'000'000);
    while (packet_index < of_packet) {
      ASSERT_TRUE(returns.empty()) << returns.size() << " returns of packet " << packet_index << " that are not in the truth";
      ++packet_index;
      ASSERT_EQ(recording_.reader->Read(recording_.packets.at(static_cast<std::size_t>(packet_index)), packet), PacketFault::kNone)
          << recording_.reader->reason();
      returns = Returns(packet);
    }
    const auto whole = [&csv](std::size_t column) { return static_cast<int>(csv.WholeNumber(column, 0, 1'000'000)); };
    const auto found = returns.find({whole(1), whole(2), whole(3)});
    ASSERT_NE(found, returns.end()) << "packet " << packet_index << " column " << whole(1) << " channel " << whole(2);
    const auto& one = found->second;
    ASSERT_EQ(std::lround(one.range_m * 1000.0), std::lround(csv.Number(6) * 1000.0));
    ASSERT_EQ(one.reflectivity, whole(7));
    ASSERT_NEAR(one.elevation_deg, csv.Number(5), 0.001);
    const Eigen::Vector3d error_m = one.p_lidar_m - Eigen::Vector3d(csv.Number(9), csv.Number(10), csv.Number(11));
    worst_azimuth_deg = std::max(worst_azimuth_deg, std::abs(std::remainder(one.azimuth_deg - csv.Number(4), 360.0)));
    worst_time_us = std::max(worst_time_us, std::abs(one.time_us - csv.Number(8)));
    worst_level_m = std::max(worst_level_m, error_m.head<2>().norm());
    worst_height_m = std::max(worst_height_m, std::abs(error_m.z()));
    returns.erase(found);
    ++num_compared;
  }
  EXPECT_TRUE(returns.empty());
  EXPECT_EQ(num_compared, recording_.truth["truth_returns"].get<std::int64_t>());
  EXPECT_LT(worst_azimuth_deg, 0.01);
  EXPECT_LT(worst_time_us, 1.0);
  EXPECT_LT(worst_height_m, 0.0006) << "truth has whole millimetres";
  // What the beam's origin shifts in the level plane has no place on the wire.
  double level_error_m = 0.0;
  for (const auto& beam : recording_.reader->head().beams) {
    const double n_m = recording_.metadata.beam_origin_m;
    const double offset_rad = beam.azimuth_offset_rad;
    level_error_m = std::max(level_error_m, std::hypot(n_m * (std::cos(offset_rad) - std::cos(beam.elevation_rad)), n_m * std::sin(offset_rad)));
  }
  EXPECT_LT(worst_level_m, level_error_m + 0.001);
  RecordProperty("worst_azimuth_deg", std::to_string(worst_azimuth_deg));
  std::cout << recording_.name << ": azimuth " << worst_azimuth_deg << " deg, time " << worst_time_us << " us, height " << worst_height_m * 1000
            << " mm, level " << worst_level_m * 1000 << " mm (bound " << level_error_m * 1000 << ")\n";
}

TEST_P(OusterCapture, HasTheSumsOfTheWhole) {
  const auto& facts = recording_.truth["facts"];
  Packet packet;
  std::int64_t num_returns = 0;
  std::int64_t sum_range_mm = 0;
  std::int64_t sum_reflectivity = 0;
  std::map<int, std::int64_t> num_by_channel;
  std::vector<std::int32_t> rows;  // packet, column, channel, return, range, reflectivity
  ASSERT_EQ(recording_.packets.size(), facts["packets"].get<std::size_t>());
  std::optional<PacketNumber> last;
  std::chrono::nanoseconds expected{0};
  for (std::size_t i = 0; i < recording_.packets.size(); ++i) {
    ASSERT_EQ(recording_.reader->Read(recording_.packets[i], packet), PacketFault::kNone) << recording_.reader->reason();
    for (const auto& [place, one] : Returns(packet)) {
      const auto range_mm = std::lround(one.range_m * 1000.0);
      ++num_returns;
      sum_range_mm += range_mm;
      sum_reflectivity += one.reflectivity;
      ++num_by_channel[std::get<1>(place)];
      for (const std::int64_t value : {static_cast<std::int64_t>(i), std::int64_t{std::get<0>(place)}, std::int64_t{std::get<1>(place)},
                                       std::int64_t{std::get<2>(place)}, std::int64_t{range_mm}, std::int64_t{one.reflectivity}}) {
        rows.push_back(static_cast<std::int32_t>(value));
      }
    }
    ASSERT_TRUE(packet.number);
    if (last) {
      EXPECT_EQ(packet.number->number, (last->number + 1) % last->modulus);
      EXPECT_NEAR(static_cast<double>((packet.stamp - expected).count()), 0.0, 20'000.0) << "packet " << i;
    }
    last = packet.number;
    expected = packet.stamp + packet.duration;
  }
  EXPECT_EQ(num_returns, facts["returns"].get<std::int64_t>());
  EXPECT_EQ(sum_range_mm, facts["sum_range_mm"].get<std::int64_t>());
  EXPECT_EQ(sum_reflectivity, facts["sum_reflectivity"].get<std::int64_t>());
  for (std::size_t channel = 0; channel < facts["returns_of_channel"].size(); ++channel) {
    EXPECT_EQ(num_by_channel[static_cast<int>(channel)], facts["returns_of_channel"][channel].get<std::int64_t>()) << channel;
  }
  EXPECT_EQ(Md5(rows), facts["md5_packet_block_channel_return_range_reflectivity"].get<std::string>());
  EXPECT_FALSE(recording_.reader->has_other_init_id());
  EXPECT_FALSE(recording_.reader->has_other_window());
}

TEST_P(OusterCapture, HasAnImuAtRest) {
  ASSERT_FALSE(recording_.imu.empty());
  std::chrono::nanoseconds last{0};
  for (const auto& payload : recording_.imu) {
    const auto sample = ParseOusterImu(payload);
    ASSERT_TRUE(sample);
    EXPECT_GT(sample->stamp, last);
    last = sample->stamp;
    const auto& acceleration_g = sample->acceleration_g;
    EXPECT_NEAR(std::hypot(acceleration_g[0], acceleration_g[1], acceleration_g[2]), 1.07, 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Lidars, OusterCapture, testing::Values("ouster_os0_32_dual", "ouster_os1_64_fw20_legacy", "ouster_os1_128_low_bandwidth"),
                         [](const auto& test) { return std::string(test.param); });

// Digest of the maker's SDK for the capture that it calls OS-0-32-U1_v2.2.0_1024x10: MD5 of each field of the scan, [rings x columns] from the top
// down.
TEST(OusterDigest, IsThatOfTheMaker) {
  const auto capture = kLidars / "ouster_os0_32_dual.pcap.xz";
  if (!std::filesystem::exists(capture)) GTEST_SKIP() << "no recording " << capture;
  OusterReader reader(ParseOusterMetadata(support::ReadFile(kLidars / "meta/ouster_os0_32.json")));
  constexpr std::size_t kRings = 32;
  constexpr std::size_t kColumns = 1024;
  std::array<std::vector<std::uint32_t>, 2> range{std::vector<std::uint32_t>(kRings * kColumns), std::vector<std::uint32_t>(kRings * kColumns)};
  std::array<std::vector<std::uint8_t>, 2> reflectivity{std::vector<std::uint8_t>(kRings * kColumns), std::vector<std::uint8_t>(kRings * kColumns)};
  std::vector<std::uint64_t> stamp_ns(kColumns);
  std::vector<std::uint16_t> ids(kColumns);
  Packet packet;
  for (const auto& payload : PayloadsTo(UnpackXz(capture), kLidarPort)) {
    ASSERT_EQ(reader.Read(payload, packet), PacketFault::kNone) << reader.reason();
    std::size_t cell = 0;
    for (const auto& column : packet.columns) {
      const auto id = static_cast<std::size_t>(std::lround(column.azimuth_rad / kTwoPi * kColumns));
      stamp_ns.at(id) = static_cast<std::uint64_t>((packet.stamp + column.time).count());
      ids.at(id) = static_cast<std::uint16_t>(id);
      for (const auto& beam : reader.head().beams) {
        for (std::size_t i = 0; i < 2; ++i, ++cell) {
          const auto place = static_cast<std::size_t>(beam.channel) * kColumns + id;
          range[i][place] = packet.range[cell];
          // The maker's field has a reflectivity also where there is no return: from the packet itself.
          const std::size_t in_packet = 32 + (id % 16) * (12 + kRings * 16) + 12 + static_cast<std::size_t>(beam.channel) * 16 + 3 + 4 * i;
          EXPECT_TRUE(packet.range[cell] != 0 || packet.reflectivity[cell] == 0);
          reflectivity[i][place] = packet.range[cell] != 0 ? packet.reflectivity[cell] : payload.at(in_packet);
        }
      }
    }
  }
  EXPECT_EQ(Md5(range[0]), "b7e7a2a5aa86516f86fd2e8f56b8f6b0");
  EXPECT_EQ(Md5(range[1]), "67b3d847d10084cef0e33a958591cdb5");
  EXPECT_EQ(Md5(reflectivity[0]), "e0873ecae1da2f575c3918c9b4dc0130");
  EXPECT_EQ(Md5(reflectivity[1]), "3c6ec9fcc23d08e37367115bd67200f6");
  EXPECT_EQ(Md5(stamp_ns), "060e7ccbcf80ef9632dec5688e47a6d1");
  EXPECT_EQ(Md5(ids), "ab4e111268cce8326714d9308aafd5fe");
}

}  // namespace
}  // namespace lookout::lidar::ouster_capture_test
