#include "tools/sim/scene_faults.hpp"

#include <sstream>
#include <utility>

#include "common/config/text_config.hpp"
#include "config/schema/scene.pb.h"

namespace lookout::sim {

SceneFaults::SceneFaults(const std::string& text, std::string name) : name_(std::move(name)) {
  config::Scene scene;
  google::protobuf::TextFormat::Parser parser;
  parser.WriteLocationsTo(&positions_);
  parser.ParseFromString(text, &scene);
}

void SceneFaults::Add(const std::string& field, const std::string& reason) {
  faults_.push_back(name_ + ":" + std::to_string(LineOf(field)) + ": " + field + ": " + reason);
}

void SceneFaults::ThrowIfAny() const {
  if (!faults_.empty()) throw config::ConfigError(faults_);
}

int SceneFaults::LineOf(const std::string& field) const {
  const auto* tree = &positions_;
  const auto* message = config::Scene::descriptor();
  int line = 0;
  std::istringstream parts(field);
  for (std::string part; tree != nullptr && message != nullptr && std::getline(parts, part, '.');) {
    const std::size_t bracket = part.find('[');
    const auto* descriptor = message->FindFieldByName(part.substr(0, bracket));
    if (descriptor == nullptr) break;
    int index = descriptor->is_repeated() ? 0 : -1;
    if (bracket != std::string::npos) index = std::stoi(part.substr(bracket + 1));
    const int found = tree->GetLocation(descriptor, index).line;
    if (found < 0) break;
    line = found;
    message = descriptor->message_type();
    tree = message == nullptr ? nullptr : tree->GetTreeForNested(descriptor, index);
  }
  return line + 1;
}

}  // namespace lookout::sim
