#include "services/lidar/core/vlp16/scan_cutter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::vlp16 {

namespace {

using namespace format;
using std::chrono::nanoseconds;

// Columns lie at block azimuths and half way between them: azimuths in halves of 0.01 deg are exact.
constexpr int kHalfCdegPerRevolution = 2 * kAzimuthsPerRevolution;
constexpr double kRadPerHalfCdeg = kTwoPi / kHalfCdegPerRevolution;
constexpr int kMaxBackHalfCdeg = 2 * kMaxGapCdeg;
// The slowest revolution takes 0.2 s. The caps leave a head that stands or starts some room, and hold times in 32 bits of nanoseconds.
constexpr nanoseconds kMaxScanDuration = std::chrono::seconds(2);
constexpr int kMaxColumns = 65536;
// The time behind a jump of a limited field of view is known to some tenths of a percent until the next packet comes. A step back in time by more
// than kMaxOverlap does not come from such a jump: the scan ends.
constexpr nanoseconds kMaxOverlap = std::chrono::milliseconds(1);
static_assert(kMaxScanDuration < nanoseconds(std::numeric_limits<std::int32_t>::max()));
constexpr int kUsualColumns = 2048;  // a scan at 600 rpm has 1808

int Clockwise(int from_half_cdeg, int to_half_cdeg) {
  const int difference = to_half_cdeg - from_half_cdeg;
  return difference < 0 ? difference + kHalfCdegPerRevolution : difference;
}

// Over open water most firings come back empty.
bool IsEmpty(const std::uint8_t* sequence) {
  std::array<std::uint64_t, kNumLasers * kReturnSizeBytes / sizeof(std::uint64_t)> words{};
  std::memcpy(words.data(), sequence, sizeof words);
  std::uint64_t any = 0;
  for (const auto word : words) any |= word;
  return any == 0;
}

// One firing of the 16 lasers, in order of laser id, to the rings of a column whose cells stand `kNumReturns` apart.
template <std::size_t kNumReturns>
void CopySequence(const std::uint8_t* bytes, const std::array<int, kNumLasers>& ring_of_laser, std::uint16_t* range, std::uint8_t* reflectivity) {
  if constexpr (kNumReturns == 1) {
    if (IsEmpty(bytes)) {
      std::fill_n(range, kNumLasers, std::uint16_t{0});
      std::fill_n(reflectivity, kNumLasers, std::uint8_t{0});
      return;
    }
  }
  for (std::size_t laser = 0; laser < kNumLasers; ++laser, bytes += kReturnSizeBytes) {
    const std::size_t cell = static_cast<std::size_t>(ring_of_laser[laser]) * kNumReturns;
    const auto count = static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8);
    range[cell] = count;
    reflectivity[cell] = count != 0 ? bytes[2] : std::uint8_t{0};
  }
}

}  // namespace

ScanCutter::ScanCutter(double cut_azimuth_rad, bool use_vertical_origin_offsets, std::function<void(const Scan&)> on_scan)
    : cut_half_cdeg_(static_cast<int>(std::llround(WrapTo2Pi(cut_azimuth_rad) / kRadPerHalfCdeg) % kHalfCdegPerRevolution)),
      use_vertical_origin_offsets_(use_vertical_origin_offsets),
      on_scan_(std::move(on_scan)) {
  scan_.range_unit_m = kRangeUnitM;
}

void ScanCutter::Add(const PlacedPacket& placed, const ClockReading& clock, const PacketCounts& counts) {
  const DataPacket& packet = placed.packet;
  if (num_columns_ > 0 && (packet.mode != mode_ || placed.model != model_)) End(counts);
  if (num_columns_ > 0 && (placed.is_elsewhere || placed.time < last_column_ - kMaxOverlap)) End(counts);
  if (placed.num_lost > 0) AddLoss(placed, 2 * packet.azimuth_cdeg[0], counts);
  for (int step = 0; step < packet.num_steps; ++step) {
    const int gap_cdeg = placed.steps.gap_cdeg[step];
    nanoseconds time = placed.time + placed.steps.time[step];
    if (num_columns_ > 0) time = std::max(time, last_column_);
    for (int sequence = 0; sequence < kSequencesPerBlock; ++sequence, time += kSequencePeriod) {
      const int azimuth_half_cdeg = (2 * packet.azimuth_cdeg[step] + sequence * gap_cdeg) % kHalfCdegPerRevolution;
      if (num_columns_ > 0 && CrossesCut(azimuth_half_cdeg, time)) {
        is_after_cut_ = true;
        Finish(counts);
      } else if (num_columns_ == kMaxColumns || (num_columns_ > 0 && time - start_ > kMaxScanDuration)) {
        ++num_capped_;
        End(counts);
      }
      if (num_columns_ == 0) Begin(placed, clock, azimuth_half_cdeg, gap_cdeg, time);
      AddColumn(packet, step, sequence, azimuth_half_cdeg, gap_cdeg, time);
    }
  }
  last_gap_cdeg_ = placed.last_gap_cdeg();
}

void ScanCutter::End(const PacketCounts& counts) {
  is_after_cut_ = false;
  num_lost_before_scan_ = 0;
  if (num_columns_ == 0) return;
  // It may have come to its end all the same: the next column would have been in the next scan.
  const int rest_half_cdeg = Clockwise(reach_half_cdeg_, cut_half_cdeg_);
  scan_.is_partial_end = rest_half_cdeg == 0 || rest_half_cdeg > advance_half_cdeg_;
  Finish(counts);
}

void ScanCutter::Begin(const PlacedPacket& placed, const ClockReading& clock, int azimuth_half_cdeg, int advance_half_cdeg, nanoseconds time) {
  const auto time_us = std::chrono::floor<std::chrono::microseconds>(time);
  start_ = time_us;
  scan_.number = num_scans_;
  scan_.clock = clock;
  clock_ = clock;
  scan_.time = clock.ToUtime(time_us);
  model_ = placed.model;
  mode_ = placed.packet.mode;
  scan_.head = &HeadOf(model_, mode_, use_vertical_origin_offsets_);
  beams_ = &BeamsOf(placed.model);
  Resize(std::max(kUsualColumns, scan_.num_columns()));
  // Without a scan before it, it begins at the cut when no column of its own could have been there.
  scan_.is_partial_start = !is_after_cut_ && Clockwise(cut_half_cdeg_, azimuth_half_cdeg) >= std::max(1, advance_half_cdeg);
  scan_.is_partial_end = false;
  scan_.has_hole = num_lost_before_scan_ > 0;
  scan_.num_lost_packets = num_lost_before_scan_;
  num_lost_before_scan_ = 0;
  is_after_cut_ = false;
  sum_gap_cdeg_ = 0;
  reach_half_cdeg_ = azimuth_half_cdeg;
}

void ScanCutter::Finish(const PacketCounts& counts) {
  Resize(num_columns_);
  scan_.end_time = scan_.time + std::chrono::floor<std::chrono::microseconds>(last_column_ - start_ + (kNumLasers - 1) * kLaserPeriod);
  const double mean_gap_rad = DegToRad(static_cast<double>(sum_gap_cdeg_) / static_cast<double>(num_columns_) / 100.0);
  scan_.rate_radps = mean_gap_rad / ToSeconds(kBlockPeriod);
  scan_.counts = counts;
  ++num_scans_;
  num_columns_ = 0;
  on_scan_(scan_);
}

void ScanCutter::AddColumn(const DataPacket& packet, int step, int sequence, int azimuth_half_cdeg, int gap_cdeg, nanoseconds time) {
  if (num_columns_ == capacity_columns_) Resize(2 * capacity_columns_);
  const auto column = static_cast<std::size_t>(num_columns_);
  scan_.azimuth_rad[column] = static_cast<float>(azimuth_half_cdeg * kRadPerHalfCdeg);
  scan_.time_ns[column] = static_cast<std::int32_t>((time - start_).count());
  const auto sequence_offset = kBlockReturnsOffset + static_cast<std::size_t>(sequence) * kNumLasers * kReturnSizeBytes;
  const std::uint8_t* block = packet.payload.data() + static_cast<std::size_t>(step * scan_.num_returns()) * kBlockSizeBytes + sequence_offset;
  const std::size_t cell = column * kNumLasers;
  const auto& ring_of_laser = beams_->ring_of_laser;
  if (scan_.num_returns() == 1) {
    CopySequence<1>(block, ring_of_laser, scan_.range.data() + cell, scan_.reflectivity.data() + cell);
  } else {
    CopySequence<2>(block, ring_of_laser, scan_.range.data() + 2 * cell, scan_.reflectivity.data() + 2 * cell);
    CopySequence<2>(block + kBlockSizeBytes, ring_of_laser, scan_.range.data() + 2 * cell + 1, scan_.reflectivity.data() + 2 * cell + 1);
  }
  if (Clockwise(reach_half_cdeg_, azimuth_half_cdeg) <= kHalfCdegPerRevolution - kMaxBackHalfCdeg) reach_half_cdeg_ = azimuth_half_cdeg;
  advance_half_cdeg_ = gap_cdeg;
  sum_gap_cdeg_ += gap_cdeg;
  last_column_ = time;
  ++num_columns_;
}

// Where packets are missing, they were of the scan that goes on, or of two scans, one on each side of the cut; then a packet across the cut
// counts for both. When a whole revolution or more is missing, nothing on one side belongs to the other.
void ScanCutter::AddLoss(const PlacedPacket& placed, int azimuth_half_cdeg, const PacketCounts& counts) {
  if (num_columns_ == 0) return;
  scan_.has_hole = true;
  const int sweep_half_cdeg = Clockwise(reach_half_cdeg_, azimuth_half_cdeg);
  const int to_cut_half_cdeg = Clockwise(reach_half_cdeg_, cut_half_cdeg_);
  const double gap_per_second_half_cdeg = 2.0 * last_gap_cdeg_ / ToSeconds(kBlockPeriod);
  const double expected_half_cdeg = gap_per_second_half_cdeg * ToSeconds(nanoseconds(placed.time) - last_column_);
  // A little less than a revolution looks like a step back.
  const bool is_just_behind = sweep_half_cdeg > kHalfCdegPerRevolution - kMaxBackHalfCdeg && expected_half_cdeg > 0.5 * kHalfCdegPerRevolution;
  const bool is_whole_revolution_missing = is_just_behind || expected_half_cdeg - sweep_half_cdeg > 0.5 * kHalfCdegPerRevolution;
  if (!is_whole_revolution_missing && !CrossesCut(azimuth_half_cdeg, placed.time)) {
    scan_.num_lost_packets += placed.num_lost;
    return;
  }
  const double total_half_cdeg = is_whole_revolution_missing ? expected_half_cdeg : sweep_half_cdeg;
  const double before_cut = std::min(1.0, (to_cut_half_cdeg > 0 ? to_cut_half_cdeg : kHalfCdegPerRevolution) / total_half_cdeg) * placed.num_lost;
  scan_.num_lost_packets += static_cast<int>(std::ceil(before_cut));
  if (is_whole_revolution_missing) End(counts);
  const double after_cut = Clockwise(cut_half_cdeg_, azimuth_half_cdeg) / total_half_cdeg * placed.num_lost;
  num_lost_before_scan_ = static_cast<int>(std::ceil(after_cut));
}

// A way that no head makes in the time was not made forwards: the head trembles, or goes back.
bool ScanCutter::CrossesCut(int azimuth_half_cdeg, nanoseconds time) const {
  const int sweep_half_cdeg = Clockwise(reach_half_cdeg_, azimuth_half_cdeg);
  if (sweep_half_cdeg > kHalfCdegPerRevolution - kMaxBackHalfCdeg) return false;
  const double num_periods = static_cast<double>((time - last_column_).count()) / static_cast<double>(kBlockPeriod.count());
  if (sweep_half_cdeg > 2.0 * kMaxGapCdeg * (num_periods + 2.0)) return false;
  const int to_cut_half_cdeg = Clockwise(reach_half_cdeg_, cut_half_cdeg_);
  return to_cut_half_cdeg > 0 && to_cut_half_cdeg <= sweep_half_cdeg;
}

// The arrays keep their memory from scan to scan; only what they grow by is filled with zeros.
void ScanCutter::Resize(int num_columns) {
  capacity_columns_ = num_columns;
  const auto capacity = static_cast<std::size_t>(num_columns);
  const auto num_cells = capacity * kNumLasers * static_cast<std::size_t>(scan_.num_returns());
  scan_.azimuth_rad.resize(capacity);
  scan_.time_ns.resize(capacity);
  scan_.range.resize(num_cells);
  scan_.reflectivity.resize(num_cells);
}

}  // namespace lookout::vlp16
