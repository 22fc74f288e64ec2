// Scans of a simulated scene with the truth about each return, on the way that packets of the sensor take.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "common/config/boat.hpp"
#include "lab/eval/methods/method.hpp"
#include "lab/sim/scene.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/lidar/core/driver/scan.hpp"
#include "services/lidar/params.hpp"
#include "services/segmenter/core/segmenter.hpp"

namespace lookout::eval {

/// The boat that is simulated and scored.
struct Boat {
  std::filesystem::path config_folder;
  config::BoatFacts facts;
  lidar::Params lidar;
  segmenter::Params segmenter;
};

/// @throws config::ConfigError
Boat LoadBoat(const std::filesystem::path& config_folder);

/// The segmenter's scan out of its parts; nullopt when it refuses one, or one is missing
std::optional<segmenter::Scan> ScanOfMessages(const std::vector<lidar_scan_t>& parts);

/// The scan as the segmenter receives it over messages, without a bus. @throws std::logic_error when it would refuse it
segmenter::Scan ToSegmenterScan(const lidar::Scan& scan);

using ScanHandler = std::function<void(const LabelledScan&)>;

/// Lets the simulated lidar look at a scene, decodes its packets as lookout-lidar does, and hands on each whole scan, one at a time. The truth joins
/// its cell exactly: no packet is lost on the way, so that the returns of the packets and those of the columns follow each other one by one.
///
/// Scans of a head whose packets are not made (Scene::lidar) come as LIDAR_SCAN would bring them.
///
/// @param scene    outlives the call
/// @param seed     of the sensor
/// @param seconds  of firing; the begun scans at both ends are left out
/// Deterministic. Cost: that of the simulation. @throws std::logic_error when a packet was refused or truth and cells do not agree
void RenderScans(const sim::Scene& scene, const Boat& boat, std::uint64_t seed, double seconds, const ScanHandler& on_scan);

}  // namespace lookout::eval
