// PCD files of the Point Cloud Library, written in text or binary.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "lab/data/point_cloud.hpp"

namespace lookout::data {

/// Fields may come in any order, with any type and size, and others beside them. x, y, z are metres in the frame of the sensor. `intensity` is kept
/// as a whole number from 0 to 255. `label` is the object that a point belongs to, 0 and below for none; without it the cloud has no labels.
///
/// @throws PointFileError
PointCloud ReadPcd(const std::filesystem::path& file);

/// ReadPcd for bytes in memory. The name is for errors.
PointCloud ParsePcd(std::string_view bytes, const std::string& name);

}  // namespace lookout::data
