#include "tools/import/cloud_scan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"
#include "common/messages/checks.hpp"

namespace lookout::importer {

namespace {

constexpr int kNumCloudBands = 64;  // bands of a sensor without rings
constexpr double kCloudRangeUnitM = 0.002;
constexpr double kMaxCloudCount = std::numeric_limits<std::uint16_t>::max();
// Greatest scatter of the points of a ring about its cone, as a share of their distance: more is no ring (0.6 degrees).
constexpr double kMaxRingScatter = 0.01;
constexpr double kMaxOriginM = 0.3;
constexpr double kLongestScanNs = 2e9;
constexpr std::size_t kNumElevations = 18'000;  // from straight down to straight up, 0.01 deg each
constexpr double kMinBandsRad = 1e-3;           // all bands together

// Splits a scan into messages that fit.
std::vector<lidar_scan_t> SplitScan(const lidar_scan_t& scan) {
  const auto cells_per_column = static_cast<std::size_t>(scan.num_rings) * static_cast<std::size_t>(scan.num_returns);
  lidar_scan_t head = scan;
  head.azimuth_rad.clear();
  head.time_ns.clear();
  head.range.clear();
  head.reflectivity.clear();
  head.num_columns = head.num_cells = 0;
  const auto column_bytes = static_cast<int>(sizeof(float) + sizeof(std::int32_t) + cells_per_column * (sizeof(std::int16_t) + sizeof(std::uint8_t)));
  const int max_columns = std::max(1, (bus::kMaxMessageBytes - head.getEncodedSize()) / column_bytes);
  const int num_parts = std::max(1, (scan.num_turn_columns + max_columns - 1) / max_columns);
  std::vector<lidar_scan_t> parts;
  for (int part = 0; part < num_parts; ++part) {
    auto& message = parts.emplace_back(head);
    message.part_index = part;
    message.num_parts = num_parts;
    const auto column_at = [&](std::int64_t of_part) { return static_cast<std::ptrdiff_t>(of_part * scan.num_turn_columns / num_parts); };
    const auto begin = column_at(part);
    const auto end = column_at(part + 1);
    const auto cells = static_cast<std::ptrdiff_t>(cells_per_column);
    message.first_column = static_cast<std::int32_t>(begin);
    message.azimuth_rad.assign(scan.azimuth_rad.begin() + begin, scan.azimuth_rad.begin() + end);
    message.time_ns.assign(scan.time_ns.begin() + begin, scan.time_ns.begin() + end);
    message.range.assign(scan.range.begin() + begin * cells, scan.range.begin() + end * cells);
    message.reflectivity.assign(scan.reflectivity.begin() + begin * cells, scan.reflectivity.begin() + end * cells);
    message.num_columns = messages::CountOf(message.azimuth_rad);
    message.num_cells = messages::CountOf(message.range);
  }
  return parts;
}

// A multiple of 2 mm that brings the farthest range into 16 bits.
double RangeUnitFor(double farthest_m) { return kCloudRangeUnitM * std::max(1.0, std::ceil(farthest_m / (kCloudRangeUnitM * kMaxCloudCount))); }

}  // namespace

bool CloudScans::Learn(const RosPointCloud& cloud) {
  std::string why;
  const auto points = ToRingCloud(cloud, why);
  if (is_settled_ || !points || points->points.empty()) return false;
  has_rings_ = has_rings_ && points->has_rings;
  AddElevations(*points);
  Add(*points);
  return true;
}

void CloudScans::AddElevations(const RingCloud& cloud) {
  elevations_.resize(kNumElevations);
  for (const auto& point : cloud.points) {
    const double elevation_rad = Atan2(point.z_m, point.level_m);
    learned_rad_ = {std::min(learned_rad_[0], elevation_rad), std::max(learned_rad_[1], elevation_rad)};
    const double place = (elevation_rad / kPi + 0.5) * static_cast<double>(kNumElevations);
    auto& sum = elevations_[std::min(static_cast<std::size_t>(std::max(place, 0.0)), kNumElevations - 1)];
    sum.num += 1.0;
    sum.level += point.level_m;
    sum.z += point.z_m;
  }
}

// The field for rings may count something else: lines of sensors that do not spin.
bool CloudScans::AreRingsScattered() const {
  int num_rings = 0;
  int num_scattered = 0;
  for (const auto& sum : sums_) {
    if (sum.num < static_cast<double>(kMinRingPoints)) continue;
    const double slope = sum.level_z / sum.level_level;
    const double rest_m2 = std::max(0.0, sum.z_z - slope * sum.level_z);
    ++num_rings;
    num_scattered += rest_m2 > kMaxRingScatter * kMaxRingScatter * sum.level_level ? 1 : 0;
  }
  return 2 * num_scattered > num_rings;
}

// From here on rings or bands stay what they are.
void CloudScans::Settle() {
  is_settled_ = true;
  has_rings_ = has_rings_ && !AreRingsScattered();
  if (!has_rings_) CutBands();
  elevations_ = {};
}

void CloudScans::CutBands() {
  const auto [lowest_rad, highest_rad] = learned_rad_;
  // Half a band more on each side: places of points are rounded, and parallax moves near ones.
  const double margin_rad = std::max(highest_rad - lowest_rad, kMinBandsRad) / (2.0 * kNumCloudBands);
  bands_rad_ = {lowest_rad - margin_rad, highest_rad + margin_rad};
  sums_ = {};
  for (const auto& elevation : elevations_) {
    if (elevation.num == 0.0) continue;
    const auto band = std::clamp(BandOf(Atan2(elevation.z, elevation.level)), 0, kNumCloudBands - 1);
    auto& sum = sums_[static_cast<std::size_t>(band)];
    sum.num += elevation.num;
    sum.level += elevation.level;
    sum.z += elevation.z;
  }
}

// Outside of all bands it is less than 0, or kNumCloudBands or more.
std::int32_t CloudScans::BandOf(double elevation_rad) const {
  const auto [lowest_rad, highest_rad] = *bands_rad_;
  return static_cast<std::int32_t>(std::floor((elevation_rad - lowest_rad) / (highest_rad - lowest_rad) * kNumCloudBands));
}

// In a cloud of a sensor without rings, bands of equal height stand for rings.
void CloudScans::MendRings(RingCloud& cloud) {
  if (has_rings_) return;
  for (auto& point : cloud.points) point.ring = BandOf(Atan2(point.z_m, point.level_m));
  const auto num_outside = std::erase_if(cloud.points, [](const RingPoint& point) { return point.ring < 0 || point.ring >= kNumCloudBands; });
  counts_.num_out_of_range += static_cast<std::int64_t>(num_outside);
}

void CloudScans::Add(const RingCloud& cloud) {
  for (const auto& point : cloud.points) {
    if (point.ring < 0) continue;
    auto& sum = sums_[static_cast<std::size_t>(point.ring)];
    sum.num += 1.0;
    sum.level += point.level_m;
    sum.z += point.z_m;
    sum.level_level += point.level_m * point.level_m;
    sum.level_z += point.level_m * point.z_m;
    sum.z_z += point.z_m * point.z_m;
  }
}

// From the lowest up.
std::vector<CloudScans::Beam> CloudScans::Beams() const {
  std::vector<Beam> beams;
  for (std::size_t ring = 0; ring < sums_.size(); ++ring) {
    const auto& sum = sums_[ring];
    if (sum.num < static_cast<double>(kMinRingPoints)) continue;
    Beam beam{static_cast<std::int32_t>(ring), Atan2(sum.z, sum.level), 0.0};
    // z = height + level tan(elevation), where points lie at distances different enough to tell the two.
    const double spread_m2 = sum.level_level / sum.num - sum.level * sum.level / (sum.num * sum.num);
    const double slope = (sum.level_z / sum.num - sum.level * sum.z / (sum.num * sum.num)) / spread_m2;
    const double height_m = (sum.z - slope * sum.level) / sum.num;
    if (has_rings_ && spread_m2 > 1.0 && std::abs(height_m) < kMaxOriginM) {
      beam.elevation_rad = Atan2(slope, 1.0);
      beam.origin_height_m = height_m;
    }
    beams.push_back(beam);
  }
  std::ranges::stable_sort(beams, {}, &Beam::elevation_rad);
  return beams;
}

// Points of rings that are known, as places in `beams`; a ring that was not seen before is learned from this cloud.
std::vector<CloudScans::Beam> CloudScans::SortIntoBeams(RingCloud& cloud) {
  RingCloud unknown;
  auto beams = Beams();
  auto places = PlacesOf(beams);
  for (const auto& point : cloud.points) {
    if (point.ring >= 0 && places[static_cast<std::size_t>(point.ring)] < 0) unknown.points.push_back(point);
  }
  if (!unknown.points.empty()) {
    Add(unknown);
    beams = Beams();
    places = PlacesOf(beams);
  }
  counts_.num_no_ring +=
      std::erase_if(cloud.points, [&](const RingPoint& point) { return point.ring < 0 || places[static_cast<std::size_t>(point.ring)] < 0; });
  return beams;
}

std::array<std::int32_t, kMaxImportRings> CloudScans::PlacesOf(const std::vector<Beam>& beams) {
  std::array<std::int32_t, kMaxImportRings> places{};
  places.fill(-1);
  for (std::size_t i = 0; i < beams.size(); ++i) places[static_cast<std::size_t>(beams[i].ring)] = static_cast<std::int32_t>(i);
  return places;
}

// The scan without its cells.
lidar_scan_t CloudScans::HeadOf(const std::vector<Beam>& beams, const CloudColumns& columns, std::int64_t stamp_ns) {
  lidar_scan_t scan{};
  scan.time_source = lidar_scan_t::TIME_HOST;
  const bool has_columns = !columns.azimuth_rad.empty();
  const double begin_ns = has_columns ? *std::ranges::min_element(columns.time_ns) : 0.0;
  const auto base_ns = stamp_ns + std::llround(begin_ns);
  scan.utime_us = base_ns >= 0 ? base_ns / 1000 : (base_ns - 999) / 1000;
  const auto base_of_cloud_ns = static_cast<double>(scan.utime_us * 1000 - stamp_ns);
  double longest_offset_ns = 0.0;
  for (const auto& beam : beams) {
    const auto ring = static_cast<std::size_t>(beam.ring);
    const double offset_ns = has_columns ? columns.time_offset_ns[ring] : 0.0;
    longest_offset_ns = std::max(longest_offset_ns, offset_ns);
    scan.elevation_rad.push_back(static_cast<float>(beam.elevation_rad));
    scan.azimuth_offset_rad.push_back(has_columns ? static_cast<float>(columns.azimuth_offset_rad[ring]) : 0.0F);
    scan.time_offset_ns.push_back(static_cast<std::int32_t>(std::llround(offset_ns)));
    scan.origin_height_m.push_back(static_cast<float>(beam.origin_height_m));
  }
  scan.num_rings = messages::CountOf(scan.elevation_rad);
  scan.return_kind = {lidar_scan_t::RETURN_STRONGEST};
  scan.num_returns = 1;
  std::int32_t last_ns = 0;
  for (std::size_t column = 0; column < columns.azimuth_rad.size(); ++column) {
    // 2 pi as a float is more than 2 pi.
    scan.azimuth_rad.push_back(std::min(static_cast<float>(columns.azimuth_rad[column]), std::nextafter(static_cast<float>(kTwoPi), 0.0F)));
    scan.time_ns.push_back(static_cast<std::int32_t>(std::llround(std::clamp(columns.time_ns[column] - base_of_cloud_ns, 0.0, kLongestScanNs))));
    last_ns = std::max(last_ns, scan.time_ns.back());
  }
  scan.num_turn_columns = messages::CountOf(scan.azimuth_rad);
  scan.end_utime_us = scan.utime_us + (last_ns + static_cast<std::int64_t>(std::ceil(longest_offset_ns)) + 999) / 1000;
  return scan;
}

// Two points of one ring and one shot: in one direction at one time. Others of the ring are a column apart, or a turn. A band holds several rings, so
// there the elevation counts, too.
bool CloudScans::IsOneShot(const RingPoint& one, const RingPoint& other) const {
  constexpr double kSameDirectionRad = 1e-4;
  constexpr std::int64_t kSameTimeNs = 1000;
  if (std::abs(WrapToPi(one.azimuth_rad - other.azimuth_rad)) > kSameDirectionRad || std::abs(one.time_ns - other.time_ns) > kSameTimeNs)
    return false;
  return has_rings_ || std::abs(Atan2(one.z_m, one.level_m) - Atan2(other.z_m, other.level_m)) <= kSameDirectionRad;
}

// The nearest point of each cell, and where the cloud has two returns of a shot the next one of the same shot.
CloudScans::CellPoints CloudScans::SortIntoCells(const RingCloud& cloud, const std::vector<std::size_t>& cell_of_point,
                                                 const std::vector<double>& ranges_m, std::size_t num_cells) {
  constexpr std::int64_t kLeastSecondReturns = 8;
  CellPoints cells;
  cells.first.assign(num_cells, kNoPoint);
  const auto is_nearer = [&](std::size_t point, std::int32_t than) {
    return than == kNoPoint || ranges_m[point] < ranges_m[static_cast<std::size_t>(than)];
  };
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    auto& first = cells.first[cell_of_point[i]];
    if (is_nearer(i, first)) first = static_cast<std::int32_t>(i);
  }
  cells.second.assign(num_cells, kNoPoint);
  std::int64_t num_beside = 0;
  std::int64_t num_of_shot = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto first = static_cast<std::size_t>(cells.first[cell_of_point[i]]);
    if (first == i) continue;
    ++num_beside;
    if (!IsOneShot(cloud.points[first], cloud.points[i])) continue;
    ++num_of_shot;
    auto& second = cells.second[cell_of_point[i]];
    if (is_nearer(i, second)) second = static_cast<std::int32_t>(i);
  }
  // A turn that ends over its beginning meets a direction again by chance, and of a grid some points share a cell.
  const bool has_second =
      num_of_shot >= kLeastSecondReturns && 2 * num_of_shot > num_beside && 2 * std::ssize(cells.first) <= messages::kMaxScanCells;
  if (!has_second) cells.second.clear();
  counts_.num_hidden += num_beside - (has_second ? std::ranges::count_if(cells.second, [](std::int32_t point) { return point != kNoPoint; }) : 0);
  return cells;
}

void CloudScans::FillCells(const RingCloud& cloud, const std::vector<Beam>& beams, const CloudColumns& columns, lidar_scan_t& scan) {
  const auto places = PlacesOf(beams);
  double farthest_m = 0.0;
  std::vector<double> ranges_m;
  ranges_m.reserve(cloud.points.size());
  std::vector<std::size_t> cell_of_point;
  cell_of_point.reserve(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto& point = cloud.points[i];
    const auto place = static_cast<std::size_t>(places[static_cast<std::size_t>(point.ring)]);
    ranges_m.push_back(Hypot(point.level_m, point.z_m - beams[place].origin_height_m));
    farthest_m = std::max(farthest_m, ranges_m.back());
    cell_of_point.push_back(static_cast<std::size_t>(columns.column_of_point[i]) * beams.size() + place);
  }
  scan.range_unit_m = RangeUnitFor(farthest_m);
  const auto num_shots = columns.azimuth_rad.size() * beams.size();
  const auto cells = SortIntoCells(cloud, cell_of_point, ranges_m, num_shots);
  const std::size_t num_returns = cells.second.empty() ? 1 : 2;
  if (num_returns == 2) {
    // The farther one of two came last. Which one is the stronger no cloud says.
    scan.return_kind = {lidar_scan_t::RETURN_STRONGEST, lidar_scan_t::RETURN_LAST};
    scan.num_returns = 2;
    has_second_returns_ = true;
  }
  scan.range.assign(num_shots * num_returns, 0);
  scan.reflectivity.assign(num_shots * num_returns, 0);
  cell_labels_.assign(cloud.has_labels ? num_shots * num_returns : 0, 0);
  const auto put = [&](std::int32_t of_cell, std::size_t cell) {
    if (of_cell == kNoPoint) return;
    const auto i = static_cast<std::size_t>(of_cell);
    const auto count = static_cast<std::uint16_t>(std::clamp(std::round(ranges_m[i] / scan.range_unit_m), 1.0, kMaxCloudCount));
    scan.range[cell] = std::bit_cast<std::int16_t>(count);
    scan.reflectivity[cell] = cloud.points[i].reflectivity;
    if (cloud.has_labels) cell_labels_[cell] = cloud.points[i].label;
  };
  for (std::size_t shot = 0; shot < num_shots; ++shot) {
    put(cells.first[shot], shot * num_returns);
    if (num_returns == 2) put(cells.second[shot], shot * num_returns + 1);
  }
}

std::vector<lidar_scan_t> CloudScans::Refuse(std::string reason) {
  last_refusal_ = std::move(reason);
  ++counts_.num_refused;
  return {};
}

std::vector<lidar_scan_t> CloudScans::Convert(const RosPointCloud& cloud, std::int64_t stamp_ns, const std::string& model) {
  std::string why;
  auto points = ToRingCloud(cloud, why);
  if (!points) return Refuse(why);
  has_times_ = has_times_ && (points->has_times || points->are_times_refused);
  counts_.num_times_refused += points->are_times_refused ? 1 : 0;
  counts_.num_no_time += points->has_times ? points->num_no_time : 0;
  has_reflectivity_ = has_reflectivity_ && points->has_reflectivity;
  is_clock_other_ = is_clock_other_ || points->is_clock_other;
  counts_.num_points += std::ssize(points->points) + points->num_empty + points->num_out_of_range;
  counts_.num_empty += points->num_empty;
  counts_.num_out_of_range += points->num_out_of_range;
  if (!is_settled_) {
    if (elevations_.empty() && !Learn(cloud)) return Refuse("has too few points to know any ring");
    Settle();
  }
  MendRings(*points);
  const auto beams = SortIntoBeams(*points);
  if (beams.empty()) return Refuse("has too few points to know any ring");
  const auto columns = FindColumns(*points);
  const auto num_columns = std::ssize(columns.azimuth_rad);
  const bool is_lost = num_columns == 0 && !points->points.empty();
  if (is_lost || num_columns > messages::kMaxScanColumns || num_columns * std::ssize(beams) > messages::kMaxScanCells) {
    return Refuse("has more columns than a turn of a lidar");
  }
  auto scan = HeadOf(beams, columns, stamp_ns);
  scan.seq = next_seq_;
  scan.model = model;
  FillCells(*points, beams, columns, scan);
  auto parts = SplitScan(scan);
  for (const auto& part : parts) {
    if (const auto fault = messages::FaultOf(part, bus::kMaxMessageBytes)) return Refuse("gives no scan: " + std::string(*fault));
  }
  ++next_seq_;
  return parts;
}

std::vector<std::string> CloudScans::Remarks() const {
  std::vector<std::string> remarks;
  if (!has_rings_) {
    remarks.push_back("the clouds have no rings: " + std::to_string(kNumCloudBands) +
                      " bands of equal height stand for them, and the elevation of a point is that of its band");
  }
  if (!has_times_) remarks.emplace_back("the clouds have no times of points: each scan has one time, that of its cloud");
  if (counts_.num_times_refused > 0) {
    remarks.push_back(std::to_string(counts_.num_times_refused) +
                      " clouds have times of points that are more than a second apart, or are none: each of their scans has one time");
  }
  if (is_clock_other_) remarks.emplace_back("the times of points are of another clock than the cloud's: only their differences are used");
  if (has_second_returns_) {
    remarks.emplace_back("there are clouds with two returns of a shot: the nearer one stands as the strongest, the farther one as the last");
  }
  if (!has_reflectivity_) remarks.emplace_back("the clouds have no reflectivity: it is 0");
  if (counts_.num_refused > 0) remarks.push_back(std::to_string(counts_.num_refused) + " clouds give no scan; the last one " + last_refusal_);
  return remarks;
}

}  // namespace lookout::importer
