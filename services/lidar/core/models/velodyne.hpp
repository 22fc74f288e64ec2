// Velodyne HDL-32E, VLP-32C and VLS-128 (Alpha Prime).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "services/lidar/core/models/packet_reader.hpp"

namespace lookout::lidar {

enum class VelodyneModel { kHdl32e, kVlp32c, kVls128 };
inline constexpr int kNumVelodyneModels = 3;

/// As in Head::model: "Velodyne VLP-32C".
std::string_view NameOf(VelodyneModel model);

/// The model that size, flag and product byte name. HDL-32E and some early VLP-16 share a product byte: the caller must tell the two apart by other
/// means.
std::optional<VelodyneModel> VelodyneModelOf(Bytes payload);

/// One firing of all lasers is a column: a block, of a VLS-128 four blocks; in dual return twice as many, whose returns are LAST and STRONGEST as
/// sent. Between two columns of a packet the head may skip a part of the circle; the time for the skipped part follows from the rate in earlier
/// packets.
class VelodyneReader : public PacketReader {
 public:
  explicit VelodyneReader(VelodyneModel model);

  std::unique_ptr<PacketReader> Clone() const override { return std::make_unique<VelodyneReader>(*this); }
  PacketFault Read(Bytes payload, Packet& packet) override;
  const Head& head() const override { return head_; }
  int head_number() const override { return head_number_; }
  const std::string& reason() const override { return reason_; }
  bool MayBe(std::size_t size_bytes) const override;

 private:
  PacketFault Refuse(PacketFault fault, std::string reason);

  VelodyneModel model_;
  Head head_;
  int head_number_ = 0;
  std::uint8_t mode_ = 0;                         // as in head_
  double rate_cdeg_ = 0.0;                        // per firing, of packets before; 0 = not known
  int num_rates_ = 0;                             // in rate_cdeg_
  std::array<std::uint16_t, 128> cell_offset_{};  // [rings] in a block
  std::array<std::uint8_t, 128> bank_{};          // [rings] which of the blocks of a firing
  std::string reason_;
};

}  // namespace lookout::lidar
