// From a checked scene file and a seed to a scene.
#pragma once

#include <cstdint>

#include "config/schema/scene.pb.h"
#include "tools/sim/scene.hpp"
#include "tools/sim/scene_faults.hpp"

namespace lookout::sim {

/// @param scene   as CheckScene leaves it without fault
/// @param faults  takes what the drawing finds: no place for an object, a name twice, an object in the way of the own boat
/// @throws config::ConfigError by way of `faults`
Scene DrawScene(const config::Scene& scene, std::uint64_t seed, SceneFaults& faults);

}  // namespace lookout::sim
