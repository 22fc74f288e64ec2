// Our arrays against LCM's own.
#include "lcmtypes/arrays.hpp"

#include <cstring>
#include <gtest/gtest.h>
#include <lcm/lcm_coretypes.h>
#include <limits>
#include <random>
#include <vector>

namespace lookout::wire {
namespace {

template <typename T>
std::vector<T> AnyValues(std::size_t size) {
  std::mt19937_64 random(size);
  std::vector<T> values(size);
  for (auto& value : values) {
    const auto bits = random();
    std::memcpy(&value, &bits, sizeof(T));
  }
  if (size > 2) values[1] = std::numeric_limits<T>::lowest();
  return values;
}

template <typename T, typename LcmEncode, typename LcmDecode>
void ExpectAsLcm(LcmEncode lcm_encode, LcmDecode lcm_decode) {
  for (const std::size_t size : {0U, 1U, 2U, 3U, 7U, 8U, 9U, 33U, 1000U}) {
    const auto values = AnyValues<T>(size);
    const int count = static_cast<int>(size);
    const int num_bytes = count * static_cast<int>(sizeof(T));
    std::vector<std::uint8_t> ours(size * sizeof(T) + 3, 0xEE);
    auto theirs = ours;
    EXPECT_EQ(EncodeArray(ours.data(), 3, num_bytes, values.data(), count), num_bytes);
    EXPECT_EQ(lcm_encode(theirs.data(), 3, num_bytes, values.data(), count), num_bytes);
    EXPECT_EQ(ours, theirs) << size;
    std::vector<T> back(size);
    std::vector<T> back_of_lcm(size);
    EXPECT_EQ(DecodeArray(ours.data(), 3, num_bytes, back.data(), count), num_bytes);
    EXPECT_EQ(lcm_decode(ours.data(), 3, num_bytes, back_of_lcm.data(), count), num_bytes);
    if (size == 0) continue;
    EXPECT_EQ(std::memcmp(back.data(), back_of_lcm.data(), size * sizeof(T)), 0) << size;
    EXPECT_EQ(std::memcmp(back.data(), values.data(), size * sizeof(T)), 0) << size;
    EXPECT_EQ(EncodeArray(ours.data(), 3, num_bytes - 1, values.data(), count), -1);
    EXPECT_EQ(DecodeArray(ours.data(), 3, num_bytes - 1, back.data(), count), -1);
  }
}

TEST(WireArrays, AreThoseOfLcm) {
  ExpectAsLcm<std::int16_t>(__int16_t_encode_array, __int16_t_decode_array);
  ExpectAsLcm<std::int32_t>(__int32_t_encode_array, __int32_t_decode_array);
  ExpectAsLcm<std::int64_t>(__int64_t_encode_array, __int64_t_decode_array);
  ExpectAsLcm<float>(__float_encode_array, __float_decode_array);
  ExpectAsLcm<double>(__double_encode_array, __double_decode_array);
}

TEST(WireArrays, RefuseMoreThanThereCanBe) {
  std::vector<std::int64_t> values(4);
  std::vector<std::uint8_t> bytes(32);
  // 2^29 values of 8 bytes are 2^32: 0 in 32 bits.
  EXPECT_EQ(DecodeArray(bytes.data(), 0, 32, values.data(), 1 << 29), -1);
  EXPECT_EQ(EncodeArray(bytes.data(), 0, 32, values.data(), 1 << 29), -1);
}

}  // namespace
}  // namespace lookout::wire
