// From the text of a scene file and a seed to a scene: faults with their lines, drawing.
#pragma once

#include <cstdint>
#include <google/protobuf/text_format.h>
#include <string>
#include <vector>

#include "config/schema/scene.pb.h"
#include "lab/sim/fleet.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

/// Faults of a scene file, each with its line.
class SceneFaults {
 public:
  /// @param text  a scene that config::ParseText accepts
  /// @param name  stands for the file in faults
  SceneFaults(const std::string& text, std::string name);

  /// @param field  its path in the schema, such as "object[2].path.speed_mps"; the line is that of the longest part of this path that the file has
  void Add(const std::string& field, const std::string& reason);

  /// @throws config::ConfigError when there are any
  void ThrowIfAny() const;

 private:
  int LineOf(const std::string& field) const;

  google::protobuf::TextFormat::ParseInfoTree positions_;
  std::string name_;
  std::vector<std::string> faults_;
};

/// @return in lower case, as in objects' kinds
std::string NameOf(config::Scene::Kind kind);

/// @return nullptr for shores and islands
const KindOfObject* FindKind(config::Scene::Kind kind);

/// @param scene   as ParseScene checks it
/// @param faults  gets what the drawing finds: no place for an object, a name twice, an object in the way of the own boat
/// @throws config::ConfigError with `faults`
Scene DrawScene(const config::Scene& scene, std::uint64_t seed, SceneFaults& faults);

}  // namespace lookout::sim
