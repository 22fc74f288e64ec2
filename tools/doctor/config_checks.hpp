// The check of each service's config.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace lookout::doctor {

struct ConfigCheck {
  std::string_view service;
  /// @throws config::ConfigError
  void (*load)(const std::filesystem::path& config_folder);
};

/// LoadParams of each service's params.hpp, in the order of the service table, out of which CMake makes this list.
const std::vector<ConfigCheck>& ConfigChecks();

}  // namespace lookout::doctor
