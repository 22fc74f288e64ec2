#include "services/plotter/params.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "common/config/text_config.hpp"
#include "services/plotter/core/n2k_device.hpp"
#include "tests/support/files.hpp"

namespace lookout::plotter {
namespace {

namespace fs = std::filesystem;

class PlotterParams : public ::testing::Test {
 protected:
  PlotterParams() { fs::copy(support::kDemoConfig, folder_ / "config"); }

  Params Load(const std::string& text) {
    std::ofstream(folder_ / "config/plotter.txtpb") << text;
    return LoadParams(folder_ / "config");
  }
  // All faults, or nothing.
  std::string FaultOf(const std::string& output, const std::string& format = "NMEA0183") {
    try {
      Load("output { name: 'x' format: " + format + " " + output + " }\n");
      return {};
    } catch (const config::ConfigError& error) {
      return error.what();
    }
  }
  bool Says(const std::string& output, const std::string& words) {
    const auto fault = FaultOf(output);
    EXPECT_NE(fault.find(words), std::string::npos) << output << ": " << fault;
    return fault.find("plotter.txtpb:1: output: 'x': ") != std::string::npos;
  }

  support::TempDir folder_;
};

TEST_F(PlotterParams, HaveNoOutputsWithoutAFile) {
  fs::remove(folder_ / "config/plotter.txtpb");
  const auto params = LoadParams(folder_ / "config");
  EXPECT_TRUE(params.outputs.empty());
  EXPECT_EQ(params.boat, "demo");
  EXPECT_EQ(InWords(params), "# plotter.txtpb: no output: nothing is sent\n");
}

TEST_F(PlotterParams, SayWhatGoesWhere) {
  EXPECT_EQ(InWords(Load("output { name: 'a' format: NMEA0183 tcp_server { bind_address: '127.0.0.1' port: 10111 } alerts: ALF }\n"
                         "output { name: 'b' format: SIGNALK websocket { address: '::1' } sends_own_ship: false }\n")),
            "# plotter.txtpb: output 'a': NMEA 0183 OSD TTM RMC HDT ALF, TCP to at most 8 that connect to 127.0.0.1 port 10111\n"
            "# plotter.txtpb: output 'b': Signal K, WebSocket ws://::1:3000/signalk/v1/stream?subscribe=none without a token\n");
}

TEST_F(PlotterParams, HoldAnAutopilotsDistancesAndTheSightOfTheBoatsLidars) {
  const auto params = Load(
      "output { name: 'a' format: MAVLINK udp { address: '192.168.1.7' port: 14550 } }\n"
      "output { name: 'b' format: MAVLINK serial { device: '/dev/ttyACM0' baud: 115200 }\n"
      "         mavlink { system_id: 2 component_id: 1 form: POINTS max_distance_m: 60 sends_alerts: false } }\n");
  EXPECT_EQ(InWords(params),
            "# plotter.txtpb: output 'a': MAVLink 2 OBSTACLE_DISTANCE to 40 m as system 1 component 196 and alerts, UDP to 192.168.1.7 port 14550\n"
            "# plotter.txtpb: output 'b': MAVLink 2 OBSTACLE_DISTANCE_3D to 60 m as system 2 component 1, serial port /dev/ttyACM0 at 115200 baud\n");
  ASSERT_TRUE(params.surroundings);
  EXPECT_EQ(params.surroundings->reach_m, 60.0);
  ASSERT_EQ(params.surroundings->lidars.size(), 1U);
  EXPECT_NEAR(params.surroundings->lidars.front().above_water_m, 1.5, 1e-9);
  EXPECT_FALSE(Load("output { name: 'x' format: NMEA0183 udp { address: '127.0.0.1' port: 2000 } }").surroundings);
}

TEST_F(PlotterParams, RefuseWhatCannotBe) {
  EXPECT_TRUE(Says("", "must have one of udp, tcp_server, tcp_client, serial, websocket and can, and has 0"));
  EXPECT_TRUE(Says("udp { address: 'tablet' port: 2000 }", "'tablet' is no numeric address"));
  EXPECT_TRUE(Says("udp { address: '0.0.0.0' port: 2000 }", "must be of a receiver"));
  EXPECT_TRUE(Says("udp { address: '127.0.0.1' port: 2000 } mavlink { system_id: 2 }", "mavlink is of format MAVLINK only"));
  EXPECT_TRUE(Says("websocket { address: '127.0.0.1' }", "a websocket carries format SIGNALK only"));
  EXPECT_TRUE(Says("udp { address: '127.0.0.1' port: 2000 } targets_as_vessels: true", "targets_as_vessels is of format SIGNALK only"));
  EXPECT_TRUE(Says("serial { device: 'ttyUSB0' baud: 4800 }", "the whole path"));
  EXPECT_TRUE(Says("serial { device: '/dev/ttyUSB0' baud: 4801 }", "none that serial ports have"));
  EXPECT_TRUE(Says("udp { address: '10.0.0.1' port: 2000 } target_talker: 'RAD'", "two capital letters"));
  EXPECT_TRUE(Says("udp { address: '10.0.0.1' port: 2000 } alerts: ALR takes_acknowledgements: true", "nothing comes back over udp"));
  EXPECT_TRUE(Says("tcp_client { address: '10.0.0.1' port: 2000 } takes_acknowledgements: true", "wants alerts"));
  EXPECT_NE(FaultOf("udp { address: '10.0.0.1' port: 0 }").find("port"), std::string::npos);
}

TEST_F(PlotterParams, RefuseWhatAnAutopilotCannotGet) {
  const auto fault = [this](const std::string& output) { return FaultOf(output, "MAVLINK"); };
  EXPECT_EQ(fault("udp { address: '10.0.0.1' port: 14550 }"), "");
  EXPECT_NE(fault("tcp_client { address: '10.0.0.1' port: 5760 }").find("format MAVLINK goes over udp or a serial port"), std::string::npos);
  EXPECT_NE(fault("serial { device: '/dev/ttyACM0' baud: 38400 }").find("MAVLINK wants a serial port of 57600 baud or more"), std::string::npos);
  EXPECT_NE(fault("udp { address: '10.0.0.1' port: 14550 } mavlink { max_distance_m: 0.5 }").find("max_distance_m"), std::string::npos);
  EXPECT_NE(fault("udp { address: '10.0.0.1' port: 14550 } mavlink { system_id: 256 }").find("system_id"), std::string::npos);
  EXPECT_NE(fault("udp { address: '10.0.0.1' port: 14550 } alerts: ALR").find("of format NMEA0183 only"), std::string::npos);
  EXPECT_NE(fault("serial { device: '/dev/ttyACM0' baud: 115200 } takes_acknowledgements: true").find("bring no acknowledgements back"),
            std::string::npos);
}

TEST_F(PlotterParams, MakeADeviceOfNmea2000) {
  const auto params = Load(
      "output { name: 'a' format: N2K_DEVICE tcp_client { address: '192.168.4.1' port: 1457 } }\n"
      "output { name: 'b' format: N2K_DEVICE can { interface: 'can0' } n2k { preferred_address: 80 unique_number: 7 } }\n"
      "output { name: 'c' format: N2K_DEVICE serial { device: '/dev/ttyACM0' baud: 115200 } }\n");
  const auto number = UniqueNumberOf("demo/a");
  EXPECT_EQ(InWords(params),
            "# plotter.txtpb: output 'a': NMEA 2000 as a device of unique number " + std::to_string(number) +
                " that claims address 35 first, RAW text, TCP to 192.168.4.1 port 1457\n"
                "# plotter.txtpb: output 'b': NMEA 2000 as a device of unique number 7 that claims address 80 first, CAN interface can0\n"
                "# plotter.txtpb: output 'c': NMEA 2000 as a device of unique number " +
                std::to_string(UniqueNumberOf("demo/c")) + " that claims address 35 first, RAW text, serial port /dev/ttyACM0 at 115200 baud\n");
  const auto fault = [this](const std::string& output) { return FaultOf(output, "N2K_DEVICE"); };
  EXPECT_NE(fault("udp { address: '10.0.0.1' port: 1457 }").find("goes over tcp_client or serial, to a gateway, or over can"), std::string::npos);
  EXPECT_NE(fault("can { interface: '' }").find("can.interface"), std::string::npos);
  EXPECT_NE(fault("can { interface: 'can0' } n2k { preferred_address: 252 }").find("preferred_address"), std::string::npos);
  EXPECT_NE(fault("can { interface: 'can0' } n2k { unique_number: 2097152 }").find("unique_number"), std::string::npos);
  EXPECT_NE(fault("can { interface: 'can0' } takes_acknowledgements: true").find("bring no acknowledgements back"), std::string::npos);
  EXPECT_TRUE(Says("can { interface: 'can0' }", "can and n2k are of format N2K_DEVICE only"));
}

// A position of ours that comes back as one that was measured would hide that none is.
TEST_F(PlotterParams, RefuseToFeedTheOwnNavigator) {
  for (const auto* address : {"127.0.0.1", "192.168.1.255", "239.1.2.3", "255.255.255.255"}) {
    const std::string udp = std::string("udp { address: '") + address + "' port: 10110 }";
    EXPECT_TRUE(Says(udp, "lookout-navigator reads UDP port 10110 of this computer")) << address;
    EXPECT_EQ(FaultOf(udp + " sends_own_ship: false"), "") << address;
  }
  EXPECT_EQ(FaultOf("udp { address: '192.0.2.7' port: 10110 }"), "");
  EXPECT_EQ(FaultOf("udp { address: '127.0.0.1' port: 10112 }"), "");
  std::ofstream(folder_ / "config/navigator.txtpb", std::ios::app)
      << "input { name: 'gps' serial { device: '/dev/ttyUSB7' baud: 4800 } }\ninput { name: 'mux' tcp { address: '127.0.0.1' port: 2001 } }\n";
  EXPECT_TRUE(Says("serial { device: '/dev/../dev/ttyUSB7' baud: 38400 }", "is an input of navigator.txtpb"));
  EXPECT_TRUE(Says("tcp_server { bind_address: '0.0.0.0' port: 2001 }", "lookout-navigator reads TCP port 2001 of this computer"));
}

TEST_F(PlotterParams, ReadATokenThatNotEverybodyMay) {
  const std::string output = "output { name: 'x' format: SIGNALK websocket { address: '127.0.0.1' token_file: 'token' } }\n";
  EXPECT_THROW(Load(output), config::ConfigError);
  std::ofstream(folder_ / "config/token") << "abc.def\r\nmore\n";
  fs::permissions(folder_ / "config/token", fs::perms::owner_read | fs::perms::group_read);
  EXPECT_EQ(Load(output).outputs.at(0).destination.token, "abc.def");
  EXPECT_EQ(InWords(Load(output)).find("abc"), std::string::npos);
  fs::permissions(folder_ / "config/token", fs::perms::others_read, fs::perm_options::add);
  EXPECT_THROW(Load(output), config::ConfigError);
}

}  // namespace
}  // namespace lookout::plotter
