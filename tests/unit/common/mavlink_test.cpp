#include "common/core/mavlink.hpp"

#include <array>
#include <gtest/gtest.h>
#include <string>

#include "tests/support/mavlink_frames.hpp"

namespace lookout {
namespace {

using enum MavlinkLook::Verdict;

constexpr std::array kHeartbeat{MavlinkKind{.id = 0, .crc_extra = 50, .num_bytes = 9, .max_payload_bytes = 9}};

TEST(LookForMavlink, TellsAFrameFromItsBegin) {
  for (const bool is_second : {true, false}) {
    const auto whole = support::AutopilotHeartbeat(is_second);
    const auto text = whole + "more";
    const auto [verdict, frame] = LookForMavlink(text, kHeartbeat);
    ASSERT_EQ(verdict, kFrame);
    EXPECT_EQ(frame.bytes, whole);
    EXPECT_EQ(frame.payload, whole.substr(is_second ? 10 : 6, 9));
    EXPECT_EQ(frame.system_id, 1);
    EXPECT_EQ(frame.component_id, 1);
    EXPECT_EQ(frame.id, 0U);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_EQ(LookForMavlink(whole.substr(0, size), kHeartbeat).verdict, kUnfinished) << size;
    }
  }
  EXPECT_EQ(LookForMavlink("text", kHeartbeat).verdict, kNone);
}

// Where and how a byte is wrong decides: what cannot be a message that is looked for is passed over at once, and nothing is waited for.
TEST(LookForMavlink, RefusesWhatIsOtherwise) {
  const auto verdict_of = [](std::size_t place, char byte) {
    auto frame = support::AutopilotHeartbeat();
    frame[place] = byte;
    return LookForMavlink(frame + std::string(20, '\0'), kHeartbeat).verdict;
  };
  EXPECT_EQ(verdict_of(0, '\xFC'), kNone);
  EXPECT_EQ(verdict_of(1, '\x0A'), kNone) << "longer than the message";
  EXPECT_EQ(verdict_of(1, '\0'), kNone) << "one byte of payload is always sent";
  EXPECT_EQ(verdict_of(1, '\x08'), kBadChecksum);
  EXPECT_EQ(verdict_of(2, '\x01'), kBadChecksum) << "the flag is under the checksum";
  EXPECT_EQ(verdict_of(2, '\x02'), kNone) << "a flag that changes what the frame means";
  EXPECT_EQ(verdict_of(4, '\x55'), kBadChecksum);
  EXPECT_EQ(verdict_of(7, '\x01'), kNone) << "another message";
  EXPECT_EQ(verdict_of(9, '\x01'), kNone);
  EXPECT_EQ(verdict_of(19, '\0'), kBadChecksum);
  auto first = support::AutopilotHeartbeat(false);
  first[1] = '\x08';
  EXPECT_EQ(LookForMavlink(first, kHeartbeat).verdict, kNone) << "MAVLink 1 leaves nothing out";
}

TEST(LookForMavlink, WaitsForASignatureAndPassesOverIt) {
  auto frame = support::AutopilotHeartbeat();
  frame.resize(frame.size() - 2);
  frame[2] = '\x01';
  const auto crc = support::MavlinkCrc(frame.substr(1) + '\x32');
  frame += static_cast<char>(crc & 0xFF);
  frame += static_cast<char>(crc >> 8);
  EXPECT_EQ(LookForMavlink(frame, kHeartbeat).verdict, kUnfinished);
  EXPECT_EQ(LookForMavlink(frame + std::string(12, 's'), kHeartbeat).verdict, kUnfinished);
  const auto signed_frame = frame + std::string(13, 's');
  const auto text = signed_frame + "more";
  const auto look = LookForMavlink(text, kHeartbeat);
  ASSERT_EQ(look.verdict, kFrame);
  EXPECT_EQ(look.frame.bytes, signed_frame);
  EXPECT_EQ(signed_frame.size(), MaxMavlinkFrameBytes(9));
}

}  // namespace
}  // namespace lookout
