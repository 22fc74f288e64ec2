// Captures of other lidars through the whole service: every return comes out, and LIDAR_PACKETS give the same scans again.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "services/lidar/io/capture_reader.hpp"
#include "services/lidar/params.hpp"
#include "services/lidar/service.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"

namespace lookout::lidar {
namespace {

namespace fs = std::filesystem;

struct OtherCapture {
  const char* file;
  const char* config;
  const char* beam_file;
  std::int64_t num_returns;
  double max_unit_m;
};

// Numbers of returns: counted over the raw bytes by others (truth/*.json beside the captures).
const std::vector<OtherCapture> kOtherCaptures{
    {"hesai_xt32_dual", "model: MODEL_XT32", "PandarXT32.csv", 486'606, 0.004},
    {"hesai_xt16_dual", "model: MODEL_XT16", "PandarXT16.csv", 165'138, 0.004},
    {"hesai_qt64_dual", "model: MODEL_QT64", "PandarQT64.csv", 299'376, 0.004},
    {"velodyne_vlp32c", "model: MODEL_VLP32C", "", 131'305, 0.004},
    {"ouster_os0_32_dual", "model: MODEL_OUSTER data_port: 7502 position_port: 7503", "ouster_os0_32.json", 21'803, 0.001},
    {"ouster_os1_128_low_bandwidth", "model: MODEL_OUSTER data_port: 7502 position_port: 7503", "ouster_os1_128.json", 322'536, 0.008},
    {"ouster_os1_64_fw20_legacy", "model: MODEL_OUSTER data_port: 7502 position_port: 7503", "ouster_os1_64_fw20_reduced.json", 16'749, 0.002}};

class OtherLidars : public ::testing::TestWithParam<OtherCapture> {
 protected:
  Params LoadWith(const std::string& source) {
    const auto& capture = GetParam();
    std::ofstream file(folder_ / "lidar.txtpb");
    file << source << "\ncut_azimuth_deg: 0\n" << capture.config << "\n";
    if (*capture.beam_file != '\0') {
      fs::copy_file((support::kRecordings / "lidars") / "meta" / capture.beam_file, folder_ / capture.beam_file,
                    fs::copy_options::overwrite_existing);
      file << "beam_file: \"" << capture.beam_file << "\"\n";
    }
    file.close();
    return LoadParams(folder_);
  }

  support::TempDir temporary_;
  fs::path folder_ = temporary_.path();
};

INSTANTIATE_TEST_SUITE_P(Recorded, OtherLidars, ::testing::ValuesIn(kOtherCaptures), [](const auto& one) { return std::string(one.param.file); });

TEST_P(OtherLidars, GiveEveryReturnAndTheSameScansFromTheirPackets) {
  const auto packed = (support::kRecordings / "lidars") / (std::string(GetParam().file) + ".pcap.xz");
  if (!fs::exists(packed)) GTEST_SKIP() << "no recording at " << packed;
  const auto unpacked = folder_ / "capture.pcap";
  ASSERT_EQ(std::system(("xz -dc '" + packed.string() + "' >'" + unpacked.string() + "'").c_str()), 0);

  const auto params = LoadWith("source: UDP bind_address: \"127.0.0.1\"");
  bus::MemoryBus live_bus;
  std::vector<std::vector<std::uint8_t>> live_scans;
  std::vector<std::vector<std::uint8_t>> packets;
  std::int64_t num_returns = 0;
  live_bus.SubscribeAll([&](std::string_view channel, Bytes bytes) {
    if (channel == bus::kLidarPackets.name) packets.emplace_back(bytes.begin(), bytes.end());
    if (channel != bus::kLidarScan.name) return;
    live_scans.emplace_back(bytes.begin(), bytes.end());
    const auto scan = bus::Decode<lidar_scan_t>(bytes).value();
    num_returns += std::ranges::count_if(scan.range, [](std::int16_t range) { return range != 0; });
    EXPECT_LE(scan.range_unit_m, GetParam().max_unit_m);
    EXPECT_EQ(scan.num_lost_packets, 0);
  });
  Service live(live_bus, params);
  CaptureReader reader(unpacked);
  while (const auto datagram = reader.Next()) {
    live.OnDatagram(datagram->host_time, datagram->destination_port, datagram->payload, {datagram->source_address, datagram->source_port});
  }
  live.Finish({});
  support::HandleAll(live_bus);
  EXPECT_EQ(num_returns, GetParam().num_returns);
  EXPECT_EQ(live.Report().reason, "");

  auto log_params = params;
  log_params.input = Input::kLog;
  bus::MemoryBus log_bus;
  std::vector<std::vector<std::uint8_t>> replayed_scans;
  log_bus.SubscribeAll([&](std::string_view channel, Bytes bytes) {
    if (channel == bus::kLidarScan.name) replayed_scans.emplace_back(bytes.begin(), bytes.end());
  });
  Service replayed(log_bus, log_params);
  for (const auto& message : packets) {
    log_bus.Publish(bus::kLidarPackets, message);
    support::HandleAll(log_bus);
  }
  EXPECT_EQ(replayed_scans, live_scans);
}

TEST(OtherLidarParams, AreRefusedWithWhatIsMissing) {
  const support::TempDir temporary;
  const auto& folder = temporary.path();
  const auto faults_of = [&](const std::string& text) -> std::string {
    std::ofstream(folder / "lidar.txtpb") << "source: UDP bind_address: \"127.0.0.1\" cut_azimuth_deg: 0\n" << text << "\n";
    try {
      LoadParams(folder);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(faults_of("model: MODEL_OUSTER data_port: 7502").find("beam_file: must be set for an Ouster"), std::string::npos);
  EXPECT_NE(faults_of("model: MODEL_OUSTER beam_file: \"no.json\"").find("data_port: must be set for an Ouster: 7502"), std::string::npos);
  EXPECT_NE(faults_of("model: MODEL_VLP32C beam_file: \"x.csv\"").find("none is read"), std::string::npos);
  EXPECT_NE(faults_of("beam_file: \"x.csv\"").find("is for other models"), std::string::npos);
  std::ofstream(folder / "bad.csv") << "1,2\n";
  EXPECT_NE(faults_of("model: MODEL_XT32 beam_file: \"bad.csv\"").find("bad.csv: "), std::string::npos);
  EXPECT_EQ(faults_of("model: MODEL_XT32"), "");
}

}  // namespace
}  // namespace lookout::lidar
