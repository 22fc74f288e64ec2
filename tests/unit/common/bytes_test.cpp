#include "common/core/bytes.hpp"

#include <array>
#include <gtest/gtest.h>

#include "common/core/utime.hpp"

namespace lookout {
namespace {

TEST(Bytes, ReadsLittleEndianAtAnOffset) {
  const std::array<std::uint8_t, 6> bytes{0xAA, 0x01, 0x02, 0x03, 0xFF, 0xBB};
  EXPECT_EQ(ReadU16LittleEndian(bytes, 1), 0x0201);
  EXPECT_EQ(ReadU32LittleEndian(bytes, 1), 0xFF030201U);
}

TEST(Bytes, ReadsBackWhatItWrote) {
  std::array<std::uint8_t, 4> bytes{};
  WriteU32LittleEndian(bytes, 0, 0xDEADBEEFU);
  EXPECT_EQ(ReadU32LittleEndian(bytes, 0), 0xDEADBEEFU);
  EXPECT_EQ(bytes[0], 0xEF);
}

TEST(Utime, RefusesWhatWouldOverflowLater) {
  EXPECT_TRUE(UtimeFromWire(0));
  EXPECT_TRUE(UtimeFromWire(-1500));
  EXPECT_FALSE(UtimeFromWire(INT64_MAX));
  EXPECT_FALSE(UtimeFromWire(INT64_MIN));
  EXPECT_EQ(ToUtimeUs(*UtimeFromWire(1453364282708714)), 1453364282708714);
}

}  // namespace
}  // namespace lookout
