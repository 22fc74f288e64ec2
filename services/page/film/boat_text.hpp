// The own boat as a page draws it: `boat` of a source (PROTOCOL.md).
#pragma once

#include <filesystem>
#include <string>

namespace lookout {
class run_info_t;
}

namespace lookout::config {
class Boat;
class Tracker;
}  // namespace lookout::config

namespace lookout::page {

/// @return JSON text
std::string BoatText(const config::Boat& boat, const config::Tracker& tracker);

/// Of boat.txtpb and tracker.txtpb in a folder; "null" without boat.txtpb.
/// @param fault why guard zones and the limit of the closest approach are those of no tracker.txtpb; empty: they are its own
/// @throws config::ConfigError where boat.txtpb is wrong
std::string BoatTextOfFolder(const std::filesystem::path& folder, std::string& fault);

/// Of the texts in RUN_INFO; "null" where one is missing or was written for another schema.
std::string BoatTextOf(const run_info_t& info);

}  // namespace lookout::page
