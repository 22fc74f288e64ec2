#include "services/lidar/io/fragments.hpp"

#include <gtest/gtest.h>
#include <numeric>

#include "services/lidar/io/frame.hpp"

namespace lookout::lidar {
namespace {

constexpr int kRawIp = 12;  // DLT_RAW

std::vector<std::uint8_t> Counting(std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

// UDP from port 7502 to 7502.
std::vector<std::uint8_t> Udp(std::size_t payload_size) {
  const auto size = payload_size + 8;
  std::vector<std::uint8_t> udp{0x1D, 0x4E, 0x1D, 0x4E, static_cast<std::uint8_t>(size >> 8), static_cast<std::uint8_t>(size), 0, 0};
  const auto payload = Counting(payload_size);
  udp.insert(udp.end(), payload.begin(), payload.end());
  return udp;
}

std::vector<std::uint8_t> Ipv4Part(Bytes part, std::uint8_t id, std::size_t offset, bool is_last) {
  const auto size = part.size() + 20;
  const auto place = (is_last ? 0U : 0x2000U) | offset / 8;
  std::vector<std::uint8_t> frame{0x45,
                                  0,
                                  static_cast<std::uint8_t>(size >> 8),
                                  static_cast<std::uint8_t>(size),
                                  0,
                                  id,
                                  static_cast<std::uint8_t>(place >> 8),
                                  static_cast<std::uint8_t>(place),
                                  64,
                                  17,
                                  0,
                                  0,
                                  10,
                                  0,
                                  0,
                                  1,
                                  10,
                                  0,
                                  0,
                                  2};
  frame.insert(frame.end(), part.begin(), part.end());
  return frame;
}

std::vector<std::uint8_t> Ipv6Part(Bytes part, std::uint8_t id, std::size_t offset, bool is_last) {
  const auto size = part.size() + 8;
  std::vector<std::uint8_t> frame{0x60, 0, 0, 0, static_cast<std::uint8_t>(size >> 8), static_cast<std::uint8_t>(size), 44, 64};
  frame.resize(40, 0x11);
  const auto place = offset | (is_last ? 0U : 1U);
  for (const auto byte : {17U, 0U, static_cast<unsigned>(place >> 8), static_cast<unsigned>(place & 0xFF), 0U, 0U, 0U, static_cast<unsigned>(id)}) {
    frame.push_back(static_cast<std::uint8_t>(byte));
  }
  frame.insert(frame.end(), part.begin(), part.end());
  return frame;
}

class Fragments : public ::testing::TestWithParam<bool> {
 protected:
  std::vector<std::uint8_t> PartOf(Bytes whole, std::uint8_t id, std::size_t begin, std::size_t size) const {
    const auto part = whole.subspan(begin, std::min(size, whole.size() - begin));
    const bool is_last = begin + part.size() == whole.size();
    return GetParam() ? Ipv6Part(part, id, begin, is_last) : Ipv4Part(part, id, begin, is_last);
  }

  std::optional<std::vector<std::uint8_t>> Add(const std::vector<std::uint8_t>& frame_bytes) {
    const auto frame = ParseFrame(kRawIp, frame_bytes, false);
    EXPECT_EQ(frame.fault, FrameFault::kFragment);
    EXPECT_TRUE(frame.fragment);
    return frame.fragment ? joiner_.Add(now_, *frame.fragment) : std::nullopt;
  }

  Utime now_{};
  FragmentJoiner joiner_;
};

INSTANTIATE_TEST_SUITE_P(Ipv6, Fragments, ::testing::Bool());

TEST_P(Fragments, AreADatagramAgainInAnyOrder) {
  const auto udp = Udp(8448);
  for (const bool is_backwards : {false, true}) {
    std::optional<std::vector<std::uint8_t>> joined;
    constexpr std::size_t kPartBytes = 1480;
    const std::size_t num_parts = (udp.size() + kPartBytes - 1) / kPartBytes;
    for (std::size_t i = 0; i < num_parts; ++i) {
      EXPECT_FALSE(joined);
      joined = Add(PartOf(udp, 7, (is_backwards ? num_parts - 1 - i : i) * kPartBytes, kPartBytes));
    }
    ASSERT_TRUE(joined);
    const auto frame = ParseDatagram(*joined, "10.0.0.1", "10.0.0.2");
    EXPECT_EQ(frame.fault, FrameFault::kNone);
    EXPECT_EQ(frame.destination_port, 7502);
    EXPECT_TRUE(std::ranges::equal(frame.payload, Counting(8448)));
  }
  EXPECT_EQ(joiner_.num_given_up(), 0);
}

TEST_P(Fragments, OfTwoDatagramsDoNotMix) {
  const auto one = Udp(2000);
  const auto other = Udp(3000);
  EXPECT_FALSE(Add(PartOf(one, 1, 0, 1480)));
  EXPECT_FALSE(Add(PartOf(other, 2, 0, 1480)));
  EXPECT_EQ(Add(PartOf(one, 1, 1480, 1480)), one);
  EXPECT_FALSE(Add(PartOf(other, 2, 1480, 1480)));
  EXPECT_EQ(Add(PartOf(other, 2, 2960, 1480)), other);
}

TEST_P(Fragments, ThatOverlapAreGivenUp) {
  const auto udp = Udp(4000);
  EXPECT_FALSE(Add(PartOf(udp, 1, 0, 1480)));
  EXPECT_FALSE(Add(PartOf(udp, 1, 1472, 1480)));
  EXPECT_EQ(joiner_.num_given_up(), 1);
}

// An identification comes again: what was left of a datagram must not become part of another.
TEST_P(Fragments, ThatAreOldAreGivenUp) {
  const auto udp = Udp(2000);
  EXPECT_FALSE(Add(PartOf(udp, 1, 1480, 1480)));
  now_ += std::chrono::milliseconds(1001);
  EXPECT_FALSE(Add(PartOf(udp, 1, 0, 1480)));
  EXPECT_EQ(joiner_.num_given_up(), 1);
}

TEST_P(Fragments, WithoutBytesAreGivenUp) {
  const auto udp = Udp(4000);
  const std::vector<std::uint8_t> none;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_FALSE(Add(GetParam() ? Ipv6Part(none, 1, 8, false) : Ipv4Part(none, 1, 8, false)));
  }
  EXPECT_EQ(joiner_.num_given_up(), 1000);
}

TEST_P(Fragments, OfDatagramsThatNeverBecomeWholeAreBounded) {
  const auto udp = Udp(4000);
  for (int id = 0; id < 200; ++id) EXPECT_FALSE(Add(PartOf(udp, static_cast<std::uint8_t>(id), 0, 1480)));
  EXPECT_EQ(joiner_.num_given_up(), 200 - static_cast<std::int64_t>(FragmentJoiner::kMaxDatagrams));
}

}  // namespace
}  // namespace lookout::lidar
