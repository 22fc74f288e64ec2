// Sentences that come by UDP, by serial ports and through a lidar.
#include <chrono>
#include <gtest/gtest.h>
#include <string>

#include "common/core/sentence.hpp"
#include "tests/support/pseudo_terminal.hpp"
#include "tools/setup/nmea_survey.hpp"
#include "tools/setup/serial_search.hpp"

namespace lookout::setup {
namespace {

using std::chrono::milliseconds;
constexpr Utime kStart{std::chrono::seconds(1'800'000'000)};
const std::string kHdt = "$GPHDT,90.0,T*0C\r\n";
const std::string kGga = "$GPGGA,120000.00,4338.0000,N,07209.0000,W,1,08,1.0,10.0,M,-30.0,M,,*4B\r\n";

Bytes BytesOf(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

TEST(NmeaSurvey, CountsSentencesByPortAndType) {
  NmeaSurvey survey;
  for (int i = 0; i <= 30; ++i) survey.AddDatagram(kStart + milliseconds(100 * i), 10110, BytesOf(kHdt), false);
  survey.AddDatagram(kStart, 2000, BytesOf(kHdt + kHdt), false);
  survey.AddDatagram(kStart, 2001, BytesOf("$GPHDT,90.0,T*0D\r\nno sentence * at all"), false);
  const auto sources = survey.Sources();
  ASSERT_EQ(sources.size(), 2U);
  EXPECT_EQ(sources[0].port, 2000);
  EXPECT_EQ(SentencesInWords(sources[0]), "HDT") << "one instant has no rate";
  EXPECT_EQ(sources[1].port, 10110);
  EXPECT_TRUE(sources[1].has_heading);
  EXPECT_FALSE(sources[1].has_position);
  EXPECT_EQ(SentencesInWords(sources[1]), "HDT 10.3/s");
}

// With the right to capture the same datagram comes by the interface and by the socket.
TEST(NmeaSurvey, CountsADatagramThatComesTwoWaysOnce) {
  NmeaSurvey survey;
  for (const bool is_frame : {false, true}) survey.AddDatagram(kStart, 10110, BytesOf(kHdt), is_frame);
  ASSERT_EQ(survey.Sources().size(), 1U);
  EXPECT_EQ(survey.Sources()[0].num_by_type.at("HDT"), 1);
}

TEST(SerialSearch, FindsSentencesOnASerialPort) {
  const support::PseudoTerminal terminal;
  NmeaSurvey survey;
  SerialSearch search(terminal.device);
  auto now = kStart;
  for (; now < kStart + SerialSearch::kWait * 2 && !search.is_found(); now += milliseconds(5)) {
    search.Poll(now, survey);
    // At the first rate the receiver is silent.
    if (now > kStart + SerialSearch::kWait + milliseconds(100)) terminal.Write(kHdt);
  }
  EXPECT_TRUE(search.is_found());
  EXPECT_TRUE(search.IsDone());
  const auto sources = survey.Sources();
  ASSERT_EQ(sources.size(), 1U);
  EXPECT_EQ(sources[0].device, terminal.device);
  EXPECT_EQ(sources[0].baud, SerialSearch::kBauds[1]);
}

TEST(SerialSearch, GivesUpAfterTheLastRate) {
  const support::PseudoTerminal terminal;
  NmeaSurvey survey;
  SerialSearch search(terminal.device);
  auto now = kStart;
  while (!search.IsDone() && now < kStart + std::chrono::seconds(60)) {
    search.Poll(now, survey);
    now += milliseconds(100);
  }
  EXPECT_TRUE(search.IsDone());
  EXPECT_FALSE(search.is_found());
  EXPECT_LT(now - kStart, std::chrono::seconds(10));
  EXPECT_TRUE(survey.Sources().empty());

  SerialSearch missing("/dev/no-such-port");
  missing.Poll(kStart, survey);
  EXPECT_NE(missing.fault(), "");
}

}  // namespace
}  // namespace lookout::setup
