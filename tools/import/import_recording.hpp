// ROS bags, recordings of rosbag2 and MCAP files into a log.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "tools/import/recording.hpp"
#include "tools/import/topic_map.hpp"
#include "tools/log/log_output.hpp"

namespace lookout::importer {

struct RecordingRequest {
  std::filesystem::path config_folder;
  std::vector<std::filesystem::path> files;  // files of one recording, in their order
  std::optional<std::filesystem::path> topic_map_file;
  std::optional<std::filesystem::path> truth_folder = std::nullopt;
  std::optional<std::filesystem::path> label_map_file = std::nullopt;
  bool force = false;
};

/// Topics of all files together. Where a file has no index, all of it is read.
/// @throws std::runtime_error when a file is none of these
Topics TopicsOf(const std::vector<std::filesystem::path>& files);

/// Reads the recording and writes the log; what is used, lost and lacking is told on `notes`.
///
/// @return whether the recording was read without loss
/// @throws config::ConfigError of the config or the topic map; std::runtime_error when nothing in it can be used
bool ImportRecording(const RecordingRequest& request, log::LogOutput& output, std::ostream& notes);

}  // namespace lookout::importer
