// Hesai XT16, XT32, XT32M, QT64, QT128, Pandar40P, Pandar64: one reader by a table of layouts, and the maker's files of angles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/lidar/core/models/packet_reader.hpp"

namespace lookout::lidar {

enum class HesaiModel { kXt16, kXt32, kXt32m, kQt64, kQt128, kPandar40p, kPandar64 };
inline constexpr int kNumHesaiModels = 7;

/// As in Head::model: "Hesai XT32".
std::string_view NameOf(HesaiModel model);

/// The model whose packets have this size and head. Looks at no more than that: Read may still refuse the payload.
std::optional<HesaiModel> HesaiModelOf(Bytes payload);

/// Angles of one channel, in degrees as in the maker's files.
struct HesaiAngle {
  double elevation_deg = 0.0;
  double azimuth_offset_deg = 0.0;  // clockwise, in [-180, 180)

  bool operator==(const HesaiAngle&) const = default;
};

/// The maker's table of a unit (CSV; from the sensor by command 5): columns of channel (from 1), elevation, azimuth offset, in any order and under
/// any of the makers' titles; without titles in this order. Separated by commas, semicolons or tabs.
///
/// @return by channel, without holes; 1 to 128
/// @throws std::runtime_error  "line 7: ..." with what is wrong
std::vector<HesaiAngle> ParseHesaiAngles(std::string_view csv);

/// Nominal angles of the model; the angles of a single unit differ by some 0.1 deg (0.17 m at 100 m).
std::vector<HesaiAngle> NominalHesaiAngles(HesaiModel model);

/// Each block of a packet (dual return: each pair of blocks of one azimuth) is a column. A block of a QT128 holds 96 of the 128 channels: channels 1
/// to 32 and 33 to 64 fire in turn and have no return in every other column.
///
/// Returns of a pair are told by their ranges, since models place them differently under the same mode. In modes of first, last and strongest the
/// nearer is returns[0]: STRONGEST of last + strongest (0x39), FIRST of first + last (0x3b) and first + strongest (0x3c). A lone return is nearest.
class HesaiReader : public PacketReader {
 public:
  /// @param angles  by channel
  /// @throws std::runtime_error  where the model has another number of channels
  HesaiReader(HesaiModel model, const std::vector<HesaiAngle>& angles);
  explicit HesaiReader(HesaiModel model) : HesaiReader(model, NominalHesaiAngles(model)) {}

  std::unique_ptr<PacketReader> Clone() const override { return std::make_unique<HesaiReader>(*this); }
  PacketFault Read(Bytes payload, Packet& packet) override;
  const Head& head() const override { return head_; }
  int head_number() const override { return head_number_; }
  const std::string& reason() const override { return reason_; }
  bool MayBe(std::size_t size_bytes) const override;

 private:
  PacketFault Refuse(PacketFault fault, std::string reason);
  void UpdateHead(std::uint8_t mode, int unit_mm);

  HesaiModel model_;
  Head head_;
  int head_number_ = 0;
  int unit_mm_ = 0;                               // as in head_
  std::uint8_t mode_ = 0;                         // as in head_
  bool has_right_crc_ = false;                    // once
  std::array<std::uint16_t, 128> cell_offset_{};  // [rings] in a block
  std::string reason_;
};

}  // namespace lookout::lidar
