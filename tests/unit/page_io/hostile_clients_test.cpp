// Browsers that say what no page of ours says.
#include <gtest/gtest.h>
#include <string>

#include "tests/unit/page_io/page_server.hpp"

namespace {

using namespace lookout;
using namespace lookout::page;
using namespace lookout::page::test;

class HostileClients : public PageServerTest {
 protected:
  // Whoever behaves is served as ever.
  void ExpectServed() {
    auto browser = OpenWatching();
    Publish("TRACKS", 1, "tracks");
    EXPECT_EQ(MessageOf(browser.Next()), "tracks");
  }
  std::string AnswerTo(const std::string& head) const { return Peer(server_->port()).Ask(head); }
};

TEST_F(HostileClients, OfAnotherPageGetNoSocket) {
  const Peer peer(server_->port());
  EXPECT_TRUE(AnswerTo(peer.Upgrade("http://evil.example")).starts_with("HTTP/1.1 403"));
  EXPECT_TRUE(AnswerTo(peer.Upgrade("null")).starts_with("HTTP/1.1 403"));
  EXPECT_TRUE(AnswerTo(peer.Upgrade("")).starts_with("HTTP/1.1 403"));
  EXPECT_EQ(CountOf(*server_, "clients"), 0);
  ExpectServed();
}

TEST_F(HostileClients, OfAnotherVersionGetNoSocket) {
  const Peer peer(server_->port());
  EXPECT_TRUE(AnswerTo(peer.Upgrade("http://" + peer.host(), "lookout.page.v2")).starts_with("HTTP/1.1 400"));
  EXPECT_TRUE(AnswerTo(peer.Upgrade("http://" + peer.host(), "")).starts_with("HTTP/1.1 400"));
}

TEST_F(HostileClients, ThatSendTooMuchAreClosed) {
  auto browser = Open();
  browser.Say(std::string(5000, ' '));
  EXPECT_EQ(browser.Next().close_code(), 1009);
  ExpectServed();
}

TEST_F(HostileClients, ThatClaimAFrameOfAHundredMegabytesAreClosedAtOnce) {
  auto browser = Open();
  browser.Write(ClientFrame(0x81, "x", 100'000'000));
  EXPECT_EQ(browser.Next().close_code(), 1009);
  ExpectServed();
}

TEST_F(HostileClients, ThatSendFragmentsWithoutEndAreClosed) {
  auto browser = Open();
  browser.Write(ClientFrame(0x01, "x", 1));
  for (int i = 0; i < 5000; ++i) {
    if (!browser.Write(ClientFrame(0x00, "x", 1))) break;
  }
  EXPECT_EQ(browser.Next().close_code(), 1009);
  ExpectServed();
}

TEST_F(HostileClients, ThatSendBytesAreClosed) {
  auto browser = Open();
  browser.Write(ClientFrame(0x82, "x", 1));
  EXPECT_EQ(browser.Next().close_code(), 1003);
  EXPECT_TRUE(Until([&] { return CountOf(*server_, "clients") == 0; }));
}

TEST_F(HostileClients, ThatKeepToNoProtocolAreClosed) {
  for (const auto& bytes : {ClientFrame(0x81, "x", 1, false), ClientFrame(0xF1, "x", 1), ClientFrame(0x83, "x", 1), ClientFrame(0x80, "x", 1),
                            ClientFrame(0x81, "\xFF\xFE", 2), std::string(1000, '\xAA'), std::string("GET / HTTP/1.1\r\n\r\n")}) {
    auto browser = Open();
    browser.Write(bytes);
    const auto code = browser.Next().close_code();
    EXPECT_TRUE(code == 1002 || code == 1007) << code;
  }
  EXPECT_TRUE(Until([&] { return CountOf(*server_, "clients") == 0; }));
  ExpectServed();
}

TEST_F(HostileClients, ThatSayWhatIsNoRequestAreToldTenTimes) {
  auto browser = Open();
  for (int i = 0; i < 11; ++i) browser.Say("garbage");
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(browser.Next().Holds("refused")) << i;
  EXPECT_EQ(browser.Next().close_code(), 1008);
}

TEST_F(HostileClients, ThatConfirmWhatWasNotSentAreClosed) {
  auto browser = OpenWatching();
  Publish("TRACKS", 1, "tracks");
  EXPECT_EQ(MessageOf(browser.Next()), "tracks");
  browser.Confirm(1);
  browser.Confirm(2);
  EXPECT_EQ(browser.Next().close_code(), 1002);
}

TEST_F(HostileClients, ThatAskAndNeverReadCostLittle) {
  auto browser = Open(4096);
  // Each is refused, and none of the refusals is read.
  const auto question = ClientFrame(0x81, AtText(1, 1), AtText(1, 1).size());
  int num_said = 0;
  while (num_said < 200'000 && browser.WriteNow(question, 1s)) ++num_said;
  EXPECT_LT(num_said, 200'000) << "the server goes on to listen";
  ExpectServed();
}

// What vanished without a word, or was stopped.
TEST_F(HostileClients, ThatAnswerNothingAreLetGo) {
  auto browser = Open();
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(Until([&] { return CountOf(*server_, "clients_silent") == 1 && CountOf(*server_, "clients") == 0; }, 25s));
  EXPECT_GT(std::chrono::steady_clock::now() - begin, 15s);
  EXPECT_TRUE(browser.Ends());
}

}  // namespace
