#include "services/lidar/core/models/velodyne.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"
#include "services/lidar/core/models/velodyne_tables.hpp"

namespace lookout::lidar {

namespace {

using std::chrono::nanoseconds;

// The packet of all models: 12 blocks of 100 bytes (flag, azimuth, 32 cells of 3 bytes), then stamp, return mode, product.
constexpr std::size_t kVelodynePacketBytes = 1206;
constexpr std::size_t kVelodyneNumBlocks = 12;
constexpr std::size_t kVelodyneBlockBytes = 100;
constexpr std::size_t kVelodyneAzimuthAt = 2;
constexpr std::size_t kVelodyneCellsAt = 4;
constexpr std::size_t kVelodyneCellBytes = 3;
constexpr std::size_t kLasersPerBlock = 32;
constexpr std::size_t kVelodyneStampAt = 1200;
constexpr std::size_t kVelodyneModeAt = 1204;
constexpr std::size_t kVelodyneProductAt = 1205;
// Flags at the begin of the blocks of a firing, by bank.
constexpr std::array<std::uint16_t, 4> kVelodyneFlags{0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF};

constexpr std::uint8_t kVelodyneStrongestMode = 0x37;
constexpr std::uint8_t kVelodyneLastMode = 0x38;
constexpr std::uint8_t kVelodyneDualMode = 0x39;

constexpr int kCdegPerVelodyneTurn = 36'000;
constexpr double kGreatestRpm = 1200.0;
constexpr double kLeastRpm = 300.0;
constexpr double kCdegPerNsOfRpm = kCdegPerVelodyneTurn / 60.0 / 1e9;

struct VelodyneLayout {
  std::string_view name;
  std::array<std::uint8_t, 2> products;
  std::size_t num_banks;  // blocks of one firing
  nanoseconds period;     // of a firing
  double unit_m;

  std::size_t num_lasers() const { return num_banks * kLasersPerBlock; }
  // A quarter beyond the greatest speed: what is more is a jump of a limited field of view.
  double max_gap_cdeg() const { return 1.25 * kGreatestRpm * kCdegPerNsOfRpm * static_cast<double>(period.count()); }
  // Half of the least speed: a head that turns slower is starting, and its jumps come from the encoder.
  double min_rate_cdeg() const { return 0.5 * kLeastRpm * kCdegPerNsOfRpm * static_cast<double>(period.count()); }
};

// By VelodyneModel. HDL-32E User Manual 63-9113; VLP-32C User Manual 63-9325; VLS-128: three firings in 165.6 us, as captures show (the manual has
// 159.9 us). 0x63 was the product of the VLS-128 before 0xA1.
constexpr std::array<VelodyneLayout, kNumVelodyneModels> kVelodyneLayouts{{
    {"Velodyne HDL-32E", {0x21, 0x21}, 1, nanoseconds(46'080), 0.002},
    {"Velodyne VLP-32C", {0x28, 0x28}, 1, nanoseconds(55'296), 0.004},
    {"Velodyne VLS-128", {0xA1, 0x63}, 4, nanoseconds(55'200), 0.004},
}};

constexpr const VelodyneLayout& VelodyneLayoutOf(VelodyneModel model) { return kVelodyneLayouts[static_cast<std::size_t>(model)]; }

struct Laser {
  double elevation_deg = 0.0;
  double azimuth_offset_deg = 0.0;
  nanoseconds time{0};  // since the first shot of the firing
};

Laser LaserOf(VelodyneModel model, std::size_t id) {
  const auto number = static_cast<std::int64_t>(id);
  switch (model) {
    case VelodyneModel::kHdl32e: {
      // Two fans of 16 beams, 1.333 deg apart, that fire in turn.
      const double lowest_deg = id % 2 == 0 ? -92.0 / 3.0 : -28.0 / 3.0;
      const std::int64_t step = number / 2;
      return {lowest_deg + static_cast<double>(step) * 4.0 / 3.0, 0.0, nanoseconds(1152 * number)};
    }
    case VelodyneModel::kVlp32c:
      return {velodyne::kVlp32cAngles[id].elevation_deg, velodyne::kVlp32cAngles[id].azimuth_offset_deg, nanoseconds(2304 * (number / 2))};
    case VelodyneModel::kVls128: {
      // Eight lasers at once in each twentieth of a firing; one twentieth is left out after 64 lasers.
      const std::int64_t slot = number / 8 + number / 64;
      return {velodyne::kVls128ElevationDeg[id], velodyne::kVls128AzimuthOffsetDeg[id % 8], VelodyneLayoutOf(model).period * slot / 20};
    }
  }
  return {};
}

int ClockwiseCdeg(int from_cdeg, int to_cdeg) { return to_cdeg >= from_cdeg ? to_cdeg - from_cdeg : to_cdeg - from_cdeg + kCdegPerVelodyneTurn; }

/// How the firings of a packet follow each other.
struct Firings {
  std::array<nanoseconds, kVelodyneNumBlocks> time{};  // since the first
  nanoseconds duration{0};                             // from the first firing to the first of the next packet
  double rate_cdeg = 0.0;                              // per firing; 0 = the packet has no two that follow each other
  int sweep_cdeg = 0;
};

/// Where the head skipped a part of the circle the later firings come as much later as it needs at `known_cdeg` per firing, else at the rate of this
/// packet. Steps back are noise of the encoder.
Firings FiringsOf(std::span<const int> azimuth_cdeg, const VelodyneLayout& layout, double known_cdeg) {
  Firings firings;
  std::array<int, kVelodyneNumBlocks> gap_cdeg{};
  int sum_cdeg = 0;
  int num_steps = 0;
  const auto max_gap_cdeg = static_cast<int>(layout.max_gap_cdeg());
  const auto is_back = [&](int gap) { return gap >= kCdegPerVelodyneTurn - max_gap_cdeg; };
  for (std::size_t i = 0; i + 1 < azimuth_cdeg.size(); ++i) {
    gap_cdeg[i] = ClockwiseCdeg(azimuth_cdeg[i], azimuth_cdeg[i + 1]);
    if (!is_back(gap_cdeg[i])) firings.sweep_cdeg += gap_cdeg[i];
    if (gap_cdeg[i] > max_gap_cdeg) continue;
    sum_cdeg += gap_cdeg[i];
    ++num_steps;
  }
  if (num_steps > 0) firings.rate_cdeg = static_cast<double>(sum_cdeg) / num_steps;
  const double rate_cdeg = known_cdeg > 0.0 ? known_cdeg : firings.rate_cdeg;
  nanoseconds time{0};
  for (std::size_t i = 0; i < azimuth_cdeg.size(); ++i) {
    firings.time[i] = time;
    time += layout.period;
    if (gap_cdeg[i] <= max_gap_cdeg || is_back(gap_cdeg[i]) || rate_cdeg < layout.min_rate_cdeg()) continue;
    time += nanoseconds(std::llround((gap_cdeg[i] / rate_cdeg - 1.0) * static_cast<double>(layout.period.count())));
  }
  firings.duration = time;
  return firings;
}

}  // namespace

std::string_view NameOf(VelodyneModel model) { return VelodyneLayoutOf(model).name; }

std::optional<VelodyneModel> VelodyneModelOf(Bytes payload) {
  if (payload.size() != kVelodynePacketBytes || ReadU16LittleEndian(payload, 0) != kVelodyneFlags[0]) return std::nullopt;
  for (int i = 0; i < kNumVelodyneModels; ++i) {
    const auto& products = kVelodyneLayouts[static_cast<std::size_t>(i)].products;
    if (std::ranges::find(products, payload[kVelodyneProductAt]) != products.end()) return static_cast<VelodyneModel>(i);
  }
  return std::nullopt;
}

VelodyneReader::VelodyneReader(VelodyneModel model) : model_(model) {
  const auto& layout = VelodyneLayoutOf(model);
  std::vector<std::size_t> laser_of_ring(layout.num_lasers());
  std::iota(laser_of_ring.begin(), laser_of_ring.end(), std::size_t{0});
  std::ranges::stable_sort(laser_of_ring, {}, [&](std::size_t id) { return LaserOf(model, id).elevation_deg; });
  head_.model = layout.name;
  head_.range_unit_m = layout.unit_m;
  head_.stamp = StampKind::kPastHour;
  head_.returns = {ReturnKind::kStrongest};
  head_.beams.reserve(laser_of_ring.size());
  for (std::size_t ring = 0; ring < laser_of_ring.size(); ++ring) {
    const std::size_t id = laser_of_ring[ring];
    const auto laser = LaserOf(model, id);
    bank_[ring] = static_cast<std::uint8_t>(id / kLasersPerBlock);
    cell_offset_[ring] = static_cast<std::uint16_t>(kVelodyneCellsAt + id % kLasersPerBlock * kVelodyneCellBytes);
    Beam beam;
    beam.elevation_rad = DegToRad(laser.elevation_deg);
    beam.azimuth_offset_rad = DegToRad(laser.azimuth_offset_deg);
    beam.time_offset = laser.time;
    beam.turning_time = laser.time;
    beam.channel = static_cast<int>(id);
    head_.beams.push_back(beam);
  }
}

bool VelodyneReader::MayBe(std::size_t size_bytes) const { return size_bytes == kVelodynePacketBytes; }

PacketFault VelodyneReader::Refuse(PacketFault fault, std::string reason) {
  reason_ = std::string(NameOf(model_)) + ": " + std::move(reason);
  return fault;
}

PacketFault VelodyneReader::Read(Bytes payload, Packet& packet) {
  const auto& layout = VelodyneLayoutOf(model_);
  if (payload.size() != kVelodynePacketBytes) {
    return Refuse(PacketFault::kSize, "a packet of " + std::to_string(payload.size()) + " bytes, not " + std::to_string(kVelodynePacketBytes));
  }
  const std::uint8_t product = payload[kVelodyneProductAt];
  if (std::ranges::find(layout.products, product) == layout.products.end()) {
    const auto other = VelodyneModelOf(payload);
    return Refuse(PacketFault::kHead,
                  other ? "the packet is of a " + std::string(NameOf(*other)) : "the packet has product " + std::to_string(product));
  }
  const std::uint8_t mode = payload[kVelodyneModeAt];
  if (mode != kVelodyneStrongestMode && mode != kVelodyneLastMode && mode != kVelodyneDualMode) {
    return Refuse(PacketFault::kMode, "return mode " + std::to_string(mode) + " is not known");
  }

  const std::size_t num_returns = mode == kVelodyneDualMode ? 2 : 1;
  const std::size_t blocks_per_column = layout.num_banks * num_returns;
  const std::size_t num_columns = kVelodyneNumBlocks / blocks_per_column;  // a VLS-128 in dual return leaves the last four blocks unused
  std::array<int, kVelodyneNumBlocks> azimuth_cdeg{};                      // [columns]
  std::array<std::uint16_t, kVelodyneNumBlocks> block_at{};                // [columns x banks x returns]
  for (std::size_t column = 0; column < num_columns; ++column) {
    std::array<std::size_t, kVelodyneFlags.size()> num_of_bank{};
    for (std::size_t i = 0; i < blocks_per_column; ++i) {
      const std::size_t at = (column * blocks_per_column + i) * kVelodyneBlockBytes;
      const auto bank = static_cast<std::size_t>(std::ranges::find(kVelodyneFlags, ReadU16LittleEndian(payload, at)) - kVelodyneFlags.begin());
      if (bank >= layout.num_banks || num_of_bank[bank] == num_returns) return Refuse(PacketFault::kHead, "a block has the flag of another sensor");
      block_at[column * blocks_per_column + bank * num_returns + num_of_bank[bank]++] = static_cast<std::uint16_t>(at);
      int azimuth = ReadU16LittleEndian(payload, at + kVelodyneAzimuthAt);
      // The head rounds 359.996 deg to 36000, and may be a step beyond before it wraps.
      if (azimuth > kCdegPerVelodyneTurn + static_cast<int>(layout.max_gap_cdeg())) {
        return Refuse(PacketFault::kAzimuth, "an azimuth of " + std::to_string(azimuth) + " / 100 deg");
      }
      if (azimuth >= kCdegPerVelodyneTurn) azimuth -= kCdegPerVelodyneTurn;
      if (i == 0) azimuth_cdeg[column] = azimuth;
      if (azimuth != azimuth_cdeg[column]) return Refuse(PacketFault::kAzimuth, "the blocks of one firing have two azimuths");
    }
  }
  const auto firings = FiringsOf(std::span(azimuth_cdeg).first(num_columns), layout, rate_cdeg_);
  if (firings.sweep_cdeg >= kCdegPerVelodyneTurn) return Refuse(PacketFault::kAzimuth, "the blocks go round more than once");

  // Mean of some packets: the azimuths of one are too coarse.
  constexpr int kMaxRates = 64;
  if (firings.rate_cdeg > 0.0) {
    num_rates_ = std::min(num_rates_ + 1, kMaxRates);
    rate_cdeg_ += (firings.rate_cdeg - rate_cdeg_) / num_rates_;
  }
  if (mode != mode_) {
    mode_ = mode;
    head_.returns = mode == kVelodyneDualMode   ? std::vector{ReturnKind::kLast, ReturnKind::kStrongest}
                    : mode == kVelodyneLastMode ? std::vector{ReturnKind::kLast}
                                                : std::vector{ReturnKind::kStrongest};
    ++head_number_;
  }

  packet.stamp = std::chrono::microseconds(ReadU32LittleEndian(payload, kVelodyneStampAt));
  packet.duration = firings.duration;
  packet.number.reset();
  const std::size_t num_rings = head_.beams.size();
  packet.columns.resize(num_columns);
  packet.range.resize(num_columns * num_rings * num_returns);
  packet.reflectivity.resize(packet.range.size());
  std::size_t cell = 0;
  for (std::size_t column = 0; column < num_columns; ++column) {
    constexpr double kRadPerCdeg = kTwoPi / kCdegPerVelodyneTurn;
    packet.columns[column].azimuth_rad = azimuth_cdeg[column] * kRadPerCdeg;
    packet.columns[column].time = firings.time[column];
    const std::uint16_t* blocks = block_at.data() + column * blocks_per_column;
    for (std::size_t ring = 0; ring < num_rings; ++ring) {
      const std::uint16_t* blocks_of_bank = blocks + bank_[ring] * num_returns;
      for (std::size_t i = 0; i < num_returns; ++i, ++cell) {
        const std::uint8_t* bytes = payload.data() + blocks_of_bank[i] + cell_offset_[ring];
        const std::uint32_t range = bytes[0] | std::uint32_t{bytes[1]} << 8;
        packet.range[cell] = range;
        packet.reflectivity[cell] = range != 0 ? bytes[2] : std::uint8_t{0};
      }
    }
  }
  return PacketFault::kNone;
}

}  // namespace lookout::lidar
