// Structures over the water that stand on the ground.
#pragma once

#include "lab/sim/fleet.hpp"
#include "lab/sim/random.hpp"

namespace lookout::sim {

/// A deck on rows of piles (bents), with or without a railing: seen through. The origin is the middle of its landward end, x runs out along it.
///
/// @param size  all but the length and the width may be 0: then they are drawn
SceneObject MakePilePier(const Size& size, Random& random);

/// A deck on massive piers. The origin as of a pier.
SceneObject MakeBridge(const Size& size, Random& random);

/// Prolongs the deck of a dock, pier or bridge, its first part, beyond its landward end.
void ProlongToLand(double by_m, SceneObject& dock);

}  // namespace lookout::sim
