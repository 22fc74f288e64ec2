// What floats and what is built: boats, swimmers, buoys, markers, docks, piers and walls. Sizes are those of common craft, rounded.
#pragma once

#include <span>
#include <string_view>

#include "tools/sim/scene.hpp"

namespace lookout::sim {

/// Of an object. 0 where its kind has no such size.
struct Size {
  double length_m = 0.0;  // along x
  double width_m = 0.0;   // along y; of round things the diameter
  double height_m = 0.0;  // above the water
  double reflectance = 0.0;
};

/// A kind of object and how to make one.
struct KindOfObject {
  std::string_view name;  // as in scene files, lower case
  Size usual;             // 0 = the kind has no such size
  bool is_in_water;       // a boat, swimmer, buoy or marker
  bool is_afloat;         // rides the waves
  /// Makes parts and outline.
  void (*make)(const Size& size, SceneObject& object);
};

/// All kinds but shores and islands (shore.hpp).
std::span<const KindOfObject> Kinds();

/// @return an object of this kind without id, name and way
SceneObject MakeObject(const KindOfObject& kind, const Size& size);

}  // namespace lookout::sim
