// Turns of a simulated scene with the truth about each return, on the way that packets of the sensor take.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "common/config/boat.hpp"
#include "services/segmenter/core/segmenter.hpp"
#include "services/vlp16/core/scan.hpp"
#include "services/vlp16/params.hpp"
#include "tools/eval/method.hpp"
#include "tools/sim/scene.hpp"

namespace lookout::eval {

/// The boat that is simulated and scored.
struct Boat {
  std::filesystem::path config_folder;
  config::BoatFacts facts;
  vlp16::Params lidar;
  segmenter::Params segmenter;
};

/// @throws config::ConfigError
Boat LoadBoat(const std::filesystem::path& config_folder);

/// The way of the messages, without a bus: what the segmenter gets of this turn. @throws std::logic_error when it would refuse it
segmenter::Scan ScanOfTurn(const vlp16::Scan& turn, bool use_vertical_origin_offsets);

using ScanHandler = std::function<void(const LabelledScan&)>;

/// Lets the simulated lidar look at a scene, decodes its packets as lookout-vlp16 does, and hands on each whole turn, one at a time. The truth joins
/// its cell exactly: no packet is lost on the way, so that the returns of the packets and those of the columns follow each other one by one.
///
/// @param scene    outlives the call
/// @param seed     of the sensor
/// @param seconds  of firing; the begun turns at both ends are left out
/// Deterministic. Cost: that of the simulation. @throws std::logic_error when a packet was refused or truth and cells do not agree
void RenderScans(const sim::Scene& scene, const Boat& boat, std::uint64_t seed, double seconds, const ScanHandler& on_scan);

}  // namespace lookout::eval
