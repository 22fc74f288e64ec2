// Config of the tracker process (boat.txtpb, tracker.txtpb, and ranges and field of view of segmenter.txtpb) as checked values.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>

#include "services/tracker/core/look_out.hpp"
#include "services/tracker/core/own_map.hpp"
#include "services/tracker/core/tracker.hpp"
#include "services/tracker/core/zone_sight.hpp"

namespace lookout::tracker {

struct Params {
  TrackerParams tracker;
  LookOutParams look_out = {};
  ZoneSightParams zone_sight = {};
  std::chrono::microseconds wait_timeout{500'000};  // live only
  std::shared_ptr<const OwnMap> map = {};           // what the file of `map` holds; nullptr: none is named, or it was not to be read
};

/// Whether the file of `map` is read. A replay takes what the log says was given.
enum class MapFile { kRead, kLeave };

/// @param config_folder  the boat's folder, holding boat.txtpb, segmenter.txtpb and tracker.txtpb
/// @throws config::ConfigError, also of a map that cannot be used
Params LoadParams(const std::filesystem::path& config_folder, MapFile map_file = MapFile::kRead);

}  // namespace lookout::tracker
