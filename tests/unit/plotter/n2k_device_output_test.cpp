// What a gateway gets of a device, and what it makes of that which comes back.
#include "services/plotter/n2k_device_output.hpp"

#include <gtest/gtest.h>

#include "tests/unit/plotter/fixture.hpp"
#include "tests/unit/plotter/made_up.hpp"

namespace lookout::plotter {
namespace {

using namespace std::chrono_literals;
using test::KeepingLink;

class PlotterN2kDeviceOutput : public ::testing::Test {
 protected:
  PlotterN2kDeviceOutput() { Open(Destination::Kind::kTcpClient); }

  void Open(Destination::Kind kind) {
    auto link = std::make_unique<KeepingLink>();
    link_ = link.get();
    output_ =
        std::make_unique<N2kDeviceOutput>(OutputParams{.name = "n2k", .format = Format::kN2kDevice, .destination = {.kind = kind}}, std::move(link),
                                          2500ms, N2kIdentity{.name = N2kName(0x12345), .preferred_address = 35, .sent_pgns = {128520}});
    own_ = test::MakeOwnShip();
    targets_ = {test::MakeTarget(17)};
    numbers_.Assign(targets_, passed_);
  }
  Told ToldNow() { return {.passed = passed_, .own = own_, .targets = targets_, .numbers = numbers_, .notices = {}, .host_time = {}}; }
  // A gateway says at least what it sent for us.
  void Pass(std::chrono::milliseconds time, bool is_echoed = true) {
    for (const auto end = passed_ + time; passed_ < end;) {
      passed_ += 100ms;
      numbers_.Assign(targets_, passed_);
      if (is_echoed) Hear("17:33:21.107 T 09F80123 01");
      output_->TakeCommands(ToldNow());
      output_->TellOwnShip(ToldNow());
      output_->TellTargets(ToldNow());
      output_->TellNotices(ToldNow());
    }
  }
  void Hear(const std::string& line) { link_->received.push_back(line); }
  std::int64_t Count(const std::string& name) const {
    for (const auto& counter : output_->counters()) {
      if (counter.name == name) return counter.count;
    }
    return -100;
  }

  std::chrono::microseconds passed_{0};
  OwnShip own_;
  std::vector<Target> targets_;
  TargetNumbers numbers_{60s};
  KeepingLink* link_ = nullptr;
  std::unique_ptr<N2kDeviceOutput> output_;
};

TEST_F(PlotterN2kDeviceOutput, SendsNothingElseBeforeItsAddressIsClaimed) {
  Pass(200ms);
  ASSERT_EQ(link_->sent.size(), 2U);
  EXPECT_EQ(link_->sent.at(0), "18EAFFFE 00 EE 00\r\n");
  EXPECT_EQ(link_->sent.at(1), "18EEFF23 45 23 C1 FF 00 BE 78 C0\r\n");
  EXPECT_EQ(Count("output_n2k_address"), -1);
  Pass(1s);
  EXPECT_EQ(Count("output_n2k_address"), 35);
  EXPECT_FALSE(link_->With("09F80123 ").empty()) << "the own ship";
  ASSERT_FALSE(link_->With("09F60823 ").empty()) << "a target";
  EXPECT_EQ(output_->fault(), "");
}

TEST_F(PlotterN2kDeviceOutput, TellsTargetsAnewUnderItsNextAddress) {
  Pass(1s);
  link_->sent.clear();
  Hear("17:33:21.107 R 18EEFF23 01 00 00 00 00 00 00 C0");
  Pass(200ms);
  EXPECT_EQ(link_->sent.size(), 1U);
  EXPECT_EQ(link_->sent.front(), "18EEFF24 45 23 C1 FF 00 BE 78 C0\r\n");
  Pass(500ms);
  EXPECT_FALSE(link_->With("09F60824 ").empty());
  EXPECT_TRUE(link_->With("09F60823 ").empty());
  EXPECT_EQ(Count("output_n2k_addresses_lost"), 1);
}

TEST_F(PlotterN2kDeviceOutput, ClaimsAnewOnEachConnection) {
  Pass(1s);
  link_->sent.clear();
  ++link_->openings;
  Pass(2500ms);
  ASSERT_FALSE(link_->With("18EAFFFE 00 EE 00").empty());
  const auto claim = std::ranges::find(link_->sent, "18EAFFFE 00 EE 00\r\n");
  ASSERT_NE(claim + 1, link_->sent.end());
  EXPECT_TRUE((claim + 1)->starts_with("18EEFF23 "));
  ASSERT_GT(link_->sent.end() - claim, 2);
  EXPECT_TRUE((claim + 2)->starts_with("1DF01123 ")) << "nothing before the heartbeat: " << *(claim + 2);
}

TEST_F(PlotterN2kDeviceOutput, NamesAGatewayThatDoesNotAnswer) {
  Pass(9s, false);
  EXPECT_EQ(output_->fault(), "");
  Pass(2s, false);
  EXPECT_EQ(output_->fault(), "no RAW line has come from the gateway for 10 s: its server must speak RAW, in both directions");
  // Sentences of NMEA 0183 are none.
  Hear("$GPRMC,,V,,,,,,,,,,N*53");
  Pass(100ms, false);
  EXPECT_NE(output_->fault(), "");
  EXPECT_EQ(output_->num_refused(), 1);
  Pass(100ms);
  EXPECT_EQ(output_->fault(), "");
}

TEST_F(PlotterN2kDeviceOutput, ExpectsNoEchoOfAnInterface) {
  Open(Destination::Kind::kCan);
  Pass(20s, false);
  EXPECT_EQ(output_->fault(), "");
  EXPECT_EQ(Count("output_n2k_address"), 35);
}

TEST_F(PlotterN2kDeviceOutput, NamesAGatewayThatTakesOurAddressAway) {
  Pass(1s);
  Hear("17:33:21.107 T 18EEFF0A 45 23 C1 FF 00 BE 78 C0");
  Pass(100ms);
  EXPECT_EQ(output_->fault(), "the gateway sends under its own address 10 in place of ours: others take our messages for its own");
  Hear("17:33:21.107 T 18EEFF23 45 23 C1 FF 00 BE 78 C0");
  Pass(100ms);
  EXPECT_EQ(output_->fault(), "");
}

// Another program behind the same gateway is a device as well; its requests are not the network's, and ours come back.
TEST_F(PlotterN2kDeviceOutput, MindsClaimsOfProgramsBesideIt) {
  Pass(1s);
  link_->sent.clear();
  Hear("17:33:21.107 T 18EAFFFE 00 EE 00");
  Pass(100ms);
  EXPECT_TRUE(link_->With("18EE").empty());
  Hear("17:33:21.107 T 18EEFF23 01 00 00 00 00 00 00 C0");
  Pass(100ms);
  EXPECT_FALSE(link_->With("18EEFF24 ").empty());
}

TEST_F(PlotterN2kDeviceOutput, ReadsAllThatABusyNetworkSends) {
  Pass(1s);
  for (int i = 0; i < 60; ++i) Hear("17:33:21.107 R 09F80101 00 00 00 00 00 00 00 00");
  Hear("17:33:21.107 R 18EAFF01 14 F0 01");
  link_->sent.clear();
  output_->TakeCommands(ToldNow());
  EXPECT_TRUE(link_->received.empty());
  EXPECT_FALSE(link_->With("19F01423 ").empty());
}

}  // namespace
}  // namespace lookout::plotter
