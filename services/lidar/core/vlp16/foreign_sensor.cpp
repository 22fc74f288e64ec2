#include "services/lidar/core/vlp16/foreign_sensor.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::vlp16 {

namespace {

using namespace std::string_view_literals;

// The manual, table 9-2, as printed; VeloView and two drivers have the same. Byte 0x23 is VLP-32A in some sources and Puck LITE in others, 0xA0 is
// defined by no maker: both stay without a name. 0x63 was the VLS-128 before 0xA1.
constexpr std::uint8_t kProductVls128Early = 0x63;
constexpr std::uint8_t kProductVls128 = 0xA1;
struct Product {
  std::uint8_t byte;
  std::string_view name;
};
constexpr std::array kProducts{Product{format::kProductHdl32e, "Velodyne HDL-32E"},
                               Product{format::kProductVlp16, "Velodyne VLP-16"},
                               Product{format::kProductPuckHiRes, "Velodyne Puck Hi-Res"},
                               Product{0x28, "Velodyne VLP-32C"},
                               Product{0x31, "Velodyne Velarray"},
                               Product{kProductVls128Early, "Velodyne VLS-128 (Alpha Prime)"},
                               Product{kProductVls128, "Velodyne VLS-128 (Alpha Prime)"}};

// HDL-64E S3 User Manual: blocks of the upper lasers begin with 0xEEFF, of the lower ones with 0xDDFF. VLS-128 User Manual:
// 0xCCFF and 0xBBFF for its third and fourth bank.
constexpr std::uint16_t kSecondBankFlag = 0xDDFF;
constexpr std::uint16_t kThirdBankFlag = 0xCCFF;
constexpr std::uint16_t kFourthBankFlag = 0xBBFF;

// LeiShen's driver lslidar: blocks as in the VLP-16, in packets of 1212 bytes, or of 1206 bytes with one of these bytes in the place of the product.
constexpr std::size_t kLeishenSizeBytes = 1212;
constexpr std::uint8_t kLeishenC16 = 0x10;
constexpr std::uint8_t kLeishenC32 = 0x20;

bool BeginsWith(Bytes payload, std::string_view start) {
  return payload.size() >= start.size() && std::equal(start.begin(), start.end(), payload.begin(),
                                                      [](char one, std::uint8_t other) { return static_cast<std::uint8_t>(one) == other; });
}

// Twelve blocks as in all Velodyne data packets, each with one of the flags of the four banks.
std::string_view NameOfBlocks(Bytes payload) {
  if (payload.size() != format::kDataPacketSizeBytes && payload.size() != kLeishenSizeBytes) return {};
  bool has_second_bank = false;
  bool has_higher_bank = false;
  for (std::size_t block = 0; block < format::kNumBlocks; ++block) {
    const std::uint16_t flag = ReadU16LittleEndian(payload, block * format::kBlockSizeBytes + format::kBlockFlagOffset);
    has_second_bank |= flag == kSecondBankFlag;
    has_higher_bank |= flag == kThirdBankFlag || flag == kFourthBankFlag;
    if (flag != format::kBlockFlag && flag != kSecondBankFlag && flag != kThirdBankFlag && flag != kFourthBankFlag) return {};
  }
  if (payload.size() == kLeishenSizeBytes) return has_second_bank || has_higher_bank ? ""sv : "LeiShen"sv;
  const std::uint8_t product = payload[format::kProductOffset];
  if (has_higher_bank) return NameOfProduct(kProductVls128);
  if (has_second_bank) return product == kProductVls128 || product == kProductVls128Early ? NameOfProduct(product) : "Velodyne HDL-64E"sv;
  if (product == kLeishenC16 || product == kLeishenC32) return "LeiShen";
  const bool is_own = product == format::kProductVlp16 || product == format::kProductPuckHiRes || product == format::kProductHdl32e;
  return is_own ? ""sv : NameOfProduct(product);
}

// Pandar manuals: 0xEE, 0xFF at the start; then lasers, blocks, a reserved byte and the unit of distance, 4 mm; since protocol 1.x four bytes of
// version stand before these.
bool IsHesai(Bytes payload) {
  constexpr std::array<std::uint8_t, 6> kNumLasers{16, 20, 32, 40, 64, 128};
  constexpr std::uint8_t kDistanceUnitMm = 4;
  constexpr std::array<std::size_t, 2> kHeaderStarts{2, 6};
  constexpr std::size_t kDistanceUnitPlace = 3;
  constexpr std::size_t kLeastSizeBytes = 100;
  if (payload.size() < kLeastSizeBytes || !BeginsWith(payload, "\xEE\xFF")) return false;
  return std::ranges::any_of(kHeaderStarts, [payload, &kNumLasers](std::size_t start) {
    return std::ranges::find(kNumLasers, payload[start]) != kNumLasers.end() && payload[start + kDistanceUnitPlace] == kDistanceUnitMm;
  });
}

// RS-LiDAR-16 User Manual and rs_driver: main data begins with these bytes (since the Helios with four others), device information with the third.
bool IsRobosense(Bytes payload) {
  constexpr std::size_t kSizeBytes = 1248;
  return payload.size() == kSizeBytes && (BeginsWith(payload, "\x55\xAA\x05\x0A\x5A\xA5\x50\xA0") || BeginsWith(payload, "\x55\xAA\x05\x5A") ||
                                          BeginsWith(payload, "\xA5\xFF\x00\x5A\x11\x11\x55\x55"sv));
}

// LSLiDAR CH128X1 manual: device information has RoboSense's mark, but 1206 bytes and this end.
bool IsLeishenDevice(Bytes payload) {
  return payload.size() == format::kDataPacketSizeBytes && BeginsWith(payload, "\xA5\xFF\x00\x5A\x11\x11\x55\x55"sv) &&
         BeginsWith(payload.last(2), "\x0F\xF0");
}

// Ouster's sensor documentation. Legacy: 16 blocks of head (16 bytes, the column at 8, the frame at 10), 12 bytes a pixel, and a status of all ones
// or none. Newer: a head of 32 bytes that begins with packet type 1, 16 columns of head (12 bytes, the column at 8) and 4, 8, 12 or 16 bytes a
// pixel, a foot of 32 bytes.
bool IsOuster(Bytes payload) {
  constexpr std::array<std::size_t, 4> kNumRows{16, 32, 64, 128};
  constexpr std::array<std::size_t, 4> kPixelSizesBytes{4, 8, 12, 16};
  constexpr std::size_t kNumColumns = 16;
  constexpr std::size_t kColumnPlace = 8;
  constexpr int kMaxColumns = 4096;
  const auto are_columns_in_order = [payload](std::size_t first, std::size_t size) {
    int last = -1;
    for (std::size_t column = 0; column < kNumColumns; ++column) {
      const int number = ReadU16LittleEndian(payload, first + column * size + kColumnPlace);
      if (number >= kMaxColumns || (column > 0 && number != last + 1)) return false;
      last = number;
    }
    return true;
  };
  constexpr std::size_t kLegacyHeadBytes = 16;
  constexpr std::size_t kLegacyPixelBytes = 12;
  constexpr std::size_t kLegacyStatusBytes = 4;
  constexpr std::size_t kHeadBytes = 32;
  constexpr std::size_t kFootBytes = 32;
  constexpr std::size_t kColumnHeadBytes = 12;
  for (const std::size_t num_rows : kNumRows) {
    const std::size_t legacy_column = kLegacyHeadBytes + kLegacyPixelBytes * num_rows + kLegacyStatusBytes;
    if (payload.size() == kNumColumns * legacy_column) {
      const std::uint32_t status = ReadU32LittleEndian(payload, legacy_column - kLegacyStatusBytes);
      return (status == 0 || status == 0xFFFFFFFF) && are_columns_in_order(0, legacy_column);
    }
    for (const std::size_t pixel_bytes : kPixelSizesBytes) {
      const std::size_t column = kColumnHeadBytes + pixel_bytes * num_rows;
      if (payload.size() != kHeadBytes + kNumColumns * column + kFootBytes) continue;
      return ReadU16LittleEndian(payload, 0) == 1 && are_columns_in_order(kHeadBytes, column);
    }
  }
  return false;
}

// Livox SDK communication protocol (Mid-40, Horizon, Tele-15, Avia): version 5, data type at 9, points from 18. Mid-360 and HAP: version 0, its own
// length at 1, number of points at 5, data type at 10, points from 36.
bool IsLivox(Bytes payload) {
  constexpr std::array<std::size_t, 6> kOldSizesBytes{18 + 100 * 13, 18 + 100 * 9, 18 + 96 * 14, 18 + 96 * 10, 18 + 48 * 28, 18 + 48 * 16};
  constexpr std::array<std::size_t, 4> kPointSizesBytes{24, 14, 8, 10};
  constexpr std::uint8_t kOldVersion = 5;
  constexpr std::size_t kOldTypePlace = 9;
  constexpr std::size_t kHeadBytes = 36;
  constexpr std::size_t kTypePlace = 10;
  if (payload.size() <= kHeadBytes) return false;
  if (payload[0] == kOldVersion) {
    const std::size_t type = payload[kOldTypePlace];
    return type < kOldSizesBytes.size() && payload.size() == kOldSizesBytes.at(type);
  }
  const std::size_t type = payload[kTypePlace];
  return payload[0] == 0 && ReadU16LittleEndian(payload, 1) == payload.size() && type < kPointSizesBytes.size() &&
         payload.size() == kHeadBytes + ReadU16LittleEndian(payload, 5) * kPointSizesBytes.at(type);
}

}  // namespace

std::string_view NameOfProduct(std::uint8_t product) {
  const auto found = std::ranges::find(kProducts, product, &Product::byte);
  return found == kProducts.end() ? ""sv : found->name;
}

std::string_view NameOfForeignPayload(Bytes payload) {
  if (const auto name = NameOfBlocks(payload); !name.empty()) return name;
  if (IsHesai(payload)) return "Hesai";
  if (IsRobosense(payload)) return "RoboSense";
  if (IsLeishenDevice(payload)) return "LeiShen";
  if (IsOuster(payload)) return "Ouster";
  if (IsLivox(payload)) return "Livox";
  return {};
}

}  // namespace lookout::vlp16
