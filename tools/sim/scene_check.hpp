// What the schema's own options cannot say about a scene file.
#pragma once

#include <string>

#include "config/schema/scene.pb.h"
#include "tools/sim/fleet.hpp"
#include "tools/sim/scene_faults.hpp"

namespace lookout::sim {

/// @return in lower case, as in objects' kinds
std::string NameOf(config::Scene::Kind kind);

/// @return nullptr for shores and islands
const KindOfObject* FindKind(config::Scene::Kind kind);

/// Ranges the right way round, fields that suit the kind, ways that can be gone, names that can be written to a table.
void CheckScene(const config::Scene& scene, SceneFaults& faults);

}  // namespace lookout::sim
