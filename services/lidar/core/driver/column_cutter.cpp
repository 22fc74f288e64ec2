#include "services/lidar/core/driver/column_cutter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::lidar {

namespace {

using std::chrono::nanoseconds;

// The slowest revolution takes 0.2 s. The caps leave a head that stands or starts some room, and hold times in 32 bits of nanoseconds; what
// LIDAR_SCAN may hold stands in common/messages/checks.
constexpr nanoseconds kMaxScanDuration = std::chrono::seconds(2);
constexpr std::size_t kMaxColumns = 65536;
constexpr std::size_t kMaxCells = std::size_t{1} << 21U;
static_assert(kMaxScanDuration < nanoseconds(std::numeric_limits<std::int32_t>::max()));
// Heads of lidars turn at 40 Hz at most. An encoder may tremble back by less than a degree.
constexpr double kMaxRateRadps = 40.0 * kTwoPi;
constexpr double kMaxBackRad = DegToRad(1.0);
// Ranges beyond (524 m in 16 bits) are no obstacle's of a boat.
constexpr double kMaxRangeUnitM = 0.008;
constexpr std::uint32_t kMaxRangeCount = std::numeric_limits<std::uint16_t>::max();

double ClockwiseRad(double from_rad, double to_rad) { return WrapTo2Pi(to_rad - from_rad); }

}  // namespace

ColumnCutter::ColumnCutter(double cut_azimuth_rad, ScanHandler on_scan)
    : cut_azimuth_rad_(WrapTo2Pi(cut_azimuth_rad)), on_scan_(std::move(on_scan)) {}

void ColumnCutter::Add(const PlacedColumns& placed, const ClockReading& clock, const PacketCounts& counts) {
  const auto& columns = placed.packet->columns;
  if (scan_.num_columns() > 0 && placed.head != scan_.head) End(counts);
  if (placed.num_lost > 0) AddLoss(placed, columns.front().azimuth_rad, counts);
  const auto num_cells = placed.head->num_cells_of_column();
  auto range = placed.packet->range.begin();
  auto reflectivity = placed.packet->reflectivity.begin();
  for (const auto& column : columns) {
    const auto time = placed.time + column.time;
    if (scan_.num_columns() > 0) {
      if (CrossesCut(column.azimuth_rad, time)) {
        is_after_cut_ = true;
        Finish(counts);
      } else if (time < last_column_ || IsFull(time)) {
        if (IsFull(time)) ++num_capped_;
        End(counts);
      }
    }
    if (scan_.num_columns() == 0) Begin(placed, clock, column.azimuth_rad, time);
    const double advance_rad = ClockwiseRad(reach_rad_, column.azimuth_rad);
    if (advance_rad <= kTwoPi - kMaxBackRad) {
      swept_rad_ += advance_rad;
      advance_rad_ = advance_rad;
      reach_rad_ = column.azimuth_rad;
    }
    scan_.azimuth_rad.push_back(static_cast<float>(column.azimuth_rad));
    scan_.time_ns.push_back(static_cast<std::int32_t>((time - start_).count()));
    const auto step = static_cast<std::ptrdiff_t>(num_cells);
    range_.insert(range_.end(), range, range + step);
    scan_.reflectivity.insert(scan_.reflectivity.end(), reflectivity, reflectivity + step);
    range += step;
    reflectivity += step;
    last_column_ = time;
  }
}

void ColumnCutter::End(const PacketCounts& counts) {
  is_after_cut_ = false;
  num_lost_before_scan_ = 0;
  if (scan_.num_columns() == 0) return;
  // It may have come to its end all the same: the next column would have been in the next scan.
  const double rest_rad = ClockwiseRad(reach_rad_, cut_azimuth_rad_);
  scan_.is_partial_end = rest_rad == 0.0 || rest_rad > 1.5 * advance_rad_;
  Finish(counts);
}

void ColumnCutter::Begin(const PlacedColumns& placed, const ClockReading& clock, double azimuth_rad, nanoseconds time) {
  const auto time_us = std::chrono::floor<std::chrono::microseconds>(time);
  start_ = time_us;
  first_column_ = time;
  scan_.number = num_scans_;
  scan_.clock = clock;
  clock_ = clock;
  scan_.time = clock.ToUtime(time_us);
  scan_.head = placed.head;
  // Without a scan before it, it begins at the cut when no column of its own could have been there.
  const double least_advance_rad = DegToRad(0.05);
  scan_.is_partial_start = !is_after_cut_ && ClockwiseRad(cut_azimuth_rad_, azimuth_rad) >= 1.5 * std::max(least_advance_rad, advance_rad_);
  scan_.is_partial_end = false;
  scan_.has_hole = num_lost_before_scan_ > 0;
  scan_.num_lost_packets = num_lost_before_scan_;
  num_lost_before_scan_ = 0;
  is_after_cut_ = false;
  reach_rad_ = azimuth_rad;
  swept_rad_ = 0.0;
}

void ColumnCutter::Finish(const PacketCounts& counts) {
  nanoseconds last_shot{0};
  for (const auto& beam : scan_.head->beams) last_shot = std::max(last_shot, beam.time_offset);
  scan_.end_time = scan_.time + std::chrono::floor<std::chrono::microseconds>(last_column_ - start_ + last_shot);
  const double duration_s = ToSeconds(last_column_ - first_column_);
  scan_.rate_radps = duration_s > 0.0 ? swept_rad_ / duration_s : 0.0;
  scan_.counts = counts;
  FillRanges();
  ++num_scans_;
  on_scan_(scan_);
  scan_.azimuth_rad.clear();
  scan_.time_ns.clear();
  scan_.range.clear();
  scan_.reflectivity.clear();
  range_.clear();
}

// The head's unit, or the least multiple of it by a power of two in which the farthest return fits.
void ColumnCutter::FillRanges() {
  double unit_m = scan_.head->range_unit_m;
  const auto max_count = static_cast<std::uint32_t>(kMaxRangeCount * std::max(1.0, kMaxRangeUnitM / unit_m));
  std::uint32_t farthest = 0;
  for (const auto count : range_) farthest = std::max(farthest, count <= max_count ? count : 0U);
  unsigned shift = 0;
  // Rounding up must fit, too.
  for (; (farthest + (1U << shift >> 1U)) >> shift > kMaxRangeCount; ++shift) unit_m *= 2.0;
  scan_.range_unit_m = unit_m;
  scan_.range.resize(range_.size());
  const std::uint32_t half = 1U << shift >> 1U;
  for (std::size_t cell = 0; cell < range_.size(); ++cell) {
    const auto count = range_[cell];
    const bool is_near = count <= max_count;
    // A return stays one, however near.
    scan_.range[cell] = is_near ? static_cast<std::uint16_t>(std::max((count + half) >> shift, std::min(count, 1U))) : std::uint16_t{0};
    if (!is_near) {
      ++num_too_far_;
      scan_.reflectivity[cell] = 0;
    }
  }
}

// Where packets are missing, they were of the scan that goes on, or of two scans, one on each side of the cut; then a packet across the cut counts
// for both. When a whole revolution or more is missing, nothing on one side belongs to the other.
void ColumnCutter::AddLoss(const PlacedColumns& placed, double azimuth_rad, const PacketCounts& counts) {
  if (scan_.num_columns() == 0) return;
  scan_.has_hole = true;
  const double duration_s = ToSeconds(last_column_ - first_column_);
  const double rate_radps = duration_s > 0.0 ? swept_rad_ / duration_s : 0.0;
  const double sweep_rad = ClockwiseRad(reach_rad_, azimuth_rad);
  const double expected_rad = rate_radps * ToSeconds(placed.time + placed.packet->columns.front().time - last_column_);
  const bool is_whole_revolution_missing = expected_rad - sweep_rad > 0.5 * kTwoPi;
  if (!is_whole_revolution_missing && !CrossesCut(azimuth_rad, placed.time)) {
    scan_.num_lost_packets += placed.num_lost;
    return;
  }
  const double total_rad = std::max(is_whole_revolution_missing ? expected_rad : sweep_rad, 1e-9);
  const double to_cut_rad = ClockwiseRad(reach_rad_, cut_azimuth_rad_);
  const double before_cut = std::min(1.0, (to_cut_rad > 0.0 ? to_cut_rad : kTwoPi) / total_rad) * placed.num_lost;
  scan_.num_lost_packets += static_cast<int>(std::ceil(before_cut));
  if (is_whole_revolution_missing) End(counts);
  const double after_cut = std::min(1.0, ClockwiseRad(cut_azimuth_rad_, azimuth_rad) / total_rad) * placed.num_lost;
  num_lost_before_scan_ = static_cast<int>(std::ceil(after_cut));
}

// A way that no head makes in the time was not made forwards: the head trembles, or goes back.
bool ColumnCutter::CrossesCut(double azimuth_rad, nanoseconds time) const {
  const double sweep_rad = ClockwiseRad(reach_rad_, azimuth_rad);
  if (sweep_rad > kTwoPi - kMaxBackRad) return false;
  if (sweep_rad > kMaxRateRadps * ToSeconds(time - last_column_) + kMaxBackRad) return false;
  const double to_cut_rad = ClockwiseRad(reach_rad_, cut_azimuth_rad_);
  return to_cut_rad > 0.0 && to_cut_rad <= sweep_rad;
}

bool ColumnCutter::IsFull(nanoseconds time) const {
  const auto num_columns = scan_.azimuth_rad.size();
  return num_columns == kMaxColumns || (num_columns + 1) * scan_.head->num_cells_of_column() > kMaxCells || time - start_ > kMaxScanDuration;
}

}  // namespace lookout::lidar
