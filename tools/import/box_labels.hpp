// Boxes around the things of a cloud, as 3D-BAT writes them and the tools of SeePerSea read them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace lookout::importer {

/// A labelled box in the frame of the cloud.
struct LabelledBox {
  std::uint32_t label = 0;  // class in the lower, instance in the upper 16 bits: as in SemanticKITTI
  double x_m = 0.0;         // centre of the box
  double y_m = 0.0;
  double z_m = 0.0;
  double half_width_m = 0.0;   // along x, before the box is turned
  double half_length_m = 0.0;  // along y
  double half_height_m = 0.0;
  double cos_yaw = 1.0;  // about z
  double sin_yaw = 0.0;
};

/// Classes of a box's category; an unknown category is kBoxOther.
inline constexpr std::uint32_t kBoxShip = 1;
inline constexpr std::uint32_t kBoxBuoy = 2;
inline constexpr std::uint32_t kBoxOther = 3;

/// {"labels": [{"id": 3, "category": "ship", "box3d": {"dimension": {"width", "length", "height"}, "location": {"x", "y", "z"}, "orientation":
/// {"rotationYaw"}}}]}. The instance is the id and one, or without it the place in the list and one. An empty file has no labels.
/// Source: view_images.py and README.md of github.com/dartmouthrobotics/SeePerSea
///
/// @return nullopt where it is not such a text, or a number is not finite, a size negative or a box larger than a ship
std::optional<std::vector<LabelledBox>> ParseBoxes(std::string_view text);

/// The label of the smallest box that holds the point; 0 where none does.
std::uint32_t LabelAt(std::span<const LabelledBox> boxes, double x_m, double y_m, double z_m);

}  // namespace lookout::importer
