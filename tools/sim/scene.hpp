// What floats and stands around the own boat.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/sim/motion.hpp"
#include "tools/sim/solid.hpp"

namespace lookout::sim {

/// What a surface gives back.
struct Material {
  double reflectance;      // diffuse, 0 to 1; the reflectivity of the device is this in per cent
  bool is_porous = false;  // foliage: a part of the beam goes on behind it
};

struct Part {
  Solid solid;  // frame of its object
  Material material;
};

inline constexpr int kNoObject = 0;  // stray return
inline constexpr int kOwnVessel = -1;

struct SceneObject {
  int id;  // 1, 2, ...
  std::string name;
  std::string kind;
  Track track;
  std::vector<Part> parts;                 // object frame: x forward, y port, z up from the calm water
  std::vector<Eigen::Vector2d> outline_m;  // all parts seen from above: a simple polygon, object frame
};

struct Scene {
  OwnMotion own_motion;
  std::vector<SceneObject> objects;
};

/// @return names that MakeScene knows, sorted
std::vector<std::string_view> SceneNames();

/// @param seed  decides on the line of the shore (with the dock on it), trees and waves; all else has the same place with every seed
/// @return nullopt when no scene has that name
std::optional<Scene> MakeScene(std::string_view name, std::uint64_t seed);

/// The own boat in the vessel frame: deck, outboard motor and the antenna's post, 0.2 m inside of the box around the own vessel at its sides.
///
/// @param box_m                own_vessel of boat.txtpb
/// @param lidar_height_m       z of the lidar: the motor stays below its level
/// @param p_vessel_antenna_m   top of the post
std::vector<Part> MakeOwnHull(const Eigen::AlignedBox3d& box_m, double lidar_height_m, const Eigen::Vector3d& p_vessel_antenna_m);

}  // namespace lookout::sim
