// The points of a file as the message of a cloud: sensor_msgs/PointCloud2 in the encoding of ROS 1, which all clouds are imported by.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/box_labels.hpp"

namespace lookout::importer {

struct PointMessage {
  std::vector<std::uint8_t> bytes;  // empty where nothing of the file can be used
  std::int64_t stamp_ns = 0;
  std::string fault;  // why points of the file are lost, with the place; empty: none is
};

/// Labels beside a file of points.
struct PointLabels {
  std::optional<std::string_view> of_points;  // bytes of a file of SemanticKITTI: class in the lower, instance in the upper 16 bits of each number
  std::optional<std::span<const LabelledBox>> boxes;
};

/// x y z and reflectance (0 to 1, kept as 0 to 100) of each point, as 32-bit floats in the order of this machine; no rings, no times.
///
/// @param name  of the file, for faults
PointMessage MessageOfKitti(std::string_view bytes, const std::string& name, std::int64_t stamp_ns, const PointLabels& labels);

/// A PCD file with x y z; ring, line or channel; time, t, offset_time or timestamp; reflectivity or intensity; label. Others are left out. A file
/// that is damaged gives its points before the fault; one of several rows keeps them.
///
/// @param stamp_ns  nullopt: the least `timestamp` of a point
PointMessage MessageOfPcd(std::string_view bytes, const std::string& name, std::optional<std::int64_t> stamp_ns, const PointLabels& labels);

}  // namespace lookout::importer
