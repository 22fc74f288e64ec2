// Checks the argument of --config: the folder of a boat, not one that holds several.
#pragma once

#include <string>

namespace lookout::config {

/// For CLI11's check.
/// @return why the folder is none of a boat, with the boats below it; empty where it is one, or nothing is known of boats
std::string BoatFolderFault(const std::string& folder);

}  // namespace lookout::config
