// A second boat on the bus: its navigator sends POSE beside the own one, from 7 km away. Obstacles stay where they are, everybody says so, and the
// log is known to stand outside the proof.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/health_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/support/live_test.hpp"
#include "tests/support/socket.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr int kOtherPort = 10111;
constexpr double kOtherNorthDeg = 0.063;  // 7 km
constexpr double kMetresPerDeg = 111'000.0;

// Sentences of a boat that lies at one place, ten times a second.
class Talker {
 public:
  Talker(double latitude_deg, double longitude_deg) : thread_([=, this] { Run(latitude_deg, longitude_deg); }) {}
  ~Talker() {
    is_over_ = true;
    thread_.join();
  }
  Talker(const Talker&) = delete;
  Talker& operator=(const Talker&) = delete;

 private:
  static std::string Sentence(const std::string& body) {
    unsigned checksum = 0;
    for (const char letter : body) checksum ^= static_cast<unsigned char>(letter);
    std::array<char, 8> end{};
    std::snprintf(end.data(), end.size(), "*%02X\r\n", checksum);
    return "$" + body + end.data();
  }
  static std::string Angle(double angle_deg, const char* form, char positive, char negative) {
    const double size_deg = std::abs(angle_deg);
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), form, static_cast<int>(size_deg), 60.0 * (size_deg - std::floor(size_deg)),
                  angle_deg < 0.0 ? negative : positive);
    return text.data();
  }
  void Run(double latitude_deg, double longitude_deg) {
    const Socket socket(SOCK_DGRAM);
    const auto target = Ipv4("127.0.0.1", kOtherPort);
    while (!is_over_) {
      const auto now = std::chrono::time_point_cast<milliseconds>(std::chrono::system_clock::now());
      const auto time = static_cast<std::time_t>(now.time_since_epoch().count() / 1000);
      std::tm utc{};
      gmtime_r(&time, &utc);
      std::array<char, 16> clock{};
      std::array<char, 16> date{};
      std::array<char, 16> hundredths{};
      std::strftime(clock.data(), clock.size(), "%H%M%S", &utc);
      std::strftime(date.data(), date.size(), "%d%m%y", &utc);
      std::snprintf(hundredths.data(), hundredths.size(), ".%02u", static_cast<unsigned>(now.time_since_epoch().count() % 1000 / 10) % 100U);
      const std::string utc_text = std::string(clock.data()) + hundredths.data();
      const std::string place = Angle(latitude_deg, "%02d%09.6f,%c", 'N', 'S') + "," + Angle(longitude_deg, "%03d%09.6f,%c", 'E', 'W');
      const std::string text = Sentence("GPRMC," + utc_text + ",A," + place + ",0.0,0.0," + date.data() + ",,,A") +
                               Sentence("GPGGA," + utc_text + "," + place + ",4,12,0.7,10.0,M,0.0,M,,") + Sentence("HEHDT,90.0,T");
      socket.SendTo(target, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
      std::this_thread::sleep_for(milliseconds(100));
    }
  }
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

class TwoPublishers : public LiveTest {
 protected:
  std::map<std::string, health_t> health_;  // by process and pid
  std::unique_ptr<bus::LcmBus> lcm_;
  std::optional<std::pair<double, double>> first_place_deg_;
  std::int64_t num_placed_ = 0;
  std::int64_t num_off_ = 0;
  double greatest_off_m_ = 0.0;

  void SetUp() override {
    fs::copy(folder_ / "config", folder_ / "other");
    ReplaceIn(folder_ / "other/navigator.txtpb", "use_lidar_nmea: true", "use_lidar_nmea: false nmea_port: " + std::to_string(kOtherPort));

    lcm_ = std::make_unique<bus::LcmBus>(bus::DefaultLcmUrl());
    lcm_->SubscribeRaw(bus::kHealth, [this](std::string_view, Bytes bytes) {
      if (auto message = bus::Decode<health_t>(bytes)) health_[message->process + " " + std::to_string(message->pid)] = std::move(*message);
    });
    lcm_->SubscribeRaw(bus::kObstacles, [this](std::string_view, Bytes bytes) {
      if (const auto message = bus::Decode<obstacles_t>(bytes)) Judge(*message);
    });
    lcm_->HandleOnce(milliseconds(0));
  }
  // The lidar sees 130 m, and the boat sails a few metres a second: no obstacle of this run is a kilometre from the first.
  double OffMetres(const obstacle_t& obstacle) const {
    return kMetresPerDeg * std::hypot(obstacle.latitude_deg - first_place_deg_->first,
                                      std::cos(obstacle.latitude_deg * 3.14159 / 180.0) * (obstacle.longitude_deg - first_place_deg_->second));
  }
  void Judge(const obstacles_t& message) {
    for (const auto& obstacle : message.obstacles) {
      if (obstacle.status != obstacle_t::STATUS_OK) continue;
      if (!first_place_deg_) first_place_deg_.emplace(obstacle.latitude_deg, obstacle.longitude_deg);
      ++num_placed_;
      greatest_off_m_ = std::max(greatest_off_m_, OffMetres(obstacle));
      if (OffMetres(obstacle) > 1000.0) ++num_off_;
    }
  }

  bool WaitUntil(const std::function<bool()>& is_true, milliseconds most = seconds(30)) { return HandleUntil(*lcm_, is_true, most); }
  void Start(const std::string& name, const std::string& program, const std::string& config) {
    children_[name] = std::make_unique<Child>(std::vector<std::string>{Bin(program), "--config", (folder_ / config).string()}, name + ".out");
  }
  const health_t* HealthOf(const std::string& name) const {
    const auto child = children_.find(name);
    for (const auto& [key, health] : health_) {
      if (health.pid == child->second->pid()) return &health;
    }
    return nullptr;
  }
  std::string ReasonOf(const std::string& name) const {
    const auto* health = HealthOf(name);
    return health == nullptr ? "" : health->reason;
  }
};

TEST_F(TwoPublishers, OfPoseNoObstacleIsPlacedByTheSecondAndAllIsToldOf) {
  for (const std::string name : {"recorder", "georeferencer", "segmenter", "navigator", "lidar"}) Start(name, name, "config");
  ASSERT_TRUE(WaitUntil([&] { return health_.size() == 5; }));
  Child sim({Bin("sim"), "--config", "config", "--scene", "lake", "--seed", "3", "--seconds", "60", "--udp", "127.0.0.1"}, "sim.out");
  ASSERT_TRUE(WaitUntil([&] { return num_placed_ >= 50; })) << sim.Output();
  EXPECT_EQ(ReasonOf("georeferencer").find("two publishers"), std::string::npos) << ReasonOf("georeferencer");

  // The other boat comes, speaks for some seconds, and goes.
  {
    const Talker talker(first_place_deg_->first + kOtherNorthDeg, first_place_deg_->second);
    Start("other", "navigator", "other");
    const auto placed_before = num_placed_;
    EXPECT_TRUE(WaitUntil([&] { return ReasonOf("georeferencer").find("POSE has two publishers") != std::string::npos; }, seconds(10)))
        << ReasonOf("georeferencer");
    EXPECT_TRUE(WaitUntil([&] { return ReasonOf("recorder").find("POSE") != std::string::npos; }, seconds(5))) << ReasonOf("recorder");
    WaitUntil([] { return false; }, seconds(4));
    EXPECT_GT(num_placed_, placed_before + 50) << "obstacles are placed no more";
    ASSERT_NE(HealthOf("other"), nullptr);
    EXPECT_NE(HealthOf("navigator"), nullptr);
    EXPECT_EQ(children_["other"]->Terminate().value_or(-1), 0) << children_["other"]->Output();
  }
  WaitUntil([] { return false; }, milliseconds(500));
  EXPECT_EQ(num_off_, 0) << "of " << num_placed_ << " placed obstacles; the furthest is off by " << greatest_off_m_ << " m";
  std::cout << num_placed_ << " obstacles placed, " << num_off_ << " off, the furthest " << greatest_off_m_ << " m from the first\n";

  sim.Terminate();
  for (const std::string name : {"lidar", "navigator", "segmenter", "georeferencer", "recorder"}) {
    EXPECT_EQ(children_[name]->Terminate().value_or(-1), 0) << name << ": " << children_[name]->Output();
  }
  fs::path log;
  for (const auto& entry : fs::directory_iterator("logs")) log = entry.path();

  const auto info = RunProgram({Bin("log"), "info", log.string()}, "info.out");
  EXPECT_EQ(info.exit_code, 0) << info.output;
  EXPECT_NE(info.output.find("two publishers of NAV_RAW"), std::string::npos) << info.output;
  EXPECT_NE(info.output.find("two publishers of POSE"), std::string::npos) << info.output;
  const auto replay = RunProgram({Bin("replay"), "--config", "config", "--in", log.string(), "--out", "again"}, "replay.out");
  EXPECT_EQ(replay.exit_code, 0) << replay.output;
  EXPECT_NE(replay.output.find("NAV_RAW has two publishers"), std::string::npos) << replay.output;
  const auto diff = RunProgram({Bin("diff"), log.string(), "again"}, "diff.out");
  EXPECT_EQ(diff.exit_code, 1) << diff.output;
  EXPECT_NE(diff.output.find("two publishers of NAV_RAW"), std::string::npos) << diff.output;

  // The replay keeps the stream first heard, too.
  num_off_ = num_placed_ = 0;
  bus::LogReader reader("again");
  while (const auto event = reader.Next()) {
    if (event->channel != "OBSTACLES") continue;
    if (const auto message = bus::Decode<obstacles_t>(event->bytes)) Judge(*message);
  }
  EXPECT_GT(num_placed_, 50);
  EXPECT_EQ(num_off_, 0);
}

}  // namespace
}  // namespace lookout::system_test
