// What anybody can send to the port of the bus: no datagram ends a process, and with a time-to-live of 0 none of another computer is taken.
// Runs in a network namespace of its own. The test listens on a socket of its own: LCM's receiver is what is tried here.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/services.hpp"
#include "lookout/health_t.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/live_test.hpp"
#include "tests/support/socket.hpp"
#include "tests/system/lcm_datagrams.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr const char* kGroup = "239.255.76.67";
constexpr std::uint16_t kPort = 7667;
const std::vector<std::string> kServices = bus::StartOrder();

class Sender {
 public:
  Sender() { socket_.Set(SO_BROADCAST, 1); }
  bool Send(const Datagram& datagram, const std::string& to = kGroup) const { return socket_.SendTo(Ipv4(to, kPort), datagram); }

 private:
  Socket socket_{SOCK_DGRAM};
};

// HEALTH of all processes, without LCM.
class HealthListener {
 public:
  HealthListener() {
    if (!socket_.Bind(kPort, kGroup)) std::abort();
    const ip_mreq request{Ipv4(kGroup, kPort).sin_addr, {}};
    setsockopt(socket_.descriptor(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request);
  }

  // Takes what has come.
  void Listen() {
    std::array<std::uint8_t, 65536> buffer;
    for (;;) {
      const auto size = recv(socket_.descriptor(), buffer.data(), buffer.size(), MSG_DONTWAIT);
      if (size < 0) return;
      constexpr std::string_view kName("HEALTH\0", 7);
      const std::string_view text(reinterpret_cast<const char*>(buffer.data()), static_cast<std::size_t>(size));
      if (text.substr(0, 4) != "LC02" || text.size() < kShortHeaderBytes || text.substr(kShortHeaderBytes, kName.size()) != kName) continue;
      const auto message = bus::Decode<health_t>(Bytes(buffer).first(text.size()).subspan(kShortHeaderBytes + kName.size()));
      if (message) latest[message->process] = *message;
    }
  }

  std::map<std::string, health_t> latest;

 private:
  Socket socket_{SOCK_DGRAM};
};

class BusGuard : public LiveTest {
 protected:
  void SetUp() override { unsetenv("LCM_DEFAULT_URL"); }

  // All processes, lookout-top and lookout-doctor, up.
  void StartAll(HealthListener& listener) {
    for (const auto& service : kServices) Start(service);
    children_["top"] = std::make_unique<Child>(std::vector<std::string>{Bin("top"), "--once", "--seconds", "600"}, Output("top"));
    Start("doctor", {"--seconds", "600"});
    EXPECT_TRUE(WaitUntil([&] {
      listener.Listen();
      return listener.latest.size() == kServices.size();
    })) << "not all processes are heard";
    std::this_thread::sleep_for(milliseconds(500));  // lookout-top and lookout-doctor do not say when they listen
  }

  void ExpectAllRunning(const std::string& after) {
    for (const auto& [name, child] : children_) {
      EXPECT_TRUE(child->IsRunning()) << name << " ended with " << child->Wait(milliseconds(0)).value_or(-1) << " after " << after << ": "
                                      << child->Output();
    }
  }

  // Each says HEALTH anew.
  void ExpectAllHeard(HealthListener& listener) {
    listener.Listen();
    auto before = listener.latest;
    EXPECT_TRUE(WaitUntil([&] {
      listener.Listen();
      return std::ranges::all_of(kServices, [&](const auto& service) { return listener.latest[service].seq > before[service].seq + 1; });
    })) << "not all processes say HEALTH any more";
  }

  void EndAll() {
    for (const auto& service : kServices) {
      if (!children_.contains(service)) continue;
      EXPECT_EQ(children_[service]->Terminate().value_or(-1), 0) << service << ": " << children_[service]->Output();
    }
  }
};

TEST_F(BusGuard, NoDatagramEndsAProcess) {
  HealthListener listener;
  const Sender sender;
  StartAll(listener);
  for (const auto& hostile : HostileDatagrams()) {
    for (const char* to : {kGroup, "127.0.0.1", "127.255.255.255"}) sender.Send(hostile.datagram, to);
    std::this_thread::sleep_for(milliseconds(20));
    ExpectAllRunning(hostile.what);
    if (HasFailure()) return;
  }
  ExpectAllHeard(listener);
  for (const auto& service : kServices) {
    if (service == "lidar") continue;  // reads nothing from the bus
    EXPECT_GE(support::CountOf(listener.latest[service], "datagrams_dropped"), static_cast<std::int64_t>(HostileDatagrams().size()) - 1) << service;
  }
  ExpectAllRunning("all of them");
  EndAll();
}

TEST_F(BusGuard, ADatagramBeforeTheFirstMessageEndsNoProcessEither) {
  std::atomic<bool> is_over = false;
  std::thread flood([&] {
    const Sender sender;
    const auto hostile = HostileDatagrams();
    while (!is_over) {
      for (const auto& one : hostile) {
        for (const char* to : {kGroup, "127.0.0.1"}) sender.Send(one.datagram, to);
      }
    }
  });
  int num_dead = 0;
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    for (const std::string service : {"segmenter", "georeferencer", "tracker", "plotter", "page", "recorder"}) {
      Start(service);
      const auto& child = children_[service];
      WaitUntil([&] { return !child->IsRunning() || child->Output().find("starts, version") != std::string::npos; });
      std::this_thread::sleep_for(milliseconds(150));
      if (!child->IsRunning()) {
        ++num_dead;
        ADD_FAILURE() << service << " ended with " << child->Wait(milliseconds(0)).value_or(-1) << " at its start: " << child->Output();
      }
      children_.erase(service);
    }
  }
  is_over = true;
  flood.join();
  std::cout << num_dead << " of " << 3 * kRounds << " starts ended\n";
}

TEST_F(BusGuard, MutatedDatagramsEndNoProcess) {
  const char* wanted = std::getenv("LOOKOUT_BUS_DATAGRAMS");
  const long num_datagrams = wanted != nullptr ? std::strtol(wanted, nullptr, 10) : 30'000;
  HealthListener listener;
  const Sender sender;
  StartAll(listener);
  const auto sound = SoundDatagrams();
  std::mt19937 random(14);
  for (long i = 0; i < num_datagrams; ++i) {
    sender.Send(Mutated(sound, random));
    if (i % 200 == 199) std::this_thread::sleep_for(milliseconds(1));  // so that most are looked at, not lost
    if (i % 5000 == 4999) {
      listener.Listen();
      ExpectAllRunning(std::to_string(i + 1) + " mutated datagrams");
      if (HasFailure()) return;
    }
  }
  ExpectAllHeard(listener);
  ExpectAllRunning("all mutated datagrams");
  for (const auto& service : kServices) {
    std::cout << service << ": " << support::CountOf(listener.latest[service], "datagrams_dropped") << " dropped, resident "
              << listener.latest[service].resident_bytes / 1'000'000 << " MB\n";
  }
  EndAll();
}

TEST_F(BusGuard, AnAddressThatIsNoBusIsRefusedWithItsReason) {
  const std::vector<std::pair<std::string, std::string>> wrong{{"memq://", "stays inside one process"},
                                                               {"file:///dev/null", "is a log and no bus"},
                                                               {"udpm://239.255.76.67:7667?ttl=256", "ttl=256: 0 (this computer only) to 255"},
                                                               {"udpm://192.168.1.5:7667", "is no IPv4 multicast group"}};
  std::vector<std::string> programs = kServices;
  programs.insert(programs.end(), {"top", "doctor"});
  for (const auto& [url, reason] : wrong) {
    for (const auto& program : programs) {
      if (program == "doctor" && url != wrong.front().first) continue;  // it takes its time
      std::vector<std::string> options{"--lcm-url", url};
      if (program == "top") options.emplace_back("--once");
      if (program == "doctor") options.insert(options.end(), {"--seconds", "2"});
      if (program != "top") options.insert(options.end(), {"--config", Config()});
      options.insert(options.begin(), Bin(program));
      children_[program] = std::make_unique<Child>(options, Output(program));
      const auto& child = children_[program];
      // The doctor looks at all the rest too, and calls it a fault.
      EXPECT_EQ(child->Wait(seconds(20)).value_or(-1), program == "doctor" ? 1 : 2) << program << " " << url;
      auto output = child->Output();
      for (auto place = output.find('\n'); place != std::string::npos; place = output.find('\n')) {
        output.replace(place, output.find_first_not_of(" \n", place) - place, " ");  // the doctor wraps its lines
      }
      EXPECT_NE(output.find(reason), std::string::npos) << program << ": " << output;
      children_.erase(program);
    }
  }
}

// Another computer at the other end of a cable: a network namespace of its own.
class BusOnACable : public BusGuard {
 protected:
  std::unique_ptr<Child> second_;
  std::unique_ptr<Sender> outside_;

  void SetUp() override {
    BusGuard::SetUp();
    second_ = std::make_unique<Child>(std::vector<std::string>{"unshare", "--net", "sleep", "300"}, (folder_ / "second.out").string());
    const auto theirs = "/proc/" + std::to_string(second_->pid()) + "/ns/net";
    ASSERT_TRUE(WaitUntil([&] {
      std::error_code error;
      const auto link = fs::read_symlink(theirs, error);
      return !error && link != fs::read_symlink("/proc/self/ns/net", error);
    }));
    Run("ip link add cable1 type veth peer name cable2 netns " + std::to_string(second_->pid()));
    Run("ip addr add 10.76.0.1/24 dev cable1 && ip link set cable1 up && ip route replace 239.255.76.0/24 dev cable1");
    OnSecond("ip addr add 10.76.0.2/24 dev cable2 && ip link set cable2 up && ip route add 239.255.76.0/24 dev cable2");
    // A socket stays in the namespace in which it was made.
    std::thread([&] {
      const int there = open(theirs.c_str(), O_RDONLY | O_CLOEXEC);
      if (setns(there, CLONE_NEWNET) == 0) outside_ = std::make_unique<Sender>();
      close(there);
    }).join();
    ASSERT_TRUE(outside_);
  }
  void TearDown() override {
    Run("ip link del cable1; ip route replace 239.255.76.0/24 dev lo");
    second_.reset();
    unsetenv("LCM_DEFAULT_URL");
    BusGuard::TearDown();
  }

  void Run(const std::string& line) const {
    const auto result = RunProgram({"sh", "-c", line}, (folder_ / "ip.out").string());
    ASSERT_EQ(result.exit_code, 0) << line << ": " << result.output;
  }
  void OnSecond(const std::string& line) const { Run("nsenter --net --target " + std::to_string(second_->pid()) + " sh -c '" + line + "'"); }

  // Recorder and segmenter: the first hears the second.
  void StartTwo(HealthListener& listener) {
    Start("recorder");
    Start("segmenter");
    ASSERT_TRUE(WaitUntil([&] {
      listener.Listen();
      return listener.latest.size() == 2;
    }));
  }

  // The next HEALTH but one of the recorder: what came before is in it.
  static health_t Heard(HealthListener& listener) {
    listener.Listen();
    const auto seq = listener.latest["recorder"].seq;
    EXPECT_TRUE(WaitUntil([&] {
      listener.Listen();
      return listener.latest["recorder"].seq >= seq + 2;
    }));
    return listener.latest["recorder"];
  }
  static std::int64_t NumHealth(const health_t& health) {
    for (const auto& channel : health.channels) {
      if (channel.channel == "HEALTH" && channel.is_input != 0) return channel.num_messages;
    }
    return 0;
  }

  void SendFromOutside(const std::string& to, int count = 20) const {
    for (int i = 0; i < count; ++i) EXPECT_TRUE(outside_->Send(ShortDatagram(static_cast<std::uint32_t>(i), Named("FOREIGN"), 10), to)) << to;
  }
};

TEST_F(BusOnACable, WithATimeToLiveOf0OnlyThisComputerIsHeardWhateverItsAddress) {
  HealthListener listener;
  StartTwo(listener);
  const auto before = Heard(listener);
  for (const char* to : {kGroup, "10.76.0.1", "10.76.0.255"}) SendFromOutside(to);
  const auto after = Heard(listener);
  EXPECT_EQ(support::CountOf(after, "unknown_channel"), 0) << "datagrams of another computer were taken";
  EXPECT_GE(support::CountOf(after, "datagrams_dropped"), support::CountOf(before, "datagrams_dropped") + 40)
      << "the test's datagrams did not arrive";
  EXPECT_GT(NumHealth(after), NumHealth(before)) << "own messages are no longer taken";

  // A new lease: this computer has another address, and the other one takes the old.
  // The kernel takes nothing from where it has no way to.
  Run("ip addr add 10.99.0.7/24 dev cable1 && ip addr del 10.76.0.1/24 dev cable1 && ip route replace 239.255.76.0/24 dev cable1 && "
      "ip route add 10.76.0.0/24 dev cable1");
  OnSecond("ip addr del 10.76.0.2/24 dev cable2 && ip addr add 10.76.0.1/24 dev cable2 && ip route replace 239.255.76.0/24 dev cable2");
  SendFromOutside(kGroup);
  const auto moved = Heard(listener);
  EXPECT_EQ(support::CountOf(moved, "unknown_channel"), 0);
  EXPECT_GE(support::CountOf(moved, "datagrams_dropped"), support::CountOf(after, "datagrams_dropped") + 20);
  EXPECT_GE(NumHealth(moved), NumHealth(after) + 2) << "own messages are no longer taken";
  const Sender own;
  for (int i = 0; i < 10; ++i) own.Send(ShortDatagram(1, Named("OWN"), 1));
  EXPECT_EQ(support::CountOf(Heard(listener), "unknown_channel"), 10);
  EndAll();
}

TEST_F(BusOnACable, WithATimeToLiveOf1TheOtherComputerIsHeardOnTheGroupAlone) {
  setenv("LCM_DEFAULT_URL", "udpm://239.255.76.67:7667?ttl=1", 1);
  HealthListener listener;
  StartTwo(listener);
  for (const char* to : {"10.76.0.1", "10.76.0.255"}) SendFromOutside(to);
  EXPECT_EQ(support::CountOf(Heard(listener), "unknown_channel"), 0) << "datagrams were taken that were not sent to the group";
  SendFromOutside(kGroup);
  EXPECT_EQ(support::CountOf(Heard(listener), "unknown_channel"), 20);
  for (const auto& hostile : HostileDatagrams()) {
    for (const char* to : {kGroup, "10.76.0.1", "10.76.0.255"}) outside_->Send(hostile.datagram, to);
  }
  EXPECT_EQ(support::CountOf(Heard(listener), "unknown_channel"), 20);
  ExpectAllRunning("hostile datagrams of another computer");
  EndAll();
}

TEST_F(BusOnACable, TheDoctorNamesWhoListensThereWithoutAFilter) {
  const auto port_lines = [&] {
    const auto output =
        RunProgram({Bin("doctor"), "--config", (folder_ / "config").string(), "--seconds", "2"}, (folder_ / "doctor.out").string()).output;
    std::string lines;
    bool is_port = false;
    std::istringstream in(output);
    for (std::string line; std::getline(in, line);) {
      if (line.find_first_not_of(' ') == 0) is_port = line.find(" port ") != std::string::npos;
      if (is_port) lines += line + "\n";
    }
    return lines;
  };
  Start("segmenter");
  const auto guarded = port_lines();
  EXPECT_EQ(guarded.rfind("ok ", 0), 0U) << guarded;
  const HealthListener listener;
  const auto unguarded = port_lines();
  EXPECT_EQ(unguarded.rfind("warning ", 0), 0U) << unguarded;
  EXPECT_NE(unguarded.find("system_bus_guar"), std::string::npos) << unguarded;
  EXPECT_EQ(unguarded.find("lookout-segment"), std::string::npos) << unguarded;
}

}  // namespace
}  // namespace lookout::system_test
