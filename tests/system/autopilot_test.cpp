// lookout-plotter on a live bus with an autopilot on loopback: distances over UDP and over a serial port, and silence when nobody looks.
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/support/counters.hpp"
#include "tests/support/live_scene.hpp"
#include "tests/support/mavlink_frames.hpp"
#include "tests/support/pseudo_terminal.hpp"
#include "tests/support/socket.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
using std::chrono::seconds;

constexpr int kPilotPort = 14550;

class Autopilot : public LiveScene {
 protected:
  Autopilot() {
    EXPECT_TRUE(socket_.Bind(kPilotPort));
    std::ofstream(folder_ / "config/plotter.txtpb")
        << "output { name: 'udp' format: MAVLINK udp { address: '127.0.0.1' port: " << kPilotPort << " } }\n"
        << "output { name: 'serial' format: MAVLINK serial { device: '" << terminal_.device << "' baud: 115200 } mavlink { form: POINTS } }\n";
    scene_.has_scan = true;
    Start("plotter");
  }
  // Datagrams are whole frames, so that their text is one of frames, too.
  const std::vector<MavlinkFrame>& Read() { return frames_ = ReadMavlink(bytes_ += socket_.Read()); }
  std::size_t Count(std::uint32_t message_id) { return Only(message_id, Read()).size(); }
  bool Says(const std::string& text) {
    return std::ranges::any_of(Only(kStatusTextId, Read()), [&text](const MavlinkFrame& frame) { return frame.text() == text; });
  }

  PseudoTerminal terminal_;
  Socket socket_{SOCK_DGRAM};
  std::string bytes_;
  std::vector<MavlinkFrame> frames_ = {};
};

TEST_F(Autopilot, GetsDistancesAndIsToldWhenNobodyLooks) {
  ASSERT_TRUE(Runs()) << child_->Output();
  ASSERT_TRUE(Until([&] { return Count(kObstacleDistanceId) >= 10 && Count(kHeartbeatId) >= 2; })) << child_->Output();
  // One track, north of the boat at the map's middle; the boat heads 1.5 rad to starboard of it. Its outline is a point at (1, 1) m.
  const auto look = Only(kObstacleDistanceId, frames_).back();
  EXPECT_EQ(look.distance_cm(0), 4001);
  const auto sector = static_cast<std::size_t>(std::lround((0.7853981634 - 1.5 + 2.0 * 3.14159265359) * 180.0 / 3.14159265359 / 5.0)) % 72;
  EXPECT_NEAR(look.distance_cm(sector), 141, 15);
  EXPECT_TRUE(Says("Lookout: the look-out begins"));
  EXPECT_EQ(CountOf(health_, "output_udp_unheard"), 0);
  // Its heartbeat comes back to the port that sends.
  sockaddr_in sender{};
  socklen_t size = sizeof sender;
  ASSERT_TRUE(socket_.IsReadable(5000)) << "no scan is sent meanwhile, and a HEARTBEAT comes once a second";
  ASSERT_GT(recvfrom(socket_.descriptor(), nullptr, 0, MSG_PEEK, reinterpret_cast<sockaddr*>(&sender), &size), -1);
  EXPECT_EQ(CountOf(health_, "output_udp_heartbeats"), 0);
  const auto heartbeat = AutopilotHeartbeat();
  EXPECT_TRUE(socket_.SendTo(sender, {reinterpret_cast<const std::uint8_t*>(heartbeat.data()), heartbeat.size()}));
  EXPECT_TRUE(Until([&] { return CountOf(health_, "output_udp_heartbeats") == 1; })) << child_->Output();

  scene_.has_tracks = false;
  ASSERT_TRUE(Until([&] { return Says("Lookout: no look-out, no distances are sent"); })) << child_->Output();
  const auto num_looks = Count(kObstacleDistanceId);
  Until([] { return false; }, seconds(2));
  EXPECT_EQ(Count(kObstacleDistanceId), num_looks);
  scene_.has_tracks = true;
  ASSERT_TRUE(Until([&] { return Count(kObstacleDistanceId) > num_looks && Says("Lookout: the look-out is back"); })) << child_->Output();
  EXPECT_EQ(child_->Terminate(), 0) << child_->Output();
}

TEST_F(Autopilot, GetsPointsOverASerialPort) {
  ASSERT_TRUE(Runs()) << child_->Output();
  std::string bytes;
  ASSERT_TRUE(Until([&] { return (bytes += terminal_.Read()).size() > 2000; })) << child_->Output();
  // Up to the last whole frame.
  std::size_t end = 0;
  while (end + 12 <= bytes.size() && end + 12 + static_cast<std::uint8_t>(bytes[end + 1]) <= bytes.size())
    end += 12U + static_cast<std::uint8_t>(bytes[end + 1]);
  const auto frames = ReadMavlink(bytes.substr(0, end));
  EXPECT_GE(Only(kObstacleDistance3dId, frames).size(), 10U);
  EXPECT_GE(Only(kHeartbeatId, frames).size(), 1U);
  // Of what an autopilot says its heartbeat is counted, all else is dropped, and our frames go on.
  terminal_.Write(std::string("\xFD\x09\x00\x00", 4) + std::string(2000, '\x01') + "\n" + AutopilotHeartbeat());
  ASSERT_TRUE(Until([&] { return CountOf(health_, "output_serial_heartbeats") == 1; })) << health_.reason;
  const auto size = bytes.size();
  ASSERT_TRUE(Until([&] { return (bytes += terminal_.Read()).size() > size + 500; })) << child_->Output();
}

}  // namespace
}  // namespace lookout::system_test
