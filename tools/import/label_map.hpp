// The meaning of a data set's labels for lookout-eval: read from a text file, or the default of the data set.
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
  std::string name;  // "car"; "label 10" for a label without a name
};

/// By class, the lower 16 bits of a label. Points of a class that is not in the map belong to no object.
using LabelMap = std::map<std::uint16_t, LabelMeaning>;

/// Map for the classes of semantic-kitti.yaml: of roads, whose surface counts as water.
extern const std::string_view kSemanticKittiLabels;
/// Map for the classes of box_labels.hpp.
extern const std::string_view kBoxLabels;

/// Lines "CLASS water|land|obstacle|none [NAME]"; # begins a comment.
///
/// @throws config::ConfigError with all faults, each with its line
LabelMap ParseLabelMap(const std::string& text, const std::string& name);

}  // namespace lookout::importer
