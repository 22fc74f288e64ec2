// What runs, with which values: RUN_INFO, and --check.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lookout/run_info_t.hpp"

namespace lookout::runtime {

/// @return RUN_INFO without time and number: version, host, schema, the effective text of every *.txtpb in the folder, by name, "machine.txt"
///         (MachineText), and the texts of the wire types ("lcmtypes/x_t.lcm")
/// @throws config::ConfigError
run_info_t MakeRunInfo(const std::string& program, const std::filesystem::path& config_folder);

/// What --check prints: the values in force of these files of the folder, each under its name.
std::string EffectiveConfig(const std::filesystem::path& config_folder, const std::vector<std::string>& file_names);

/// The same of every *.txtpb in the folder.
std::string EffectiveConfig(const std::filesystem::path& config_folder);

}  // namespace lookout::runtime
