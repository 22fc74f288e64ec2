#include "services/lidar/core/models/hesai.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "common/core/angles.hpp"
#include "services/lidar/core/models/hesai_tables.hpp"

namespace lookout::lidar {

namespace {

using std::chrono::nanoseconds;

constexpr int kCdegPerHesaiTurn = 36000;
constexpr std::size_t kNoByte = 0;  // the layout does not have this byte

/// Layout of a model's packets. Offsets of the head count from the begin of the packet, offsets of the tail from the begin of the tail.
struct HesaiLayout {
  std::string_view name;
  std::array<std::uint16_t, 2> sizes;  // bytes of a packet, without and with its optional part
  std::size_t num_channels;
  std::size_t num_blocks;
  std::size_t head_bytes;
  std::size_t channels_at;  // kNoByte: blocks begin with a flag instead of a head
  std::size_t blocks_at;
  std::size_t unit_at;
  std::size_t cell_bytes;
  std::size_t tail_at;
  std::size_t us_at;
  std::size_t mode_at;
  std::size_t date_at;
  std::size_t sequence_at;  // beyond the end of a packet that has no number
  std::size_t crc_at;       // checksum of the body, from the packet's begin; kNoByte: there is none
  int unit_mm;              // of the manual
  bool is_counted_back;     // first_ns is of the last column of a packet, else of the first
  std::int64_t first_ns;    // from the packet's stamp to the first shot of that column
  std::int64_t period_ps;   // from column to column

  constexpr std::size_t block_head_bytes() const { return channels_at == kNoByte ? 4 : 2; }
  constexpr std::size_t block_bytes() const { return block_head_bytes() + num_channels * cell_bytes; }
  constexpr bool HasSize(std::size_t size_bytes) const { return size_bytes == sizes[0] || size_bytes == sizes[1]; }
};

// By HesaiModel. Sources: layouts of tier4/nebula and HesaiLidar_SDK_2.0; times of the latter. In XT heads and in QT64 and QT128 the packets of the
// sensor end with the number of the packet, in Pandar40P and Pandar64 by its setting; QT128 adds a signature of 32 bytes.
constexpr std::array<HesaiLayout, kNumHesaiModels> kHesaiLayouts{{
    {"Hesai XT16", {564, 568}, 16, 8, 12, 6, 7, 9, 4, 540, 19, 10, 13, 24, kNoByte, 4, true, 5632 + 368, 50'000'000},
    {"Hesai XT32", {1076, 1080}, 32, 8, 12, 6, 7, 9, 4, 1052, 19, 10, 13, 24, kNoByte, 4, true, 5632 + 368, 50'000'000},
    {"Hesai XT32M", {816, 820}, 32, 6, 12, 6, 7, 9, 4, 792, 19, 10, 13, 24, kNoByte, 5, true, 5632 + 368, 50'000'000},
    {"Hesai QT64", {1068, 1072}, 64, 4, 12, 6, 7, 9, 4, 1044, 12, 16, 18, 24, kNoByte, 4, false, 25'710 + 12'310, 166'666'667},
    {"Hesai QT128", {1095, 1127}, 128, 2, 12, 6, 7, 9, 4, 1061, 21, 12, 15, 26, 1040, 4, false, 9000, 111'110'000},
    {"Hesai Pandar40P", {1262, 1266}, 40, 10, 0, kNoByte, kNoByte, kNoByte, 3, 1240, 10, 14, 16, 22, kNoByte, 4, true, -28'580 - 54'670, 55'560'000},
    {"Hesai Pandar64", {1194, 1198}, 64, 6, 8, 2, 3, 5, 3, 1172, 10, 14, 16, 22, kNoByte, 4, true, -42'580 - 54'668, 55'560'000},
}};

constexpr const HesaiLayout& HesaiLayoutOf(HesaiModel model) { return kHesaiLayouts[static_cast<std::size_t>(model)]; }

static_assert(std::ranges::all_of(kHesaiLayouts, [](const HesaiLayout& layout) {
  const std::size_t body_end = layout.head_bytes + layout.num_blocks * layout.block_bytes();
  return layout.crc_at == kNoByte ? layout.tail_at == body_end : layout.crc_at == body_end;
}));

std::int64_t FireNs(HesaiModel model, std::size_t channel) {
  const auto number = static_cast<std::int64_t>(channel);
  switch (model) {
    case HesaiModel::kXt16:
      return 3024 * number;
    case HesaiModel::kXt32:
      return 1512 * number;
    case HesaiModel::kXt32m:
      return 2888 * (number % 16);
    case HesaiModel::kQt64:
      return hesai::kQt64FireNs[channel];
    case HesaiModel::kQt128:
      return hesai::kQt128FireNs[channel];
    case HesaiModel::kPandar40p:
      return hesai::kPandar40pFireNs[channel];
    case HesaiModel::kPandar64:
      return hesai::kPandar64FireNs[channel];
  }
  return 0;
}

/// How the blocks of one azimuth become returns.
enum class HesaiOrder { kAsSent, kNearestFirst, kNearestAndFarthest };

struct HesaiReturnMode {
  std::size_t num_blocks = 1;  // of one azimuth
  HesaiOrder order = HesaiOrder::kAsSent;
  std::array<ReturnKind, 2> kinds{};

  std::size_t num_returns() const { return num_blocks == 1 ? 1 : 2; }
};

std::optional<HesaiReturnMode> HesaiReturnModeOf(std::uint8_t byte) {
  using enum ReturnKind;
  switch (byte) {
    case 0x33:
      return HesaiReturnMode{1, HesaiOrder::kAsSent, {kFirst}};
    case 0x34:
      return HesaiReturnMode{1, HesaiOrder::kAsSent, {kSecond}};
    case 0x37:
      return HesaiReturnMode{1, HesaiOrder::kAsSent, {kStrongest}};
    case 0x38:
      return HesaiReturnMode{1, HesaiOrder::kAsSent, {kLast}};
    case 0x39:
      return HesaiReturnMode{2, HesaiOrder::kNearestFirst, {kStrongest, kLast}};
    case 0x3a:
      return HesaiReturnMode{2, HesaiOrder::kNearestFirst, {kFirst, kSecond}};
    case 0x3b:
      return HesaiReturnMode{2, HesaiOrder::kNearestFirst, {kFirst, kLast}};
    case 0x3c:
      return HesaiReturnMode{2, HesaiOrder::kNearestFirst, {kFirst, kStrongest}};
    case 0x3d:
      return HesaiReturnMode{3, HesaiOrder::kNearestAndFarthest, {kFirst, kLast}};
    case 0x3e:
      return HesaiReturnMode{2, HesaiOrder::kAsSent, {kStrongest, kSecond}};
    default:
      return std::nullopt;
  }
}

// A cell as one number that sorts by range. A cell without a return sorts as the farthest.
constexpr std::uint32_t NearKey(const std::uint8_t* cell) {
  const std::uint32_t range = cell[0] | std::uint32_t{cell[1]} << 8;
  return ((range - 1) & 0xFFFF) << 8 | cell[2];
}
constexpr std::uint16_t RangeOfKey(std::uint32_t key) { return static_cast<std::uint16_t>((key >> 8) + 1); }
constexpr std::uint8_t ReflectivityOfKey(std::uint32_t key) { return RangeOfKey(key) != 0 ? static_cast<std::uint8_t>(key & 0xFF) : 0; }

void CopyBlock(const std::uint8_t* block, std::size_t num_rings, const std::uint16_t* cell_offset, std::size_t num_returns, std::size_t first_return,
               std::uint32_t* range, std::uint8_t* reflectivity) {
  for (std::size_t ring = 0; ring < num_rings; ++ring) {
    const std::uint32_t key = NearKey(block + cell_offset[ring]);
    range[ring * num_returns + first_return] = RangeOfKey(key);
    reflectivity[ring * num_returns + first_return] = ReflectivityOfKey(key);
  }
}

void CopyPair(const std::uint8_t* one, const std::uint8_t* other, std::size_t num_rings, const std::uint16_t* cell_offset, std::uint32_t* range,
              std::uint8_t* reflectivity) {
  for (std::size_t ring = 0; ring < num_rings; ++ring) {
    const std::uint32_t one_key = NearKey(one + cell_offset[ring]);
    const std::uint32_t other_key = NearKey(other + cell_offset[ring]);
    const std::uint32_t near = std::min(one_key, other_key);
    const std::uint32_t far = std::max(one_key, other_key);
    range[2 * ring] = RangeOfKey(near);
    range[2 * ring + 1] = RangeOfKey(far);
    reflectivity[2 * ring] = ReflectivityOfKey(near);
    reflectivity[2 * ring + 1] = ReflectivityOfKey(far);
  }
}

// The nearest and the farthest of three; a lone return is the nearest.
void CopyThree(const std::uint8_t* first_block, std::size_t block_bytes, std::size_t num_rings, const std::uint16_t* cell_offset,
               std::uint32_t* range, std::uint8_t* reflectivity) {
  for (std::size_t ring = 0; ring < num_rings; ++ring) {
    std::array<std::uint32_t, 3> keys{};
    for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = NearKey(first_block + i * block_bytes + cell_offset[ring]);
    std::ranges::sort(keys);
    const std::uint32_t far = RangeOfKey(keys[2]) != 0 ? keys[2] : keys[1];
    range[2 * ring] = RangeOfKey(keys[0]);
    range[2 * ring + 1] = RangeOfKey(far);
    reflectivity[2 * ring] = ReflectivityOfKey(keys[0]);
    reflectivity[2 * ring + 1] = ReflectivityOfKey(far);
  }
}

// CRC-32/MPEG-2: polynomial 0x04C11DB7, highest bit first, begins with ones, nothing is inverted. Four bytes at a time.
constexpr std::array<std::array<std::uint32_t, 256>, 4> MakeCrcTables() {
  std::array<std::array<std::uint32_t, 256>, 4> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte << 24;
    for (int bit = 0; bit < 8; ++bit) crc = crc << 1 ^ ((crc & 0x80000000U) != 0 ? 0x04C11DB7U : 0U);
    tables[0][byte] = crc;
  }
  for (std::size_t table = 1; table < tables.size(); ++table) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[table - 1][byte];
      tables[table][byte] = before << 8 ^ tables[0][before >> 24];
    }
  }
  return tables;
}

constexpr std::uint32_t Crc32Mpeg2(Bytes bytes) {
  constexpr auto kTables = MakeCrcTables();
  std::uint32_t crc = 0xFFFFFFFFU;
  std::size_t i = 0;
  for (; i + 4 <= bytes.size(); i += 4) {
    crc ^= std::uint32_t{bytes[i]} << 24 | std::uint32_t{bytes[i + 1]} << 16 | std::uint32_t{bytes[i + 2]} << 8 | bytes[i + 3];
    crc = kTables[3][crc >> 24] ^ kTables[2][crc >> 16 & 0xFF] ^ kTables[1][crc >> 8 & 0xFF] ^ kTables[0][crc & 0xFF];
  }
  for (; i < bytes.size(); ++i) crc = crc << 8 ^ kTables[0][crc >> 24 ^ bytes[i]];
  return crc;
}
constexpr std::array<std::uint8_t, 9> kCrcCheckInput{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
static_assert(Crc32Mpeg2(kCrcCheckInput) == 0x0376E6E7U);

/// Seconds since 1970 of the six bytes of a date. Bytes of year below 70 are of this century (Pandar40P, Pandar64), others count from 1900. XT and QT
/// heads may send 0, 0 and seconds, highest byte first, instead (HesaiLidar_SDK_2.0, GetMicroLidarTimeU64).
std::optional<std::chrono::sys_seconds> DateOf(Bytes date, bool may_be_seconds) {
  using namespace std::chrono;
  if (may_be_seconds && date[0] == 0) {
    return sys_seconds(seconds(std::uint32_t{date[2]} << 24 | std::uint32_t{date[3]} << 16 | std::uint32_t{date[4]} << 8 | date[5]));
  }
  constexpr std::uint8_t kFirstYearOfLastCentury = 70;
  const year_month_day day(year(date[0] + (date[0] < kFirstYearOfLastCentury ? 2000 : 1900)), month(date[1]), std::chrono::day(date[2]));
  // 60: a leap second.
  if (!day.ok() || date[3] > 23 || date[4] > 59 || date[5] > 60) return std::nullopt;
  return sys_days(day) + hours(date[3]) + minutes(date[4]) + seconds(date[5]);
}

bool HasHeadOf(const HesaiLayout& layout, Bytes payload) {
  if (layout.channels_at == kNoByte) {
    for (std::size_t block = 0; block < layout.num_blocks; ++block) {
      if (payload[block * layout.block_bytes()] != 0xFF || payload[block * layout.block_bytes() + 1] != 0xEE) return false;
    }
    return true;
  }
  return payload[0] == 0xEE && payload[1] == 0xFF && payload[layout.channels_at] == layout.num_channels &&
         payload[layout.blocks_at] == layout.num_blocks;
}

}  // namespace

std::string_view NameOf(HesaiModel model) { return HesaiLayoutOf(model).name; }

std::optional<HesaiModel> HesaiModelOf(Bytes payload) {
  for (int i = 0; i < kNumHesaiModels; ++i) {
    const auto model = static_cast<HesaiModel>(i);
    if (HesaiLayoutOf(model).HasSize(payload.size()) && HasHeadOf(HesaiLayoutOf(model), payload)) return model;
  }
  return std::nullopt;
}

HesaiReader::HesaiReader(HesaiModel model, const std::vector<HesaiAngle>& angles) : model_(model) {
  const auto& layout = HesaiLayoutOf(model);
  if (angles.size() != layout.num_channels) {
    throw std::runtime_error("the table of angles has " + std::to_string(angles.size()) + " channels; " + std::string(layout.name) + " has " +
                             std::to_string(layout.num_channels));
  }
  std::vector<std::size_t> channel_of_ring(angles.size());
  std::iota(channel_of_ring.begin(), channel_of_ring.end(), std::size_t{0});
  std::ranges::stable_sort(channel_of_ring, {}, [&](std::size_t channel) { return angles[channel].elevation_deg; });
  head_.model = layout.name;
  head_.stamp = StampKind::kAbsolute;
  head_.beams.reserve(angles.size());
  for (std::size_t ring = 0; ring < channel_of_ring.size(); ++ring) {
    const std::size_t channel = channel_of_ring[ring];
    cell_offset_[ring] = static_cast<std::uint16_t>(layout.block_head_bytes() + channel * layout.cell_bytes);
    Beam beam;
    beam.elevation_rad = DegToRad(angles[channel].elevation_deg);
    beam.azimuth_offset_rad = DegToRad(angles[channel].azimuth_offset_deg);
    beam.time_offset = nanoseconds(FireNs(model, channel));
    beam.channel = static_cast<int>(channel);
    head_.beams.push_back(beam);
  }
  head_.range_unit_m = layout.unit_mm / 1000.0;
  head_.returns = {ReturnKind::kStrongest};
}

bool HesaiReader::MayBe(std::size_t size_bytes) const { return HesaiLayoutOf(model_).HasSize(size_bytes); }

PacketFault HesaiReader::Refuse(PacketFault fault, std::string reason) {
  reason_ = std::string(NameOf(model_)) + ": " + std::move(reason);
  return fault;
}

void HesaiReader::UpdateHead(std::uint8_t mode, int unit_mm) {
  if (mode == mode_ && unit_mm == unit_mm_) return;
  const auto returns = HesaiReturnModeOf(mode).value();
  mode_ = mode;
  unit_mm_ = unit_mm;
  head_.range_unit_m = unit_mm / 1000.0;
  head_.returns.assign(returns.kinds.begin(), returns.kinds.begin() + static_cast<std::ptrdiff_t>(returns.num_returns()));
  head_.is_hearing_three = returns.num_blocks == 3;
  ++head_number_;
}

PacketFault HesaiReader::Read(Bytes payload, Packet& packet) {
  const auto& layout = HesaiLayoutOf(model_);
  if (!layout.HasSize(payload.size()) || !HasHeadOf(layout, payload)) {
    const bool has_size = layout.HasSize(payload.size());
    const auto other = HesaiModelOf(payload);
    return Refuse(has_size ? PacketFault::kHead : PacketFault::kSize,
                  other      ? "the packet is of a " + std::string(NameOf(*other))
                  : has_size ? "the packet has the head of another sensor"
                             : "a packet of " + std::to_string(payload.size()) + " bytes, not " + std::to_string(layout.sizes[1]));
  }
  const int unit_mm = layout.unit_at == kNoByte ? layout.unit_mm : payload[layout.unit_at];
  constexpr int kMaxUnitMm = 8;
  if (unit_mm < 1 || unit_mm > kMaxUnitMm) return Refuse(PacketFault::kHead, "a unit of range of " + std::to_string(unit_mm) + " mm");
  const Bytes tail = payload.subspan(layout.tail_at);
  const std::uint8_t mode_byte = tail[layout.mode_at];
  const auto mode = HesaiReturnModeOf(mode_byte);
  if (!mode || layout.num_blocks % mode->num_blocks != 0)
    return Refuse(PacketFault::kMode, "return mode " + std::to_string(mode_byte) + " is not known");

  const std::size_t block_bytes = layout.block_bytes();
  const std::size_t azimuth_at = layout.head_bytes + layout.block_head_bytes() - 2;
  const std::size_t num_columns = layout.num_blocks / mode->num_blocks;
  std::array<int, 16> azimuth_cdeg{};  // [blocks]
  for (std::size_t block = 0; block < layout.num_blocks; ++block) {
    azimuth_cdeg[block] = ReadU16LittleEndian(payload, azimuth_at + block * block_bytes);
    if (azimuth_cdeg[block] >= kCdegPerHesaiTurn)
      return Refuse(PacketFault::kAzimuth, "an azimuth of " + std::to_string(azimuth_cdeg[block]) + " / 100 deg");
    if (azimuth_cdeg[block] != azimuth_cdeg[block - block % mode->num_blocks]) {
      return Refuse(PacketFault::kAzimuth, "returns of one shot have two azimuths");
    }
  }
  const auto date = DateOf(tail.subspan(layout.date_at, 6), layout.head_bytes == 12);
  const std::uint32_t us = ReadU32LittleEndian(tail, layout.us_at);
  constexpr std::uint32_t kMaxUs = 2'000'000;  // a leap second may follow the last second
  if (!date || us >= kMaxUs) return Refuse(PacketFault::kStamp, "a date or time of day that is none");
  if (layout.crc_at != kNoByte) {
    const Bytes body = payload.subspan(layout.head_bytes, layout.crc_at - layout.head_bytes);
    const bool is_right = Crc32Mpeg2(body) == ReadU32LittleEndian(payload, layout.crc_at);
    if (!is_right && has_right_crc_) return Refuse(PacketFault::kChecksum, "the checksum of the returns is wrong");
    has_right_crc_ = has_right_crc_ || is_right;
  }

  UpdateHead(mode_byte, unit_mm);
  packet.stamp = date->time_since_epoch() + std::chrono::microseconds(us);
  packet.number.reset();
  if (layout.sequence_at + 4 <= tail.size()) packet.number = PacketNumber{ReadU32LittleEndian(tail, layout.sequence_at), std::uint64_t{1} << 32};
  const auto time_of = [&](std::size_t steps) { return nanoseconds(static_cast<std::int64_t>(steps) * layout.period_ps / 1000); };
  packet.duration = time_of(num_columns);
  const std::size_t num_rings = head_.beams.size();
  const std::size_t num_returns = head_.returns.size();
  packet.columns.resize(num_columns);
  packet.range.resize(num_columns * num_rings * num_returns);
  packet.reflectivity.resize(packet.range.size());
  for (std::size_t column = 0; column < num_columns; ++column) {
    const std::size_t first_block = column * mode->num_blocks;
    constexpr double kRadPerCdeg = kTwoPi / kCdegPerHesaiTurn;
    packet.columns[column].azimuth_rad = azimuth_cdeg[first_block] * kRadPerCdeg;
    packet.columns[column].time = nanoseconds(layout.first_ns) + (layout.is_counted_back ? -time_of(num_columns - 1 - column) : time_of(column));
    const std::uint8_t* block = payload.data() + layout.head_bytes + first_block * block_bytes;
    std::uint32_t* range = packet.range.data() + column * num_rings * num_returns;
    std::uint8_t* reflectivity = packet.reflectivity.data() + column * num_rings * num_returns;
    switch (mode->order) {
      case HesaiOrder::kAsSent:
        for (std::size_t i = 0; i < num_returns; ++i) {
          CopyBlock(block + i * block_bytes, num_rings, cell_offset_.data(), num_returns, i, range, reflectivity);
        }
        break;
      case HesaiOrder::kNearestFirst:
        CopyPair(block, block + block_bytes, num_rings, cell_offset_.data(), range, reflectivity);
        break;
      case HesaiOrder::kNearestAndFarthest:
        CopyThree(block, block_bytes, num_rings, cell_offset_.data(), range, reflectivity);
        break;
    }
  }
  return PacketFault::kNone;
}

}  // namespace lookout::lidar
