// Whether the lidar points where boat.txtpb says, by the standing things around the boat.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/core/angles.hpp"
#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kBumpSubject = "mounting";

// A smaller turn is no bump: a boat is measured to about this. A bump also exceeds this many deviations, the reference's included.
constexpr double kLeastBumpDeg = 1.0;
constexpr double kLeastBumpSds = 4.0;
// An axis counts as not known where only a greater bump than this would be told.
constexpr double kMostToldDeg = 10.0;

struct AxisWords {
  const char* positive;  // turned by the right hand about this axis of the vessel
  const char* negative;
  const char* name;
};
constexpr std::array<AxisWords, 3> kTurnWords{{{"leans {} farther to starboard", "leans {} farther to port", "its lean to a side"},
                                               {"leans {} farther forward", "leans {} farther aft", "its lean forward or aft"},
                                               {"is turned {} farther to port", "is turned {} farther to starboard", "its turn"}}};
constexpr std::size_t kUpAxis = 2;

double LeastToldDeg(const MountingSeen::Axis& axis) {
  return std::max(kLeastBumpDeg, kLeastBumpSds * RadToDeg(std::hypot(axis.sd_rad, axis.reference_sd_rad)));
}

std::string TurnOf(const MountingSeen::Axis& axis, const AxisWords& words) {
  return fmt::format(fmt::runtime(axis.turned_rad < 0.0 ? words.negative : words.positive),
                     fmt::format("{} deg (deviation {})", Fixed(std::abs(RadToDeg(axis.turned_rad)), 1), Fixed(RadToDeg(axis.sd_rad), 2)));
}

}  // namespace

Findings CheckMountingSeen(const Observations& seen) {
  if (!seen.mounting) return {};
  const auto& mounting = *seen.mounting;
  const std::string not_known = "whether the lidar was bumped is not known: ";
  const std::string missing = mounting.missing.empty() ? "" : "; missing: " + Joined(mounting.missing);
  // Who asks, and gets no answer, must see that.
  constexpr const char* kAskAgain = "ask again while the boat turns by 180 deg within 40 m of what stands; --seconds 120 gives more time";
  if (!mounting.not_known.empty()) return {Warning(kBumpSubject, not_known + mounting.not_known + missing, kAskAgain)};
  const auto by = fmt::format("by what stood around the boat for {} s the lidar ", Fixed(mounting.watched_s, 0));
  const std::string cure = "then lookout-calibrate on a recording of turns near what stands";
  if (!mounting.turned_in_words.empty()) {
    return {Warning(kBumpSubject, by + "is not mounted as boat.txtpb says: " + mounting.turned_in_words, "stop and look at its mount; " + cure)};
  }
  std::vector<std::string> all;
  std::vector<std::string> bumped;
  std::vector<std::string> least;
  std::vector<std::string> unknown;
  bool is_heading_named = false;
  bool is_attitude_named = false;
  for (std::size_t i = 0; i < kTurnWords.size(); ++i) {
    const auto& axis = mounting.axes.at(i);
    if (!(LeastToldDeg(axis) <= kMostToldDeg)) {
      unknown.emplace_back(kTurnWords.at(i).name);
      continue;
    }
    all.push_back(TurnOf(axis, kTurnWords.at(i)));
    least.push_back(Fixed(LeastToldDeg(axis), 1));
    if (std::abs(RadToDeg(axis.turned_rad)) < LeastToldDeg(axis)) continue;
    bumped.push_back(all.back());
    (i == kUpAxis ? is_heading_named : is_attitude_named) = true;
  }
  if (all.empty()) return {Warning(kBumpSubject, not_known + "the deviations are too large" + missing, kAskAgain)};
  if (bumped.empty()) {
    const std::string of_others = unknown.empty() ? "" : "; not known: " + Joined(unknown) + missing;
    return {Ok(kBumpSubject, by + "points as boat.txtpb says: it " + Joined(all) + "; a bump is told from " + Joined(least) + " deg on" + of_others)};
  }
  const std::string sensor = is_heading_named && is_attitude_named ? "heading or attitude sensor"
                             : is_heading_named                    ? "heading sensor"
                                                                   : "attitude sensor";
  return {Warning(kBumpSubject, by + Joined(bumped) + " than boat.txtpb says: was it bumped?",
                  "stop and look at its mount, and at the " + sensor + ", whose error looks the same; " + cure)};
}

}  // namespace lookout::doctor
