// Scans as the KITTI and SemanticKITTI data sets keep them: x y z i of each point, and a label for each in a file of its own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "lab/data/point_cloud.hpp"

namespace lookout::data {

/// @param points_file  little-endian 32-bit floats: x, y, z in metres, intensity 0 to 1 (kept as 0 to 100)
/// @param label_file   little-endian 32-bit numbers: class in the lower, instance in the upper 16 bits. nullopt = no labels
/// @return points with an instance belong to an object, one for each class and instance; points without (road, water, plants) to none. Where no point
///         of the file has an instance each class is one object, but 0 (unlabelled) and 1 (outlier)
/// @throws PointFileError
/// Source: A. Geiger et al., "Vision meets Robotics: The KITTI Dataset", IJRR 2013; J. Behley et al., "SemanticKITTI", ICCV 2019.
PointCloud ReadKitti(const std::filesystem::path& points_file, const std::optional<std::filesystem::path>& label_file);

/// ReadKitti for bytes in memory. The names are for errors.
PointCloud ParseKitti(std::string_view points, const std::string& points_name, std::optional<std::string_view> labels,
                      const std::string& labels_name);

}  // namespace lookout::data
