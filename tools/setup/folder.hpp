// The folder that lookout-setup writes: a new boat takes the place of an old one whole, and only when it is right.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lookout::setup {

/// Files of the folder that a new boat.txtpb takes the place of: an old one, and those whose values stand in it. Others of the folder stay, as
/// lidar_2.txtpb and evidence.
std::vector<std::filesystem::path> ReplacedFiles(const std::filesystem::path& folder);

/// Whether the boat may be written there. @throws std::runtime_error: it replaces files, and `force` is not set; the folder is a file
void CheckPlace(const std::filesystem::path& folder, bool force);

/// Checks boat.txtpb as lookout-doctor --check does, with the files that stay; writes it; keeps what it replaces as FILE.old, or
/// FILE.old.2 and so on.
///
/// @return the kept files
/// @throws config::ConfigError where the boat would be wrong; std::runtime_error as CheckPlace, and where it cannot be written: then the
/// boat is as it was, unless an old file beside a new boat could not be renamed; every process refuses the two together
std::vector<std::filesystem::path> WriteBoat(const std::filesystem::path& folder, const std::string& text, bool force);

/// Doubts that lookout-doctor has about the numbers of a written boat, a line each.
std::string DoubtsOf(const std::filesystem::path& folder);

/// The next steps, and the address of the page, for people.
std::string NextSteps(const std::filesystem::path& folder);

}  // namespace lookout::setup
