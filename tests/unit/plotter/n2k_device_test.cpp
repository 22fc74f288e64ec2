// The claim of an address, with hand-drawn contention. Frames are written as RAW text: what is sent, and what comes.
#include "services/plotter/core/n2k_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

namespace lookout::plotter {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kOurName = 0xC078BE00FFC12345;
// In the order of their numbers: the lower wins.
const std::string kLower = "44 23 C1 FF 00 BE 78 C0";
const std::string kOurs = "45 23 C1 FF 00 BE 78 C0";
const std::string kHigher = "46 23 C1 FF 00 BE 78 C0";

class PlotterN2kDevice : public ::testing::Test {
 protected:
  N2kDevice device_{
      {.name = kOurName, .preferred_address = 35, .model = "Model", .software_version = "0.1", .serial_number = "74565", .sent_pgns = {128520}}};
  std::chrono::milliseconds now_{1000};

  // What is sent, a line for each frame.
  std::string Sent() {
    std::string lines;
    for (const auto& [message, source] : device_.TakeSendings()) {
      for (const auto& frame : FramesOf(message, source, 0)) lines += RawLine(frame);
    }
    return lines;
  }
  std::string After(std::chrono::milliseconds time) {
    for (const auto end = now_ + time; now_ < end;) {
      now_ += 10ms;
      device_.Advance(now_);
    }
    return Sent();
  }
  bool Hear(const std::string& line) { return device_.Take(*ReadRawLine(line), now_); }
  std::string Answer(const std::string& line) {
    EXPECT_TRUE(Hear(line)) << line;
    return Sent();
  }
  void ClaimAddress() {
    device_.Begin(now_);
    After(300ms);
    ASSERT_TRUE(device_.is_claimed());
  }
};

// As canboatjs packs the same fields.
TEST_F(PlotterN2kDevice, HasANameOfItsBoat) {
  EXPECT_EQ(N2kName(0x12345), kOurName);
  EXPECT_EQ(N2kName(0x12345 | 1U << 21U), kOurName);
  EXPECT_EQ(UniqueNumberOf("demo/n2k"), UniqueNumberOf("demo/n2k"));
  EXPECT_NE(UniqueNumberOf("demo/n2k"), UniqueNumberOf("demo/n2l"));
  EXPECT_LE(UniqueNumberOf(""), 0x1F'FFFFU);
}

TEST_F(PlotterN2kDevice, AsksWhoIsThereAndClaimsItsAddress) {
  EXPECT_EQ(After(1s), "");
  device_.Begin(now_);
  EXPECT_EQ(Sent(), "18EAFFFE 00 EE 00\r\n18EEFF23 " + kOurs + "\r\n");
  EXPECT_EQ(After(240ms), "");
  EXPECT_FALSE(device_.is_claimed());
  // Nobody has contended for 250 ms: it is ours, and a heartbeat says so.
  EXPECT_EQ(After(10ms), "1DF01123 70 17 00 CF FF FF FF FF\r\n");
  EXPECT_TRUE(device_.is_claimed());
  EXPECT_EQ(device_.address(), 35);
}

TEST_F(PlotterN2kDevice, KeepsItsAddressAgainstAHigherName) {
  device_.Begin(now_);
  Sent();
  EXPECT_EQ(Answer("18EEFF23 " + kHigher), "18EEFF23 " + kOurs + "\r\n");
  After(300ms);
  EXPECT_TRUE(device_.is_claimed());
  EXPECT_EQ(Answer("18EEFF23 " + kHigher), "18EEFF23 " + kOurs + "\r\n");
  EXPECT_TRUE(device_.is_claimed());
  EXPECT_EQ(device_.num_addresses_lost(), 0);
}

TEST_F(PlotterN2kDevice, TakesTheNextFreeAddressAfterALowerName) {
  device_.Begin(now_);
  Sent();
  // 36 is taken by a device that was heard before it mattered.
  EXPECT_EQ(Answer("18EEFF24 01 00 00 00 00 00 00 C0"), "");
  EXPECT_EQ(After(200ms), "");
  EXPECT_EQ(Answer("18EEFF23 " + kLower), "18EEFF25 " + kOurs + "\r\n");
  // The new claim waits anew.
  EXPECT_EQ(After(240ms), "");
  EXPECT_FALSE(device_.is_claimed());
  After(10ms);
  EXPECT_TRUE(device_.is_claimed());
  EXPECT_EQ(device_.address(), 37);
  // An address that was ours for long is lost as well.
  EXPECT_EQ(Answer("18EEFF25 " + kLower), "18EEFF26 " + kOurs + "\r\n");
}

TEST_F(PlotterN2kDevice, ClaimsTheAddressThatItHadWhenTheNetworkIsThereAgain) {
  device_.Begin(now_);
  Hear("18EEFF23 " + kLower);
  After(300ms);
  EXPECT_EQ(device_.address(), 36);
  device_.Begin(now_);
  EXPECT_FALSE(device_.is_claimed());
  EXPECT_EQ(Sent(), "18EAFFFE 00 EE 00\r\n18EEFF24 " + kOurs + "\r\n");
}

TEST_F(PlotterN2kDevice, HasNoAddressWhereAllAreTaken) {
  device_.Begin(now_);
  for (int i = 0; i <= kMostN2kAddress; ++i) {
    if (i != 35) Hear(fmt::format("18EEFF{:02X} {:02X} 00 00 00 00 00 00 C0", i, i));
  }
  Sent();
  EXPECT_EQ(Answer("18EEFF23 " + kLower), "");
  // Not at once: the NAME says after how many milliseconds (0 to 153).
  const auto delay_ms = kOurName % 154;
  EXPECT_EQ(After(std::chrono::milliseconds(delay_ms / 10 * 10)), "");
  EXPECT_EQ(After(10ms), "18EEFFFE " + kOurs + "\r\n");
  EXPECT_EQ(device_.state(), N2kDevice::State::kNoAddress);
  EXPECT_EQ(After(5s), "");
  // Who asks is told the same.
  EXPECT_EQ(Answer("18EAFF01 00 EE 00"), "");
  EXPECT_EQ(After(160ms), "18EEFFFE " + kOurs + "\r\n");
  EXPECT_EQ(Answer("18EA2301 14 F0 01"), "");
  // After a minute devices may be gone.
  EXPECT_EQ(After(60s).substr(0, 48), "18EAFFFE 00 EE 00\r\n18EEFF23 " + kOurs.substr(0, 20));
  EXPECT_TRUE(device_.is_claimed());
}

TEST_F(PlotterN2kDevice, AnswersRequests) {
  ClaimAddress();
  EXPECT_EQ(Answer("18EAFF01 00 EE 00"), "18EEFF23 " + kOurs + "\r\n");
  EXPECT_EQ(Answer("18EA2301 00 EE 00"), "18EEFF23 " + kOurs + "\r\n");
  EXPECT_EQ(Answer("18EA2401 00 EE 00"), "") << "to another";
  // Product information: its version, no code, four texts, not certified, no load.
  const auto product = Answer("18EAFF01 14 F0 01");
  EXPECT_TRUE(product.starts_with("19F01423 00 86 34 08 FF FF 4D 6F\r\n19F01423 01 64 65 6C FF")) << product;
  EXPECT_EQ(std::count(product.begin(), product.end(), '\n'), 20);
  EXPECT_TRUE(product.ends_with(" FF 00 FF FF FF FF FF\r\n")) << product;
  // Both lists of PGNs, to who asks.
  EXPECT_EQ(Answer("18EA2301 00 EE 01"),
            "19EE0123 00 16 00 00 E8 00 00 EA\r\n19EE0123 01 00 00 EE 00 00 EE 01\r\n19EE0123 02 11 F0 01 14 F0 01 08\r\n"
            "19EE0123 03 F6 01 FF FF FF FF FF\r\n"
            "19EE0123 00 0A 01 00 EA 00 00 EE\r\n19EE0123 01 00 D8 FE 00 FF FF FF\r\n");
  // Another PGN is refused where we are asked alone, also one that comes by itself (control byte 3): that request got no answer at all.
  EXPECT_EQ(Answer("18EA2301 00 F1 01"), "18E80123 01 FF FF FF FF 00 F1 01\r\n");
  EXPECT_EQ(Answer("18EAFF01 00 F1 01"), "");
  EXPECT_EQ(Answer("18EA2301 08 F6 01"), "18E80123 03 FF FF FF FF 08 F6 01\r\n");
  EXPECT_EQ(Answer("18EAFF01 08 F6 01"), "");
  EXPECT_EQ(Answer("18EA2301 01 F8 01"), "18E80123 01 FF FF FF FF 01 F8 01\r\n");
}

TEST_F(PlotterN2kDevice, SaysNothingBeforeItHasAnAddressButTheClaim) {
  device_.Begin(now_);
  Sent();
  EXPECT_EQ(Answer("18EA2301 14 F0 01"), "");
  EXPECT_EQ(Answer("18EA2301 00 F1 01"), "");
  EXPECT_EQ(Answer("18EA23FE 00 EE 00"), "18EEFF23 " + kOurs + "\r\n");
}

TEST_F(PlotterN2kDevice, SendsAHeartbeatEachMinute) {
  ClaimAddress();
  EXPECT_EQ(After(59s), "");
  EXPECT_EQ(After(1s), "1DF01123 70 17 01 CF FF FF FF FF\r\n");
  for (int i = 2; i <= 252; ++i) After(60s);
  EXPECT_EQ(After(60s), "1DF01123 70 17 00 CF FF FF FF FF\r\n");
}

TEST_F(PlotterN2kDevice, MovesToACommandedAddress) {
  ClaimAddress();
  EXPECT_EQ(Answer("18ECFF01 20 09 00 02 FF D8 FE 00"), "");
  EXPECT_EQ(Answer("18EBFF01 01 " + kOurs.substr(0, 20)), "");
  EXPECT_EQ(Answer("18EBFF01 02 C0 50 FF FF FF FF FF"), "18EEFF50 " + kOurs + "\r\n");
  EXPECT_FALSE(device_.is_claimed());
  After(250ms);
  EXPECT_EQ(device_.address(), 80);
  // The command is of another, of a wrong address, or another's packets come between.
  const auto command = [this](const std::string& name, const std::string& address) {
    Hear("18ECFF01 20 09 00 02 FF D8 FE 00");
    Hear("18EBFF01 01 " + name.substr(0, 20));
    return Answer("18EBFF01 02 " + name.substr(21) + " " + address + " FF FF FF FF FF");
  };
  EXPECT_EQ(command(kLower, "51"), "");
  EXPECT_EQ(command(kOurs, "FC"), "");
  Hear("18ECFF01 20 09 00 02 FF D8 FE 00");
  Hear("18EBFF02 01 " + kOurs.substr(0, 20));
  EXPECT_FALSE(Hear("18EBFF01 02 C0 51 FF FF FF FF FF"));
  EXPECT_EQ(Sent(), "");
  EXPECT_EQ(device_.address(), 80);
}

TEST_F(PlotterN2kDevice, RefusesFramesThatCannotBe) {
  ClaimAddress();
  EXPECT_FALSE(Hear("18EAFF01 14 F0"));
  EXPECT_FALSE(Hear("18EEFF23 00 00"));
  EXPECT_FALSE(Hear("18EEFF23"));
  EXPECT_FALSE(Hear("18ECFF01 20 09 00"));
  EXPECT_FALSE(Hear("18ECFF01 20 FF FF 02 FF D8 FE 00"));
  EXPECT_TRUE(Hear("18EBFF01 01 02")) << "of a broadcast of which nothing is known";
  EXPECT_TRUE(Hear("09F80101 01"));
  EXPECT_EQ(Sent(), "");
  EXPECT_TRUE(device_.is_claimed());
}

// A claim under our own NAME is ours that came back; from where nobody can be, it takes nothing.
TEST_F(PlotterN2kDevice, IsNotMovedByItsEcho) {
  ClaimAddress();
  EXPECT_EQ(Answer("18EEFF23 " + kOurs), "");
  EXPECT_EQ(Answer("18EEFF40 " + kOurs), "");
  EXPECT_EQ(Answer("18EEFFFE " + kLower), "");
  EXPECT_EQ(Answer("18EEFFFC " + kLower), "");
  EXPECT_TRUE(device_.is_claimed());
}

TEST_F(PlotterN2kDevice, AnswersAFloodOnlySoOften) {
  ClaimAddress();
  After(1s);
  std::string answers;
  for (int i = 0; i < 1000; ++i) answers += Answer("18EAFF01 00 EE 00");
  EXPECT_EQ(std::count(answers.begin(), answers.end(), '\n'), N2kDevice::kMostAnswers);
  EXPECT_EQ(device_.num_unanswered(), 1000 - N2kDevice::kMostAnswers);
  After(1s);
  EXPECT_NE(Answer("18EAFF01 00 EE 00"), "");
  // One that takes each address that we claim ends it as well.
  for (int i = 0; i < 100 && device_.state() != N2kDevice::State::kNoAddress; ++i) Hear(fmt::format("18EEFF{:02X} ", device_.address()) + kLower);
  EXPECT_EQ(device_.state(), N2kDevice::State::kNoAddress);
}

}  // namespace
}  // namespace lookout::plotter
