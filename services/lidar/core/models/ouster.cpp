#include "services/lidar/core/models/ouster.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::lidar {
namespace {

using namespace std::chrono_literals;

// Firmware User Manual, "Lidar Data Packet Format", and the layouts of the maker's SDK.
constexpr std::size_t kOusterHeadBytes = 32;  // and as many at the end; LEGACY has neither
constexpr std::size_t kOusterColumnHeadBytes = 12;
constexpr std::size_t kOusterLegacyColumnHeadBytes = 16;
constexpr std::size_t kOusterLegacyStatusBytes = 4;  // at the end of a column
constexpr std::size_t kOusterIdOffset = 8;           // in a column
constexpr std::size_t kOusterStatusOffset = 10;
constexpr std::size_t kOusterLegacyFrameOffset = 10;
constexpr std::uint32_t kOusterLegacyGood = 0xFFFF'FFFF;
constexpr int kOusterLidarPacket = 1;
constexpr std::size_t kOusterChecksumBytes = 8;
constexpr int kOusterTriedChecksums = 64;
constexpr std::array kOusterColumnsPerPacket{4, 8, 16};  // that the sensor can be set to
constexpr int kOusterFirstGenerationPixels = 64;         // whatever the number of beams

constexpr std::array kOusterProfiles{OusterProfile::kLegacy, OusterProfile::kSingle, OusterProfile::kDual, OusterProfile::kLowBandwidth,
                                     OusterProfile::kFusaDual};

// Columns are 24 us to 0.4 ms apart.
constexpr int kOusterShortTurns = 3;
constexpr std::uint64_t kOusterMaxPacketNs = 1'000'000'000;
constexpr std::uint64_t kOusterMaxStampNs = std::uint64_t{1} << 62;  // the year 2116

// Where a return stands in its pixel: range in the low bits of a word, reflectivity in a byte.
template <OusterProfile kProfile>
struct OusterPixel;
template <>
struct OusterPixel<OusterProfile::kLegacy> {
  static constexpr std::size_t kBytes = 12;
  static constexpr std::uint32_t kRangeMask = (1U << 20) - 1;
  static constexpr std::array<std::size_t, 1> kRange{0};
  static constexpr std::array<std::size_t, 1> kReflectivity{4};
};
template <>
struct OusterPixel<OusterProfile::kSingle> {
  static constexpr std::size_t kBytes = 12;
  static constexpr std::uint32_t kRangeMask = (1U << 19) - 1;
  static constexpr std::array<std::size_t, 1> kRange{0};
  static constexpr std::array<std::size_t, 1> kReflectivity{4};
};
template <>
struct OusterPixel<OusterProfile::kDual> {
  static constexpr std::size_t kBytes = 16;
  static constexpr std::uint32_t kRangeMask = (1U << 19) - 1;
  static constexpr std::array<std::size_t, 2> kRange{0, 4};
  static constexpr std::array<std::size_t, 2> kReflectivity{3, 7};
};
template <>
struct OusterPixel<OusterProfile::kLowBandwidth> {
  static constexpr std::size_t kBytes = 4;
  static constexpr std::uint32_t kRangeMask = (1U << 15) - 1;
  static constexpr std::array<std::size_t, 1> kRange{0};
  static constexpr std::array<std::size_t, 1> kReflectivity{2};
};
template <>
struct OusterPixel<OusterProfile::kFusaDual> {
  static constexpr std::size_t kBytes = 8;
  static constexpr std::uint32_t kRangeMask = (1U << 15) - 1;
  static constexpr std::array<std::size_t, 2> kRange{0, 4};
  static constexpr std::array<std::size_t, 2> kReflectivity{2, 6};
};

// Calls `use` with the OusterPixel of a profile.
template <typename Use>
auto WithOusterPixel(OusterProfile profile, const Use& use) {
  switch (profile) {
    case OusterProfile::kSingle:
      return use(OusterPixel<OusterProfile::kSingle>());
    case OusterProfile::kDual:
      return use(OusterPixel<OusterProfile::kDual>());
    case OusterProfile::kLowBandwidth:
      return use(OusterPixel<OusterProfile::kLowBandwidth>());
    case OusterProfile::kFusaDual:
      return use(OusterPixel<OusterProfile::kFusaDual>());
    case OusterProfile::kLegacy:
      break;
  }
  return use(OusterPixel<OusterProfile::kLegacy>());
}

std::size_t OusterPixelBytes(OusterProfile profile) {
  return WithOusterPixel(profile, [](auto pixel) { return decltype(pixel)::kBytes; });
}

std::size_t OusterColumnBytes(OusterProfile profile, int num_pixels) {
  const auto pixels_bytes = static_cast<std::size_t>(num_pixels) * OusterPixelBytes(profile);
  return profile == OusterProfile::kLegacy ? kOusterLegacyColumnHeadBytes + pixels_bytes + kOusterLegacyStatusBytes
                                           : kOusterColumnHeadBytes + pixels_bytes;
}

std::size_t OusterPacketBytes(OusterProfile profile, int num_pixels, int num_columns) {
  const auto columns_bytes = static_cast<std::size_t>(num_columns) * OusterColumnBytes(profile, num_pixels);
  return profile == OusterProfile::kLegacy ? columns_bytes : columns_bytes + 2 * kOusterHeadBytes;
}

// CRC-64/XZ (ECMA-182, reflected), 16 bytes at a time: table k holds what a byte does that k more follow.
constexpr std::size_t kOusterCrcSlices = 16;
using OusterCrcTables = std::array<std::array<std::uint64_t, 256>, kOusterCrcSlices>;

constexpr OusterCrcTables MakeOusterCrcTables() {
  constexpr std::uint64_t kPolynomial = 0xC96C'5795'D787'0F42;
  OusterCrcTables tables{};
  for (std::size_t byte = 0; byte < 256; ++byte) {
    std::uint64_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? (crc >> 1) ^ kPolynomial : crc >> 1;
    tables[0][byte] = crc;
  }
  for (std::size_t slice = 1; slice < kOusterCrcSlices; ++slice) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const auto before = tables[slice - 1][byte];
      tables[slice][byte] = tables[0][before & 0xFF] ^ (before >> 8);
    }
  }
  return tables;
}

constexpr OusterCrcTables kOusterCrcTables = MakeOusterCrcTables();

// Share of eight bytes in the checksum when kBehind more bytes follow.
template <std::size_t kBehind>
std::uint64_t OusterCrcOfWord(std::uint64_t word) {
  const auto& tables = kOusterCrcTables;
  return tables[kBehind + 7][word & 0xFF] ^ tables[kBehind + 6][(word >> 8) & 0xFF] ^ tables[kBehind + 5][(word >> 16) & 0xFF] ^
         tables[kBehind + 4][(word >> 24) & 0xFF] ^ tables[kBehind + 3][(word >> 32) & 0xFF] ^ tables[kBehind + 2][(word >> 40) & 0xFF] ^
         tables[kBehind + 1][(word >> 48) & 0xFF] ^ tables[kBehind][word >> 56];
}

std::uint64_t OusterCrc(Bytes bytes) {
  std::uint64_t crc = ~std::uint64_t{0};
  std::size_t at = 0;
  for (; at + kOusterCrcSlices <= bytes.size(); at += kOusterCrcSlices) {
    crc = OusterCrcOfWord<8>(crc ^ ReadU64LittleEndian(bytes, at)) ^ OusterCrcOfWord<0>(ReadU64LittleEndian(bytes, at + 8));
  }
  for (; at < bytes.size(); ++at) crc = kOusterCrcTables[0][(crc ^ bytes[at]) & 0xFF] ^ (crc >> 8);
  return ~crc;
}

bool IsOusterChecksumRight(Bytes payload) {
  const auto place = payload.size() - kOusterChecksumBytes;
  return ReadU64LittleEndian(payload, place) == OusterCrc(payload.first(place));
}

std::uint64_t ReadU40LittleEndian(Bytes bytes, std::size_t offset) {
  return ReadU32LittleEndian(bytes, offset) | std::uint64_t{bytes[offset + 4]} << 32;
}

std::uint32_t ReadU24LittleEndian(Bytes bytes, std::size_t offset) {
  return ReadU16LittleEndian(bytes, offset) | std::uint32_t{bytes[offset + 2]} << 16;
}

// Firmware User Manual, "return_order"; ReturnOrder in types.h of the maker's SDK: strongest to weakest unless set otherwise.
std::vector<ReturnKind> OusterReturns(const OusterMetadata& metadata) {
  ReturnKind first = ReturnKind::kStrongest;
  if (metadata.return_order == OusterReturnOrder::kNearestToFarthest) first = ReturnKind::kFirst;
  if (metadata.return_order == OusterReturnOrder::kFarthestToNearest) first = ReturnKind::kLast;
  const bool is_dual = metadata.profile == OusterProfile::kDual || metadata.profile == OusterProfile::kFusaDual;
  return is_dual ? std::vector{first, ReturnKind::kSecond} : std::vector{first};
}

int OusterFrameBits(OusterProfile profile) { return profile == OusterProfile::kFusaDual ? 32 : 16; }

// Whether the packet has the type of a lidar packet, and good columns that go round. The size is right.
bool HasOusterColumns(Bytes payload, const OusterLayout& layout) {
  const bool is_legacy = layout.profile == OusterProfile::kLegacy;
  const int type = layout.profile == OusterProfile::kFusaDual ? payload[0] : ReadU16LittleEndian(payload, 0);
  if (!is_legacy && type != kOusterLidarPacket) return false;
  const std::size_t column_bytes = OusterColumnBytes(layout.profile, layout.pixels_per_column);
  constexpr int kMaxColumns = 4096;
  int last_id = -1;
  for (int i = 0; i < layout.columns_per_packet; ++i) {
    const std::size_t column = (is_legacy ? 0 : kOusterHeadBytes) + static_cast<std::size_t>(i) * column_bytes;
    const auto status = is_legacy ? ReadU32LittleEndian(payload, column + column_bytes - kOusterLegacyStatusBytes)
                                  : ReadU16LittleEndian(payload, column + kOusterStatusOffset);
    if (is_legacy && status != 0 && status != kOusterLegacyGood) return false;
    if ((status & 1) == 0) continue;
    const int id = ReadU16LittleEndian(payload, column + kOusterIdOffset);
    if (id >= kMaxColumns || id <= last_id || ReadU64LittleEndian(payload, column) >= kOusterMaxStampNs) return false;
    last_id = id;
  }
  return last_id >= 0;
}

double OusterRangeUnitM(OusterProfile profile) {
  return profile == OusterProfile::kLowBandwidth || profile == OusterProfile::kFusaDual ? 0.008 : 0.001;
}

}  // namespace

OusterReader::OusterReader(const OusterMetadata& metadata)
    : metadata_(metadata),
      head_bytes_(metadata.profile == OusterProfile::kLegacy ? 0 : kOusterHeadBytes),
      column_bytes_(OusterColumnBytes(metadata.profile, metadata.pixels_per_column)),
      column_head_bytes_(metadata.profile == OusterProfile::kLegacy ? kOusterLegacyColumnHeadBytes : kOusterColumnHeadBytes) {
  std::vector<std::size_t> channels(static_cast<std::size_t>(metadata.pixels_per_column));
  std::iota(channels.begin(), channels.end(), std::size_t{0});
  std::erase_if(channels, [&](std::size_t channel) { return std::isnan(metadata.elevation_rad[channel]); });
  std::ranges::stable_sort(channels, {}, [&](std::size_t channel) { return metadata.elevation_rad[channel]; });
  head_.model = metadata.ModelName();
  head_.range_unit_m = OusterRangeUnitM(metadata.profile);
  head_.returns = OusterReturns(metadata);
  head_.beams.reserve(channels.size());
  pixel_of_ring_.reserve(channels.size());
  for (const auto channel : channels) {
    const double elevation_rad = metadata.elevation_rad[channel];
    head_.beams.push_back({.elevation_rad = elevation_rad,
                           .azimuth_offset_rad = metadata.azimuth_offset_rad[channel],
                           .origin_height_m = metadata.beam_origin_height_m - metadata.beam_origin_m * Sin(elevation_rad),
                           .channel = static_cast<int>(channel)});
    pixel_of_ring_.push_back(channel * OusterPixelBytes(metadata.profile));
  }

  sizes_bytes_.push_back(OusterPacketBytes(metadata.profile, metadata.pixels_per_column, metadata.columns_per_packet));
  for (const auto profile : kOusterProfiles) {
    for (const int num_columns : kOusterColumnsPerPacket) sizes_bytes_.push_back(OusterPacketBytes(profile, metadata.pixels_per_column, num_columns));
    sizes_bytes_.push_back(OusterPacketBytes(profile, metadata.pixels_per_column, metadata.columns_per_packet));
  }
  sizes_bytes_.push_back(OusterPacketBytes(OusterProfile::kLegacy, kOusterFirstGenerationPixels, kOusterColumnsPerPacket.back()));

  // Which packets of a turn hold a column of the window, and with which of its columns each begins.
  const int num_columns = metadata.columns_per_frame;
  const int window_columns = (metadata.last_column - metadata.first_column + num_columns) % num_columns + 1;
  std::vector<int> first_columns;
  const int num_packets = (num_columns - 1) / metadata.columns_per_packet + 1;
  place_in_frame_.assign(static_cast<std::size_t>(num_packets), -1);
  next_column_.assign(place_in_frame_.size(), 0);
  for (int id = 0; id < num_columns; ++id) {
    const bool is_in_window = (id - metadata.first_column + num_columns) % num_columns < window_columns;
    const auto packet = static_cast<std::size_t>(id / metadata.columns_per_packet);
    if (!is_in_window || place_in_frame_[packet] >= 0) continue;
    place_in_frame_[packet] = packets_per_frame_++;
    first_columns.push_back(id);
  }
  for (std::size_t packet = place_in_frame_.size(), next = 0; packet-- > 0;) {
    next_column_[packet] = first_columns[next % first_columns.size()];
    if (place_in_frame_[packet] >= 0) next = static_cast<std::size_t>(place_in_frame_[packet]);
  }
  good_columns_.reserve(static_cast<std::size_t>(metadata.columns_per_packet));
}

bool OusterReader::MayBe(std::size_t size_bytes) const { return std::ranges::find(sizes_bytes_, size_bytes) != sizes_bytes_.end(); }

PacketFault OusterReader::Refuse(PacketFault fault, const std::string& reason) {
  reason_ = head_.model + ": " + reason;
  return fault;
}

PacketFault OusterReader::CheckHead(Bytes payload, bool is_checksum_right) {
  if (has_checksum_ && !is_checksum_right) return Refuse(PacketFault::kChecksum, "the checksum of the packet is wrong");
  const bool is_fusa = metadata_.profile == OusterProfile::kFusaDual;
  const int type = is_fusa ? payload[0] : ReadU16LittleEndian(payload, 0);
  if (type != kOusterLidarPacket) return Refuse(PacketFault::kHead, "packet type " + std::to_string(type) + ", where 1 is a lidar packet");
  const auto serial_number = ReadU40LittleEndian(payload, is_fusa ? 11 : 7);
  // Recordings that were made anonymous have zeros.
  if (metadata_.serial_number && serial_number != 0 && serial_number != *metadata_.serial_number) {
    return Refuse(PacketFault::kHead, "the packet is of the sensor with the serial number " + std::to_string(serial_number) +
                                          ", the metadata are of " + std::to_string(*metadata_.serial_number));
  }
  return PacketFault::kNone;
}

PacketFault OusterReader::FindColumns(Bytes payload) {
  good_columns_.clear();
  const bool is_legacy = metadata_.profile == OusterProfile::kLegacy;
  const int num_columns = metadata_.columns_per_frame;
  for (int i = 0; i < metadata_.columns_per_packet; ++i) {
    const std::size_t column = head_bytes_ + static_cast<std::size_t>(i) * column_bytes_;
    const int id = ReadU16LittleEndian(payload, column + kOusterIdOffset);
    const auto stamp_ns = ReadU64LittleEndian(payload, column);
    if (i == 0) {
      first_id_ = id;
      first_stamp_ns_ = stamp_ns;
    }
    const bool is_good = is_legacy ? ReadU32LittleEndian(payload, column + column_bytes_ - kOusterLegacyStatusBytes) == kOusterLegacyGood
                                   : (ReadU16LittleEndian(payload, column + kOusterStatusOffset) & 1) != 0;
    if (!is_good) continue;
    if (id >= num_columns) {
      return Refuse(PacketFault::kAzimuth, "column " + std::to_string(id) + " of a turn of " + std::to_string(num_columns));
    }
    if (stamp_ns >= kOusterMaxStampNs) return Refuse(PacketFault::kStamp, "the stamp of a column is beyond the year 2116");
    if (!good_columns_.empty()) {
      const auto& first = good_columns_.front();
      const auto& last = good_columns_.back();
      const auto turned = [&](int to) { return to >= first.id ? to - first.id : to - first.id + num_columns; };
      if (turned(id) <= turned(last.id)) return Refuse(PacketFault::kHead, "the columns of the packet do not go round");
      if (stamp_ns < last.stamp_ns || stamp_ns - first.stamp_ns > kOusterMaxPacketNs) {
        return Refuse(PacketFault::kStamp, "the stamps of the packet's columns jump");
      }
    }
    good_columns_.push_back({.pixels = column + column_head_bytes_, .id = id, .stamp_ns = stamp_ns});
  }
  if (good_columns_.empty()) {
    // Filler is no place of a column.
    const std::size_t last = head_bytes_ + static_cast<std::size_t>(metadata_.columns_per_packet - 1) * column_bytes_;
    if (ReadU16LittleEndian(payload, last + kOusterIdOffset) != first_id_ + metadata_.columns_per_packet - 1) first_id_ = num_columns;
    if (first_stamp_ns_ >= kOusterMaxStampNs) return Refuse(PacketFault::kStamp, "the stamp of a column is beyond the year 2116");
  } else {
    first_id_ = good_columns_.front().id;
    first_stamp_ns_ = good_columns_.front().stamp_ns;
  }
  return PacketFault::kNone;
}

std::chrono::nanoseconds OusterReader::DurationOf(int first_id) const {
  const std::int64_t num_columns = metadata_.columns_per_frame;
  std::int64_t ahead = metadata_.columns_per_packet;
  if (first_id < num_columns) {
    const auto packet = static_cast<std::size_t>(first_id / metadata_.columns_per_packet);
    ahead = has_other_window_ ? (first_id / metadata_.columns_per_packet + 1) * metadata_.columns_per_packet - first_id
                              : (next_column_[packet] - first_id + num_columns - 1) % num_columns + 1;
  }
  std::int64_t span_ns = std::chrono::nanoseconds(1s).count();
  std::int64_t span_columns = num_columns * metadata_.frames_per_s;
  if (good_columns_.size() > 1) {
    span_ns = static_cast<std::int64_t>(good_columns_.back().stamp_ns - good_columns_.front().stamp_ns);
    span_columns = (good_columns_.back().id - good_columns_.front().id + num_columns) % num_columns;
  }
  return std::chrono::nanoseconds((span_ns * ahead + span_columns / 2) / span_columns);
}

// Firmware User Manual: the frame id counts turns, from column 0 on, also where the window goes over it.
std::uint32_t OusterReader::FrameOf(Bytes payload) const {
  if (metadata_.profile == OusterProfile::kFusaDual) return ReadU32LittleEndian(payload, 4);
  if (metadata_.profile != OusterProfile::kLegacy) return ReadU16LittleEndian(payload, 2);
  const std::size_t column = good_columns_.empty() ? 0 : good_columns_.front().pixels - column_head_bytes_;
  return ReadU16LittleEndian(payload, column + kOusterLegacyFrameOffset);
}

// A sensor with half as many columns as the metadata say sends packets of the same size, and all its azimuths would be read as half their value. Its
// turns end early: the frame id goes on by one and no time passes for the columns that are missing.
bool OusterReader::HasShortTurns(std::uint32_t frame) {
  if (good_columns_.size() < 2) return short_turn_columns_ != 0;
  const std::int64_t num_columns = metadata_.columns_per_frame;
  const auto& first = good_columns_.front();
  const auto& last = good_columns_.back();
  const Turning now{.frame = frame,
                    .id = first.id,
                    .stamp_ns = first.stamp_ns,
                    .column_ns = (last.stamp_ns - first.stamp_ns) / static_cast<std::uint64_t>((last.id - first.id + num_columns) % num_columns)};
  if (last_turning_ && frame == last_turning_->frame + 1 && first.stamp_ns >= last_turning_->stamp_ns) {
    const std::int64_t columns_by_id = first.id + num_columns - last_turning_->id;
    const auto elapsed_ns = static_cast<std::int64_t>(std::min(first.stamp_ns - last_turning_->stamp_ns, kOusterMaxPacketNs));
    const std::int64_t columns_by_time = elapsed_ns / std::max<std::int64_t>(1, static_cast<std::int64_t>(now.column_ns));
    // Once, it may be a clock that was set back.
    const bool is_short = now.column_ns > 0 && columns_by_id - columns_by_time > num_columns / 4;
    num_short_turns_ = is_short ? num_short_turns_ + 1 : 0;
    if (num_short_turns_ >= kOusterShortTurns) short_turn_columns_ = last_turning_->id + metadata_.columns_per_packet;
    if (num_short_turns_ == 0) short_turn_columns_ = 0;
  }
  if (last.id >= short_turn_columns_) short_turn_columns_ = 0;
  last_turning_ = now;
  return short_turn_columns_ != 0;
}

std::optional<PacketNumber> OusterReader::NumberOf(std::uint32_t frame, int first_id) const {
  if (has_other_window_ || first_id >= metadata_.columns_per_frame) return std::nullopt;
  const int place = place_in_frame_[static_cast<std::size_t>(first_id / metadata_.columns_per_packet)];
  if (place < 0) return std::nullopt;
  const auto packets_per_frame = static_cast<std::uint64_t>(packets_per_frame_);
  return PacketNumber{.number = std::uint64_t{frame} * packets_per_frame + static_cast<std::uint64_t>(place),
                      .modulus = packets_per_frame << OusterFrameBits(metadata_.profile)};
}

void OusterReader::Fill(Bytes payload, Packet& packet) const {
  const std::size_t num_rings = pixel_of_ring_.size();
  const std::size_t num_cells = good_columns_.size() * num_rings * head_.returns.size();
  packet.range.resize(num_cells);
  packet.reflectivity.resize(num_cells);
  WithOusterPixel(metadata_.profile, [&](auto pixel_type) {
    using Pixel = decltype(pixel_type);
    std::uint32_t* range_out = packet.range.data();
    std::uint8_t* reflectivity_out = packet.reflectivity.data();
    for (const auto& column : good_columns_) {
      const Bytes pixels = payload.subspan(column.pixels, num_rings * Pixel::kBytes);
      for (const std::size_t place : pixel_of_ring_) {
        for (std::size_t i = 0; i < Pixel::kRange.size(); ++i) {
          const std::uint32_t range = ReadU32LittleEndian(pixels, place + Pixel::kRange[i]) & Pixel::kRangeMask;
          *range_out++ = range;
          *reflectivity_out++ = static_cast<std::uint8_t>(pixels[place + Pixel::kReflectivity[i]] & (range != 0 ? 0xFF : 0));
        }
      }
    }
  });
}

PacketFault OusterReader::Read(Bytes payload, Packet& packet) {
  if (payload.size() != sizes_bytes_.front()) {
    const std::string size = std::to_string(payload.size()) + " bytes, where a packet of " + std::string(NameOf(metadata_.profile)) + " has " +
                             std::to_string(sizes_bytes_.front());
    if (!MayBe(payload.size())) return Refuse(PacketFault::kSize, size);
    return Refuse(PacketFault::kMode, size + ": the sensor sends another profile than its metadata say");
  }
  const bool has_head = metadata_.profile != OusterProfile::kLegacy;
  bool is_checksum_right = false;
  if (has_head) {
    const bool is_tried = metadata_.profile != OusterProfile::kFusaDual && (has_checksum_ || num_wrong_checksums_ < kOusterTriedChecksums);
    is_checksum_right = is_tried && IsOusterChecksumRight(payload);
    if (const auto fault = CheckHead(payload, is_checksum_right); fault != PacketFault::kNone) return fault;
  }
  if (const auto fault = FindColumns(payload); fault != PacketFault::kNone) return fault;
  const auto frame = FrameOf(payload);
  if (HasShortTurns(frame)) {
    return Refuse(PacketFault::kMode, "turns end behind column " + std::to_string(short_turn_columns_ - 1) + ", where the metadata say " +
                                          std::to_string(metadata_.columns_per_frame) + " columns: the sensor was set to another mode");
  }

  if (has_head) {
    has_checksum_ = has_checksum_ || is_checksum_right;
    if (!has_checksum_ && num_wrong_checksums_ < kOusterTriedChecksums) ++num_wrong_checksums_;
    has_other_init_id_ =
        metadata_.init_id && ReadU24LittleEndian(payload, metadata_.profile == OusterProfile::kFusaDual ? 8 : 4) != *metadata_.init_id;
  }
  const auto is_in_window = [&](const GoodColumn& column) {
    const int num_columns = metadata_.columns_per_frame;
    const auto past = [&](int id) { return (id - metadata_.first_column + num_columns) % num_columns; };
    return past(column.id) <= past(metadata_.last_column);
  };
  has_other_window_ = has_other_window_ || !std::ranges::all_of(good_columns_, is_in_window);

  packet.stamp = std::chrono::nanoseconds(static_cast<std::int64_t>(first_stamp_ns_));
  packet.duration = DurationOf(first_id_);
  packet.number = NumberOf(frame, first_id_);
  packet.columns.resize(good_columns_.size());
  std::ranges::transform(good_columns_, packet.columns.begin(), [&](const GoodColumn& column) {
    return Column{.azimuth_rad = kTwoPi * column.id / metadata_.columns_per_frame,
                  .time = std::chrono::nanoseconds(static_cast<std::int64_t>(column.stamp_ns - first_stamp_ns_))};
  });
  Fill(payload, packet);
  return PacketFault::kNone;
}

std::vector<OusterLayout> OusterLayoutsOf(Bytes payload) {
  constexpr std::array kPixels{16, 32, 64, 128};
  std::vector<OusterLayout> layouts;
  for (const auto profile : kOusterProfiles) {
    for (const int pixels : kPixels) {
      for (const int columns : kOusterColumnsPerPacket) {
        const OusterLayout layout{profile, pixels, columns};
        if (payload.size() == OusterPacketBytes(profile, pixels, columns) && HasOusterColumns(payload, layout)) layouts.push_back(layout);
      }
    }
  }
  return layouts;
}

std::chrono::nanoseconds OusterStampOf(Bytes payload, const OusterLayout& layout) {
  const auto stamp_ns = ReadU64LittleEndian(payload, layout.profile == OusterProfile::kLegacy ? 0 : kOusterHeadBytes);
  return std::chrono::nanoseconds(static_cast<std::int64_t>(std::min(stamp_ns, kOusterMaxStampNs)));
}

std::optional<OusterImu> ParseOusterImu(Bytes payload) {
  constexpr std::size_t kImuBytes = 48;
  // Twice the widest scale of the sensor's IMU.
  constexpr float kMaxAccelerationG = 32.0F;
  constexpr float kMaxRateDegps = 4000.0F;
  if (payload.size() != kImuBytes) return std::nullopt;
  OusterImu sample;
  for (const auto& [offset, stamp] :
       {std::pair<std::size_t, std::chrono::nanoseconds*>{0, &sample.stamp}, {8, &sample.acceleration_stamp}, {16, &sample.rate_stamp}}) {
    const auto stamp_ns = ReadU64LittleEndian(payload, offset);
    if (stamp_ns >= kOusterMaxStampNs) return std::nullopt;
    *stamp = std::chrono::nanoseconds(static_cast<std::int64_t>(stamp_ns));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sample.acceleration_g[axis] = std::bit_cast<float>(ReadU32LittleEndian(payload, 24 + 4 * axis));
    sample.rate_degps[axis] = std::bit_cast<float>(ReadU32LittleEndian(payload, 36 + 4 * axis));
    // A number that is none compares as false.
    if (!(std::abs(sample.acceleration_g[axis]) <= kMaxAccelerationG && std::abs(sample.rate_degps[axis]) <= kMaxRateDegps)) return std::nullopt;
  }
  return sample;
}

}  // namespace lookout::lidar
