#include "lab/data/organise.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::data {

namespace {

constexpr int kNumBands = 64;        // as most lidars of the road have
constexpr int kUsualColumns = 1800;  // of a revolution at 10 Hz: a step of 0.2 degrees
constexpr int kMinColumns = 360;
constexpr double kRangeUnitM = 0.002;  // as a VLP-16
constexpr double kMaxRangeCount = std::numeric_limits<std::uint16_t>::max();
constexpr double kMinStepRad = 1e-4;  // smaller steps come from rounding of one azimuth
constexpr std::chrono::microseconds kScanDuration{100'000};

struct Beam {
  std::size_t point = 0;
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
  double range_m = 0.0;
  int ring = 0;
};

std::vector<Beam> BeamsOf(const PointCloud& cloud, std::int64_t& num_out_of_range) {
  std::vector<Beam> beams;
  beams.reserve(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const double x_m = cloud.points[i].x_m;
    const double y_m = cloud.points[i].y_m;
    const double z_m = cloud.points[i].z_m;
    const double level_m = std::hypot(x_m, y_m);
    const double range_m = std::hypot(level_m, z_m);
    if (range_m < kRangeUnitM || range_m > kMaxCloudRangeM) {
      ++num_out_of_range;
      continue;
    }
    beams.push_back({i, WrapTo2Pi(-std::atan2(y_m, x_m)), std::atan2(z_m, level_m), range_m, 0});
  }
  return beams;
}

struct Heap {
  std::size_t begin, end;  // of the sorted elevations
};

// Heaps of sorted elevations with gaps of more than `min_gap_rad` between them; nullopt unless every gap is twice as wide as every heap.
std::optional<std::vector<Heap>> HeapsOf(const std::vector<double>& sorted_rad, double min_gap_rad) {
  std::vector<Heap> heaps{{0, 1}};
  double least_gap_rad = kPi;
  for (std::size_t i = 1; i < sorted_rad.size(); ++i) {
    const double gap_rad = sorted_rad[i] - sorted_rad[i - 1];
    if (gap_rad > min_gap_rad) {
      least_gap_rad = std::min(least_gap_rad, gap_rad);
      heaps.push_back({i, i});
    }
    heaps.back().end = i + 1;
  }
  if (heaps.size() > static_cast<std::size_t>(kMaxCloudRings)) return std::nullopt;
  // A cloud of one heap is one ring only if that is as flat as a ring.
  if (heaps.size() == 1) least_gap_rad = min_gap_rad;
  for (const auto& heap : heaps) {
    if (2.0 * (sorted_rad[heap.end - 1] - sorted_rad[heap.begin]) > least_gap_rad) return std::nullopt;
  }
  return heaps;
}

// Sets the ring of each beam. @return whether rings were found
bool FindRings(std::vector<Beam>& beams) {
  std::vector<double> sorted_rad;
  sorted_rad.reserve(beams.size());
  for (const auto& beam : beams) sorted_rad.push_back(beam.elevation_rad);
  std::ranges::sort(sorted_rad);
  // From sensors of few rings to sensors of 128 rings, which are 0.11 degrees apart at the horizon.
  for (const double min_gap_deg : {0.5, 0.25, 0.1, 0.05, 0.02}) {
    const auto heaps = HeapsOf(sorted_rad, DegToRad(min_gap_deg));
    if (!heaps) continue;
    std::vector<double> begin_rad;
    for (const auto& heap : *heaps) begin_rad.push_back(sorted_rad[heap.begin]);
    for (auto& beam : beams) beam.ring = static_cast<int>(std::ranges::upper_bound(begin_rad, beam.elevation_rad) - begin_rad.begin()) - 1;
    return true;
  }
  const double bottom_rad = sorted_rad.front();
  const double height_rad = sorted_rad.back() - bottom_rad;
  for (auto& beam : beams) {
    const double part = height_rad > 0.0 ? (beam.elevation_rad - bottom_rad) / height_rad : 0.0;
    beam.ring = std::min(kNumBands - 1, static_cast<int>(part * kNumBands));
  }
  return false;
}

// Leaves out rings without points, and gives the others the mean elevation of theirs.
std::vector<segmenter::Ring> NumberRings(std::vector<Beam>& beams) {
  std::array<double, kMaxCloudRings> sum_rad{};
  std::array<int, kMaxCloudRings> count{};
  for (const auto& beam : beams) {
    sum_rad[static_cast<std::size_t>(beam.ring)] += beam.elevation_rad;
    ++count[static_cast<std::size_t>(beam.ring)];
  }
  std::vector<segmenter::Ring> rings;
  std::array<int, kMaxCloudRings> number{};
  for (std::size_t ring = 0; ring < count.size(); ++ring) {
    number[ring] = static_cast<int>(rings.size());
    if (count[ring] > 0) rings.push_back({static_cast<float>(sum_rad[ring] / count[ring]), 0.0F, 0, 0.0F});
  }
  for (auto& beam : beams) beam.ring = number[static_cast<std::size_t>(beam.ring)];
  return rings;
}

// Precondition: beams are sorted by ring, then azimuth.
int FindNumColumns(const std::vector<Beam>& beams) {
  std::vector<double> steps_rad;
  for (std::size_t i = 1; i < beams.size(); ++i) {
    const double step_rad = beams[i].azimuth_rad - beams[i - 1].azimuth_rad;
    if (beams[i].ring == beams[i - 1].ring && step_rad > kMinStepRad) steps_rad.push_back(step_rad);
  }
  if (steps_rad.empty()) return kUsualColumns;
  const auto middle = steps_rad.begin() + static_cast<std::ptrdiff_t>(steps_rad.size() / 2);
  std::nth_element(steps_rad.begin(), middle, steps_rad.end());
  return std::clamp(static_cast<int>(std::lround(kTwoPi / *middle)), kMinColumns, kMaxCloudColumns);
}

// A multiple of 2 mm that brings the farthest point into 16 bits.
double RangeUnit(const std::vector<Beam>& beams) {
  double max_m = 0.0;
  for (const auto& beam : beams) max_m = std::max(max_m, beam.range_m);
  return kRangeUnitM * std::max(1.0, std::ceil(max_m / (kRangeUnitM * kMaxRangeCount)));
}

segmenter::Scan EmptyScan(std::vector<segmenter::Ring> rings, int num_columns, double range_unit_m) {
  segmenter::Scan scan;
  scan.head.time = Utime{};
  scan.head.end_time = scan.head.time + kScanDuration;
  scan.head.range_unit_m = range_unit_m;
  scan.head.rings = std::move(rings);
  scan.head.num_turn_columns = num_columns;
  scan.parts = {{0, num_columns}};
  for (int column = 0; column < num_columns; ++column) {
    scan.columns.azimuth_rad.push_back(static_cast<float>(kTwoPi * (column + 0.5) / num_columns));
    scan.columns.time_ns.push_back(static_cast<std::int32_t>(std::chrono::nanoseconds(kScanDuration).count() * column / num_columns));
  }
  const auto num_cells = static_cast<std::size_t>(num_columns) * scan.head.rings.size();
  scan.columns.range.assign(num_cells, 0);
  scan.columns.reflectivity.assign(num_cells, 0);
  return scan;
}

// Points into cells: the nearer first, so that it has the cell.
class Placer {
 public:
  Placer(const PointCloud& cloud, OrganisedCloud& result) : cloud_(cloud), result_(result), num_columns_(result.labelled.scan.columns.size()) {}

  bool Place(const Beam& beam, int column) {
    auto& scan = result_.labelled.scan;
    const auto cell = static_cast<std::size_t>(column) * scan.head.rings.size() + static_cast<std::size_t>(beam.ring);
    if (scan.columns.range[cell] != 0) return false;
    const auto& point = cloud_.points[beam.point];
    const double count = std::round(beam.range_m / scan.head.range_unit_m);
    scan.columns.range[cell] = static_cast<std::uint16_t>(std::clamp(count, 1.0, kMaxRangeCount));
    scan.columns.reflectivity[cell] = point.reflectivity;
    result_.labelled.object[cell] = point.object;
    result_.cell_of_point[beam.point] = static_cast<std::int32_t>(cell);
    return true;
  }

  int ColumnOf(const Beam& beam) const { return std::min(num_columns_ - 1, static_cast<int>(beam.azimuth_rad / kTwoPi * num_columns_)); }

  // Into the free cell of a neighbouring column: first that on the side where the point is.
  bool PlaceBeside(const Beam& beam) {
    const int column = ColumnOf(beam);
    const int next = column + 1 < num_columns_ ? column + 1 : 0;
    const int previous = column > 0 ? column - 1 : num_columns_ - 1;
    const bool is_beyond_middle = beam.azimuth_rad / kTwoPi * num_columns_ - column >= 0.5;
    return Place(beam, is_beyond_middle ? next : previous) || Place(beam, is_beyond_middle ? previous : next);
  }

 private:
  const PointCloud& cloud_;
  OrganisedCloud& result_;
  int num_columns_;
};

}  // namespace

OrganisedCloud Organise(const PointCloud& cloud) {
  OrganisedCloud result;
  result.cell_of_point.assign(cloud.points.size(), OrganisedCloud::kNoCell);
  result.labelled.objects = cloud.objects;
  auto beams = BeamsOf(cloud, result.num_out_of_range);
  if (beams.empty()) {
    result.labelled.scan = EmptyScan({segmenter::Ring{}}, kUsualColumns, kRangeUnitM);
    result.labelled.object.assign(result.labelled.scan.num_cells(), kNoTrueObject);
    return result;
  }
  result.are_rings_found = FindRings(beams);
  auto rings = NumberRings(beams);
  std::ranges::stable_sort(
      beams, [](const Beam& one, const Beam& other) { return one.ring != other.ring ? one.ring < other.ring : one.azimuth_rad < other.azimuth_rad; });
  result.labelled.scan = EmptyScan(std::move(rings), FindNumColumns(beams), RangeUnit(beams));
  result.labelled.object.assign(result.labelled.scan.num_cells(), kNoTrueObject);

  std::ranges::stable_sort(beams, [](const Beam& one, const Beam& other) { return one.range_m < other.range_m; });
  Placer placer(cloud, result);
  std::vector<Beam> beaten;
  for (const auto& beam : beams) {
    if (!placer.Place(beam, placer.ColumnOf(beam))) beaten.push_back(beam);
  }
  for (const auto& beam : beaten) ++(placer.PlaceBeside(beam) ? result.num_moved : result.num_hidden);
  return result;
}

}  // namespace lookout::data
