// lookout-page on a live bus: its files, live frames, who may ask, and an acknowledgement that reaches the bus.
#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "tests/support/live_scene.hpp"
#include "tests/support/page_browser.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
using std::chrono::seconds;

constexpr int kPort = 7668;
const std::string kToken = "0123456789abcdef0123456789abcdef";

class Page : public LiveScene {
 protected:
  Page() {
    std::ofstream(folder_ / "config/page.txtpb") << "token_file: 'token' look_back_folder: 'spool' foxglove {}\n";
    std::ofstream(folder_ / "config/token") << kToken << "\n";
    std::filesystem::permissions(folder_ / "config/token", std::filesystem::perms::owner_read);
    Start("page");
  }

  PageBrowser browser_{kPort};
};

TEST_F(Page, ServesItsFilesToWhoAsksForIt) {
  ASSERT_TRUE(Runs()) << child_->Output();
  const auto front = browser_.Ask("GET", "/");
  EXPECT_EQ(front.status, 200);
  EXPECT_NE(front.body.find("<!doctype html>"), std::string::npos) << front.body.substr(0, 200);
  EXPECT_NE(front.policy.find("default-src 'none'"), std::string::npos) << front.policy;
  EXPECT_EQ(browser_.Ask("GET", "/page.js").status, 200);
  EXPECT_EQ(browser_.Ask("GET", "/tiles.json").status, 204) << "a boat without chart tiles";
  EXPECT_EQ(browser_.Ask("GET", "/../../etc/passwd").status, 404);
  EXPECT_EQ(browser_.Ask("GET", "/", "", "evil.example:7668").status, 421);
  EXPECT_EQ(browser_.Ask("GET", "/", "", "", "http://evil.example").status, 403);
  EXPECT_EQ(child_->Output().find(kToken), std::string::npos) << "the token stands in the journal";
  EXPECT_EQ(child_->Terminate().value_or(-1), 0) << child_->Output();
}

TEST_F(Page, ShowsTheBusAndCarriesAnAcknowledgementBack) {
  ASSERT_TRUE(Runs()) << child_->Output();
  scene_.alerts = {PlotterScene::MakeAlert(41, 1)};
  PageTab tab(kPort);
  EXPECT_NE(tab.Read().bytes.find("\"may_acknowledge\":true"), std::string::npos);
  tab.Say(R"({"op":"watch","channels":["ALERTS"]})");
  Until([] { return false; }, seconds(1));
  auto frame = tab.Read();
  while (frame.is_text) frame = tab.Read();
  ASSERT_GT(frame.bytes.size(), 16U);
  const auto* begin = reinterpret_cast<const std::uint8_t*>(frame.bytes.data());
  const auto alerts = bus::Decode<alerts_t>({begin + 16, frame.bytes.size() - 16});
  ASSERT_TRUE(alerts);
  ASSERT_EQ(alerts->num_alerts, 1);
  const std::string body =
      "{\"alert_id\":" + std::to_string(alerts->alerts[0].id) + ",\"raised_utime_us\":" + std::to_string(alerts->alerts[0].raised_utime_us) + "}";
  EXPECT_EQ(browser_.Ask("POST", "/acknowledge", body, "", browser_.Origin()).status, 401);
  EXPECT_EQ(browser_.Ask("POST", "/acknowledge", body, "", browser_.Origin(), "0123456789abcdef0123456789abcdee").status, 401);
  EXPECT_EQ(browser_.Ask("POST", "/acknowledge", body, "", "", kToken).status, 403);
  EXPECT_EQ(browser_.Ask("POST", "/acknowledge", "{}", "", browser_.Origin(), kToken).status, 400);
  EXPECT_EQ(browser_.Ask("POST", "/acknowledge", body, "", browser_.Origin(), kToken).status, 202);
  EXPECT_TRUE(Until([this] { return !acknowledged_.empty(); })) << child_->Output();
  ASSERT_EQ(acknowledged_.size(), 1U);
  EXPECT_EQ(acknowledged_[0].source, "page");
  EXPECT_EQ(acknowledged_[0].alert_id, alerts->alerts[0].id);
  EXPECT_EQ(child_->Terminate().value_or(-1), 0) << child_->Output();
}

TEST_F(Page, ServesViewersOfFoxglovesProtocolOnAPortOfTheirOwn) {
  ASSERT_TRUE(Runs()) << child_->Output();
  constexpr int kFoxglovePort = 8765;
  const PageBrowser viewer(kFoxglovePort);
  EXPECT_EQ(viewer.Ask("GET", "/").status, 426) << "a WebSocket is wanted";
  EXPECT_EQ(viewer.Ask("GET", "/", "", "", "https://evil.example").status, 403);
  EXPECT_TRUE(Until([this] {
    return std::ranges::any_of(health_.counters, [](const auto& one) { return one.name == "foxglove_refused_origin" && one.count == 1; });
  })) << child_->Output();
  EXPECT_EQ(child_->Terminate().value_or(-1), 0) << child_->Output();
}

// It ended where its port was taken, and lookout-up ended the look-out with it.
TEST_F(Page, WaitsForAPortThatIsTakenAndSaysWhoHasIt) {
  ASSERT_TRUE(Runs()) << child_->Output();
  const auto first_pid = health_.pid;
  Child second(std::vector<std::string>{Bin("page"), "--config", (folder_ / "config").string()}, (folder_ / "second").string());
  const std::string taken =
      "the page cannot be served on 127.0.0.1 port 7668: the port is taken by lookout-page (pid " + std::to_string(first_pid) + ")";
  ASSERT_TRUE(Until([&] { return health_.pid != first_pid && health_.state == health_t::STATE_DEGRADED; })) << second.Output();
  EXPECT_NE(health_.reason.find(taken), std::string::npos) << health_.reason;
  EXPECT_NE(second.Output().find(taken), std::string::npos) << second.Output();
  EXPECT_EQ(child_->Terminate().value_or(-1), 0) << child_->Output();
  ASSERT_TRUE(Until([&] { return health_.pid != first_pid && health_.reason.find("cannot be served") == std::string::npos; })) << health_.reason;
  EXPECT_EQ(browser_.Ask("GET", "/").status, 200);
}

// 64 connections that ask for nothing kept every browser out while HEALTH was ok.
TEST_F(Page, IsThereForBrowsersBesideConnectionsThatAskForNothing) {
  ASSERT_TRUE(Runs()) << child_->Output();
  boost::asio::io_context context;
  std::vector<std::unique_ptr<boost::asio::ip::tcp::socket>> silent;
  const boost::asio::ip::tcp::endpoint page(boost::asio::ip::address_v4::loopback(), kPort);
  const auto connect = [&] {
    boost::system::error_code ignored;
    silent.push_back(std::make_unique<boost::asio::ip::tcp::socket>(context));
    silent.back()->connect(page, ignored);
  };
  for (int i = 0; i < 70; ++i) connect();
  for (int i = 0; i < 20; ++i) {
    connect();
    EXPECT_EQ(browser_.Ask("GET", "/").status, 200) << i;
  }
  ASSERT_TRUE(Until([&] { return health_.reason.find("64 connections at one time, ") != std::string::npos; })) << health_.reason;
  EXPECT_EQ(health_.state, health_t::STATE_DEGRADED);
}

}  // namespace
}  // namespace lookout::system_test
