#include "lab/data/kitti.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "common/core/bytes.hpp"
#include "tools/import/file_bytes.hpp"

namespace lookout::data {

namespace {

using importer::ReadFileBytes;
using importer::RefuseByte;

constexpr std::size_t kPointBytes = 16;
constexpr std::size_t kLabelBytes = 4;
constexpr float kReflectivityOfWhite = 100.0F;  // per cent, as a VLP-16 states it

// semantic-kitti.yaml: 0 "unlabeled", 1 "outlier".
constexpr std::uint32_t kOutlierClass = 1;

Bytes ToBytes(std::string_view text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

std::uint16_t InstanceOf(std::uint32_t label) { return static_cast<std::uint16_t>(label >> 16); }

std::uint8_t ToReflectivity(float intensity) {
  if (!(intensity > 0.0F)) return 0;  // also NaN
  return static_cast<std::uint8_t>(std::lround(std::min(1.0F, intensity) * kReflectivityOfWhite));
}

}  // namespace

PointCloud ParseKitti(std::string_view points, const std::string& points_name, std::optional<std::string_view> labels,
                      const std::string& labels_name) {
  if (points.size() % kPointBytes != 0) {
    RefuseByte(points_name, points.size() / kPointBytes * kPointBytes, "the file ends inside a point of 16 bytes");
  }
  const std::size_t num_points = points.size() / kPointBytes;
  if (num_points > static_cast<std::size_t>(kMaxCloudPoints)) RefuseByte(points_name, 0, std::to_string(num_points) + " points are no scan");
  if (labels && labels->size() != num_points * kLabelBytes) {
    RefuseByte(labels_name, std::min(labels->size(), num_points * kLabelBytes),
               std::to_string(num_points) + " points need " + std::to_string(num_points * kLabelBytes) + " bytes of labels, not " +
                   std::to_string(labels->size()));
  }

  PointCloud cloud;
  cloud.has_labels = labels.has_value();
  std::map<std::uint32_t, std::int32_t> object_of_label;
  if (labels) {
    std::set<std::uint32_t> seen;
    for (std::size_t i = 0; i < num_points; ++i) seen.insert(ReadU32LittleEndian(ToBytes(*labels), i * kLabelBytes));
    const bool has_instances = std::ranges::any_of(seen, [](std::uint32_t label) { return InstanceOf(label) != 0; });
    for (const auto label : seen) {
      if (has_instances ? InstanceOf(label) == 0 : label <= kOutlierClass) continue;
      const auto object = static_cast<std::int32_t>(object_of_label.size()) + 1;
      object_of_label.emplace(label, object);
      const std::string kind = "class " + std::to_string(label & 0xFFFFU);
      cloud.objects[object] = {has_instances ? kind + " instance " + std::to_string(InstanceOf(label)) : kind, kind, false};
    }
    cloud.are_classes_objects = !has_instances && !cloud.objects.empty();
  }
  const auto number = [bytes = ToBytes(points)](std::size_t offset) { return std::bit_cast<float>(ReadU32LittleEndian(bytes, offset)); };
  cloud.points.reserve(num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    const std::size_t offset = i * kPointBytes;
    CloudPoint point{number(offset), number(offset + 4), number(offset + 8), ToReflectivity(number(offset + 12)), kNoTrueObject};
    if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m) || !std::isfinite(point.z_m)) {
      ++cloud.num_not_finite;
      continue;
    }
    if (labels) {
      const auto found = object_of_label.find(ReadU32LittleEndian(ToBytes(*labels), i * kLabelBytes));
      if (found != object_of_label.end()) point.object = found->second;
    }
    cloud.points.push_back(point);
  }
  return cloud;
}

PointCloud ReadKitti(const std::filesystem::path& points_file, const std::optional<std::filesystem::path>& label_file) {
  const auto points = ReadFileBytes(points_file);
  if (!label_file) return ParseKitti(points, points_file.string(), std::nullopt, "");
  const auto labels = ReadFileBytes(*label_file);
  return ParseKitti(points, points_file.string(), labels, label_file->string());
}

}  // namespace lookout::data
