#include "tools/import/cloud_points.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::importer {

namespace {

constexpr std::size_t CloudFieldBytes(std::uint8_t type) {
  switch (type) {
    case RosPointField::kInt8:
    case RosPointField::kUint8:
      return 1;
    case RosPointField::kInt16:
    case RosPointField::kUint16:
      return 2;
    case RosPointField::kInt32:
    case RosPointField::kUint32:
    case RosPointField::kFloat32:
      return 4;
    case RosPointField::kFloat64:
      return 8;
    default:
      return 0;
  }
}

bool IsFloat(const RosPointField& field) { return field.type == RosPointField::kFloat32 || field.type == RosPointField::kFloat64; }

// The first field of these names that lies inside of a point.
const RosPointField* FindField(const RosPointCloud& cloud, std::initializer_list<std::string_view> names) {
  for (const auto name : names) {
    for (const auto& field : cloud.fields) {
      const auto size = CloudFieldBytes(field.type);
      if (field.name == name && size > 0 && field.count <= 1 && std::uint64_t{field.offset} + size <= cloud.point_step) return &field;
    }
  }
  return nullptr;
}

std::uint64_t BitsOf(Bytes bytes, bool is_big_endian) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) bits = bits << 8 | bytes[is_big_endian ? i : bytes.size() - 1 - i];
  return bits;
}

double ValueOf(const RosPointField& field, Bytes point, bool is_big_endian) {
  const auto bits = BitsOf(point.subspan(field.offset, CloudFieldBytes(field.type)), is_big_endian);
  switch (field.type) {
    case RosPointField::kInt8:
      return static_cast<std::int8_t>(bits);
    case RosPointField::kInt16:
      return static_cast<std::int16_t>(bits);
    case RosPointField::kInt32:
      return static_cast<std::int32_t>(bits);
    case RosPointField::kFloat32:
      return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    case RosPointField::kFloat64:
      return std::bit_cast<double>(bits);
    default:
      return static_cast<double>(bits);
  }
}

// Times of points as a driver states them, in nanoseconds since the stamp.
class PointTimes {
 public:
  PointTimes(const RosPointCloud& cloud, const RosPointField* field) : stamp_ns_(cloud.header.stamp_ns), field_(field) {
    is_absolute_ = field != nullptr && field->name == "timestamp";
  }

  bool is_absolute() const { return is_absolute_; }

  // Time of a point; nullopt where it has none. At most half of what an int64_t holds, so that differences do not overflow.
  std::optional<std::int64_t> Of(Bytes point, bool is_big_endian) const {
    const auto time_ns = NsOf(point, is_big_endian);
    return time_ns && *time_ns >= -kMostTimeNs && *time_ns <= kMostTimeNs ? time_ns : std::nullopt;
  }

 private:
  static constexpr std::int64_t kMostTimeNs = 4'000'000'000'000'000'000;

  std::optional<std::int64_t> NsOf(Bytes point, bool is_big_endian) const {
    constexpr double kNsPerSecond = 1e9;
    constexpr double kLeastNs = 1e14;  // seconds since 1970 are fewer by far, nanoseconds more
    constexpr double kMostNs = 4e18;
    if (field_ == nullptr) return 0;
    const double value = ValueOf(*field_, point, is_big_endian);
    if (!(std::abs(value) < kMostNs)) return std::nullopt;
    if (!IsFloat(*field_) || std::abs(value) > kLeastNs) return static_cast<std::int64_t>(value) - (is_absolute_ ? stamp_ns_ : 0);
    // Whole seconds apart, so that none of the digits of the double is lost.
    const double whole_s = std::floor(value);
    if (std::abs(whole_s) * kNsPerSecond > kMostNs) return std::nullopt;
    return static_cast<std::int64_t>(whole_s) * 1'000'000'000 + std::llround((value - whole_s) * kNsPerSecond) - (is_absolute_ ? stamp_ns_ : 0);
  }

  std::int64_t stamp_ns_;
  const RosPointField* field_;
  bool is_absolute_ = false;
};

// nullopt where no point has a time.
std::optional<std::int64_t> MedianTimeNs(const RingCloud& cloud) {
  std::vector<std::int64_t> times_ns;
  times_ns.reserve(cloud.points.size());
  for (const auto& point : cloud.points) {
    if (point.has_time) times_ns.push_back(point.time_ns);
  }
  if (times_ns.empty()) return std::nullopt;
  const auto middle = times_ns.begin() + static_cast<std::ptrdiff_t>(times_ns.size() / 2);
  std::ranges::nth_element(times_ns, middle);
  return *middle;
}

void RefuseTimes(RingCloud& cloud) {
  cloud.has_times = false;
  cloud.are_times_refused = true;
  for (auto& point : cloud.points) point.time_ns = 0;
}

// Takes away times that are none, so that one of them does not move the others. @return the least and greatest that stay; nullopt: there are none
std::optional<std::array<std::int64_t, 2>> MendTimes(RingCloud& cloud) {
  const auto median_ns = MedianTimeNs(cloud);
  std::int64_t first_ns = median_ns.value_or(0);
  std::int64_t last_ns = first_ns;
  for (auto& point : cloud.points) {
    point.has_time = median_ns && point.has_time && std::abs(point.time_ns - *median_ns) <= kMaxPointTimeOffNs;
    cloud.num_no_time += point.has_time ? 0 : 1;
    if (!point.has_time) continue;
    first_ns = std::min(first_ns, point.time_ns);
    last_ns = std::max(last_ns, point.time_ns);
  }
  if (!median_ns || cloud.num_no_time > std::max<std::int64_t>(1, std::ssize(cloud.points) / kMaxNoTimeShare)) return std::nullopt;
  // Drivers write firing by firing, or ring by ring.
  const auto first_timed = std::ranges::find_if(cloud.points, &RingPoint::has_time);
  auto before_ns = first_timed->time_ns;
  for (auto& point : cloud.points) before_ns = point.time_ns = point.has_time ? point.time_ns : before_ns;
  return std::array{first_ns, last_ns};
}

// A sensor that has no time of day, or another one: the first point is taken to be of the time of the stamp.
void MendClock(RingCloud& cloud) {
  if (!cloud.has_times || cloud.points.empty()) return;
  const auto span_ns = MendTimes(cloud);
  if (!span_ns) return RefuseTimes(cloud);
  const auto [first_ns, last_ns] = *span_ns;
  if (first_ns >= -kMaxPointTimeOffNs && last_ns <= kMaxPointTimeOffNs) return;
  cloud.is_clock_other = true;
  for (auto& point : cloud.points) point.time_ns -= first_ns;
}

}  // namespace

std::optional<RingCloud> ToRingCloud(const RosPointCloud& cloud, std::string& why) {
  const auto* const x = FindField(cloud, {"x"});
  const auto* const y = FindField(cloud, {"y"});
  const auto* const z = FindField(cloud, {"z"});
  if (x == nullptr || y == nullptr || z == nullptr) {
    why = "has no fields x, y and z";
    return std::nullopt;
  }
  const auto* const ring = FindField(cloud, {"ring", "line", "channel"});
  const auto* const time = FindField(cloud, {"time", "t", "offset_time", "timestamp"});
  const auto* const reflectivity = FindField(cloud, {"reflectivity", "intensity"});
  const auto* const label = FindField(cloud, {"label"});
  RingCloud result;
  result.height = static_cast<std::int32_t>(cloud.height);
  result.width = static_cast<std::int32_t>(cloud.width);
  result.has_times = time != nullptr;
  result.has_reflectivity = reflectivity != nullptr;
  result.has_labels = label != nullptr;
  const bool are_rows_rings = ring == nullptr && result.height > 1 && result.height <= kMaxImportRings && result.width > 1;
  result.has_rings = ring != nullptr || are_rows_rings;
  const PointTimes times(cloud, time);
  result.points.reserve(static_cast<std::size_t>(cloud.height) * cloud.width);
  for (std::int32_t row = 0; row < result.height; ++row) {
    for (std::int32_t column = 0; column < result.width; ++column) {
      const auto point =
          cloud.data.subspan(static_cast<std::size_t>(row) * cloud.row_step + static_cast<std::size_t>(column) * cloud.point_step, cloud.point_step);
      const double x_m = ValueOf(*x, point, cloud.is_big_endian);
      const double y_m = ValueOf(*y, point, cloud.is_big_endian);
      const double z_m = ValueOf(*z, point, cloud.is_big_endian);
      if (!std::isfinite(x_m) || !std::isfinite(y_m) || !std::isfinite(z_m)) {
        ++result.num_empty;
        continue;
      }
      const double level_m = std::sqrt(x_m * x_m + y_m * y_m);
      const double range_m = std::sqrt(level_m * level_m + z_m * z_m);
      if (range_m < kMinImportRangeM) {
        ++result.num_empty;
        continue;
      }
      const double number = ring == nullptr ? (are_rows_rings ? row : RingCloud::kNoRing) : ValueOf(*ring, point, cloud.is_big_endian);
      if (!(range_m <= kMaxImportRangeM) || !(number >= RingCloud::kNoRing && number < kMaxImportRings)) {
        ++result.num_out_of_range;
        continue;
      }
      auto& made = result.points.emplace_back();
      made.azimuth_rad = WrapTo2Pi(-Atan2(y_m, x_m));
      made.level_m = level_m;
      made.z_m = z_m;
      const auto time_ns = times.Of(point, cloud.is_big_endian);
      made.has_time = time_ns.has_value();
      made.time_ns = time_ns.value_or(0);
      made.ring = static_cast<std::int32_t>(number);
      made.row = row;
      made.column = column;
      if (label != nullptr) {
        const double value = ValueOf(*label, point, cloud.is_big_endian);
        made.label = value > 0.0 ? static_cast<std::uint32_t>(std::min(value, 4294967295.0)) : 0;
      }
      if (reflectivity == nullptr) continue;
      const double value = ValueOf(*reflectivity, point, cloud.is_big_endian);
      made.reflectivity = static_cast<std::uint8_t>(value > 0.0 ? std::min(std::round(value), 255.0) : 0.0);
    }
  }
  MendClock(result);
  return result;
}

}  // namespace lookout::importer
