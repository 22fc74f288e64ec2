// Sources as they are on a boat: a serial port that is unplugged, servers that go and come back, gpsd, a file of sentences.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <thread>

#include "services/navigator/io/gpsd_client.hpp"
#include "services/navigator/io/serial_port.hpp"
#include "services/navigator/io/tcp_client.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"
#include "tests/support/pseudo_terminal.hpp"
#include "tests/support/socket.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using io::Source;
using namespace std::chrono_literals;

// Host time that goes a tenth of a second with each round: pauses between attempts take no real time.
class SourceTest : public ::testing::Test {
 protected:
  // What the source gives until it has given `size` bytes, or two seconds have gone by.
  std::string Take(Source& source, std::size_t size) {
    std::string text;
    for (int round = 0; round < 200 && text.size() < size; ++round) {
      Step(source);
      while (const auto piece = source.Receive(now_)) text.append(piece->bytes.begin(), piece->bytes.end());
      if (text.size() < size) std::this_thread::sleep_for(10ms);
    }
    return text;
  }
  bool Wait(Source& source, bool has_fault) {
    for (int round = 0; round < 200 && source.fault().empty() == has_fault; ++round) {
      Step(source);
      while (const auto piece = source.Receive(now_)) num_breaks_ += piece->kind == Source::Kind::kBreak ? 1 : 0;
      std::this_thread::sleep_for(10ms);
    }
    return source.fault().empty() != has_fault;
  }
  void Step(Source& source) {
    now_ += 100ms;
    source.Poll(now_);
  }
  static bool IsReadable(const Source& source) {
    pollfd waiting{source.file_descriptor(), POLLIN, 0};
    return poll(&waiting, 1, 2000) == 1;
  }

  Utime now_ = NoonPlus(0);
  int num_breaks_ = 0;  // that Wait saw
};

class SerialTest : public SourceTest {
 protected:
  SerialTest() { std::filesystem::create_directories(folder_); }
  std::unique_ptr<Source> Serial(int baud) const { return std::make_unique<SerialPort>("gnss", link_, baud); }

  support::TempDir folder_;
  std::filesystem::path link_ = folder_ / "gnss";
};

TEST_F(SerialTest, GivesTheBytesRawAndSetsThePort) {
  support::PseudoTerminal pty;
  ASSERT_GE(pty.cable, 0);
  pty.PlugInAs(link_);
  const auto source = Serial(38400);
  ASSERT_TRUE(Wait(*source, false)) << source->fault();
  // A terminal that is not raw would echo, turn CR into LF, and eat 0x03 and 0x13.
  const std::string text = std::string("$GPHDT,1.0,T*00\r\n\x03\x13\x11\x00\xFF\r", 23);
  pty.Write(text);
  EXPECT_TRUE(IsReadable(*source));
  EXPECT_EQ(Take(*source, text.size()), text);
  termios settings{};
  ASSERT_EQ(tcgetattr(pty.cable, &settings), 0);
  EXPECT_EQ(cfgetispeed(&settings), B38400);
  EXPECT_EQ(settings.c_cflag & (CSIZE | PARENB | CSTOPB), static_cast<tcflag_t>(CS8));
  EXPECT_EQ(settings.c_lflag & (ICANON | ECHO | ISIG), 0U);
  EXPECT_EQ(support::CountOf(*source, "gnss_bytes"), static_cast<std::int64_t>(text.size()));
}

TEST_F(SerialTest, OpensAgainAfterItWasUnplugged) {
  auto first = std::make_unique<support::PseudoTerminal>();
  first->PlugInAs(link_);
  const auto source = Serial(4800);
  const int file_descriptor = source->file_descriptor();
  ASSERT_TRUE(Wait(*source, false)) << source->fault();
  first->Write("$A\r\n$B");
  EXPECT_EQ(Take(*source, 6), "$A\r\n$B");
  first->Unplug();
  std::filesystem::remove(link_);
  ASSERT_TRUE(Wait(*source, true));
  EXPECT_EQ(num_breaks_, 1);
  EXPECT_NE(source->fault().find(link_.string()), std::string::npos) << source->fault();
  const support::PseudoTerminal second;
  second.PlugInAs(link_);
  ASSERT_TRUE(Wait(*source, false)) << source->fault();
  second.Write("$C\r\n");
  EXPECT_EQ(Take(*source, 4), "$C\r\n");
  EXPECT_EQ(source->file_descriptor(), file_descriptor);
  EXPECT_EQ(support::CountOf(*source, "gnss_lost"), 1);
  EXPECT_EQ(support::CountOf(*source, "gnss_opened"), 2);
}

TEST_F(SerialTest, SaysWhyItCannotBeOpened) {
  const auto source = Serial(4800);
  Step(*source);
  EXPECT_NE(source->fault().find("No such file"), std::string::npos) << source->fault();
  std::ofstream(link_) << "a file";
  EXPECT_FALSE(Wait(*source, false));
  EXPECT_NE(source->fault().find("is no serial port"), std::string::npos) << source->fault();
}

// A server on a free port of this computer.
struct Server {
  support::Socket listener{SOCK_STREAM};
  support::Socket client = support::Socket::Of(-1);
  int port = 0;

  explicit Server(int asked_port = 0) {
    EXPECT_TRUE(listener.Bind(asked_port) && listener.Listen());
    port = listener.port();
  }
  void Accept() { client = listener.Accept(); }
  void Drop() { client.Close(); }
  void Write(const std::string& text) const { client.Write(text); }
};

std::unique_ptr<Source> Tcp(int port) { return std::make_unique<TcpClient>("plotter", "127.0.0.1", port); }

TEST_F(SourceTest, TcpConnectsAgainWhenTheServerWasAway) {
  auto server = std::make_unique<Server>();
  const int port = server->port;
  const auto source = Tcp(port);
  ASSERT_TRUE(Wait(*source, false)) << source->fault();
  server->Accept();
  server->Write("$A\r\n");
  EXPECT_TRUE(IsReadable(*source));
  EXPECT_EQ(Take(*source, 4), "$A\r\n");
  server.reset();
  ASSERT_TRUE(Wait(*source, true));
  for (int i = 0; i < 30; ++i) Step(*source);
  EXPECT_NE(source->fault().find("Connection refused"), std::string::npos) << source->fault();
  server = std::make_unique<Server>(port);
  ASSERT_TRUE(Wait(*source, false)) << source->fault();
  server->Accept();
  server->Write("$B\r\n");
  EXPECT_EQ(Take(*source, 4), "$B\r\n");
  EXPECT_EQ(num_breaks_, 1);
  EXPECT_EQ(support::CountOf(*source, "plotter_lost"), 1);
  EXPECT_EQ(support::CountOf(*source, "plotter_opened"), 2);
}

TEST_F(SourceTest, TcpReportsNothingOfAConnectionThatIsMadeAtOnceAndEachChangeOnce) {
  auto server = std::make_unique<Server>();
  const auto source = Tcp(server->port);
  std::vector<std::string> changes;
  const auto poll = [&] {
    now_ += 100ms;
    if (const auto change = source->Poll(now_); !change.empty()) changes.push_back(change);
    while (source->Receive(now_)) {
    }
  };
  for (int round = 0; round < 5; ++round) poll();
  EXPECT_TRUE(source->fault().empty()) << source->fault();
  EXPECT_TRUE(changes.empty()) << changes.front();
  server->Accept();
  const int port = server->port;
  server.reset();
  for (int round = 0; round < 200 && changes.empty(); ++round) {
    poll();
    std::this_thread::sleep_for(10ms);
  }
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_NE(changes.back().find(": "), std::string::npos) << changes.back();
  for (int round = 0; round < 40; ++round) poll();
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_NE(changes.back().find("Connection refused"), std::string::npos) << changes.back();
  server = std::make_unique<Server>(port);
  for (int round = 0; round < 100 && changes.size() == 2; ++round) poll();
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_NE(changes.back().find(" is open"), std::string::npos) << changes.back();
}

TEST_F(SourceTest, TcpWaitsLongerAfterEachFailure) {
  int port = 0;
  {
    const Server gone;
    port = gone.port;
  }
  const auto source = Tcp(port);
  // The server that comes is found at the next attempt: within 8 s, not at once.
  for (int i = 0; i < 400; ++i) Step(*source);
  Server server(port);
  int num_steps = 0;
  while (!source->fault().empty() && num_steps < 100) {
    Step(*source);
    ++num_steps;
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_TRUE(source->fault().empty()) << source->fault();
  EXPECT_LE(num_steps, 83);
}

// What gpsd 3.22 says and does: a banner, reports as JSON, and after ?WATCH with nmea the sentences.
TEST_F(SourceTest, GpsdIsAskedForSentencesAndItsReportsAreLeftOut) {
  Server server;
  const auto source = std::make_unique<GpsdClient>("gpsd", "127.0.0.1", server.port);
  std::string command;
  std::thread gpsd([&] {
    server.Accept();  // the connection that tells that gpsd is there
    server.Accept();  // that of the library
    server.Write("{\"class\":\"VERSION\",\"release\":\"3.22\",\"rev\":\"3.22\",\"proto_major\":3,\"proto_minor\":14}\r\n");
    char text[256] = {};
    const auto size = recv(server.client.descriptor(), text, sizeof text - 1, 0);
    command.assign(text, static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    server.Write(
        "{\"class\":\"DEVICES\",\"devices\":[]}\r\n$GPHDT,1.0,T*00\r\n{\"class\":\"TPV\",\"mode\":1}\r\n$GPHDT,2.0,T*00\r\n!AIVDM,1\r\n$GPH");
    std::this_thread::sleep_for(100ms);
    server.Write("DT,3.0,T*00\r\n");
  });
  const std::string expected = "$GPHDT,1.0,T*00\n$GPHDT,2.0,T*00\n!AIVDM,1\n$GPHDT,3.0,T*00\n";
  std::string text;
  for (const char character : Take(*source, expected.size() + 4)) {
    if (character != '\r') text += character;
  }
  gpsd.join();
  EXPECT_EQ(text, expected);
  EXPECT_NE(command.find("?WATCH="), std::string::npos) << command;
  EXPECT_NE(command.find("\"nmea\":true"), std::string::npos) << command;
  server.Drop();
  EXPECT_TRUE(Wait(*source, true));
}

// The library holds what is not a whole line: it must not wait for the rest for ever, with a descriptor that stays readable.
TEST_F(SourceTest, GpsdThatEndsWithinALineOrNeverEndsOneIsLost) {
  for (const auto& text : {std::string("$GPHDT,1.0,T*00\r\n$GPH"), std::string(100'000, '$')}) {
    Server server;
    const auto source = std::make_unique<GpsdClient>("gpsd", "127.0.0.1", server.port);
    std::thread gpsd([&] {
      server.Accept();
      server.Accept();
      char command[256] = {};
      recv(server.client.descriptor(), command, sizeof command, 0);
      server.Write(text);
      if (text.size() < 100) server.Drop();
    });
    for (int round = 0; round < 200 && support::CountOf(*source, "gpsd_lost") == 0; ++round) {
      Step(*source);
      while (source->Receive(now_)) {
      }
      std::this_thread::sleep_for(10ms);
    }
    EXPECT_EQ(support::CountOf(*source, "gpsd_lost"), 1) << text.substr(0, 30);
    gpsd.join();
  }
}

// The real gpsd, fed by a pseudo terminal.
TEST_F(SourceTest, GpsdPassesTheSentencesOfAReceiverOn) {
  // Installed, or as ./dev test unpacks it.
  std::string program = "/usr/sbin/gpsd";
  if (access(program.c_str(), X_OK) != 0) program = (support::kSources / "build/gpsd/usr/sbin/gpsd").string();
  if (access(program.c_str(), X_OK) != 0) GTEST_SKIP() << program << " is not at hand (package gpsd)";
  const support::PseudoTerminal pty;
  int port = 0;
  {
    const Server free_port;
    port = free_port.port;
  }
  const pid_t child = fork();
  if (child == 0) {
    const int null = open("/dev/null", O_RDWR);
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
    const auto port_text = std::to_string(port);
    execl(program.c_str(), "gpsd", "-N", "-n", "-b", "-S", port_text.c_str(), pty.device.c_str(), nullptr);
    _exit(127);
  }
  const auto line = RmcLine(NoonPlus(0), 50.0, 8.0, 2.0, 30.0) + "\r\n";
  const auto source = std::make_unique<GpsdClient>("gpsd", "127.0.0.1", port);
  std::string text;
  for (int round = 0; round < 600 && text.find(line.substr(0, line.size() - 2)) == std::string::npos; ++round) {
    if (round % 10 == 0) pty.Write(line);
    Step(*source);
    while (const auto piece = source->Receive(now_)) text.append(piece->bytes.begin(), piece->bytes.end());
    std::this_thread::sleep_for(10ms);
  }
  kill(child, SIGTERM);
  waitpid(child, nullptr, 0);
  EXPECT_NE(text.find(line.substr(0, line.size() - 2)), std::string::npos) << source->fault() << "\n" << text;
}

}  // namespace
}  // namespace lookout::navigator
