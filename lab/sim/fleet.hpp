// Floating and built things: boats, swimmers, buoys, markers, docks, piers and walls (sizes of common craft, rounded); and land: a bank
// along an irregular waterline, rising ground behind it, and trees.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "lab/sim/random.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

class Model;

/// Size of an object. 0 where its kind has no such size.
struct Size {
  double length_m = 0.0;  // along x
  double width_m = 0.0;   // along y; diameter of round things
  double height_m = 0.0;  // above the water
  double reflectance = 0.0;
};

/// A kind of object and how to make one: always the same one, or one that a seed draws.
struct KindOfObject {
  std::string_view name;  // as in scene files, lower case
  Size usual;             // 0 = the kind has no such size; for a drawn kind the greatest size
  bool is_in_water;       // a boat, swimmer, buoy or marker
  bool is_afloat;         // rides the waves
  // A kind has one of make, draw and one_of. This one makes parts and outline.
  void (*make)(const Size& size, SceneObject& object);
  /// Draws parts and waterline, and every size that is 0. An object without an outline then gets one round all parts.
  void (*draw)(const Size& size, Model& model) = nullptr;
  /// Names of the kinds of which the seed draws one. Kinds of many forms come more often.
  std::span<const std::string_view> one_of = {};

  bool is_drawn() const { return make == nullptr; }
};

/// All kinds but shores and islands.
std::span<const KindOfObject> Kinds();

/// @param size  sizes that are not given are the usual ones, 0 for a drawn kind
/// @return an object of this kind without id, name and way
SceneObject MakeObject(const KindOfObject& kind, const Size& size, Random& random);

/// @return radius of the waterline at a bearing
using Waterline = std::function<double(double bearing_rad)>;

struct Shore {
  SceneObject object;  // frame: x north, y west, origin in the middle of the circle
  Waterline waterline_m;
};

/// Land outward of the waterline.
Shore MakeShore(const config::Scene::Land& land, Random& random);

/// Land inward of the waterline: a bank round it and a hill. Trees only where their crowns stay over the land.
SceneObject MakeIsland(const config::Scene::Land& land, Random& random);

}  // namespace lookout::sim
