// Captures under the doctor: which lidars speak, the lines for lidar.txtpb, and what is wrong.
#include "tools/doctor/cable.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/unit/doctor/healthy.hpp"
#include "tests/unit/lidar_models/hesai_packet.hpp"
#include "tests/unit/lidar_models/ouster_packet_maker.hpp"

namespace lookout::doctor::test {
namespace {

namespace fs = std::filesystem;
using Payload = std::vector<std::uint8_t>;
using lidar::OusterProfile;

constexpr std::uint64_t kSecond = 1'000'000'000;
constexpr std::uint64_t kStartNs = 1'795'780'801 * kSecond;  // 2026-11-27 12:00:01

// A capture of libpcap: Ethernet, IPv4, UDP, each datagram one frame.
class CaptureFile {
 public:
  explicit CaptureFile(const fs::path& file) : file_(file, std::ios::binary) {
    for (const std::uint32_t word : {0xA1B2'C3D4U, 0x0004'0002U, 0U, 0U, 262'144U, 1U}) Put(word, 4);
  }
  void Add(std::uint64_t time_ns, const std::array<std::uint8_t, 4>& to, int port, const Payload& payload) {
    const auto size = static_cast<std::uint32_t>(14 + 20 + 8 + payload.size());
    for (const std::uint32_t word :
         {static_cast<std::uint32_t>(time_ns / kSecond), static_cast<std::uint32_t>(time_ns % kSecond / 1000), size, size}) {
      Put(word, 4);
    }
    std::vector<std::uint8_t> head(42);
    head[12] = 0x08;
    head[14] = 0x45;
    SetBig(head, 16, static_cast<int>(size - 14));
    head[22] = 64;
    head[23] = 17;
    const std::array<std::uint8_t, 4> from{192, 168, 1, 201};
    std::ranges::copy(from, head.begin() + 26);
    std::ranges::copy(to, head.begin() + 30);
    SetBig(head, 34, 50'000);
    SetBig(head, 36, port);
    SetBig(head, 38, static_cast<int>(payload.size()) + 8);
    file_.write(reinterpret_cast<const char*>(head.data()), static_cast<std::streamsize>(head.size()));
    file_.write(reinterpret_cast<const char*>(payload.data()), static_cast<std::streamsize>(payload.size()));
  }

 private:
  static void SetBig(std::vector<std::uint8_t>& bytes, std::size_t at, int value) {
    bytes[at] = static_cast<std::uint8_t>(value >> 8);
    bytes[at + 1] = static_cast<std::uint8_t>(value & 0xFF);
  }
  void Put(std::uint32_t word, int num_bytes) {
    for (int i = 0; i < num_bytes; ++i) file_.put(static_cast<char>(word >> (8 * i) & 0xFF));
  }

  std::ofstream file_;
};

std::string MetadataText(OusterProfile profile, int num_rings) {
  nlohmann::json json;
  json["prod_line"] = "OS-1-" + std::to_string(num_rings);
  json["lidar_mode"] = "1024x10";
  json["data_format"] = {{"columns_per_frame", 1024},
                         {"columns_per_packet", 16},
                         {"pixels_per_column", num_rings},
                         {"udp_profile_lidar", std::string(NameOf(profile))},
                         {"column_window", {0, 1023}}};
  for (int i = 0; i < num_rings; ++i) {
    json["beam_altitude_angles"].push_back(20.0 - 0.3 * i);
    json["beam_azimuth_angles"].push_back(0.0);
  }
  return json.dump();
}

class DoctorCapture : public ::testing::Test {
 protected:
  Findings Ask(const std::string& lidar_config) {
    fs::copy(support::kDemoConfig, folder_ / "config", fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    std::ofstream(folder_ / "config/lidar.txtpb") << "source: UDP bind_address: \"0.0.0.0\" cut_azimuth_deg: 0\n" << lidar_config << "\n";
    return Ask(ReadConfig((folder_ / "config").string()));
  }
  Findings Ask(ConfigSeen config) {
    Observations seen;
    seen.config = std::move(config);
    ReadCaptures({capture_}, seen);
    return CheckCaptures(seen);
  }
  // One turn of an Ouster at 10 Hz; columns [first, last] are sent.
  void MakeOuster(OusterProfile profile, int num_rings, std::uint64_t ahead_ns = 0, int first = 0, int last = 1023, std::uint32_t range_mm = 20'000) {
    CaptureFile file(capture_);
    const auto metadata = lidar::ouster_maker::MakeMetadata(profile, num_rings);
    for (std::uint32_t frame = 1; frame < 4; ++frame) {
      for (int id = first / 16 * 16; id <= last; id += 16) {
        const std::uint64_t time_ns = kStartNs + (frame * 1024 + static_cast<std::uint64_t>(id)) * 97'656;
        lidar::ouster_maker::PacketText text;
        text.frame = frame;
        text.first_id = id;
        text.stamp_ns = time_ns + ahead_ns;
        text.echo = [&](int, int, int) { return lidar::ouster_maker::Echo{range_mm, 10}; };
        file.Add(time_ns + 16 * 97'656, {192, 168, 1, 77}, 7502, MakePacket(metadata, text));
      }
    }
  }
  void WriteMetadata(OusterProfile profile, int num_rings) {
    fs::create_directories(folder_ / "config");
    std::ofstream(folder_ / "config/metadata.json") << MetadataText(profile, num_rings);
  }

  support::TempDir temporary_;
  fs::path folder_ = temporary_.path();
  fs::path capture_ = folder_ / "capture.pcap";
};

constexpr const char* kOusterLines = "model: MODEL_OUSTER data_port: 7502 position_port: 7503 beam_file: \"metadata.json\"";

TEST_F(DoctorCapture, SaysWhichLinesAnOusterNeedsWithoutAConfig) {
  MakeOuster(OusterProfile::kSingle, 32);
  const auto findings = Ask(ConfigSeen());
  EXPECT_SAYS(About(findings, "lidar"), kWarning, std::string("lines for lidar.txtpb: ") + kOusterLines);
  EXPECT_SAYS(About(findings, "lidar"), kWarning, "RNG19_RFL8_SIG16_NIR16 with 32 rings, 16 columns a packet");
  EXPECT_SAYS(About(findings, "lidar"), kWarning, "at 192.168.1.201 sends to 192.168.1.77, port 7502");
  EXPECT_SAYS(About(findings, "clock"), kOk, "agrees with the capture's");
}

TEST_F(DoctorCapture, FindsNothingWrongWithAnOusterThatFitsItsConfig) {
  MakeOuster(OusterProfile::kSingle, 32);
  WriteMetadata(OusterProfile::kSingle, 32);
  const auto findings = Ask(kOusterLines);
  EXPECT_SAYS(About(findings, "lidar"), kOk, "OS1-32, strongest return");
  EXPECT_SAYS(About(findings, "clock"), kOk, "agrees with the capture's to 0.1 ms; scans have the sensor's time");
  EXPECT_EQ(About(findings, "window").text, "");
}

TEST_F(DoctorCapture, SaysThatTheMetadataAreOfAnotherProfile) {
  MakeOuster(OusterProfile::kLowBandwidth, 32);
  WriteMetadata(OusterProfile::kSingle, 32);
  const auto findings = Ask(kOusterLines);
  EXPECT_SAYS(
      About(findings, "lidar"), kFault,
      "the metadata file says RNG19_RFL8_SIG16_NIR16 with 32 rings, 16 columns a packet, but the Ouster OS1-32 sends RNG15_RFL8_NIR8 with 32");
}

TEST_F(DoctorCapture, SaysThatTheClockIsInTai) {
  MakeOuster(OusterProfile::kSingle, 32, 37 * kSecond);
  WriteMetadata(OusterProfile::kSingle, 32);
  const auto findings = Ask(kOusterLines);
  EXPECT_SAYS(About(findings, "clock"), kWarning, "as TAI is ahead of UTC by 37 s");
  EXPECT_SAYS(About(findings, "clock"), kWarning, "scans have this computer's time");
}

// config/demo: the lidar's azimuth 0 is near the bow. An Ouster's column 512 looks aft.
TEST_F(DoctorCapture, SaysWhereAWindowLooks) {
  WriteMetadata(OusterProfile::kSingle, 32);
  MakeOuster(OusterProfile::kSingle, 32, 0, 400, 623);
  EXPECT_SAYS(About(Ask(kOusterLines), "window"), kWarning, "nothing ahead is seen");
  EXPECT_SAYS(About(Ask(kOusterLines), "window"), kWarning, "the lidar fires into 80 of 360 deg alone, azimuth 140 to 220 deg");
  MakeOuster(OusterProfile::kSingle, 32, 0, 400, 623, 400);
  EXPECT_SAYS(About(Ask(kOusterLines), "window"), kWarning, "it faces the mast or the hull");
}

// The cover was forgotten: its packets were whole, and all was well.
TEST_F(DoctorCapture, SaysThatNoBeamReturned) {
  WriteMetadata(OusterProfile::kSingle, 32);
  MakeOuster(OusterProfile::kSingle, 32, 0, 0, 1023, 0);
  EXPECT_SAYS(About(Ask(kOusterLines), "window"), kWarning, "beams returned: lasers off, or window covered");
  MakeOuster(OusterProfile::kSingle, 32);
  EXPECT_EQ(About(Ask(kOusterLines), "window").text, "");
}

TEST_F(DoctorCapture, TellsAHesaiFromWhatTheConfigSays) {
  CaptureFile(capture_).Add(kStartNs, {255, 255, 255, 255}, 2368, lidar::MadeHesaiPacket(lidar::HesaiModel::kXt32, 0x37).bytes);
  const auto findings = Ask("model: MODEL_VLP32C");
  EXPECT_SAYS(About(findings, "lidar"), kFault, "but lidar.txtpb is for MODEL_VLP32C on port 2368");
  EXPECT_SAYS(About(findings, "lidar"), kFault, "lines for lidar.txtpb: model: MODEL_XT32 data_port: 2368 position_port: 10110");
  EXPECT_SAYS(About(Ask("model: MODEL_XT32"), "lidar"), kOk, "Hesai XT32 at 192.168.1.201 sends to 255.255.255.255, port 2368");
}

TEST_F(DoctorCapture, SaysThatNobodyHearsTheDestination) {
  CaptureFile(capture_).Add(kStartNs, {192, 168, 1, 50}, 2368, lidar::MadeHesaiPacket(lidar::HesaiModel::kXt32, 0x37).bytes);
  auto config = ReadConfig(support::kDemoConfig.string());
  config.lidar->sources.kind = lidar::Sources::Kind::kUdp;
  config.lidar->sources.bind_address = "192.168.1.77";
  EXPECT_SAYS(About(Ask(config), "network"), kWarning, "but bind_address in lidar.txtpb is 192.168.1.77, which does not hear that");
}

TEST_F(DoctorCapture, SaysThatNothingInItIsOfALidar) {
  CaptureFile(capture_).Add(kStartNs, {192, 168, 1, 50}, 10'110, {'$', 'G'});
  EXPECT_SAYS(About(Ask(ConfigSeen()), "lidar"), kFault, "no datagram in the captures is of a lidar that is known");
}

TEST(DoctorSpeakers, SayLiveWhereAnotherLidarSendsTo) {
  auto seen = Healthy();
  lidar::Speaker speaker;
  speaker.source_address = "192.168.1.202";
  speaker.destination_address = "192.168.1.9";
  speaker.data_port = 2368;
  speaker.name = "Hesai XT32";
  speaker.other = lidar::OtherModel::kXt32;
  seen.lidar.speakers = {speaker};
  EXPECT_SAYS(About(CheckSpeakers(seen), "lidar"), kWarning, "lines for lidar_2.txtpb: model: MODEL_XT32");
  EXPECT_SAYS(About(CheckSpeakers(seen), "lidar"), kWarning, "if that is the lidar to use: the same lines for lidar.txtpb");
  EXPECT_SAYS(About(CheckSpeakers(seen), "network"), kWarning, "which is no address of this computer");
  seen.lidar.speakers[0].destination_address = "192.168.1.77";
  EXPECT_EQ(About(CheckSpeakers(seen), "network").text, "");
  seen.lidar.num_fragments_lost = 3;
  EXPECT_SAYS(About(CheckSpeakers(seen), "network"), kWarning, "3 datagrams lost because IP fragments of them did not come");
}

TEST(DoctorSpeakers, OfASecondLidarFitItsOwnFile) {
  auto seen = Healthy();
  seen.config.lidar_2 = seen.config.lidar;
  seen.config.lidar_2->number = 2;
  seen.config.lidar_2->data_port = 2370;
  seen.config.lidar_2->other = lidar::OtherLidar{.model = lidar::OtherModel::kXt32};
  lidar::Speaker speaker;
  speaker.source_address = "192.168.1.202";
  speaker.destination_address = "192.168.1.77";
  speaker.data_port = 2370;
  speaker.name = "Hesai XT32";
  speaker.other = lidar::OtherModel::kXt32;
  seen.lidar.speakers = {speaker};
  EXPECT_EQ(About(CheckSpeakers(seen), "lidar").text, "") << "live it is right without a word";
  seen.lidar.speakers[0].data_port = 2380;
  EXPECT_SAYS(About(CheckSpeakers(seen), "lidar"), kWarning, "lidar_2.txtpb is for MODEL_XT32 on port 2370");
  // Where the first is silent too, its file may be wrong.
  seen.lidar.model.clear();
  EXPECT_SAYS(About(CheckSpeakers(seen), "lidar"), kFault, "lines for lidar.txtpb: model: MODEL_XT32 data_port: 2380");
}

// The sensor is asked for its beams, and no file has them: the doctor threw.
TEST_F(DoctorCapture, ReportsWhereTheSensorIsAskedForItsBeams) {
  MakeOuster(OusterProfile::kSingle, 32);
  fs::copy(support::kDemoConfig, folder_ / "config", fs::copy_options::recursive);
  std::ofstream(folder_ / "config/lidar.txtpb") << "source: UDP bind_address: \"0.0.0.0\" cut_azimuth_deg: 0 model: MODEL_OUSTER data_port: 7502 "
                                                   "position_port: 7503 sensor_address: \"192.168.1.201\"\n";
  const auto config = ReadConfig((folder_ / "config").string());
  ASSERT_TRUE(config.lidar);
  for (const auto& finding : Ask(config)) EXPECT_EQ(finding.text.find("metadata file"), std::string::npos) << finding.text;
  const auto mounting = CheckMounting(config);
  ASSERT_FALSE(mounting.empty());
  for (const auto& finding : mounting) EXPECT_EQ(finding.text.find("lowest beam"), std::string::npos) << finding.text;
}

TEST(DoctorConfig, HoldsTheSecondLidar) {
  const support::TempDir folder;
  fs::copy(support::kDemoConfig, folder.path(), fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  EXPECT_FALSE(ReadConfig(folder.string()).lidar_2);
  std::ofstream(folder / "boat.txtpb", std::ios::app) << "lidar_2 { x_m: 0 y_m: 0 z_m: 1.5 roll_deg: 0 pitch_deg: 0 yaw_deg: 0 }\n";
  std::ofstream(folder / "lidar_2.txtpb") << "source: UDP bind_address: \"0.0.0.0\" data_port: 2370 position_port: 8310 cut_azimuth_deg: 0\n";
  const auto config = ReadConfig(folder.string());
  ASSERT_TRUE(config.lidar_2);
  EXPECT_EQ(config.lidar_2->data_port, 2370);
  EXPECT_TRUE(config.files.at("lidar_2.txtpb").empty());
}

// Captures of real sensors, where they are.
TEST(DoctorRecordings, AreTold) {
  const auto folder = support::kRecordings / "lidars";
  if (!fs::exists(folder)) GTEST_SKIP() << "no recordings at " << folder;
  const std::vector<std::pair<std::string, std::string>> captures{{"hesai_xt32_dual", "model: MODEL_XT32"},
                                                                  {"hesai_xt16_dual", "model: MODEL_XT16"},
                                                                  {"hesai_qt64_dual", "model: MODEL_QT64"},
                                                                  {"velodyne_vlp32c", "model: MODEL_VLP32C"},
                                                                  {"ouster_os0_32_dual", "RNG19_RFL8_SIG16_NIR16_DUAL with 32 rings"},
                                                                  {"ouster_os1_128_low_bandwidth", "RNG15_RFL8_NIR8 with 128 rings"},
                                                                  {"ouster_os1_64_fw20_legacy", "LEGACY with 64 rings"}};
  const support::TempDir temporary;
  for (const auto& [name, words] : captures) {
    const auto unpacked = temporary.path() / (name + ".pcap");
    ASSERT_EQ(std::system(("xz -dc '" + (folder / (name + ".pcap.xz")).string() + "' >'" + unpacked.string() + "'").c_str()), 0);
    Observations seen;
    ReadCaptures({unpacked}, seen);
    EXPECT_SAYS(About(CheckCaptures(seen), "lidar"), kWarning, words);
    EXPECT_EQ(seen.lidar.num_fragments_lost, 0) << name;
  }
}

}  // namespace
}  // namespace lookout::doctor::test
