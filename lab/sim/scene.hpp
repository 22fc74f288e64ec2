// Things that float and stand around the own boat.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/schema/scene.pb.h"
#include "lab/sim/motion.hpp"
#include "lab/sim/sea.hpp"
#include "lab/sim/solid.hpp"

namespace lookout::sim {

/// Strengths of effects that the lidar meets besides clean surfaces. Models and their sources: README.md, "What is simulated".
using Effects = config::Scene::Effects;

/// Why there is a return. The values are on the wire (sim_truth_t): one may be added at the end, none changes its meaning.
enum class ReturnReason {
  kObject = 0,     // the surface of an object
  kOwnVessel = 1,  // the own boat
  kStray = 2,      // noise of the receiver
  kGlint = 3,      // water near the boat
  kCrest = 4,      // foam on a wave
  kWake = 5,       // foam behind a moving boat
  kSpray = 6,      // drops at the own bow
  kRain = 7,
  kMixedEdge = 8,  // a beam on two surfaces; the return belongs to the nearer object
  kMirror = 9,     // an object mirrored in the water's surface, below which it seems to lie
  kBird = 10,      // in flight
  kFog = 11,
};
inline constexpr std::array<std::string_view, 12> kReasonNames{"object", "own_vessel", "stray",      "glint",  "crest", "wake",
                                                               "spray",  "rain",       "mixed_edge", "mirror", "bird",  "fog"};
constexpr std::string_view NameOf(ReturnReason reason) { return kReasonNames[static_cast<std::size_t>(reason)]; }

/// How a surface reflects.
struct Material {
  double reflectance;      // diffuse, 0 to 1; above 1, to 2.55, of a retro-reflector; the reflectivity of the device is this in per cent
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
  // A boat, swimmer, buoy or marker; not land, nor what is built on it: docks, piers and walls.
  bool is_in_water = false;
  Eigen::Vector2d waterline_m = Eigen::Vector2d::Zero();  // length and width of a thing that floats and rides the waves; zero = stands on the ground

  bool is_afloat() const { return !waterline_m.isZero(); }
};

/// Pose of the frame of an object. A floating object goes up and down with the water under it and leans as the water between its ends does.
Eigen::Isometry3d PoseAt(const SceneObject& object, const Sea& sea, double time_s);

struct Scene {
  OwnMotion own_motion;
  std::vector<SceneObject> objects;
  Sea sea{};
  Effects effects{};
  std::string lidar = "vlp16";      // one of HeadNames()
  std::optional<double> lasts_s{};  // where the file says how long things keep their distances
};

/// The own boat in the vessel frame: deck, outboard motor and the antenna's post, 0.2 m inside of the box around the own vessel at its sides.
///
/// @param box_m                own_vessel of boat.txtpb
/// @param lidar_height_m       z of the lidar: the motor stays below its level
/// @param p_vessel_antenna_m   top of the post
SceneObject MakeOwnHull(const Eigen::AlignedBox3d& box_m, double lidar_height_m, const Eigen::Vector3d& p_vessel_antenna_m);

/// Effects::own_crew and own_gear: people at the stern, rods at the edges, some of them a little outside of the box around the own vessel.
void AddCrewAndGear(const Effects& effects, const Eigen::AlignedBox3d& box_m, std::uint64_t seed, SceneObject& hull);

}  // namespace lookout::sim
