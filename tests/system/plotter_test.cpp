// lookout-plotter on a live bus, with receivers on loopback: what they get, what a slow one costs, and what is told when nobody looks.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "services/plotter/core/nmea0183.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/live_scene.hpp"
#include "tests/support/socket.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr int kTcpPort = 10111;
constexpr int kUdpPort = 10112;
constexpr int kSignalKPort = 10113;
constexpr int kGatewayPort = 10114;

// Reads what comes over a socket, when asked.
class Receiver {
 public:
  explicit Receiver(int type, int receive_buffer_bytes = 0, int tcp_port = kTcpPort) : socket_(type) {
    if (receive_buffer_bytes > 0) socket_.Set(SO_RCVBUF, receive_buffer_bytes);
    EXPECT_TRUE(type == SOCK_STREAM ? socket_.Connect(tcp_port) : socket_.Bind(kUdpPort));
  }

  const std::string& Read() { return text_ += socket_.Read(); }
  void Clear() { text_.clear(); }
  void Write(const std::string& text) { socket_.Write(text); }

 private:
  Socket socket_;
  std::string text_;
};

std::int64_t NumOf(const std::string& text, const std::string& piece) {
  std::int64_t number = 0;
  for (auto place = text.find(piece); place != std::string::npos; place = text.find(piece, place + 1)) ++number;
  return number;
}

class Plotter : public LiveScene {
 protected:
  Plotter() {
    std::ofstream(folder_ / "config/plotter.txtpb")
        << "output { name: 'tcp' format: NMEA0183 alerts: ALR takes_acknowledgements: true tcp_server { bind_address: '127.0.0.1' port: " << kTcpPort
        << " } }\noutput { name: 'udp' format: SIGNALK udp { address: '127.0.0.1' port: " << kUdpPort << " } }\n"
        << "output { name: 'sk' format: SIGNALK tcp_server { bind_address: '127.0.0.1' port: " << kSignalKPort << " } }\n"
        << "output { name: 'n2k' format: N2K_DEVICE tcp_client { address: '127.0.0.1' port: " << kGatewayPort << " } }\n"
        << "output { name: 'gone' format: N2K_YDEN tcp_client { address: '127.0.0.1' port: 9 } }\n";
    Start("plotter");
  }
  std::int64_t Count(const std::string& name) const { return CountOf(health_, name); }
};

TEST_F(Plotter, SendsToEachReceiverInItsLanguage) {
  ASSERT_TRUE(Runs()) << child_->Output();
  Receiver tcp(SOCK_STREAM);
  Receiver udp(SOCK_DGRAM);
  scene_.num_tracks = 3;
  ASSERT_TRUE(Until([&] { return NumOf(tcp.Read(), "$RATTM,02,") >= 2; })) << tcp.Read() << child_->Output();
  EXPECT_GE(NumOf(tcp.Read(), "$IIRMC,"), 2);
  EXPECT_EQ(NumOf(tcp.Read(), "\r\n"), NumOf(tcp.Read(), "$"));
  ASSERT_TRUE(Until([&] { return NumOf(udp.Read(), "\"targets.lidar:demo-3\"") >= 2; })) << udp.Read();
  // What nobody takes is told, by name.
  ASSERT_TRUE(Until([&] { return health_.reason.find("output 'gone': ") != std::string::npos; })) << health_.reason;

  scene_.num_tracks = 2;
  ASSERT_TRUE(Until([&] { return NumOf(tcp.Read(), ",L,") == 1; })) << tcp.Read();
  EXPECT_EQ(child_->Terminate(), 0) << child_->Output();
}

TEST_F(Plotter, IsADeviceBehindAGateway) {
  const Socket gateway(SOCK_STREAM);
  ASSERT_TRUE(gateway.Bind(kGatewayPort) && gateway.Listen());
  ASSERT_TRUE(Runs()) << child_->Output();
  ASSERT_TRUE(Until([&] { return gateway.IsReadable(); })) << health_.reason;
  Socket network = gateway.Accept();
  std::string text;
  const auto comes = [&](const std::string& line) { return Until([&] { return NumOf(text += network.Read(), line) > 0; }); };
  ASSERT_TRUE(comes("18EEFF23 ")) << text;  // claims address 35
  ASSERT_TRUE(comes("09F60823 ")) << text;  // a target
  EXPECT_LT(text.find("18EEFF23 "), text.find("09F60823 "));
  EXPECT_EQ(text.find("18EAFFFE 00 EE 00\r\n"), 0U);
  network.Write("17:33:21.107 R 18EAFF01 14 F0 01\r\n");
  EXPECT_TRUE(comes("19F01423 ")) << text;  // product information
  network.Write("17:33:21.107 R 18EEFF23 01 00 00 00 00 00 00 C0\r\n");
  EXPECT_TRUE(comes("09F60824 ")) << text;
  EXPECT_TRUE(Until([&] { return Count("output_n2k_address") == 36; }));
}

// It ended where a port was taken, and lookout-up ended the look-out with it.
TEST_F(Plotter, WaitsForAPortThatIsTakenAndServesTheOthers) {
  ASSERT_TRUE(Runs()) << child_->Output();
  EXPECT_EQ(child_->Terminate(), 0);
  const int holder = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(holder, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(kTcpPort);
  ASSERT_EQ(bind(holder, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ASSERT_EQ(listen(holder, 8), 0);
  const auto first_pid = health_.pid;
  Start("plotter", "second");
  const std::string taken = "output 'tcp': TCP server at 127.0.0.1 port 10111: the port is taken by ";
  ASSERT_TRUE(Until([&] { return health_.pid != first_pid && health_.reason.find(taken) != std::string::npos; })) << child_->Output();
  EXPECT_NE(health_.reason.find("(pid " + std::to_string(getpid()) + ")"), std::string::npos) << health_.reason;
  Receiver others(SOCK_STREAM, 0, kSignalKPort);
  ASSERT_TRUE(Until([&] { return NumOf(others.Read(), "\"targets.lidar:demo-1\"") >= 1; })) << others.Read();
  close(holder);
  ASSERT_TRUE(Until([&] { return health_.reason.find("output 'tcp'") == std::string::npos; })) << health_.reason;
  Receiver tcp(SOCK_STREAM);
  EXPECT_TRUE(Until([&] { return NumOf(tcp.Read(), "$RATTM,") >= 1; })) << tcp.Read();
}

// A receiver that is off kept HEALTH degraded for good, and took the lines of real reasons.
TEST_F(Plotter, TakesAUdpReceiverThatIsOffForNoFault) {
  ASSERT_TRUE(Runs()) << child_->Output();
  ASSERT_TRUE(Until([&] { return Count("output_udp_unheard") >= 2; })) << child_->Output();
  EXPECT_EQ(health_.reason.find("output 'udp'"), std::string::npos) << health_.reason;
  EXPECT_TRUE(Until([&] { return child_->Output().find("output 'udp': nobody listens at 127.0.0.1 port 10112") != std::string::npos; }))
      << child_->Output();
}

TEST_F(Plotter, ToldToStopStopsAndSaysWhy) {
  ASSERT_TRUE(Runs()) << child_->Output();
  Receiver tcp(SOCK_STREAM);
  ASSERT_TRUE(Until([&] { return NumOf(tcp.Read(), "$RATTM,") >= 1; })) << tcp.Read();
  scene_.has_alerts = false;
  ASSERT_TRUE(Until([&] { return NumOf(tcp.Read(), ",998,A,V,no look-out") == 1; })) << tcp.Read();
  tcp.Clear();
  Until([] { return false; }, seconds(4));
  EXPECT_EQ(NumOf(tcp.Read(), "$RATTM,"), 0) << tcp.Read();
  EXPECT_GE(NumOf(tcp.Read(), "$IIRMC,"), 2);
  scene_.has_alerts = true;
  ASSERT_TRUE(Until([&] { return NumOf(tcp.Read(), "$RATTM,") >= 1; })) << tcp.Read();
  EXPECT_EQ(NumOf(tcp.Read(), ",998,V,A,"), 1) << tcp.Read();
}

TEST_F(Plotter, LetsAlertsBeAcknowledged) {
  ASSERT_TRUE(Runs()) << child_->Output();
  Receiver tcp(SOCK_STREAM);
  scene_.alerts = {PlotterScene::MakeAlert(41, 1)};
  ASSERT_TRUE(Until([&] { return NumOf(tcp.Read(), "$RAALR,") >= 1; })) << tcp.Read();
  tcp.Write("garbage\r\n\x01\x02\r\n" + plotter::Sentence("IIACK,041"));
  ASSERT_TRUE(Until([&] { return !acknowledged_.empty(); })) << child_->Output();
  EXPECT_EQ(acknowledged_.front().alert_id, 41);
  EXPECT_EQ(acknowledged_.front().source, "plotter");
}

// One client never reads, while 200 targets are sent; the other gets all.
TEST_F(Plotter, DropsAClientThatDoesNotReadAndNoOther) {
  ASSERT_TRUE(Runs()) << child_->Output();
  Receiver reader(SOCK_STREAM);
  const Receiver stuck(SOCK_STREAM, 2048);
  scene_.num_tracks = 200;
  const auto is_dropped = [&] {
    reader.Read();
    return Count("output_tcp_clients_dropped") == 1;
  };
  ASSERT_TRUE(Until(is_dropped, seconds(60))) << health_.reason;
  EXPECT_EQ(Count("output_tcp_clients"), 1);
  reader.Clear();
  ASSERT_TRUE(Until([&] { return NumOf(reader.Read(), "$RATTM,") >= 160; })) << reader.Read();
}

// More bytes than a connection or a receiver's buffer takes at once.
TEST_F(Plotter, SendsFiveHundredTargetsToWhoReads) {
  ASSERT_TRUE(Runs()) << child_->Output();
  Receiver tcp(SOCK_STREAM, 0, kSignalKPort);
  Receiver udp(SOCK_DGRAM);
  scene_.num_tracks = 500;
  const auto has_all = [](const std::string& text) {
    for (int id = 1; id <= 500; ++id) {
      if (text.find("\"targets.lidar:demo-" + std::to_string(id) + "\"") == std::string::npos) return false;
    }
    return true;
  };
  const auto end = Clock::now() + seconds(4);
  Until([&] {
    tcp.Read();
    udp.Read();
    return Clock::now() > end;
  });
  EXPECT_TRUE(has_all(tcp.Read()));
  EXPECT_TRUE(has_all(udp.Read()));
  EXPECT_EQ(Count("output_sk_dropped"), 0);
  EXPECT_EQ(Count("output_sk_clients"), 1);
}

}  // namespace
}  // namespace lookout::system_test
