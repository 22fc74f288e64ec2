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

/// BoatText of boat.txtpb and tracker.txtpb in a folder; "null" without boat.txtpb.
/// @param fault why guard zones and the limit of the closest approach could not be read from tracker.txtpb; empty: they were
/// @throws config::ConfigError where boat.txtpb is wrong
std::string BoatTextOfFolder(const std::filesystem::path& folder, std::string& fault);

/// BoatText of the config texts in RUN_INFO; "null" where a text is missing or was written for another schema.
std::string BoatTextOf(const run_info_t& info);

}  // namespace lookout::page
