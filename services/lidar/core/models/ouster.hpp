// Ouster OS0, OS1, OS2: packets of columns, one column a firing of all channels.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "services/lidar/core/models/ouster_metadata.hpp"
#include "services/lidar/core/models/packet_reader.hpp"

namespace lookout::lidar {

/// Data packets in the profile of the metadata. The frame is the maker's lidar frame, whose x axis points to the connector; OusterMetadata has the
/// transform to the housing.
///
/// Beam::origin_height_m is exact. The level shift of beams that start off the axis is left out: n (cos(azimuth offset) - cos(elevation))
/// along the beam and n sin(azimuth offset) across it, together to 8.4 mm on OS0 and 1.6 mm on OS1.
class OusterReader final : public PacketReader {
 public:
  explicit OusterReader(const OusterMetadata& metadata);

  std::unique_ptr<PacketReader> Clone() const override { return std::make_unique<OusterReader>(*this); }
  PacketFault Read(Bytes payload, Packet& packet) override;
  const Head& head() const override { return head_; }
  int head_number() const override { return 0; }
  const std::string& reason() const override { return reason_; }
  bool MayBe(std::size_t size_bytes) const override;

  /// Packets are refused by their checksum: it was right once.
  bool has_checksum() const { return has_checksum_; }

  /// The sensor was initialised since its metadata were read: its mode may be another.
  bool has_other_init_id() const { return has_other_init_id_; }

  /// A good column came from outside of the window of the metadata. From then on packets have no number.
  bool has_other_window() const { return has_other_window_; }

 private:
  // A column of good status.
  struct GoodColumn {
    std::size_t pixels = 0;  // offset in the payload
    int id = 0;              // place in the turn
    std::uint64_t stamp_ns = 0;
  };

  // Where and when a packet began.
  struct Turning {
    std::uint32_t frame = 0;
    int id = 0;
    std::uint64_t stamp_ns = 0;
    std::uint64_t column_ns = 0;  // between two columns
  };

  PacketFault Refuse(PacketFault fault, const std::string& reason);
  PacketFault CheckHead(Bytes payload, bool is_checksum_right);
  PacketFault FindColumns(Bytes payload);
  std::chrono::nanoseconds DurationOf(int first_id) const;
  std::uint32_t FrameOf(Bytes payload) const;
  bool HasShortTurns(std::uint32_t frame);
  std::optional<PacketNumber> NumberOf(std::uint32_t frame, int first_id) const;
  void Fill(Bytes payload, Packet& packet) const;

  OusterMetadata metadata_;
  Head head_;
  std::string reason_;
  std::vector<std::size_t> sizes_bytes_;  // of packets of this sensor, in any mode; first the size that the metadata give

  // Layout of a packet in the profile of the metadata.
  std::size_t head_bytes_ = 0;
  std::size_t column_bytes_ = 0;
  std::size_t column_head_bytes_ = 0;
  std::vector<std::size_t> pixel_of_ring_;  // offset in a column, behind its head

  // Packets of a turn, by the place of their first column.
  std::vector<int> place_in_frame_;  // -1: outside of the window
  std::vector<int> next_column_;     // with which the next packet begins
  int packets_per_frame_ = 0;

  std::vector<GoodColumn> good_columns_;  // of the packet at hand
  int first_id_ = 0;                      // id of the packet's first column, good or not; columns_per_frame where the id is not known
  std::uint64_t first_stamp_ns_ = 0;

  std::optional<Turning> last_turning_;
  int num_short_turns_ = 0;     // in a row
  int short_turn_columns_ = 0;  // columns of a turn, where turns are shorter than the metadata say; 0: turns are whole

  bool has_checksum_ = false;
  int num_wrong_checksums_ = 0;
  bool has_other_init_id_ = false;
  bool has_other_window_ = false;
};

/// A layout that a data packet may have, where no metadata tell.
struct OusterLayout {
  OusterProfile profile = OusterProfile::kLegacy;
  int pixels_per_column = 0;
  int columns_per_packet = 0;

  friend bool operator==(const OusterLayout&, const OusterLayout&) = default;
};

/// @return every layout that has the size of this payload and columns that follow one another; empty: it is no data packet of an Ouster. Layouts of
///         one size cannot be told apart by a packet
std::vector<OusterLayout> OusterLayoutsOf(Bytes payload);

/// Stamp of the first column. Precondition: `layout` is one of OusterLayoutsOf(payload).
std::chrono::nanoseconds OusterStampOf(Bytes payload, const OusterLayout& layout);

/// A sample of the sensor's IMU: LEGACY, 48 bytes at 100 Hz. Along the axes of the IMU; OusterMetadata::T_sensor_imu turns them to those of the
/// sensor.
struct OusterImu {
  std::chrono::nanoseconds stamp{0};  // when the packet was made, by the clock of the columns
  std::chrono::nanoseconds acceleration_stamp{0};
  std::chrono::nanoseconds rate_stamp{0};
  std::array<float, 3> acceleration_g{};  // x, y, z; at rest 1.00 to 1.14 upwards
  std::array<float, 3> rate_degps{};      // about x, y, z
};

/// @return nullopt for any other size, and for numbers that no such IMU gives
std::optional<OusterImu> ParseOusterImu(Bytes payload);

}  // namespace lookout::lidar
