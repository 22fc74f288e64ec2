// Config of the tracker process (boat.txtpb, tracker.txtpb, and the range of segmenter.txtpb) as checked values.
#pragma once

#include <chrono>
#include <filesystem>

#include "common/core/guard_sector.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/tracker.hpp"

namespace lookout::tracker {

struct Params {
  TrackerParams tracker;
  AlertParams alerts;
  GuardZoneParams guard_zone = {};
  std::chrono::microseconds wait_timeout{500'000};  // live only
};

/// @param config_folder  the boat's folder, holding boat.txtpb, segmenter.txtpb and tracker.txtpb
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::tracker
