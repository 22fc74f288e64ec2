// What is wrong with a scene file, each with its line.
#pragma once

#include <google/protobuf/text_format.h>
#include <string>
#include <vector>

namespace lookout::sim {

class SceneFaults {
 public:
  /// @param text  a scene that parses (config::ParseText has taken it)
  /// @param name  stands for the file in faults
  SceneFaults(const std::string& text, std::string name);

  /// @param field  its path in the schema, such as "object[2].path.speed_mps"; the line is that of the last part of it that the file has
  void Add(const std::string& field, const std::string& reason);

  /// @throws config::ConfigError when there are any
  void ThrowIfAny() const;

 private:
  int LineOf(const std::string& field) const;

  google::protobuf::TextFormat::ParseInfoTree positions_;
  std::string name_;
  std::vector<std::string> faults_;
};

}  // namespace lookout::sim
