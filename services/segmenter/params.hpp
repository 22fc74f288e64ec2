// segmenter.txtpb and boat.txtpb as checked parameters.
#pragma once

#include <filesystem>
#include <optional>

#include "services/segmenter/core/segmenter.hpp"

namespace lookout::config {
class Segmenter;
struct BoatFacts;
}  // namespace lookout::config

namespace lookout::segmenter {

/// @param config_folder  the boat's folder
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

/// One for each lidar.
struct Lanes {
  Params first;
  std::optional<Params> second;  // nullopt: the boat has one
};

/// The second is as the first but for its place, and looks all round: field_of_view of the config is of the first. @throws config::ConfigError
Lanes LoadLanes(const std::filesystem::path& config_folder);

/// The same from a message whose fields were checked by the loader, each by itself.
///
/// @param file  where the message came from, for faults of relations between fields
/// @throws config::ConfigError
Params ToParams(const config::Segmenter& message, const config::BoatFacts& boat, const std::filesystem::path& file);

}  // namespace lookout::segmenter
