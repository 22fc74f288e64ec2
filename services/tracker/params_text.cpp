#include "services/tracker/params_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "services/tracker/alert_text.hpp"

namespace lookout::tracker {

namespace {

// A kayak, a swimmer's head and arms, a log.
constexpr double kLowM = 0.5;

// The least distance at which so low a thing is seen, in all bearings of the zone.
ZoneRemark LowThings(const ZoneSightParams& params) {
  const ZoneGrid grid(params, params.expected_elevation_rad, kLowM);
  const double step_m = params.zone.range_m / ZoneGrid::kNumRanges;
  double unseen_m = 0.0;
  for (std::size_t i = 0; i < grid.cells().size(); ++i) {
    const auto& cell = grid.cells()[i];
    if (cell.is_zone && cell.why == Unseen::kHeight) unseen_m = std::max(unseen_m, static_cast<double>(i % ZoneGrid::kNumRanges + 1) * step_m);
  }
  if (unseen_m == 0.0) return {fmt::format("things of {} m above the water are seen in all of the guard zone, with the boat level", kLowM), {}};
  if (unseen_m < params.zone.range_m - 1e-9) {
    return {fmt::format("in the guard zone things of {} m above the water are seen from {:.1f} m on, with the boat level: nearer they are below the "
                        "lowest beam",
                        kLowM, unseen_m),
            {}};
  }
  return {fmt::format("in some bearings of the guard zone of {:.1f} m nothing as low as {} m above the water is seen: it is not within the beams",
                      params.zone.range_m, kLowM),
          "height and angles of lidar in boat.txtpb; a lidar that is mounted lower, or a larger range_m of guard_zone in tracker.txtpb"};
}

}  // namespace

std::vector<ZoneRemark> RemarksOnZone(const Params& params) {
  const auto& zone_sight = params.zone_sight;
  if (zone_sight.zone.range_m <= 0.0) {
    return {{"there is no guard zone: what lies near raises no alert, a closest approach alone does",
             "guard_zone in tracker.txtpb, or in tracker of boat.txtpb"}};
  }
  if (zone_sight.expected_elevation_rad.empty()) return {};
  const ZoneGrid grid(zone_sight, zone_sight.expected_elevation_rad, ZoneSight::kPostM);
  auto parts = grid.PartsByConfig();
  std::erase_if(parts, [](const UnseenPart& part) { return !part.is_wide; });
  if (!parts.empty()) {
    const bool is_whole = std::ranges::none_of(grid.cells(), [](const ZoneGrid::Cell& cell) { return cell.is_zone && cell.why == Unseen::kNo; });
    return {{TextOf(parts, is_whole),
             "guard_zone in tracker.txtpb; min_range_m, max_range_m and field_of_view in segmenter.txtpb; lidar, own_vessel and hull in boat.txtpb"}};
  }
  return {
      {fmt::format("by the config the lidar can look into all of the guard zone of {:.1f} m; what the lidar itself is set to, and what stands before "
                   "it, its scans tell",
                   zone_sight.zone.range_m),
       {}},
      LowThings(zone_sight)};
}

std::string ZoneRemarksAsComments(const Params& params) {
  std::string text;
  for (const auto& remark : RemarksOnZone(params)) {
    text += "# tracker.txtpb: " + std::string(remark.cure.empty() ? "" : "warning: ") + remark.words +
            (remark.cure.empty() ? "" : "; look at " + remark.cure) + "\n";
  }
  return text;
}

}  // namespace lookout::tracker
