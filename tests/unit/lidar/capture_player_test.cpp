#include "services/lidar/io/capture_player.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <gtest/gtest.h>
#include <map>

#include "tests/support/files.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Captures of raw IP; the payload of each datagram is one byte.
class Player : public ::testing::Test {
 protected:
  struct Record {
    std::uint32_t stamp_us;
    std::uint8_t payload;
    bool is_tcp = false;
  };

  static void Append(std::string& text, std::initializer_list<std::uint32_t> words) {
    for (const auto word : words) {
      for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>(word >> shift & 0xFF);
    }
  }

  std::filesystem::path Write(const std::string& name, const std::vector<Record>& records) const {
    constexpr std::uint32_t kFrameSize = 29;
    std::string text;
    Append(text, {0xA1B2C3D4, 0x00040002, 0, 0, 65535, 101});
    for (const auto& record : records) {
      Append(text, {record.stamp_us / 1'000'000, record.stamp_us % 1'000'000, kFrameSize, kFrameSize});
      std::string ip("\x45\0\0\x1D\0\0\0\0\x40\x11\0\0\x01\x02\x03\x04\x05\x06\x07\x08", 20);
      if (record.is_tcp) ip[9] = 6;
      const std::string udp("\x09\x40\x09\x40\0\x09\0\0", 8);
      text += ip + udp + static_cast<char>(record.payload);
    }
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  // Payloads due so far.
  static std::vector<int> Due(CapturePlayer& player, milliseconds elapsed) {
    std::vector<int> payloads;
    while (const auto datagram = player.NextDue(elapsed)) payloads.push_back(datagram->payload.at(0));
    return payloads;
  }

  static std::map<std::string, std::int64_t> Counts(const CapturePlayer& player) {
    std::map<std::string, std::int64_t> counts;
    for (const auto& counter : player.counters()) counts[std::string(counter.name)] = counter.count;
    return counts;
  }

  using Payloads = std::vector<int>;
  support::TempDir folder_;
};

TEST_F(Player, GoesOnEvenlyBehindStampsThatGoFarBack) {
  CapturePlayer player({Write("a", {{500'000'000, 1}, {100'000'000, 2}, {101'000'000, 3}})}, 1.0);
  EXPECT_EQ(Due(player, milliseconds(0)), (Payloads{1, 2}));
  EXPECT_EQ(Due(player, milliseconds(999)), (Payloads{}));
  EXPECT_EQ(Due(player, milliseconds(1000)), (Payloads{3}));
}

TEST_F(Player, GivesEachDatagramWhenItIsDue) {
  CapturePlayer player({Write("a", {{5'000'000, 1}, {5'010'000, 2}, {5'010'000, 3}, {5'030'000, 4}})}, 1.0);
  EXPECT_EQ(Due(player, milliseconds(0)), (Payloads{1}));
  EXPECT_EQ(Due(player, milliseconds(9)), (Payloads{}));
  EXPECT_EQ(ToUtimeUs(player.CaptureTime(milliseconds(9))), 5'009'000);
  EXPECT_EQ(Due(player, milliseconds(10)), (Payloads{2, 3}));
  EXPECT_FALSE(player.is_finished());
  EXPECT_EQ(Due(player, milliseconds(100)), (Payloads{4}));
  EXPECT_TRUE(player.is_finished());
  EXPECT_EQ(ToUtimeUs(player.CaptureTime(milliseconds(100))), 5'100'000);
}

TEST_F(Player, PlaysFasterAndSlower) {
  const auto file = Write("a", {{0, 1}, {10'000, 2}, {20'000, 3}});
  CapturePlayer fast({file}, 10.0);
  EXPECT_EQ(Due(fast, milliseconds(1)), (Payloads{1, 2}));
  CapturePlayer slow({file}, 0.5);
  EXPECT_EQ(Due(slow, milliseconds(19)), (Payloads{1}));
  EXPECT_EQ(Due(slow, milliseconds(20)), (Payloads{2}));
}

TEST_F(Player, AtSpeedZeroEverythingIsDue) {
  CapturePlayer player({Write("a", {{0, 1}, {4'000'000, 2}}), Write("b", {{1, 3}})}, 0.0);
  EXPECT_EQ(Due(player, milliseconds(0)), (Payloads{1, 2, 3}));
  EXPECT_TRUE(player.is_finished());
  EXPECT_EQ(ToUtimeUs(player.CaptureTime(milliseconds(500))), 1);  // of the last datagram
}

TEST_F(Player, ReadsCapturesInTheirOrderAsOneStream) {
  const auto first = Write("z", {{5'000'000, 1}, {5'010'000, 2}});
  const auto second = Write("a", {{5'020'000, 3}});
  CapturePlayer player({first, Write("empty", {}), second}, 1.0);
  EXPECT_EQ(Due(player, milliseconds(10)), (Payloads{1, 2}));
  EXPECT_EQ(Due(player, milliseconds(20)), (Payloads{3}));
  EXPECT_TRUE(player.is_finished());
  auto counts = Counts(player);
  EXPECT_EQ(counts["captures_read"], 3);
  EXPECT_EQ(counts["frames_datagram"], 3);
  EXPECT_EQ(counts["capture_stamp_jumps"], 0);
  ASSERT_EQ(player.Warnings().size(), 1U);
  EXPECT_NE(player.Warnings()[0].find("empty: no datagram in 0 frames"), std::string::npos);
}

TEST_F(Player, DoesNotWaitForAStampThatJumps) {
  const auto late = static_cast<std::uint32_t>(std::chrono::microseconds(CapturePlayer::kMaxPause).count());
  // As long a pause as may be, one that is longer by a microsecond, and one back.
  CapturePlayer player({Write("a", {{0, 1}, {late, 2}, {2 * late + 1, 3}, {0, 4}})}, 1.0);
  EXPECT_EQ(Due(player, milliseconds(4999)), (Payloads{1}));
  EXPECT_EQ(Due(player, milliseconds(5000)), (Payloads{2, 3, 4}));
  EXPECT_EQ(Counts(player)["capture_stamp_jumps"], 2);
}

TEST_F(Player, KeepsThePaceWhenStampsGoBackALittle) {
  // Pairs that changed places: each step on has its step back.
  CapturePlayer player({Write("a", {{0, 1}, {20'000, 2}, {10'000, 3}, {30'000, 4}, {20'000, 5}, {40'000, 6}})}, 1.0);
  EXPECT_EQ(Due(player, milliseconds(19)), (Payloads{1}));
  EXPECT_EQ(Due(player, milliseconds(29)), (Payloads{2, 3}));
  EXPECT_EQ(Due(player, milliseconds(30)), (Payloads{4, 5}));
  EXPECT_EQ(Due(player, milliseconds(40)), (Payloads{6}));
  EXPECT_EQ(Counts(player)["capture_stamp_jumps"], 2);
}

TEST_F(Player, LetsItsCallerGoInALargeCaptureOfOtherThings) {
  std::vector<Record> records(static_cast<std::size_t>(2 * CapturePlayer::kMaxFramesPerCall + 1), Record{0, 0, true});
  records.push_back({5'000, 7});
  CapturePlayer player({Write("tcp", records)}, 1.0);
  EXPECT_EQ(Counts(player)["frames_read"], CapturePlayer::kMaxFramesPerCall);
  EXPECT_FALSE(player.has_begun());
  EXPECT_FALSE(player.is_empty());
  EXPECT_FALSE(player.NextDue(milliseconds(0)));
  EXPECT_FALSE(player.is_empty());
  EXPECT_FALSE(player.is_finished());
  const auto datagram = player.NextDue(milliseconds(0));
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->payload.at(0), 7);
  EXPECT_TRUE(player.is_finished());
}

// A stalled process used to tell the service of a time past the datagrams that it had yet to give.
TEST_F(Player, DoesNotRunAheadOfTheDatagramThatIsDue) {
  CapturePlayer player({Write("a", {{0, 1}, {10'000, 2}, {20'000, 3}})}, 1.0);
  ASSERT_TRUE(player.NextDue(seconds(3)));
  EXPECT_EQ(ToUtimeUs(player.CaptureTime(seconds(3))), 10'000);
}

TEST_F(Player, RefusesAnyWrongFileAtTheStart) {
  const auto good = Write("good", {{0, 1}});
  std::ofstream(folder_ / "text") << "hello";
  try {
    const CapturePlayer player({good, folder_ / "text"}, 1.0);
    FAIL() << "opened a text";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("text"), std::string::npos);
  }
  EXPECT_THROW(CapturePlayer({good, folder_ / "missing"}, 1.0), std::runtime_error);
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(CapturePlayer({good, folder_ / "pipe"}, 1.0), std::runtime_error);  // nobody writes: opening it would never end
}

TEST_F(Player, GoesOnWithTheNextCaptureBehindADamagedOne) {
  const auto cut = Write("cut", {{0, 1}, {10'000, 2}});
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) - 1);
  CapturePlayer player({cut, Write("b", {{20'000, 3}})}, 0.0);
  EXPECT_EQ(Due(player, milliseconds(0)), (Payloads{1, 3}));
  EXPECT_EQ(Counts(player)["capture_damaged"], 1);
  ASSERT_EQ(player.Warnings().size(), 1U);
  EXPECT_NE(player.Warnings()[0].find("cut"), std::string::npos);
}

}  // namespace
}  // namespace lookout::vlp16
