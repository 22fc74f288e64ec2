// A serial port as it is: slow, unplugged, plugged in again as another device.
#include <pty.h>
#include <termios.h>

#include <filesystem>

#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"
#include "tests/support/pseudo_terminal.hpp"
#include "tests/unit/plotter_io/links_test.hpp"

namespace lookout::plotter {
namespace {

class SerialLinkTest : public LinksTest {
 protected:
  SerialLinkTest() { std::filesystem::create_directories(folder_); }
  void Open(int baud) { link_ = links_.Serial({.name = "radio", .device = path_.string(), .baud = baud}); }
  bool IsOpen() const { return link_->is_open(); }
  std::int64_t Of(const std::string& ending) const { return support::CountOf(*link_, "radio_" + ending); }

  support::TempDir folder_;
  std::filesystem::path path_ = folder_ / "radio";
  std::unique_ptr<Link> link_;
};

TEST_F(SerialLinkTest, SendsRawBytesAndReceivesLines) {
  const support::PseudoTerminal pty;
  pty.PlugInAs(path_);
  Open(38400);
  ASSERT_TRUE(Until([&] { return IsOpen() && link_->room_bytes() > 100; })) << link_->fault();
  // A terminal that is not raw would make CR LF of LF, and obey 0x03 and 0x13.
  const std::string text = "$A\x03\x13\r\n$B\n";
  link_->Send(text);
  EXPECT_TRUE(Until([&] { return Of("sent") == 1; }));
  EXPECT_EQ(pty.Read(), text);
  pty.Write("$RAACK,001*00\r\n$half");
  ASSERT_TRUE(Until([&] { return Of("received") == 1; }));
  EXPECT_EQ(link_->Receive(), "$RAACK,001*00");
  termios settings{};
  ASSERT_EQ(tcgetattr(pty.cable, &settings), 0);
  EXPECT_EQ(cfgetospeed(&settings), B38400);
  EXPECT_EQ(settings.c_cflag & (CSIZE | PARENB | CSTOPB), static_cast<tcflag_t>(CS8));
}

// Of MAVLink each byte counts, line ends and zeros as well.
TEST_F(SerialLinkTest, ReceivesBytesAsTheyAreWhereNoLinesAreWanted) {
  const support::PseudoTerminal pty;
  pty.PlugInAs(path_);
  link_ = links_.Serial({.name = "radio", .device = path_.string(), .baud = 115200, .is_binary = true});
  ASSERT_TRUE(Until([&] { return IsOpen(); })) << link_->fault();
  const std::string bytes("\xFD\x09\0\0\r\n\x03\x13\xFF", 9);
  pty.Write(bytes);
  std::string received;
  EXPECT_TRUE(Until([&] {
    while (const auto piece = link_->Receive()) received += *piece;
    return received.size() >= bytes.size();
  }));
  EXPECT_EQ(received, bytes);
}

TEST_F(SerialLinkTest, OpensAgainAfterItWasUnplugged) {
  auto first = std::make_unique<support::PseudoTerminal>();
  first->PlugInAs(path_);
  Open(4800);
  ASSERT_TRUE(Until([&] { return IsOpen(); })) << link_->fault();
  first->Unplug();
  std::filesystem::remove(path_);
  ASSERT_TRUE(Until([&] { return !IsOpen(); }));
  EXPECT_TRUE(Holds(link_->fault(), path_.string())) << link_->fault();
  EXPECT_TRUE(Until([&] { return Holds(link_->fault(), "No such file"); })) << link_->fault();
  EXPECT_EQ(link_->room_bytes(), 0U);
  link_->Send("$old\r\n");
  EXPECT_EQ(Of("unsent"), 1);
  const support::PseudoTerminal second;
  second.PlugInAs(path_);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(Until([&] { return IsOpen() && link_->room_bytes() >= 6; })) << link_->fault();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 1500ms);
  EXPECT_EQ(link_->num_openings(), 2);
  link_->Send("$new\r\n");
  EXPECT_TRUE(Until([&] { return Of("sent") == 1; }));
  EXPECT_EQ(second.Read(), "$new\r\n");
}

TEST_F(SerialLinkTest, HasRoomForWhatItsSpeedCarries) {
  const support::PseudoTerminal pty;
  pty.PlugInAs(path_);
  Open(9600);  // 960 bytes/s
  ASSERT_TRUE(Until([&] { return IsOpen(); }));
  const std::string line = std::string(48, 'a') + "\r\n";
  const auto begin = std::chrono::steady_clock::now();
  int num_bytes = 0;
  Until(
      [&] {
        while (link_->room_bytes() >= line.size()) {
          link_->Send(line);
          num_bytes += static_cast<int>(line.size());
        }
        pty.Read();
        return false;
      },
      2s);
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GT(num_bytes, 960 * elapsed_s - 200);
  EXPECT_LT(num_bytes, 960 * (elapsed_s + 0.6));
  EXPECT_EQ(Of("dropped"), 0);
}

TEST_F(SerialLinkTest, TellsWhenItsUnsentBytesHaveLeft) {
  const support::PseudoTerminal pty;
  pty.PlugInAs(path_);
  Open(9600);  // 960 bytes/s
  ASSERT_TRUE(Until([&] { return IsOpen() && link_->delay() == 0us; }));
  link_->Send(std::string(240, 'a'));
  EXPECT_GT(link_->delay(), 200ms);
  EXPECT_LE(link_->delay(), 250ms);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(Until([&] {
    pty.Read();
    return link_->delay() == 0us;
  }));
  EXPECT_GT(std::chrono::steady_clock::now() - begin, 200ms);
}

TEST_F(SerialLinkTest, DropsWhatItHasNoRoomFor) {
  const support::PseudoTerminal pty;
  pty.PlugInAs(path_);
  Open(4800);
  ASSERT_TRUE(Until([&] { return IsOpen() && link_->room_bytes() >= 80; }));
  for (int i = 0; i < 100; ++i) link_->Send(std::string(78, 'a') + "\r\n");
  EXPECT_TRUE(Until([&] { return Of("sent") + Of("dropped") == 100; }));
  EXPECT_LE(pty.Read().size(), 256U);
  // Never more than half a second of it, however long nothing was sent.
  PollFor(1s);
  EXPECT_LE(link_->room_bytes(), 256U);
  EXPECT_GT(link_->room_bytes(), 200U);
}

// A pseudo terminal holds some kB: a port that sends nothing on, as one whose adapter hangs.
TEST_F(SerialLinkTest, OpensAgainWhenThePortSendsNothingOn) {
  const support::PseudoTerminal pty;
  pty.PlugInAs(path_);
  Open(921600);
  ASSERT_TRUE(Until([&] { return IsOpen() && link_->room_bytes() > 40'000; }));
  link_->Send(std::string(40'000, 'a'));
  EXPECT_LT(link_->room_bytes(), 40'000U);
  ASSERT_TRUE(Until([&] { return !IsOpen(); }));
  EXPECT_TRUE(Until([&] { return Holds(link_->fault(), "is too slow"); }));
  EXPECT_EQ(Of("dropped"), 1);
  EXPECT_TRUE(Until([&] { return IsOpen(); }));
}

TEST_F(SerialLinkTest, SaysWhyItCannotBeOpened) {
  Open(4800);
  EXPECT_TRUE(Until([&] { return Holds(link_->fault(), "No such file"); })) << link_->fault();
  std::filesystem::create_directory(path_);
  EXPECT_TRUE(Until([&] { return Holds(link_->fault(), "Is a directory"); })) << link_->fault();
  std::filesystem::remove(path_);
  const support::PseudoTerminal pty;
  pty.PlugInAs(path_);
  Open(4801);
  EXPECT_TRUE(Until([&] { return Holds(link_->fault(), "4801 baud is none"); })) << link_->fault();
}

}  // namespace
}  // namespace lookout::plotter
