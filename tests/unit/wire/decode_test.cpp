// Guarded decoding: no bytes make bus::Decode throw, read beyond them or take much memory.
#include "common/bus/decode.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/unit/wire/counting_new.hpp"
#include "tests/unit/wire/filled_messages.hpp"

namespace lookout {
namespace {

// An element takes at least one byte on the wire, so a count buys at most as many elements as there are bytes; the largest in memory is this.
constexpr std::size_t kLargestElementBytes =
    std::max({sizeof(obstacle_t), sizeof(segment_t), sizeof(track_t), sizeof(health_channel_t), sizeof(std::string)});

// Decodes from a heap block of exactly the bytes' size, so that a sanitizer sees each read beyond it.
template <typename T>
std::optional<T> DecodeGuarded(const std::vector<std::uint8_t>& bytes) {
  const std::vector<std::uint8_t> exact(bytes.begin(), bytes.end());
  num_allocated_bytes = 0;
  auto message = bus::Decode<T>(exact);
  const std::size_t taken = num_allocated_bytes;
  EXPECT_LE(taken, (exact.size() + 16) * kLargestElementBytes) << T::getTypeName() << " of " << exact.size() << " bytes";
  return message;
}

template <typename T>
std::vector<std::uint8_t> FingerprintBytes() {
  std::vector<std::uint8_t> bytes;
  const auto fingerprint = static_cast<std::uint64_t>(T::getHash());
  for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  return bytes;
}

TEST(Decode, GivesBackWhatWasEncoded) {
  ForEachFilledMessage([]<typename T>(const T& message) {
    const auto bytes = bus::Encode(message);
    const auto decoded = DecodeGuarded<T>(bytes);
    ASSERT_TRUE(decoded) << T::getTypeName();
    EXPECT_EQ(bus::Encode(*decoded), bytes) << T::getTypeName();
  });
}

TEST(Decode, RefusesEveryShorterMessage) {
  ForEachFilledMessage([]<typename T>(const T& message) {
    auto bytes = bus::Encode(message);
    while (!bytes.empty()) {
      bytes.pop_back();
      ASSERT_FALSE(DecodeGuarded<T>(bytes)) << T::getTypeName() << " cut to " << bytes.size();
    }
  });
}

TEST(Decode, RefusesAByteBehindTheMessage) {
  ForEachFilledMessage([]<typename T>(const T& message) {
    auto bytes = bus::Encode(message);
    bytes.push_back(0);
    EXPECT_FALSE(DecodeGuarded<T>(bytes)) << T::getTypeName();
  });
}

TEST(Decode, RefusesTheFingerprintOfAnotherType) {
  ForEachFilledMessage([]<typename T>(const T& message) {
    for (std::size_t bit = 0; bit < 64; ++bit) {
      auto bytes = bus::Encode(message);
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      EXPECT_FALSE(DecodeGuarded<T>(bytes)) << T::getTypeName();
    }
  });
}

TEST(Decode, SurvivesAnyCountThatIsOverwritten) {
  // At every place, so at that of each count and string length too.
  constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t count : {-1, kMax, 1'000'000, std::numeric_limits<std::int32_t>::min(), 0x10000}) {
    ForEachFilledMessage([count]<typename T>(const T& message) {
      const auto whole = bus::Encode(message);
      for (std::size_t offset = 8; offset + 4 <= whole.size(); ++offset) {
        auto bytes = whole;
        for (std::size_t i = 0; i < 4; ++i) bytes[offset + i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(count) >> (24 - 8 * i));
        DecodeGuarded<T>(bytes);
      }
    });
  }
}

// The number of elements of the first array, which stands behind its count.
template <typename T>
void ExpectCountRefused(T message, std::int32_t T::*count_member) {
  const auto whole = bus::Encode(message);
  T marked = message;
  marked.*count_member = 0;  // the encoder trusts the count: find its place by the first byte that differs
  std::vector<std::uint8_t> other(static_cast<std::size_t>(marked.getEncodedSize()));
  ASSERT_GT(marked.encode(other.data(), 0, static_cast<int>(other.size())), 0);
  const auto place = static_cast<std::size_t>(std::ranges::mismatch(whole, other).in1 - whole.begin()) - 3;
  for (const std::int32_t count : {-1, std::numeric_limits<std::int32_t>::max(), 1'000'000}) {
    auto bytes = whole;
    for (std::size_t i = 0; i < 4; ++i) bytes[place + i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(count) >> (24 - 8 * i));
    EXPECT_FALSE(DecodeGuarded<T>(bytes)) << T::getTypeName() << " with a count of " << count;
  }
}

TEST(Decode, RefusesCountsThatTheBytesCannotFill) {
  const auto filled = []<typename T>(T message) {
    Fill(message);
    return message;
  };
  ExpectCountRefused(filled(lidar_packets_t{}), &lidar_packets_t::num_packets);
  ExpectCountRefused(filled(lidar_packets_t{}), &lidar_packets_t::num_bytes);
  ExpectCountRefused(filled(lidar_scan_t{}), &lidar_scan_t::num_rings);
  ExpectCountRefused(filled(lidar_scan_t{}), &lidar_scan_t::num_returns);
  ExpectCountRefused(filled(lidar_scan_t{}), &lidar_scan_t::num_columns);
  ExpectCountRefused(filled(lidar_scan_t{}), &lidar_scan_t::num_cells);
  ExpectCountRefused(filled(segments_t{}), &segments_t::num_cells);
  ExpectCountRefused(filled(segments_t{}), &segments_t::num_labelled);
  ExpectCountRefused(filled(segments_t{}), &segments_t::num_segments);
  ExpectCountRefused(filled(nav_raw_t{}), &nav_raw_t::num_imu);
  ExpectCountRefused(filled(obstacles_t{}), &obstacles_t::num_obstacles);
  ExpectCountRefused(filled(tracks_t{}), &tracks_t::num_pieces);
  ExpectCountRefused(filled(health_t{}), &health_t::num_channels);
  ExpectCountRefused(filled(health_t{}), &health_t::num_counters);
  ExpectCountRefused(filled(run_info_t{}), &run_info_t::num_files);
}

TEST(Decode, SurvivesRandomBytesBehindTheRightFingerprint) {
  const std::uint64_t seed = 20261121;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  ForEachFilledMessage([&random]<typename T>(const T&) {
    for (int round = 0; round < 300; ++round) {
      auto bytes = FingerprintBytes<T>();
      const std::size_t size = random() % 600;
      // Few bits set in some rounds: small counts go deeper into the decoder.
      const bool is_sparse = round % 2 == 0;
      for (std::size_t i = 0; i < size; ++i) bytes.push_back(is_sparse && random() % 8 != 0 ? 0 : static_cast<std::uint8_t>(random() % 256));
      DecodeGuarded<T>(bytes);
    }
  });
}

TEST(Decode, SurvivesSingleBytesThatAreSpoilt) {
  const std::uint64_t seed = 20261122;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  ForEachFilledMessage([&random]<typename T>(const T& message) {
    const auto whole = bus::Encode(message);
    for (std::size_t offset = 8; offset < whole.size(); ++offset) {
      auto bytes = whole;
      bytes[offset] = static_cast<std::uint8_t>(random() % 256);
      DecodeGuarded<T>(bytes);
    }
  });
}

}  // namespace
}  // namespace lookout
