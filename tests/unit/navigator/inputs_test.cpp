// The inputs of navigator.txtpb, and what --check says of them.
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "common/config/text_config.hpp"
#include "services/navigator/params.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

namespace fs = std::filesystem;

class InputsTest : public ::testing::Test {
 protected:
  InputsTest() {
    fs::copy_file(support::kDemoConfig / "boat.txtpb", folder_ / "boat.txtpb", fs::copy_options::overwrite_existing);
    std::ofstream(folder_ / "day.nmea") << "$GPHDT,1.0,T*00\n";
  }

  Params Load(const std::string& text) const {
    std::ofstream(folder_ / "navigator.txtpb") << text << "\nheading_offset_deg: 0 pitch_offset_deg: 0 roll_offset_deg: 0\n";
    return LoadParams(folder_);
  }
  std::string FaultOf(const std::string& text) const {
    try {
      Load(text);
    } catch (const config::ConfigError& error) {
      return error.what();
    }
    return "none";
  }
  // Whether the config is refused with this line and reason.
  void ExpectFault(const std::string& text, const std::string& expected) const {
    const auto fault = FaultOf(text);
    EXPECT_NE(fault.find(expected), std::string::npos) << text << "\n" << fault;
  }

  support::TempDir folder_;
};

const std::string kLive = "source: LIVE use_lidar_nmea: true\n";

TEST_F(InputsTest, AreUdpAndLidarByDefault) {
  const auto params = Load(kLive + "bind_address: '0.0.0.0'");
  ASSERT_EQ(params.connections.size(), 1U);
  EXPECT_EQ(params.connections[0].name, "udp");
  EXPECT_EQ(params.connections[0].port, 10110);
  EXPECT_EQ(params.source_of_port.at(10110), "udp");
}

TEST_F(InputsTest, MayBeManyAtOnce) {
  const auto params = Load(kLive + R"(
    input { name: 'gnss' role: GNSS serial { device: '/dev/ttyUSB0' baud: 38400 } latency_s: 0.08 }
    input { name: 'ahrs' role: ATTITUDE tcp { address: '192.168.1.7' port: 10111 } roll_positive: PORT_DOWN pitch_positive: BOW_DOWN }
    input { name: 'daemon' gpsd {} }
    input { name: 'mux' udp { bind_address: '127.0.0.1' port: 2000 } checksum_required: false deviation_deg: 1 declination_deg: -2 }
    input { name: 'lidar' latency_s: 0.2 })");
  ASSERT_EQ(params.connections.size(), 4U);
  EXPECT_EQ(params.connections[0].baud, 38400);
  EXPECT_EQ(params.connections[2].address, "127.0.0.1");
  EXPECT_EQ(params.connections[2].port, 2947);
  EXPECT_EQ(params.source_of_port.at(2000), "mux");
  EXPECT_EQ(params.source_of_port.at(10110), "udp") << "in captures";
  const auto& sources = params.navigator.sources;
  ASSERT_EQ(sources.size(), 5U);
  EXPECT_EQ(sources[0].role, Role::kGnss);
  EXPECT_EQ(sources[0].latency, std::chrono::milliseconds(80));
  EXPECT_EQ(sources[1].roll_sign, -1.0);
  EXPECT_EQ(sources[1].pitch_sign, -1.0);
  EXPECT_FALSE(sources[3].requires_checksum);
  EXPECT_TRUE(sources[3].deviation_rad && sources[3].declination_rad);
  EXPECT_FALSE(sources[2].latency);
}

TEST_F(InputsTest, AreRefusedWithLineAndReason) {
  ExpectFault(kLive + "input { name: 'GNSS' gpsd {} }", "navigator.txtpb:2: input: 'GNSS': name must be");
  ExpectFault(kLive + "input { gpsd {} }", ":2: input.name: must be set");
  ExpectFault(kLive + "input { name: 'a' gpsd {} }\ninput { name: 'a' gpsd { port: 1 } }", ":3: input: 'a': the name stands twice");
  ExpectFault(kLive + "input { name: 'a' }", ":2: input: 'a': must have one of serial, udp, tcp, gpsd and text_log, and has 0");
  ExpectFault(kLive + "input { name: 'a' gpsd {} udp { bind_address: '::' port: 1 } }", "and has 2");
  ExpectFault(kLive + "input { name: 'udp' gpsd {} }", "'udp': is opened by bind_address");
  ExpectFault(kLive + "input { name: 'a' serial { device: '/dev/ttyUSB0' baud: 4801 } }", "baud 4801 is none that serial ports have");
  ExpectFault(kLive + "input { name: 'a' serial { device: 'ttyUSB0' baud: 4800 } }", "must be the whole path");
  ExpectFault(kLive + "input { name: 'a' serial { device: '/dev/ttyUSB0' } }", "input.serial.baud: must be set");
  ExpectFault(kLive + "input { name: 'a' tcp { address: 'plotter.local' port: 1 } }", "'plotter.local' is no numeric address");
  ExpectFault(kLive + "input { name: 'a' text_log { file: 'no.nmea' } }", "cannot be read");
  ExpectFault(kLive + "input { name: 'a' text_log { file: 'navigator.txtpb' speed: 1e-9 } }", "text_log.speed must be 0 or at least 0.001");
  ExpectFault(kLive + "bind_address: 'eth0'", ":2: bind_address: 'eth0' is no numeric address");
  ExpectFault(kLive + "input { name: 'a' gpsd {} latency_s: -1 }", "input.latency_s: must be at least 0");
  ExpectFault("source: LIVE use_lidar_nmea: false", ":1: source: is LIVE, but there is nothing to read");
}

TEST_F(InputsTest, MayBeAnAutopilot) {
  const auto params = Load(kLive + R"(
    input { name: 'pilot' protocol: MAVLINK serial { device: '/dev/ttyUSB0' baud: 115200 } mavlink_system_id: 7 latency_s: 0.03 }
    input { name: 'other' protocol: MAVLINK role: ATTITUDE udp { bind_address: '0.0.0.0' port: 14551 } }
    input { name: 'gnss' udp { bind_address: '0.0.0.0' port: 2000 } })");
  const auto& sources = params.navigator.sources;
  ASSERT_EQ(sources.size(), 3U);
  EXPECT_EQ(sources[0].protocol, Protocol::kMavlink);
  EXPECT_EQ(sources[0].mavlink_system_id, 7);
  EXPECT_EQ(sources[1].mavlink_system_id, 1);
  EXPECT_EQ(sources[2].protocol, Protocol::kNmea0183);
  const auto words = InWords(params);
  EXPECT_NE(words.find("# input 'pilot': serial port /dev/ttyUSB0, 115200 baud, 8N1; MAVLink of system 7, component 1; all that its sentences say is "
                       "used.\n#   positions are those of the autopilot's own origin"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("# input 'other': UDP on 0.0.0.0 port 14551; MAVLink of system 1, component 1; headings, roll, pitch and rates of turn are "
                       "used.\n#   pitch: bow up"),
            std::string::npos)
      << words;
}

TEST_F(InputsTest, OfAnAutopilotAreRefusedWhereTheyCannotMeanThat) {
  const std::string udp = "udp { bind_address: '::' port: 14551 } ";
  const auto of_pilot = [](const std::string& rest) { return kLive + "input { name: 'a' protocol: MAVLINK " + rest + " }"; };
  ExpectFault(of_pilot("gpsd {}"), ":2: input: 'a': protocol MAVLINK needs serial or udp of this input's own");
  ExpectFault(kLive + "bind_address: '0.0.0.0'\ninput { name: 'udp' protocol: MAVLINK }", "needs serial or udp of this input's own");
  ExpectFault(of_pilot(udp + "role: IMU"), "role IMU: no IMU samples are read from MAVLINK");
  ExpectFault(of_pilot(udp + "checksum_required: false"), "checksum_required must not be false with MAVLINK");
  ExpectFault(of_pilot(udp + "roll_positive: PORT_DOWN"), "roll_positive and pitch_positive are fixed by MAVLINK");
  ExpectFault(of_pilot(udp + "deviation_deg: 0"), "deviation_deg and declination_deg are not for MAVLINK");
  ExpectFault(of_pilot(udp + "mavlink_system_id: 0"), "mavlink_system_id: must be at least 1");
  ExpectFault(of_pilot(udp + "mavlink_system_id: 256"), "mavlink_system_id: must be at most 255");
  ExpectFault(kLive + "input { name: 'a' mavlink_system_id: 2 " + udp + "}", "mavlink_system_id is for protocol MAVLINK");
  ExpectFault(kLive + "input { name: 'b' " + udp + "}\ninput { name: 'a' protocol: MAVLINK " + udp + "}",
              ":3: input: 'a': udp port 14551 belongs to");
}

const std::string kPlayed = "source: LIVE use_lidar_nmea: false\n";

TEST_F(InputsTest, MayBeTextLogsAlone) {
  std::ofstream(folder_ / "second.nmea") << "$GPHDT,1.0,T*00\n";
  const std::string day = "input { name: 'day' text_log { file: 'day.nmea' speed: 10 date: '2026-07-01' } }\n";
  const auto params = Load(kPlayed + day + "input { name: 'second' text_log { file: 'second.nmea' speed: 10 } }");
  ASSERT_EQ(params.connections.size(), 2U);
  EXPECT_EQ(params.connections[0].file, folder_ / "day.nmea");
  EXPECT_EQ(params.connections[0].day, std::chrono::sys_days(std::chrono::year(2026) / 7 / 1));
  EXPECT_FALSE(params.connections[1].day);
  EXPECT_NE(InWords(params).find("played at its own times: POSE is not of now"), std::string::npos);
}

// The live ones have times of now: at any speed but 1 both together gave poses that were wrong by the way of the boat.
TEST_F(InputsTest, MustNotMixTextLogsWithWhatComesLive) {
  const std::string day = "input { name: 'day' text_log { file: 'day.nmea' } }\n";
  ExpectFault(kLive + day, ":1: use_lidar_nmea: must be false beside the text log of input 'day'");
  ExpectFault(kPlayed + "bind_address: '0.0.0.0'\n" + day,
              ":3: input: 'day': a text log is played at its own times, and input 'udp' comes at those of now");
  ExpectFault(kPlayed + day + "input { name: 'daemon' gpsd {} }", "and input 'daemon' comes at those of now");
  std::ofstream(folder_ / "second.nmea") << "$GPHDT,1.0,T*00\n";
  ExpectFault(kPlayed + day + "input { name: 'second' text_log { file: 'second.nmea' speed: 2 } }",
              ":3: input: 'second': text_log.speed must be that of input 'day'");
}

TEST_F(InputsTest, RefuseATextLogThatIsEmptyOrADateThatIsNone) {
  std::ofstream(folder_ / "empty.nmea").flush();
  ExpectFault(kPlayed + "input { name: 'a' text_log { file: 'empty.nmea' } }", "empty.nmea' is empty");
  ExpectFault(kPlayed + "input { name: 'a' text_log { file: 'day.nmea' date: '1.7.2026' } }", "text_log.date '1.7.2026' is no day as 2026-07-01");
}

TEST_F(InputsTest, MustNotShareADeviceOrAPort) {
  fs::create_symlink("/dev/null", folder_ / "by-id");
  const auto serial = [](const std::string& name, const std::string& device) {
    return "input { name: '" + name + "' serial { device: '" + device + "' baud: 4800 } }\n";
  };
  ExpectFault(kLive + serial("a", "/dev/null") + serial("b", (folder_ / "by-id").string()), ":3: input: 'b': serial port /dev/null is used by");
  ExpectFault(kLive + "bind_address: '0.0.0.0'\ninput { name: 'b' udp { bind_address: '::' port: 10110 } }",
              ":3: input: 'b': udp port 10110 belongs to input 'udp'");
  ExpectFault(kLive + "input { name: 'a' gpsd {} }\ninput { name: 'b' gpsd {} }", "'b': gpsd 127.0.0.1 port 2947 is used by");
}

TEST_F(InputsTest, ADatumThatIsFarFromATextLogsFirstPositionIsNamed) {
  const support::TempDir folder;
  const auto log = folder / "log";
  std::ofstream(log) << "noise\n" << Line("GPGGA,120000,,,,,0,,,,M,,M,,") << "\r\n" << RmcLine(NoonPlus(0), 43.63, -72.15, 0.0, 0.0) << "\r\n";
  auto params = Load("source: LIVE use_lidar_nmea: false\ninput { name: 'day' text_log { file: '" + log.string() + "' } }");
  params.navigator.filter.datum.reset();
  EXPECT_NE(InWords(params).find("# datum: the first fix of the run."), std::string::npos);
  params.navigator.filter.datum = GeodeticPlace{43.6, -72.1, 0.0};
  EXPECT_NE(InWords(params).find("is within 50 km."), std::string::npos) << InWords(params);
  params.navigator.filter.datum = GeodeticPlace{-72.15, 43.63, 0.0};
  EXPECT_NE(InWords(params).find("# WARNING: datum 72.15000 S 43.63000 E of boat.txtpb is 11910 km from the first position of text log"),
            std::string::npos)
      << InWords(params);
  EXPECT_NE(InWords(params).find("swapped latitude and longitude?"), std::string::npos);
  fs::remove(log);
  EXPECT_NE(InWords(params).find("Not compared with a position"), std::string::npos);
}

TEST_F(InputsTest, ArePrintedInWords) {
  const auto words = InWords(Load(kLive + "input { name: 'ahrs' serial { device: '/dev/ttyUSB0' baud: 4800 } pitch_positive: BOW_DOWN }"));
  EXPECT_NE(words.find("# input 'ahrs': serial port /dev/ttyUSB0, 4800 baud, 8N1; all that its sentences say is used."), std::string::npos) << words;
  EXPECT_NE(words.find("bow down is positive; where the sensor says +5 deg, an object 10 m ahead along the deck would be at 0.87 m below"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("starboard side down is positive; where the sensor says +5 deg, an object 10 m to starboard along the deck would be at "
                       "0.87 m below"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("# input 'lidar': the lidar's position packets"), std::string::npos) << words;
  for (const char* config : {"demo", "catabot"}) {
    EXPECT_NE(InWords(LoadParams(support::kSources / "config" / config)).find("# input 'udp': UDP on 0.0.0.0 port 10110"), std::string::npos);
  }
}

TEST(Day, IsReadInOneFormOnly) {
  EXPECT_EQ(ParseDay("2020-02-29"), std::chrono::sys_days(std::chrono::year(2020) / 2 / 29));
  for (const char* text :
       {"2021-02-29", "2020-13-01", "2020-00-10", "2020-1-1", "20200101", "1969-12-31", "2200-01-01", "2020-01-01 ", "", "2020-01-0x"}) {
    EXPECT_FALSE(ParseDay(text)) << text;
  }
}

}  // namespace
}  // namespace lookout::navigator
