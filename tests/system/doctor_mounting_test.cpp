// lookout-doctor --mounting on the simulated marina: a lidar that was bumped, one that was not, and one that sees nothing.
#include <filesystem>
#include <gtest/gtest.h>
#include <regex>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/memory_bus.hpp"
#include "services/navigator/params.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"
#include "tools/calibrate/recording.hpp"
#include "tools/doctor/mounting_watch.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;

class DoctorMounting : public ::testing::Test {
 protected:
  TempDir folder_;

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  void Simulate(const std::string& scene, const std::string& seconds, const std::string& name) const {
    const auto result = RunProgram(
        {Bin("sim"), "--config", kDemoConfig.string(), "--scene", scene, "--seed", "1", "--seconds", seconds, "--pcap", Path(name)}, Path("sim.out"));
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }

  /// @param lidar  the angles of boat.txtpb; the true ones are roll 1, pitch -0.5, yaw 5
  /// @return what the doctor says, in one line
  std::string Ask(const std::string& lidar, const std::string& capture) const {
    fs::copy(kDemoConfig, folder_ / "boat", fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    ReplaceIn(folder_ / "boat/boat.txtpb", "roll_deg: 1.0 pitch_deg: -0.5 yaw_deg: 5.0", lidar);
    const auto result = RunProgram({Bin("doctor"), "--config", Path("boat"), "--mounting", "--in", Path(capture)}, Path("doctor.out"));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    static const std::regex kWrap("\n +");
    return std::regex_replace(result.output, kWrap, " ");
  }
};

void ExpectHas(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in\n" << text;
}

TEST_F(DoctorMounting, NamesALidarThatWasBumpedAndNoneThatWasNot) {
  Simulate("marina", "40", "marina.pcap");
  ExpectHas(Ask("roll_deg: 1.0 pitch_deg: -0.5 yaw_deg: 5.0", "marina.pcap"), "the lidar points as boat.txtpb says");
  const auto said = Ask("roll_deg: -1.0 pitch_deg: -0.5 yaw_deg: 7.0", "marina.pcap");
  ExpectHas(said, "warning  mounting   by what stood around the boat for 40 s the lidar leans ");
  ExpectHas(said, "farther to starboard, is turned ");
  ExpectHas(said, "farther to starboard than boat.txtpb says: was it bumped? -> stop and look at its mount");
}

TEST_F(DoctorMounting, SaysThatNothingIsKnownWhereNothingStands) {
  Simulate((kSources / "config/scenes/calibration/straight_open_water.txtpb").string(), "15", "open.pcap");
  const auto said = Ask("roll_deg: 1.0 pitch_deg: -0.5 yaw_deg: 7.0", "open.pcap");
  ExpectHas(said, "warning  mounting   whether the lidar was bumped is not known: ");
  ExpectHas(said, "missing: go near what stands");
}

// A live bus has POSE of the boat's own navigator, which follows the lidar and so its mounting: it must not count.
TEST_F(DoctorMounting, HearsOnABusWhatARecordingHolds) {
  Simulate("marina", "6", "marina.pcap");
  const auto replay =
      RunProgram({Bin("replay"), "--config", kDemoConfig.string(), "--in", Path("marina.pcap"), "--out", Path("marina.lcmlog")}, Path("replay.out"));
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  bus::MemoryBus bus;
  doctor::MountingWatch watch(navigator::LoadParams(kDemoConfig));
  watch.ListenTo(bus);
  int num_poses = 0;
  bus::LogReader reader(Path("marina.lcmlog"));
  while (const auto event = reader.Next()) {
    for (const auto& channel : bus::kChannels) {
      if (channel.name == event->channel) bus.Publish(channel, {event->bytes.begin(), event->bytes.end()});
    }
    num_poses += event->channel == bus::kPose.name ? 1 : 0;
    while (bus.HandleOnce()) {
    }
  }
  EXPECT_GT(num_poses, 250) << "the poses that do not serve";
  const auto& heard = watch.recording();
  const auto read = calibrate::ReadRecording(kDemoConfig, {Path("marina.lcmlog")}, {});
  EXPECT_GT(heard.scans.size(), 50U);
  ASSERT_EQ(heard.scans.size(), read.scans.size());
  ASSERT_GT(heard.track.poses().size(), 200U);
  const auto num = std::min(heard.track.poses().size(), read.track.poses().size());
  EXPECT_LE(std::max(heard.track.poses().size(), read.track.poses().size()) - num, 1U) << "the pose of the end";
  for (std::size_t i = 0; i < num; ++i) {
    EXPECT_EQ(heard.track.poses()[i].time, read.track.poses()[i].time);
    EXPECT_TRUE(heard.track.poses()[i].T_map_vessel.isApprox(read.track.poses()[i].T_map_vessel, 1e-12));
  }
}

TEST_F(DoctorMounting, NeedsAConfig) {
  WriteFile(folder_ / "none.pcap", "");
  EXPECT_EQ(RunProgram({Bin("doctor"), "--mounting", "--in", Path("none.pcap")}, Path("doctor.out")).exit_code, 2);
}

}  // namespace
}  // namespace lookout::system_test
