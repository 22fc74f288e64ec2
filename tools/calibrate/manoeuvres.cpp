#include "tools/calibrate/manoeuvres.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/angles.hpp"

namespace lookout::calibrate {

namespace {

constexpr double kTrackStepS = 0.5;
constexpr double kLeastInSight = 0.3;
constexpr double kLeastWayM = 30.0;

}  // namespace

Manoeuvres ManoeuvresOf(const Recording& recording, const std::vector<odometer::Motion>& motions) {
  Manoeuvres manoeuvres;
  if (recording.scans.empty()) return manoeuvres;
  const Utime first = recording.scans.front().time;
  manoeuvres.seconds = ToSeconds(recording.scans.back().end_time - first);
  std::optional<TrackPose> before;
  double bearing_rad = 0.0;
  double least_rad = 0.0;
  double most_rad = 0.0;
  std::vector<double> rates_radps;
  for (double at_s = 0.0; at_s <= manoeuvres.seconds; at_s += kTrackStepS) {
    auto pose = recording.track.At(first, at_s);
    if (pose && before) {
      const double turn_rad = WrapToPi(HeadingOf(pose->T_map_vessel) - HeadingOf(before->T_map_vessel));
      bearing_rad += turn_rad;
      least_rad = std::min(least_rad, bearing_rad);
      most_rad = std::max(most_rad, bearing_rad);
      rates_radps.push_back(turn_rad / kTrackStepS);
      manoeuvres.way_m += (pose->T_map_vessel.translation() - before->T_map_vessel.translation()).head<2>().norm();
    }
    before = pose;
  }
  manoeuvres.turned_rad = most_rad - least_rad;
  double mean_radps = 0.0;
  for (const double rate : rates_radps) mean_radps += rate / static_cast<double>(rates_radps.size());
  double variance = 0.0;
  for (const double rate : rates_radps) variance += (rate - mean_radps) * (rate - mean_radps) / static_cast<double>(rates_radps.size());
  manoeuvres.turn_changes_radps = std::sqrt(variance);
  const auto num_known = std::ranges::count_if(motions, &odometer::Motion::is_known);
  if (!motions.empty()) manoeuvres.share_in_sight = static_cast<double>(num_known) / static_cast<double>(motions.size());
  return manoeuvres;
}

std::vector<std::string> MissingMotions(const Calibration& calibration) {
  std::vector<std::string> missing;
  const auto& done = calibration.manoeuvres;
  const bool is_yaw_found = calibration.has_fit && calibration.yaw.is_found;
  const bool is_tilt_found = calibration.has_fit && calibration.roll.is_found && calibration.pitch.is_found;
  const bool is_latency_found = calibration.has_fit && calibration.latency.is_found;
  if (done.share_in_sight < kLeastInSight && !(is_yaw_found && is_tilt_found)) {
    missing.emplace_back("go near what stands: a quay, a shore with trees, moored boats, within 40 m on at least two sides");
  }
  if (!is_tilt_found || !is_yaw_found || done.turned_rad < kLeastTurnRad) {
    if (done.turned_rad < kLeastTurnRad) missing.emplace_back("turn twice by 90 degrees near a quay or a shore, better a full round");
    if (done.way_m < kLeastWayM) missing.emplace_back("go 50 m past what stands, there and back");
    if (done.turned_rad >= kLeastTurnRad && done.way_m >= kLeastWayM)
      missing.emplace_back("the same for longer, two rounds within 40 m of what stands");
  }
  if (!is_latency_found) missing.emplace_back("swing the bow 20 degrees to either side, three times, within 40 m of what stands");
  return missing;
}

}  // namespace lookout::calibrate
