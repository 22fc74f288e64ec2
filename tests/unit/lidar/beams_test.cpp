// Beams of a lidar on the bus: LIDAR_BEAMS are in the log, and a replay uses them.
#include <bit>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <span>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "lookout/lidar_beams_t.hpp"
#include "lookout/lidar_nmea_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/lidar/params.hpp"
#include "services/lidar/service.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/lidar_models/ouster_packet_maker.hpp"

namespace lookout::lidar {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kStartUs = 1'795'780'801'000'000;
constexpr int kRings = 16;

std::string MetadataOf(double highest_deg) {
  std::string elevations;
  std::string offsets;
  for (int i = 0; i < kRings; ++i) {
    elevations += (i > 0 ? "," : "") + std::to_string(highest_deg - i);
    offsets += i > 0 ? ",0" : "0";
  }
  return R"({"prod_line": "OS-1-16", "lidar_mode": "512x10", "beam_altitude_angles": [)" + elevations + R"(], "beam_azimuth_angles": [)" + offsets +
         R"(], "data_format": {"columns_per_frame": 512, "columns_per_packet": 16, "pixels_per_column": 16, "udp_profile_lidar": )" +
         R"("RNG19_RFL8_SIG16_NIR16", "column_window": [0, 511]}, )" +
         R"("lidar_to_sensor_transform": [-1,0,0,0, 0,-1,0,0, 0,0,1,36, 0,0,0,1], "imu_to_sensor_transform": [1,0,0,6, 0,1,0,-11, 0,0,1,7, 0,0,0,1]})";
}

class LidarBeams : public ::testing::Test {
 protected:
  Params Load(const std::string& lines) {
    std::ofstream(folder_ / "lidar.txtpb") << "source: UDP bind_address: \"127.0.0.1\" cut_azimuth_deg: 0 model: MODEL_OUSTER data_port: 7502 "
                                           << "position_port: 7503 " << lines << "\n";
    return LoadParams(folder_);
  }
  Params LoadFile(double highest_deg) {
    std::ofstream(folder_ / "metadata.json") << MetadataOf(highest_deg);
    return Load("beam_file: \"metadata.json\"");
  }
  // Scans number first to last, a tenth of a second each.
  static void Feed(Service& service, int first, int last) {
    auto metadata = ouster_maker::MakeMetadata(OusterProfile::kSingle, kRings, 16, 512);
    for (int frame = first; frame <= last; ++frame) {
      for (int id = 0; id < 512; id += 16) {
        ouster_maker::PacketText text;
        text.frame = static_cast<std::uint32_t>(frame);
        text.first_id = id;
        text.column_ns = 195'312;
        const auto time_us = kStartUs + 100'000LL * frame + 195LL * id;
        text.stamp_ns = static_cast<std::uint64_t>(time_us) * 1000;
        const Utime host_time{std::chrono::microseconds(time_us + 3200)};
        service.AdvanceTo(host_time);
        service.OnDatagram(host_time, 7502, MakePacket(metadata, text), {"192.168.1.201", 7502});
      }
    }
  }
  static Utime TimeOf(int frame) { return Utime(std::chrono::microseconds(kStartUs + 100'000LL * frame)); }

  // What a replay of these messages makes, without those of `left_out`.
  std::vector<std::vector<std::uint8_t>> ScansAgain(const support::KeepingBus& live, Params params, std::string_view left_out = {}) {
    params.input = Input::kLog;
    bus::MemoryBus bus;
    std::vector<std::vector<std::uint8_t>> scans;
    bus.SubscribeAll([&](std::string_view channel, Bytes bytes) {
      if (channel == bus::kLidarScan.name) scans.emplace_back(bytes.begin(), bytes.end());
    });
    Service service(bus, params);
    service.OnNotice([this](const std::string& line) { notices_.push_back(line); });
    for (const auto& [channel, bytes] : live.sent) {
      const auto* known = bus::FindChannel(channel);
      if (!known->is_raw || channel == left_out) continue;
      bus.Publish(*known, bytes);
      support::HandleAll(bus);
    }
    counters_ = service.Report().counters;
    reason_ = service.Report().reason;
    return scans;
  }
  static std::vector<std::vector<std::uint8_t>> Scans(const support::KeepingBus& live) {
    std::vector<std::vector<std::uint8_t>> scans;
    for (const auto& [channel, bytes] : live.sent) {
      if (channel == bus::kLidarScan.name) scans.push_back(bytes);
    }
    return scans;
  }
  std::int64_t CountOf(std::string_view name) const {
    for (const auto& counter : counters_) {
      if (counter.name == name) return counter.count;
    }
    return -1;
  }

  support::TempDir temporary_;
  fs::path folder_ = temporary_.path();
  std::vector<std::string> notices_;
  std::vector<Counter> counters_;
  std::string reason_;
};

TEST_F(LidarBeams, ComeBeforeTheFirstPacketsAndEveryTenSeconds) {
  support::KeepingBus live;
  Service service(live.bus, LoadFile(10.0));
  Feed(service, 1, 215);
  service.Finish(TimeOf(216));
  support::HandleAll(live.bus);
  ASSERT_FALSE(live.sent.empty());
  EXPECT_EQ(live.sent.front().first, "LIDAR_BEAMS");
  const auto beams = live.All<lidar_beams_t>(bus::kLidarBeams);
  ASSERT_EQ(beams.size(), 3U) << "at 0, 10 and 20 s";
  EXPECT_EQ(beams[0].text, MetadataOf(10.0));
  EXPECT_EQ(beams[0].origin, "metadata.json");
  EXPECT_EQ(beams[0].model, "MODEL_OUSTER");
  EXPECT_EQ(beams[0].packets, "LIDAR_PACKETS");
  EXPECT_EQ(beams[2].seq, 2);
}

TEST_F(LidarBeams, OfTheLogAreUsedWhereTheFileHasChanged) {
  support::KeepingBus live;
  {
    Service service(live.bus, LoadFile(10.0));
    Feed(service, 1, 5);
    service.Finish(TimeOf(6));
    support::HandleAll(live.bus);
  }
  const auto scans = Scans(live);
  ASSERT_GE(scans.size(), 4U);
  EXPECT_EQ(ScansAgain(live, LoadFile(10.0)), scans);
  EXPECT_EQ(CountOf("beams_of_log"), 0);
  notices_.clear();
  EXPECT_EQ(ScansAgain(live, LoadFile(11.0)), scans);
  EXPECT_EQ(CountOf("beams_of_log"), 1);
  ASSERT_FALSE(notices_.empty());
  EXPECT_EQ(notices_.front(), "the log's beams (of metadata.json) are not those of metadata.json: the log's are used");
  // Without them the file decides, as in logs of before.
  EXPECT_NE(ScansAgain(live, LoadFile(11.0), "LIDAR_BEAMS"), scans);
}

TEST_F(LidarBeams, OfTheSensorComeWhileTheServiceRunsAndAreReplayed) {
  support::KeepingBus live;
  Service service(live.bus, Load("sensor_address: \"192.168.1.201\""));
  EXPECT_TRUE(service.WantsBeams());
  Feed(service, 1, 2);
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(service.Report().reason.rfind("packets cannot be read yet: the metadata of this sensor (JSON)", 0), 0U) << service.Report().reason;
  EXPECT_NE(service.UseBeams(TimeOf(3), "{}", "the sensor at 192.168.1.201"), "");
  EXPECT_EQ(service.UseBeams(TimeOf(3), MetadataOf(10.0), "the sensor at 192.168.1.201"), "");
  EXPECT_FALSE(service.WantsBeams());
  Feed(service, 3, 6);
  // It was taken apart and has other beams.
  EXPECT_EQ(service.UseBeams(TimeOf(7), MetadataOf(12.0), "the sensor at 192.168.1.201"), "");
  EXPECT_EQ(service.UseBeams(TimeOf(7), MetadataOf(12.0), "the sensor at 192.168.1.201"), "");
  Feed(service, 7, 10);
  service.Finish(TimeOf(11));
  support::HandleAll(live.bus);
  EXPECT_EQ(live.All<lidar_beams_t>(bus::kLidarBeams).size(), 2U);
  const auto scans = Scans(live);
  ASSERT_GE(scans.size(), 6U);
  const auto first = bus::Decode<lidar_scan_t>(scans.front()).value();
  const auto last = bus::Decode<lidar_scan_t>(scans.back()).value();
  EXPECT_NEAR(last.elevation_rad.back() - first.elevation_rad.back(), 2.0 * 3.14159265 / 180.0, 1e-6);
  EXPECT_EQ(ScansAgain(live, Load("sensor_address: \"192.168.1.201\"")), scans);
  EXPECT_EQ(ScansAgain(live, LoadFile(3.0)), scans);
  EXPECT_TRUE(ScansAgain(live, Load("sensor_address: \"192.168.1.201\""), "LIDAR_BEAMS").empty());
  EXPECT_GT(CountOf("packets_before_beams"), 0);
}

TEST_F(LidarBeams, OfALogThatAreNoneAreRefused) {
  support::KeepingBus live;
  Service service(live.bus, LoadFile(10.0));
  Feed(service, 1, 5);
  service.Finish(TimeOf(6));
  support::HandleAll(live.bus);
  const auto scans = Scans(live);
  for (const auto& spoil :
       std::vector<std::function<void(lidar_beams_t&)>>{[](auto& beams) { beams.text = "{}"; }, [](auto& beams) { beams.text.assign(100'000, ' '); },
                                                        [](auto& beams) { beams.text.clear(); }, [](auto& beams) { beams.model = "MODEL_XT32"; }}) {
    support::KeepingBus spoilt;
    for (auto [channel, bytes] : live.sent) {
      if (channel == bus::kLidarBeams.name) {
        auto beams = bus::Decode<lidar_beams_t>(bytes).value();
        spoil(beams);
        bytes = bus::Encode(beams);
      }
      spoilt.sent.emplace_back(channel, bytes);
    }
    EXPECT_EQ(ScansAgain(spoilt, LoadFile(10.0)), scans) << "the file's are used";
    EXPECT_EQ(CountOf("beams_refused"), 1);
    EXPECT_NE(reason_, "");
  }
}

TEST_F(LidarBeams, OfOtherPacketsAreNotItsOwn) {
  auto params = LoadFile(10.0);
  params.number = 2;
  support::KeepingBus live;
  Service service(live.bus, params);
  Feed(service, 1, 3);
  service.Finish(TimeOf(4));
  support::HandleAll(live.bus);
  EXPECT_EQ(live.All<lidar_beams_t>(bus::kLidarBeams).at(0).packets, "LIDAR_PACKETS_2");
  EXPECT_FALSE(live.All<lidar_scan_t>(bus::kLidarScan2).empty());
  EXPECT_TRUE(live.All<lidar_scan_t>(bus::kLidarScan).empty());
  // The first lidar of the same log does not look at them.
  EXPECT_TRUE(ScansAgain(live, LoadFile(3.0)).empty());
  EXPECT_EQ(CountOf("beams_of_log"), 0);
}

// The lidar's x axis (its connector) looks to port, so that of the housing and of the IMU to starboard. The boat heels 30 deg to starboard and turns
// to port, seen from above, with 10 deg/s.
TEST_F(LidarBeams, TellWhereTheImuOfTheSensorLooks) {
  std::ofstream(folder_ / "boat.txtpb") << "name: \"boat\" lidar { x_m: 0 y_m: 0 z_m: 1 roll_deg: 0 pitch_deg: 0 yaw_deg: 90 }\n"
                                        << "gnss_antenna { x_m: 0 y_m: 0 z_m: 1 } reference_point_above_water_m: 0.4\n"
                                        << "own_vessel { min_x_m: -1 max_x_m: 1 min_y_m: -1 max_y_m: 1 min_z_m: -1 max_z_m: 2 }\n";
  std::vector<std::uint8_t> payload(48);
  const auto put = [&payload](std::size_t at, float value) {
    WriteU32LittleEndian(std::span(payload).subspan(at), 0, std::bit_cast<std::uint32_t>(value));
  };
  // Up has a part to port then, against the IMU's x axis.
  put(24, -0.5F);
  put(32, 0.8660254F);
  put(44, 10.0F);
  support::KeepingBus live;
  Service service(live.bus, LoadFile(10.0));
  Feed(service, 1, 2);
  service.OnDatagram(TimeOf(3), 7503, payload, {"192.168.1.201", 7503});
  service.OnDatagram(TimeOf(3), 7503, std::vector<std::uint8_t>(48, 0xFF), {"192.168.1.201", 7503});
  service.Finish(TimeOf(3));
  support::HandleAll(live.bus);
  const auto sentences = live.All<lidar_nmea_t>(bus::kLidarNmea);
  ASSERT_EQ(sentences.size(), 1U) << "the second is none";
  EXPECT_EQ(sentences[0].host_utime_us, ToUtimeUs(TimeOf(3)));
  // Forward 0; along starboard, which is down, half of -g; down the rest. Turning to port is against down.
  EXPECT_EQ(sentences[0].sentence.substr(0, sentences[0].sentence.find('*')),
            "$VNIMU,0,0,0,+0.0000,-4.9033,-8.4928,+0.000000,+0.000000,-0.174533,0,0");
}

TEST_F(LidarBeams, SensorAddressesAreCheckedWithTheConfig) {
  const auto fault_of = [&](const std::string& lines) -> std::string {
    try {
      Load(lines);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(fault_of("sensor_address: \"192.168.1.201\""), "");
  EXPECT_EQ(fault_of("sensor_address: \"127.0.0.1:8080\""), "");
  EXPECT_EQ(fault_of("sensor_address: \"fe80::1\""), "");
  for (const auto* wrong : {"sensor", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:99999", "127.0.0.1:80x", "239.1.2.3", "0.0.0.0"}) {
    EXPECT_NE(fault_of("sensor_address: \"" + std::string(wrong) + "\"").find("is no numeric address of a sensor"), std::string::npos) << wrong;
  }
  EXPECT_NE(fault_of("").find("beam_file: must be set for an Ouster"), std::string::npos);
}

}  // namespace
}  // namespace lookout::lidar
