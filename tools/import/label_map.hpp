// What the labels of a data set mean to the judge: read from a text file, or the default of the data set.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace lookout::importer {

/// water, none: of no object (the surface, spray, what nobody labelled). land: an object that is not in the water. obstacle: one in the water.
enum class LabelUse { kNone, kWater, kLand, kObstacle };

struct LabelMeaning {
  LabelUse use = LabelUse::kNone;
  std::string name;  // "car"; without one "label 10"
};

/// By class: the lower 16 bits of a label. What is not in it is of no object.
using LabelMap = std::map<std::uint16_t, LabelMeaning>;

/// As in semantic-kitti.yaml: of a road, whose surface stands where water would be.
extern const std::string_view kSemanticKittiLabels;
/// Of box_labels.hpp.
extern const std::string_view kBoxLabels;

/// Lines "CLASS water|land|obstacle|none [NAME]"; # begins a comment.
///
/// @throws config::ConfigError with all faults, each with its line
LabelMap ParseLabelMap(const std::string& text, const std::string& name);

}  // namespace lookout::importer
