// The running program, its values and its computer: RUN_INFO, and --check.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lookout/run_info_t.hpp"

namespace lookout::runtime {

/// @return RUN_INFO without time and number: version, host, schema, the effective text of every file in force (config::FilesInForce) by name,
///         "machine.txt" (MachineText), and the texts of the wire types ("lcmtypes/x_t.lcm")
/// @throws config::ConfigError
run_info_t MakeRunInfo(const std::string& program, const std::filesystem::path& config_folder);

/// The output of --check: the values in force of these files of the folder (empty = of all), each under its name, wherever they stand.
std::string EffectiveConfig(const std::filesystem::path& config_folder, std::vector<std::string> file_names = {});

/// Facts of the computer, for RUN_INFO. Lines "name: value": architecture, kernel, processor, its features by which C libraries choose variants of
/// their functions, C library, GLIBC_TUNABLES, compiler. A value that cannot be read is "unknown".
std::string MachineText();

/// The lines of MachineText that tell of the processor, by the text of /proc/cpuinfo.
///
/// @param cpuinfo  of x86 ("model name", "flags") or arm ("CPU part", "Features"); the first processor counts
std::string ProcessorText(const std::string& cpuinfo);

}  // namespace lookout::runtime
