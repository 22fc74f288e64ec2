#include "services/lidar/params.hpp"

#include <unistd.h>

#include <fstream>
#include <gtest/gtest.h>

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "tests/support/files.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

class Vlp16Params : public ::testing::Test {
 protected:
  Params Load(const std::string& text) const {
    std::ofstream(folder_ / "lidar.txtpb") << text;
    return LoadParams(folder_);
  }
  std::string FaultOf(const std::string& text) const {
    try {
      Load(text);
    } catch (const config::ConfigError& error) {
      return error.what();
    }
    return "";
  }
  support::TempDir folder_;
};

TEST_F(Vlp16Params, HaveTheDefaultsOfTheSchema) {
  const auto params = Load("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 90");
  EXPECT_EQ(params.input, Input::kOutside);
  EXPECT_EQ(params.data_port, 2368);
  EXPECT_EQ(params.position_port, 8308);
  EXPECT_EQ(params.decoder.model, ModelChoice::kAuto);
  EXPECT_EQ(params.decoder.time, TimeChoice::kAuto);
  EXPECT_DOUBLE_EQ(params.decoder.cut_azimuth_rad, kPi / 2);
  EXPECT_FALSE(params.decoder.use_vertical_origin_offsets);
  EXPECT_EQ(params.sources.kind, Sources::Kind::kUdp);
  EXPECT_EQ(params.sources.receive_buffer_bytes, 4 << 20);
  EXPECT_TRUE(params.sources.interface.empty());
  EXPECT_TRUE(params.sources.multicast_group.empty());
  EXPECT_TRUE(params.sources.allowed_source_addresses.empty());
  EXPECT_DOUBLE_EQ(params.sources.capture_speed, 1.0);
}

TEST_F(Vlp16Params, FindTheCapturesBesideTheConfigAndKeepTheirOrder) {
  const auto params = Load(
      "source: CAPTURE capture_file: 'lake.pcap' capture_file: '/day/a.pcap' capture_speed: 0 cut_azimuth_deg: 0 model: MODEL_PUCK_HI_RES "
      "time_source: TIME_HOST");
  EXPECT_EQ(params.input, Input::kOutside);
  EXPECT_EQ(params.sources.kind, Sources::Kind::kCapture);
  EXPECT_EQ(params.sources.capture_files, (std::vector<std::filesystem::path>{folder_ / "lake.pcap", "/day/a.pcap"}));
  EXPECT_DOUBLE_EQ(params.sources.capture_speed, 0.0);
  EXPECT_EQ(params.decoder.model, ModelChoice::kPuckHiRes);
  EXPECT_EQ(params.decoder.time, TimeChoice::kHost);
  EXPECT_EQ(Load("source: LOG bind_address: '' cut_azimuth_deg: 0").input, Input::kLog);
}

TEST_F(Vlp16Params, HoldWhatTheSourcesNeed) {
  const auto udp = Load(
      "source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0 interface: 'eth0' multicast_group: '239.1.2.3' "
      "allowed_source_address: '192.168.1.201' allowed_source_address: '::ffff:192.168.1.202' allowed_source_address: 'FE80:0::1' "
      "allowed_source_address: 'lidar'");
  EXPECT_EQ(udp.sources.interface, "eth0");
  EXPECT_EQ(udp.sources.multicast_group, "239.1.2.3");
  // As inet_ntop writes them, whatever stands in the config; what is no address is refused by LoadChecked.
  EXPECT_EQ(udp.sources.allowed_source_addresses, (std::vector<std::string>{"192.168.1.201", "192.168.1.202", "fe80::1", "lidar"}));
  const auto live = Load("source: INTERFACE interface: 'eth0' bpf_filter: 'udp' cut_azimuth_deg: 0");
  EXPECT_EQ(live.sources.kind, Sources::Kind::kInterface);
  EXPECT_EQ(live.input, Input::kOutside);
  EXPECT_EQ(live.sources.bpf_filter, "udp");
}

TEST_F(Vlp16Params, NameEveryRelationThatIsWrongAtOnce) {
  const auto fault = FaultOf("source: INTERFACE\ncut_azimuth_deg: 0\nmulticast_group: '239.1.2.3'\nposition_port: 2368");
  EXPECT_NE(fault.find(":1: interface: must be set when source is INTERFACE"), std::string::npos) << fault;
  EXPECT_NE(fault.find(":3: multicast_group:"), std::string::npos) << fault;
  EXPECT_NE(fault.find(":4: position_port:"), std::string::npos) << fault;
}

TEST_F(Vlp16Params, NameTheFieldAndTheLineThatTheUserWrote) {
  const auto ports = FaultOf("source: UDP\nbind_address: ''\ndata_port: 8308\ncut_azimuth_deg: 0");
  EXPECT_NE(ports.find(":3: data_port: must differ from position_port, which is 8308"), std::string::npos) << ports;
  EXPECT_NE(ports.find(":2: bind_address:"), std::string::npos) << ports;
  const auto captures = FaultOf("source: CAPTURE\ncapture_file: 'a'\ncut_azimuth_deg: 0\ncapture_file: ''");
  EXPECT_NE(captures.find(":4: capture_file:"), std::string::npos) << captures;
  const auto any = FaultOf("source: INTERFACE\ninterface: 'any'\ncut_azimuth_deg: 0");
  EXPECT_NE(any.find(":2: interface:"), std::string::npos) << any;
}

TEST_F(Vlp16Params, GiveTheirFaultsToWhoHasMoreToCheck) {
  std::ofstream(folder_ / "lidar.txtpb") << "source: UDP bind_address: '' cut_azimuth_deg: 0 data_port: 8308";
  std::vector<std::string> faults{"before"};
  LoadParams(folder_, 1, faults);
  EXPECT_EQ(faults.size(), 3U);
}

TEST_F(Vlp16Params, StopTheStartWhenTheyAreWrong) {
  EXPECT_NE(FaultOf("source: UDP bind_address: '' cut_azimuth_deg: 0").find("bind_address"), std::string::npos);
  EXPECT_NE(FaultOf("source: UDP bind_address: '0.0.0.0' bpf_filter: 'udp' cut_azimuth_deg: 0").find("bpf_filter"), std::string::npos);
  EXPECT_NE(FaultOf("source: CAPTURE capture_file: '' cut_azimuth_deg: 0").find("capture_file"), std::string::npos);
  for (const char* speed : {"-1", "1001", "nan"}) {
    EXPECT_NE(FaultOf("source: CAPTURE capture_file: 'a' cut_azimuth_deg: 0 capture_speed: " + std::string(speed)).find("capture_speed"),
              std::string::npos);
  }
  EXPECT_NE(FaultOf("source: CAPTURE bind_address: '' cut_azimuth_deg: 0").find("capture_file"), std::string::npos);
  EXPECT_NE(FaultOf("source: UDP bind_address: '' cut_azimuth_deg: 0 data_port: 8308").find("position_port"), std::string::npos);
  EXPECT_NE(FaultOf("source: UDP bind_address: '' cut_azimuth_deg: 360").find("cut_azimuth_deg"), std::string::npos);
  EXPECT_NE(FaultOf("source: UDP cut_azimuth_deg: -1").find("cut_azimuth_deg"), std::string::npos);
  EXPECT_EQ(FaultOf(""), "") << "a VLP-16 as delivered";
}

}  // namespace
}  // namespace lookout::vlp16
