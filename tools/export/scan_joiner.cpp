#include "tools/export/scan_joiner.hpp"

#include <algorithm>
#include <utility>

#include "common/core/utime.hpp"

namespace lookout::exporter {

namespace {

bool IsPlace(std::int32_t part_index, std::int32_t num_parts) { return part_index >= 0 && part_index < num_parts; }

// The generated decoder has checked that no count is negative and none exceeds the bytes, so the product of two fits.
bool AreCells(std::int64_t num_cells, std::int64_t num_columns, std::int64_t num_rings, std::int64_t num_returns) {
  if (num_columns < 0 || num_rings < 0 || num_returns < 0) return false;
  const std::int64_t num_beams = num_rings * num_returns;
  if (num_beams == 0 || num_columns == 0) return num_cells == 0;
  return num_cells % num_beams == 0 && num_cells / num_beams == num_columns;
}

bool Match(const lidar_scan_t& scan, const segments_t& segments) {
  return scan.seq == segments.seq && scan.utime_us == segments.utime_us && scan.first_column == segments.first_column &&
         scan.num_columns == segments.num_columns && scan.num_rings == segments.num_rings && scan.num_returns == segments.num_returns;
}

}  // namespace

bool IsConsistent(const lidar_scan_t& scan) {
  return UtimeFromWire(scan.utime_us) && IsPlace(scan.part_index, scan.num_parts) &&
         AreCells(scan.num_cells, scan.num_columns, scan.num_rings, scan.num_returns);
}

bool IsConsistent(const segments_t& segments) {
  return UtimeFromWire(segments.utime_us) && IsPlace(segments.part_index, segments.num_parts) &&
         AreCells(segments.num_cells, segments.num_columns, segments.num_rings, segments.num_returns);
}

void ScanJoiner::Add(lidar_scan_t scan) {
  waiting_.push_back({std::move(scan), std::nullopt});
  if (waiting_.size() > kMaxWaiting) Release(1);
}

void ScanJoiner::Add(segments_t segments) {
  if (segments.num_columns == 0 && segments.part_index > 0) return;  // a further part, of segments only
  const auto part = std::ranges::find_if(waiting_, [&segments](const LabelledScan& waiting) { return Match(waiting.scan, segments); });
  if (part == waiting_.end()) {
    ++num_orphans_;
    return;
  }
  part->segments = std::move(segments);
  Release(static_cast<std::size_t>(part - waiting_.begin()) + 1);
}

void ScanJoiner::Release(std::size_t count) {
  for (; count > 0; --count) {
    handler_(waiting_.front());
    waiting_.pop_front();
  }
}

}  // namespace lookout::exporter
