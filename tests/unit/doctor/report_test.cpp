// What lookout-doctor reads of a config folder and of a bus, and how it prints.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "lookout/nav_raw_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "tests/support/bus_fixture.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/doctor/healthy.hpp"
#include "tools/doctor/findings.hpp"
#include "tools/doctor/watch.hpp"

namespace lookout::doctor::test {
namespace {

namespace fs = std::filesystem;

TEST(DoctorReport, IsAlignedAndWrapped) {
  const Findings findings{{Grade::kOk, "route", "fine", ""},
                          {Grade::kFault, "lidar", std::string(60, 'a') + " " + std::string(60, 'b'), "mend\x1b[2J it"}};
  EXPECT_EQ(ToReport(findings, false),
            "ok       route      fine\n"
            "fault    lidar      " +
                std::string(60, 'a') + "\n" + std::string(20, ' ') + std::string(60, 'b') + "\n" + std::string(20, ' ') +
                "-> mend [2J it\n"
                "1 fault, 0 warnings\n");
  EXPECT_TRUE(HasFault(findings));
  EXPECT_FALSE(HasFault({findings[0]}));
  EXPECT_EQ(ToReport({findings[0]}, true), "\033[32mok       \033[0mroute      fine\nall is well\n");
}

TEST(DoctorConfig, NamesEachWrongFileOnce) {
  const support::TempDir folder;
  fs::copy(support::kDemoConfig, folder);
  fs::remove(folder / "segmenter.txtpb");
  std::ofstream(folder / "boat.txtpb") << "name: \"x\"\n";
  std::ofstream(folder / "lidar.txtpb") << "source: UDP\nbind_address: \"nowhere\"\ncut_azimuth_deg: 0\n";
  std::ofstream(folder / "other.txtpb") << "x: 1\n";
  std::ofstream(folder / "georeferencer.txtpb") << "pose_timeout_s: 1000\n";
  const auto seen = ReadConfig(folder);
  std::map<std::string, std::string> first_fault;
  for (const auto& [file, faults] : seen.files) first_fault[file] = faults.empty() ? "" : faults.front();
  EXPECT_EQ(first_fault.size(), 9U);
  EXPECT_NE(first_fault["boat.txtpb"].find("boat.txtpb:1: lidar"), std::string::npos) << first_fault["boat.txtpb"];
  EXPECT_NE(first_fault["lidar.txtpb"].find("lidar.txtpb:2: bind_address: 'nowhere' is no numeric address"), std::string::npos);
  EXPECT_FALSE(first_fault.contains("segmenter.txtpb")) << "it has its defaults";
  EXPECT_NE(first_fault["other.txtpb"].find("there is no config/schema/other.proto"), std::string::npos);
  // Both need boat.txtpb: one has no fault of its own, the other has.
  EXPECT_NE(first_fault["georeferencer.txtpb"].find("pose_timeout_s: must be at most 60"), std::string::npos);
  EXPECT_EQ(first_fault["navigator.txtpb"], "");
  EXPECT_FALSE(seen.boat || seen.lidar || seen.navigation);
  EXPECT_TRUE(seen.log_folder.has_value());
}

class DoctorNotes : public support::BusTest {
 protected:
  Observations seen_;
  Utime now_ = kEnd;
  Notes notes_{seen_, [this] { return now_; }};

  void SetUp() override {
    seen_.config.lidar.emplace();
    notes_.ListenTo(bus_, Via::kBus);
    notes_.ListenToProcesses(bus_);
  }
};

TEST_F(DoctorNotes, CountPacketsOfTheDataPort) {
  lidar_packets_t packets{};
  packets.num_packets = 3;
  packets.host_utime_us = {Ago(2), Ago(1.5), Ago(1)};
  packets.udp_port = {2368, 8308, 2368};
  packets.size_bytes = {0, 0, 0};
  Send(bus::kLidarPackets, packets);
  EXPECT_EQ(seen_.lidar.via, Via::kBus);
  EXPECT_EQ(seen_.lidar.num_packets, 2);
  EXPECT_EQ(ToUtimeUs(seen_.lidar.first), Ago(2));
  EXPECT_EQ(ToUtimeUs(seen_.lidar.last), Ago(1));
  EXPECT_EQ(seen_.lidar.heard_last, kEnd) << "the other computer's clock may be off";
  EXPECT_GT(notes_.num_log_bytes(), 28 + 13);
}

TEST_F(DoctorNotes, KeepTheFixThatSaysMost) {
  gnss_fix_t fix{};
  fix.arrival_utime_us = Ago(3);
  fix.quality = gnss_fix_t::QUALITY_GNSS;
  fix.num_satellites = 9;
  Send(bus::kGnssFix, fix);
  fix.num_satellites = -1;
  fix.arrival_utime_us = Ago(2.9);
  Send(bus::kGnssFix, fix);
  EXPECT_EQ(seen_.navigation.fix->num_satellites, 9);
  fix.quality = gnss_fix_t::QUALITY_NONE;  // is news
  Send(bus::kGnssFix, fix);
  EXPECT_EQ(seen_.navigation.fix->quality, 0);
  fix.arrival_utime_us = Ago(0);
  fix.quality = gnss_fix_t::QUALITY_GNSS;
  Send(bus::kGnssFix, fix);
  EXPECT_EQ(seen_.navigation.fix->arrival_utime_us, Ago(0));
}

TEST_F(DoctorNotes, TellProcessesApartByComputerAndId) {
  health_t health{};
  health.process = "lidar";
  health.host = "boat";
  health.pid = 1;
  Send(bus::kHealth, health);
  now_ += std::chrono::seconds(1);
  health.seq = 1;
  Send(bus::kHealth, health);
  health.host = "cabin";
  Send(bus::kHealth, health);
  ASSERT_EQ(seen_.processes["lidar"].size(), 2U);
  EXPECT_EQ(seen_.processes["lidar"][0].first.seq, 0);
  EXPECT_EQ(seen_.processes["lidar"][0].last.seq, 1);
  EXPECT_EQ(seen_.processes["lidar"][0].heard_last, now_);
}

TEST_F(DoctorNotes, PassOverWhatCannotBeRead) {
  const std::vector<std::uint8_t> bytes(40, 0xFF);
  for (const auto& channel : bus::kChannels) bus_.Publish(channel, bytes);
  HandleAll();
  EXPECT_TRUE(seen_.processes.empty());
  lidar_packets_t packets{};
  packets.num_packets = 1;
  packets.host_utime_us = {std::numeric_limits<std::int64_t>::max()};
  packets.udp_port = {2368};
  packets.size_bytes = {0};
  Send(bus::kLidarPackets, packets);
  EXPECT_EQ(seen_.lidar.num_packets, 0);
}

}  // namespace
}  // namespace lookout::doctor::test
