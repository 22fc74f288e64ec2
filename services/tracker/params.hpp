// Config of the tracker process (boat.txtpb, tracker.txtpb, and ranges and field of view of segmenter.txtpb) as checked values.
#pragma once

#include <chrono>
#include <filesystem>

#include "common/core/cover_watch.hpp"
#include "services/tracker/core/look_out.hpp"
#include "services/tracker/core/tracker.hpp"
#include "services/tracker/core/zone_sight.hpp"

namespace lookout::tracker {

struct Params {
  TrackerParams tracker;
  LookOutParams look_out = {};
  ZoneSightParams zone_sight = {};
  CoverParams cover = {};
  std::chrono::microseconds wait_timeout{500'000};  // live only
};

/// @param config_folder  the boat's folder, holding boat.txtpb, segmenter.txtpb and tracker.txtpb
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::tracker
