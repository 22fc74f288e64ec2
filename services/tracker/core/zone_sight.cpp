#include "services/tracker/core/zone_sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "common/core/cover_watch.hpp"
#include "common/core/elementary.hpp"
#include "common/core/frames.hpp"
#include "common/core/own_vessel.hpp"

namespace lookout::tracker {

namespace {

constexpr double kBearingStepRad = DegToRad(1.0);
constexpr std::size_t kNumAzimuths = 360;
constexpr double kHeightStepM = 0.25;
constexpr double kHullMarginM = 1.0;  // as of RemarksOnBoat: fenders, an engine, a bowsprit
// A gap that is interrupted for so many bearings is one.
constexpr std::size_t kMostBetween = 1;
// A column looks half way to the next, so that a scan of few columns leaves no degree out; a larger distance is a gap.
constexpr double kMostApartDeg = 1.5;
// Below the id of every track, of land and of things without a name.

Eigen::Vector2d DirectionOf(double bearing_rad) {
  const auto [sine, cosine] = SinCosOf(bearing_rad);
  return {cosine, -sine};
}

// Half of the greater distance to the rings beside it; of a ring by itself a degree.
double HalfGapOf(std::span<const float> elevation_rad, std::size_t ring) {
  double gap_rad = 0.0;
  if (ring > 0) gap_rad = static_cast<double>(elevation_rad[ring]) - static_cast<double>(elevation_rad[ring - 1]);
  if (ring + 1 < elevation_rad.size()) {
    gap_rad = std::max(gap_rad, static_cast<double>(elevation_rad[ring + 1]) - static_cast<double>(elevation_rad[ring]));
  }
  return gap_rad > 0.0 ? gap_rad / 2.0 : DegToRad(1.0);
}

bool IsInside(const Eigen::AlignedBox3d& box_m, const Eigen::Vector2d& place_m) {
  return !box_m.isEmpty() && (place_m.array() >= box_m.min().head<2>().array()).all() && (place_m.array() <= box_m.max().head<2>().array()).all();
}

// A place in the vessel frame, as the lidar sees it.
struct Seat {
  double azimuth_rad;
  double elevation_rad;
  double range_m;
};
Seat SeatOf(const Eigen::Isometry3d& T_lidar_vessel, const Eigen::Vector3d& p_vessel_m) {
  const Eigen::Vector3d p_lidar_m = T_lidar_vessel * p_vessel_m;
  const double flat_m = Hypot(p_lidar_m.x(), p_lidar_m.y());
  return {WrapTo2Pi(Atan2(-p_lidar_m.y(), p_lidar_m.x())), Atan2(p_lidar_m.z(), flat_m), Hypot(flat_m, p_lidar_m.z())};
}

std::size_t AzimuthIndex(double azimuth_rad) { return static_cast<std::size_t>(RadToDeg(WrapTo2Pi(azimuth_rad))) % kNumAzimuths; }

}  // namespace

// The rings, seen from the vessel.
struct ZoneGrid::Beams {
  Eigen::Isometry3d T_lidar_vessel;
  std::span<const float> elevation_rad;
  std::vector<double> half_gap_rad;
};

ZoneGrid::ZoneGrid(const ZoneSightParams& params, std::span<const float> elevation_rad, double top_m)
    : range_step_m_(params.zone.range_m / kNumRanges), bearing_(params.zone.bearing) {
  const double width_rad = std::min(bearing_.width_rad, kTwoPi);
  num_bearings_ = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(width_rad / kBearingStepRad)));
  bearing_step_rad_ = width_rad / static_cast<double>(num_bearings_);
  Beams beams{params.T_vessel_lidar.inverse(), elevation_rad, {}};
  for (std::size_t ring = 0; ring < elevation_rad.size(); ++ring) beams.half_gap_rad.push_back(HalfGapOf(elevation_rad, ring));
  cells_.reserve(num_bearings_ * kNumRanges);
  for (std::size_t i = 0; i < num_bearings_; ++i) {
    const Eigen::Vector2d direction = DirectionOf(bearing_.start_rad + (static_cast<double>(i) + 0.5) * bearing_step_rad_);
    for (std::size_t k = 0; k < kNumRanges; ++k) {
      AddCell(params, beams, (static_cast<double>(k) + 0.5) * range_step_m_ * direction, top_m);
    }
  }
}

void ZoneGrid::AddCell(const ZoneSightParams& params, const Beams& beams, const Eigen::Vector2d& place_m, double top_m) {
  Cell& cell = cells_.emplace_back();
  cell.first_way = static_cast<std::uint32_t>(ways_.size());
  const double from_hull_m = params.own_hull_m.isEmpty() ? std::numeric_limits<double>::infinity() : params.own_hull_m.exteriorDistance(place_m);
  cell.is_zone = !(IsInside(params.own_vessel_box_m, place_m) && from_hull_m <= kHullMarginM);
  if (!cell.is_zone) return;

  cell.why = Unseen::kHeight;
  const auto seat_at = [&](double above_water_m) {
    return SeatOf(beams.T_lidar_vessel, {place_m.x(), place_m.y(), above_water_m - params.reference_point_above_water_m});
  };
  const int num_steps = static_cast<int>(std::ceil(top_m / kHeightStepM));
  Seat low = seat_at(0.0);
  for (int step = 0; step < num_steps; ++step) {
    const double low_m = top_m * step / num_steps;
    const Seat high = seat_at(top_m * (step + 1) / num_steps);
    for (std::size_t ring = 0; ring < beams.elevation_rad.size(); ++ring) {
      const double half_gap_rad = beams.half_gap_rad[ring];
      const double ring_rad = beams.elevation_rad[ring];
      if (ring_rad < std::min(low.elevation_rad, high.elevation_rad) - half_gap_rad) continue;
      if (ring_rad > std::max(low.elevation_rad, high.elevation_rad) + half_gap_rad) continue;
      const double span_rad = high.elevation_rad - low.elevation_rad;
      const double share = std::abs(span_rad) > 1e-9 ? std::clamp((ring_rad - low.elevation_rad) / span_rad, 0.0, 1.0) : 0.0;
      Candidate candidate;
      candidate.ring = ring;
      candidate.azimuth_rad = WrapTo2Pi(low.azimuth_rad + share * WrapToPi(high.azimuth_rad - low.azimuth_rad));
      candidate.range_m = low.range_m + share * (high.range_m - low.range_m);
      candidate.p_vessel_m << place_m, low_m + share * top_m / num_steps - params.reference_point_above_water_m;
      const auto why = WhyNot(params, candidate);
      if (why != Unseen::kNo) {
        if (cell.num_ways == 0) cell.why = std::max(cell.why, why);
        continue;
      }
      cell.why = Unseen::kNo;
      const Way way{static_cast<std::uint16_t>(ring), static_cast<std::uint16_t>(AzimuthIndex(candidate.azimuth_rad)),
                    static_cast<float>(candidate.range_m)};
      const auto known = WaysOf(cell);
      if (std::ranges::any_of(known, [&way](const Way& one) { return one.ring == way.ring && one.azimuth == way.azimuth; })) continue;
      ways_.push_back(way);
      ++cell.num_ways;
    }
    low = high;
  }
}

Unseen ZoneGrid::WhyNot(const ZoneSightParams& params, const Candidate& candidate) const {
  if (candidate.range_m < params.min_range_m) return Unseen::kNearerThanMin;
  if (candidate.range_m > params.max_range_m) return Unseen::kBeyondMax;
  if (!params.field_of_view.Contains(candidate.azimuth_rad)) return Unseen::kFieldOfView;
  if (!params.own_vessel_box_m.isEmpty() && params.own_vessel_box_m.contains(candidate.p_vessel_m)) return Unseen::kOwnBox;
  return Unseen::kNo;
}

// Cells of one bearing, from the first to the last that is not seen for one reason.
struct ZoneGrid::Run {
  std::size_t first = 0;
  std::size_t last = 0;
  bool begins = true;  // nothing nearer is seen
  bool ends = true;    // nothing farther is seen
};

std::optional<ZoneGrid::Run> ZoneGrid::RunOf(std::size_t bearing, Unseen reason, std::span<const Unseen> why) const {
  std::optional<Run> run;
  const std::size_t first_cell = bearing * kNumRanges;
  for (std::size_t k = 0; k < kNumRanges; ++k) {
    if (!cells_[first_cell + k].is_zone || why[first_cell + k] != reason) continue;
    if (!run) run = Run{.first = k};
    run->last = k;
  }
  if (!run) return run;
  bool is_last = true;
  for (std::size_t k = 0; k < kNumRanges; ++k) {
    if (!cells_[first_cell + k].is_zone) continue;
    if (k > run->last) is_last = false;
    if (why[first_cell + k] != Unseen::kNo) continue;
    if (k < run->first) run->begins = false;
    if (k > run->last) run->ends = false;
  }
  // Water below the lowest beam, or below those that pass over the own deck, was seen before it came so near, or is unseen for another reason.
  if ((reason == Unseen::kHeight && !is_last) || (reason == Unseen::kHidden && !run->ends)) return std::nullopt;
  const double depth_m = static_cast<double>(run->last - run->first + 1) * range_step_m_;
  if ((!run->begins || !run->ends) && depth_m < ZoneSight::kLeastDepthM) return std::nullopt;
  return run;
}

UnseenPart ZoneGrid::ToPart(Unseen reason, std::size_t first, std::size_t count, std::span<const std::optional<Run>> runs) const {
  UnseenPart part;
  part.why = reason;
  part.bearing.start_rad = WrapTo2Pi(bearing_.start_rad + static_cast<double>(first) * bearing_step_rad_);
  part.bearing.width_rad = static_cast<double>(count) * bearing_step_rad_;
  std::size_t nearest = kNumRanges;
  std::size_t farthest = 0;
  // Of most bearings: where the lidar is not at the reference point, a few at the sides differ.
  std::size_t num_begin = 0;
  std::size_t num_end = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& run = runs[(first + i) % num_bearings_];
    if (!run) continue;
    nearest = std::min(nearest, run->first);
    farthest = std::max(farthest, run->last);
    num_begin += run->begins ? 1 : 0;
    num_end += run->ends ? 1 : 0;
  }
  part.begins_with_zone = 2 * num_begin >= count;
  part.ends_with_zone = 2 * num_end >= count;
  part.from_m = static_cast<double>(nearest) * range_step_m_;
  part.to_m = static_cast<double>(farthest + 1) * range_step_m_;
  const bool is_wide = part.bearing.width_rad >= ZoneSight::kLeastWidthRad - 1e-9 && part.bearing.width_rad * part.to_m >= ZoneSight::kLeastWidthM;
  part.is_wide = is_wide || count == num_bearings_;
  return part;
}

void ZoneGrid::AddParts(Unseen reason, std::span<const Unseen> why, std::vector<UnseenPart>& parts) const {
  std::vector<std::optional<Run>> runs;
  for (std::size_t i = 0; i < num_bearings_; ++i) runs.push_back(RunOf(i, reason, why));
  const bool is_circle = bearing_.width_rad >= kTwoPi;
  // On a circle a part may lie across the seam: it begins behind a stretch of bearings that are no part.
  std::size_t start = 0;
  if (is_circle) {
    const auto is_free_before = [&](std::size_t i) {
      for (std::size_t k = 1; k <= kMostBetween + 1; ++k) {
        if (runs[(i + num_bearings_ - k) % num_bearings_]) return false;
      }
      return runs[i].has_value();
    };
    while (start < num_bearings_ && !is_free_before(start)) ++start;
    if (start == num_bearings_) {
      if (std::ranges::any_of(runs, [](const auto& run) { return run.has_value(); })) parts.push_back(ToPart(reason, 0, num_bearings_, runs));
      return;
    }
  }
  std::size_t first = 0;
  std::size_t count = 0;  // up to the last bearing that has a run
  for (std::size_t i = 0; i < num_bearings_; ++i) {
    if (!runs[(start + i) % num_bearings_]) continue;
    if (count > 0 && i - (first + count) > kMostBetween) {
      parts.push_back(ToPart(reason, (start + first) % num_bearings_, count, runs));
      count = 0;
    }
    if (count == 0) first = i;
    count = i - first + 1;
  }
  if (count > 0) parts.push_back(ToPart(reason, (start + first) % num_bearings_, count, runs));
}

std::vector<UnseenPart> ZoneGrid::PartsOf(std::span<const Unseen> why) const {
  std::vector<UnseenPart> parts;
  for (const auto reason :
       {Unseen::kHeight, Unseen::kNearerThanMin, Unseen::kBeyondMax, Unseen::kFieldOfView, Unseen::kOwnBox, Unseen::kNoBeams, Unseen::kHidden}) {
    if (std::ranges::find(why, reason) != why.end()) AddParts(reason, why, parts);
  }
  std::ranges::stable_sort(parts, std::ranges::greater(),
                           [](const UnseenPart& part) { return part.bearing.width_rad * (part.to_m * part.to_m - part.from_m * part.from_m); });
  return parts;
}

std::vector<UnseenPart> ZoneGrid::PartsByConfig() const {
  std::vector<Unseen> why;
  for (const auto& cell : cells_) why.push_back(cell.is_zone ? cell.why : Unseen::kNo);
  return PartsOf(why);
}

void ZoneSight::Update(Utime time, const Sweep& sweep) {
  if (params_.zone.range_m <= 0.0 || sweep.elevation_rad.empty() || sweep.azimuth_rad.empty()) return;
  if (!grid_ || elevation_rad_ != sweep.elevation_rad) {
    elevation_rad_ = sweep.elevation_rad;
    grid_.emplace(params_, elevation_rad_, kPostM);
    share_.resize(grid_->cells().size(), 1.0);
    why_.resize(grid_->cells().size(), Unseen::kNo);
    told_.resize(grid_->num_bearings());
  }
  Trace(sweep);
  // While no scan came nobody knows where it would have looked; the watch says so.
  constexpr double kLongestStepS = 0.5;
  const double step_s = newest_ ? std::clamp(ToSeconds(time - *newest_), 0.0, kLongestStepS) : 0.0;
  newest_ = time;
  Advance(step_s / kTimeConstantS);
  Tell();
}

void ZoneSight::SetZone(const GuardZoneParams& zone) {
  auto& known = params_.zone;
  if (zone.range_m == known.range_m && zone.bearing.start_rad == known.bearing.start_rad && zone.bearing.width_rad == known.bearing.width_rad) return;
  known = zone;
  grid_.reset();
  share_.clear();
  why_.clear();
  told_.clear();
  wide_.clear();
  is_whole_ = false;
  unseen_deg_ = 0;
}

void ZoneSight::Trace(const Sweep& sweep) {
  constexpr float kFree = std::numeric_limits<float>::infinity();
  const std::size_t num_rings = sweep.elevation_rad.size();
  reach_m_.assign(kNumAzimuths * num_rings, -1.0F);
  const auto see = [this, num_rings](std::int64_t azimuth_deg, std::size_t ring, float range_m) {
    const auto wrapped = static_cast<std::size_t>((azimuth_deg + 2 * std::int64_t{kNumAzimuths}) % std::int64_t{kNumAzimuths});
    auto& reach_m = reach_m_[wrapped * num_rings + ring];
    reach_m = std::max(reach_m, range_m);
  };
  const OwnVessel own_vessel(params_.own_vessel_box_m, params_.T_vessel_lidar);
  const auto is_own = [&](std::size_t column, std::size_t ring, double range_m) {
    if (range_m < params_.min_range_m || range_m <= CoverWatch::kAtLidarM) return true;
    if (!own_vessel.ReachesTo(range_m)) return false;
    const double azimuth_rad = static_cast<double>(sweep.azimuth_rad[column]) + static_cast<double>(sweep.azimuth_offset_rad[ring]);
    return own_vessel.Contains(range_m * BeamDirection(azimuth_rad, sweep.elevation_rad[ring]));
  };
  constexpr double kDegreesOfRad = 180.0 / kPi;
  const std::size_t num_columns = sweep.azimuth_rad.size();
  const auto column_rad = [&sweep, num_columns](std::size_t column) { return static_cast<double>(sweep.azimuth_rad[column % num_columns]); };
  const auto apart_deg = [&](std::size_t one, std::size_t other) { return kDegreesOfRad * std::abs(WrapToPi(column_rad(other) - column_rad(one))); };
  for (std::size_t column = 0; column < num_columns; ++column) {
    const double beside_deg = 0.5 * std::min({apart_deg(column, column + 1), apart_deg(column + num_columns - 1, column), kMostApartDeg});
    for (std::size_t ring = 0; ring < num_rings; ++ring) {
      const double range_m = sweep.range_m[column * num_rings + ring];
      const bool is_stopped = range_m > 0.0 && is_own(column, ring, range_m);
      const float reach_m = is_stopped ? static_cast<float>(range_m) : kFree;
      const double azimuth_deg = kDegreesOfRad * (column_rad(column) + static_cast<double>(sweep.azimuth_offset_rad[ring]));
      const double whole_deg = std::floor(azimuth_deg);
      const auto index = static_cast<std::int64_t>(whole_deg);
      see(index, ring, reach_m);
      if (azimuth_deg - whole_deg < beside_deg) see(index - 1, ring, reach_m);
      if (azimuth_deg - whole_deg > 1.0 - beside_deg) see(index + 1, ring, reach_m);
    }
  }
}

void ZoneSight::Advance(double weight) {
  const std::size_t num_rings = elevation_rad_.size();
  const auto& cells = grid_->cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i].is_zone) continue;
    bool is_seen = false;
    bool has_beams = false;
    for (const auto& way : grid_->WaysOf(cells[i])) {
      const float reach_m = reach_m_[way.azimuth * num_rings + way.ring];
      has_beams |= reach_m >= 0.0F;
      is_seen = reach_m >= way.range_m;
      if (is_seen) break;
    }
    share_[i] += weight * ((is_seen ? 1.0 : 0.0) - share_[i]);
    if (share_[i] > kSeenShare) {
      why_[i] = Unseen::kNo;
    } else if (!is_seen && (share_[i] < kUnseenShare || why_[i] != Unseen::kNo)) {
      why_[i] = cells[i].num_ways == 0 ? cells[i].why : has_beams ? Unseen::kHidden : Unseen::kNoBeams;
    }
  }
}

void ZoneSight::Tell() {
  wide_ = grid_->PartsOf(why_);
  std::vector<bool> unseen(grid_->num_bearings());
  std::vector<bool> now(grid_->num_bearings());
  const double step_rad = grid_->bearing_step_rad();
  for (const auto& part : wide_) {
    const auto first = std::lround(WrapTo2Pi(part.bearing.start_rad - params_.zone.bearing.start_rad) / step_rad);
    const auto count = std::lround(part.bearing.width_rad / step_rad);
    for (std::int64_t i = 0; i < count; ++i) {
      const auto bearing = static_cast<std::size_t>(first + i) % unseen.size();
      unseen[bearing] = true;
      if (part.is_wide) now[bearing] = true;
    }
  }
  std::erase_if(wide_, [](const UnseenPart& part) { return !part.is_wide; });
  unseen_deg_ = static_cast<int>(std::lround(RadToDeg(step_rad * static_cast<double>(std::ranges::count(unseen, true)))));
  is_whole_ = true;
  for (std::size_t i = 0; i < why_.size(); ++i) is_whole_ &= !grid_->cells()[i].is_zone || why_[i] != Unseen::kNo;
  is_whole_ &= !wide_.empty();
  int num_new = 0;
  for (std::size_t i = 0; i < now.size(); ++i) num_new += now[i] && !told_[i] ? 1 : 0;
  // A gap that is seen again meanwhile is told anew when it is lost.
  const bool is_new = num_new > 0 && (num_new * step_rad >= kLeastWidthRad - 1e-9 || std::ranges::count(told_, true) == 0);
  if (is_new) {
    ++num_told_;
    told_ = now;
  } else {
    for (std::size_t i = 0; i < now.size(); ++i) told_[i] = told_[i] && now[i];
  }
}

std::optional<Danger> ZoneSight::danger() const {
  if (wide_.empty()) return std::nullopt;
  const auto& largest = wide_.front();
  return Danger{
      .cause = AlertCause::kWatch,
      .thing = kFirstUnseenId - num_told_,
      .probability = 1.0,
      .distance_m = largest.from_m,
      .bearing_rad = largest.bearing.width_rad >= kTwoPi - 1e-9 ? kNan : WrapTo2Pi(largest.bearing.start_rad + largest.bearing.width_rad / 2.0),
      .is_grave = is_whole_};
}

}  // namespace lookout::tracker
