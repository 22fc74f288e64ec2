// A boat is one file: boat.txtpb may hold the values of each process as a section, in place of the file beside it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lookout::config {

/// The section of boat.txtpb that stands in place of this file: "lidar_input" for "lidar.txtpb", "tracker" for "tracker.txtpb"; empty: there is none.
std::string SectionOf(const std::string& file_name);

/// Where the values of a file of a boat's folder stand, for people: "tracker.txtpb", or "tracker in boat.txtpb" where that has this section.
std::string PlaceInWords(const std::filesystem::path& folder, const std::string& file_name);

/// Whether neither the file nor its section is there: the defaults hold. Never of a file without a section.
bool IsAbsent(const std::filesystem::path& folder, const std::string& file_name);

/// Names of the files whose values are in force in a boat's folder, in their order: those that are there (*.txtpb), and those that have a section.
std::vector<std::string> FilesInForce(const std::filesystem::path& folder);

/// Values and defaults in force of a file of the folder, wherever they stand; of boat.txtpb without its sections. @throws ConfigError
std::string EffectiveTextOf(const std::filesystem::path& folder, const std::string& file_name);

/// The text that holds the values of a file.
struct ValuesText {
  std::filesystem::path file;  // where the values stand: the file itself, or boat.txtpb
  std::string text;            // of a section: all else is blank, so that lines count as in the file
  std::string prefix = {};     // of the names of its fields: "tracker."
  int first_line = 1;
};

/// @throws ConfigError when a file that must be there cannot be read
ValuesText FindValues(const std::filesystem::path& file);

/// "path:1: file: there is no config/schema/x.proto".
std::string NoSchemaFault(const std::filesystem::path& file);

}  // namespace lookout::config
