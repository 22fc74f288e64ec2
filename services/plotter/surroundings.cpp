#include "services/plotter/surroundings.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/frames.hpp"
#include "common/core/outlines.hpp"

namespace lookout::plotter {

namespace {

using std::chrono::microseconds;

// The second lidar turns by itself: its last scan ended within a turn of the first's end.
constexpr std::int64_t kMostApartUs = 250'000;
constexpr double kMostM = 1e5;
// It is told every tenth scan.
constexpr std::chrono::seconds kWaterlineLasts(3);
constexpr double kMostMps = 1000.0;

std::vector<Eigen::Vector2d> PlacesOf(const std::vector<LidarSightParams>& lidars) {
  std::vector<Eigen::Vector2d> places_m;
  places_m.reserve(lidars.size());
  for (const auto& lidar : lidars) places_m.emplace_back(lidar.T_vessel_lidar.translation().head<2>());
  return places_m;
}

bool IsThere(const track_t& track, bool takes_tentative) {
  return track.status == track_t::STATUS_CONFIRMED || track.status == track_t::STATUS_COASTING ||
         (takes_tentative && track.status == track_t::STATUS_TENTATIVE);
}

bool Fit(const lidar_scan_t& scan, const segments_t& labels) {
  return scan.first_column == labels.first_column && scan.num_columns == labels.num_columns && scan.num_rings == labels.num_rings &&
         scan.num_returns == labels.num_returns && scan.num_cells == labels.num_cells;
}

// From east and north of a place to forward and port of a boat there.
Eigen::Matrix<double, 2, 3> VesselFromHere(double heading_rad) {
  const auto heading = SinCosOf(heading_rad);
  Eigen::Matrix<double, 2, 3> turn;
  turn << heading.sin, heading.cos, 0.0, -heading.cos, heading.sin, 0.0;
  return turn;
}

// Nearest return of each shot of a column; 0 = none.
void NearestRanges(const lidar_scan_t& scan, std::size_t column, std::vector<float>& range_m) {
  const auto num_rings = static_cast<std::size_t>(scan.num_rings);
  const auto num_returns = static_cast<std::size_t>(scan.num_returns);
  for (std::size_t ring = 0; ring < num_rings; ++ring) {
    std::uint16_t nearest = 0;
    for (std::size_t k = 0; k < num_returns; ++k) {
      const auto count = static_cast<std::uint16_t>(scan.range[(column * num_rings + ring) * num_returns + k]);
      if (count != 0 && (nearest == 0 || count < nearest)) nearest = count;
    }
    range_m[ring] = static_cast<float>(nearest * scan.range_unit_m);
  }
}

// In the map frame, as it has gone on since. nullopt: a number that cannot be.
std::optional<std::vector<Eigen::Vector2d>> OutlineAfter(const track_t& track, double duration_s) {
  const Eigen::Vector2d velocity_mps(track.velocity_map_mps[0], track.velocity_map_mps[1]);
  std::vector<Eigen::Vector2d> outline_m;
  outline_m.reserve(track.outline_east_m.size());
  for (std::size_t i = 0; i < track.outline_east_m.size(); ++i) outline_m.emplace_back(track.outline_east_m[i], track.outline_north_m[i]);
  if (outline_m.empty()) outline_m.emplace_back(track.position_map_m[0], track.position_map_m[1]);
  for (auto& corner_m : outline_m) corner_m += duration_s * velocity_mps;
  const bool is_good =
      velocity_mps.allFinite() && velocity_mps.norm() < kMostMps &&
      std::ranges::all_of(outline_m, [](const Eigen::Vector2d& corner_m) { return corner_m.allFinite() && corner_m.norm() < kMostM; });
  return is_good ? std::optional(std::move(outline_m)) : std::nullopt;
}

}  // namespace

template <typename Message>
void Surroundings::Whole<Message>::Add(const Message& message) {
  auto ended = parts.Add(message);
  if (ended.whole.empty()) return;
  scans.push_back(std::move(ended.whole));
  if (scans.size() > kMostScans) scans.pop_front();
}

template <typename Message>
const std::vector<Message>* Surroundings::Whole<Message>::Find(std::int64_t utime_us, std::int64_t seq) const {
  for (auto scan = scans.rbegin(); scan != scans.rend(); ++scan) {
    if (scan->front().utime_us == utime_us && scan->front().seq == seq) return &*scan;
  }
  return nullptr;
}

Surroundings::Surroundings(const SurroundingsParams& params)
    : params_(params), sector_sight_(PlacesOf(params.lidars), params.own_vessel_box_m, params.reach_m) {
  for (const auto& lidar : params.lidars) {
    const CoverParams cover{lidar.T_vessel_lidar, lidar.min_range_m, lidar.field_of_view, lidar.own_vessel_box_m};
    lidars_.push_back({.params = lidar, .scans = {}, .labels = {}, .cover = CoverWatch(cover), .sight = std::nullopt});
  }
}

void Surroundings::OnScan(std::size_t lidar, const lidar_scan_t& message) {
  if (const auto fault = messages::FaultOf(message, bus::kMaxMessageBytes)) return scans_refused_.Add(*fault);
  lidars_.at(lidar).scans.Add(message);
}

void Surroundings::OnLabels(std::size_t lidar, const segments_t& message) {
  if (const auto fault = messages::FaultOf(message, bus::kMaxMessageBytes)) return labels_refused_.Add(*fault);
  lidars_.at(lidar).labels.Add(message);
}

void Surroundings::OnPose(const Pose& pose) {
  if (poses_.newest() != nullptr && pose.time <= poses_.newest()->time) poses_.Clear();
  poses_.Add(pose);
}

Surroundings::Found Surroundings::FirstOf(const tracks_t& tracks) const {
  const Lidar& lidar = lidars_.front();
  return {lidar.scans.Find(tracks.utime_us, tracks.seq), lidar.labels.Find(tracks.utime_us, tracks.seq)};
}

Surroundings::Found Surroundings::SecondOf(const tracks_t& tracks) const {
  const Lidar& lidar = lidars_.back();
  for (auto labels = lidar.labels.scans.rbegin(); labels != lidar.labels.scans.rend(); ++labels) {
    const auto& head = labels->front();
    if (std::abs(head.end_utime_us - tracks.end_utime_us) > kMostApartUs) continue;
    if (const auto* scan = lidar.scans.Find(head.utime_us, head.seq)) return {scan, &*labels};
  }
  return {};
}

// Segments that count: sure segments of the scan, land, and segments of tracks that are there. All others may be spray.
std::vector<bool> Surroundings::TakenSegments(const std::vector<segments_t>& labels, std::span<const tracks_t> tracks) const {
  std::vector<bool> is_taken;
  const auto take = [&is_taken](std::int32_t id) {
    if (id <= 0 || id > std::numeric_limits<std::int16_t>::max()) return;
    const auto index = static_cast<std::size_t>(id);
    if (index >= is_taken.size()) is_taken.resize(index + 1, false);
    is_taken[index] = true;
  };
  for (const auto& part : labels) {
    for (const auto& segment : part.segments) {
      if (params_.takes_tentative || segment.confidence == segment_t::CONFIDENCE_SURE) take(segment.id);
    }
  }
  for (const auto& part : tracks) {
    std::ranges::for_each(part.land_segment_ids, take);
    for (const auto& track : part.tracks) {
      if (IsThere(track, params_.takes_tentative)) std::ranges::for_each(track.segment_ids, take);
    }
  }
  return is_taken;
}

Surroundings::ToNow Surroundings::ToNowFrom(const Pose* now, Utime time) const {
  ToNow result;
  if (now == nullptr) return result;
  const auto then = poses_.PlaceAt(time, now->datum);
  result.is_known = then && then->is_placed;
  if (!result.is_known) return result;
  const Eigen::Matrix<double, 2, 3> vessel_from_map = VesselFromHere(now->heading_rad) * now->R_map_here.transpose();
  result.turn = vessel_from_map * then->R_map_here * RotationMapVessel(then->heading_rad, then->pitch_rad, then->roll_rad);
  result.shift_m = vessel_from_map * (then->position_map_m - now->position_map_m);
  result.turned_rad = WrapToPi(now->heading_rad - then->heading_rad);
  return result;
}

bool Surroundings::AddPart(Lidar& lidar, const lidar_scan_t& scan, const segments_t& labels, const std::vector<bool>& is_taken, const Pose* now,
                           Look& look) {
  const auto num_rings = static_cast<std::size_t>(scan.num_rings);
  const auto num_returns = static_cast<std::size_t>(scan.num_returns);
  const double step_rad = kTwoPi / std::max(scan.num_turn_columns, 1);
  std::vector<SinCos> elevation;
  elevation.reserve(num_rings);
  for (const auto elevation_rad : scan.elevation_rad) elevation.push_back(SinCosOf(static_cast<double>(elevation_rad)));
  std::vector<float> range_m(num_rings);
  bool is_known = true;
  std::size_t cell = 0;
  for (std::size_t column = 0; column < static_cast<std::size_t>(scan.num_columns); ++column) {
    const auto to_now = ToNowFrom(now, Utime(microseconds(scan.utime_us + scan.time_ns[column] / 1000)));
    is_known = is_known && to_now.is_known;
    const Eigen::Matrix<double, 2, 3> turn = to_now.turn * lidar.params.T_vessel_lidar.linear();
    const Eigen::Vector2d shift_m = to_now.turn * lidar.params.T_vessel_lidar.translation() + to_now.shift_m;
    const auto azimuth_rad = static_cast<double>(scan.azimuth_rad[column]);
    NearestRanges(scan, column, range_m);
    for (std::size_t ring = 0; ring < num_rings; ++ring) {
      range_m[ring] = lidar.cover.EndOf(azimuth_rad + static_cast<double>(scan.azimuth_offset_rad[ring]), range_m[ring]);
    }
    lidar.sight->Add({azimuth_rad, step_rad, to_now.turned_rad, scan.azimuth_offset_rad, range_m});
    for (std::size_t ring = 0; ring < num_rings; ++ring) {
      for (std::size_t k = 0; k < num_returns; ++k, ++cell) {
        const auto label = static_cast<std::size_t>(std::max<std::int16_t>(labels.label[cell], 0));
        if (label >= is_taken.size() || !is_taken[label]) continue;
        const double return_m = static_cast<std::uint16_t>(scan.range[cell]) * scan.range_unit_m;
        const auto azimuth = SinCosOf(azimuth_rad + static_cast<double>(scan.azimuth_offset_rad[ring]));
        const double run_m = return_m * elevation[ring].cos;
        const Eigen::Vector3d p_lidar_m(run_m * azimuth.cos, -run_m * azimuth.sin,
                                        return_m * elevation[ring].sin + static_cast<double>(scan.origin_height_m[ring]));
        look.sectors.AddPoint(turn * p_lidar_m + shift_m);
      }
    }
  }
  return is_known;
}

void Surroundings::WatchForCovers(Lidar& lidar, const std::vector<lidar_scan_t>& scan) {
  std::vector<float> range_m(static_cast<std::size_t>(scan.front().num_rings));
  lidar.cover.Begin();
  for (const auto& part : scan) {
    for (std::size_t column = 0; column < static_cast<std::size_t>(part.num_columns); ++column) {
      NearestRanges(part, column, range_m);
      lidar.cover.AddColumn(static_cast<double>(part.azimuth_rad[column]), part.azimuth_offset_rad, part.elevation_rad, range_m);
    }
  }
  lidar.cover.End(Utime(microseconds(scan.front().end_utime_us)));
}

bool Surroundings::AddReturns(Lidar& lidar, const Found& found, const std::vector<bool>& is_taken, const Pose* now, Look& look) {
  const auto& scan = *found.scan;
  const auto& labels = *found.labels;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (i >= labels.size() || !Fit(scan[i], labels[i])) {
      ++counts_["looks_inconsistent"];
      return false;
    }
  }
  const auto& elevation_rad = scan.front().elevation_rad;
  if (!lidar.sight || !lidar.sight->IsFor(elevation_rad)) lidar.sight.emplace(lidar.params, elevation_rad);
  lidar.sight->Begin();
  WatchForCovers(lidar, scan);
  bool is_known = true;
  for (std::size_t i = 0; i < scan.size(); ++i) is_known = AddPart(lidar, scan[i], labels[i], is_taken, now, look) && is_known;
  if (!is_known) ++counts_["looks_between_poses"];
  return is_known;
}

// Adds the outlines of tracks. Left out are structures whose returns count, as returns are nearer to the truth (an outline bridges bays), and
// outlines that contain the own boat.
void Surroundings::AddTracks(std::span<const tracks_t> tracks, const Pose& now, bool has_returns, Look& look) {
  // Segments of the second lidar have greater ids.
  const auto is_of_first = [](std::int32_t id) { return id <= std::numeric_limits<std::int16_t>::max(); };
  const auto& head = tracks.front();
  if (!Datum{head.datum_latitude_deg, head.datum_longitude_deg, head.datum_ellipsoid_height_m}.IsSameAs(now.datum)) return;
  const double ahead_s = ToSeconds(now.time - Utime(microseconds(head.end_utime_us)));
  const Eigen::Matrix<double, 2, 3> vessel_from_map = VesselFromHere(now.heading_rad) * now.R_map_here.transpose();
  for (const auto& part : tracks) {
    for (const auto& track : part.tracks) {
      if (!IsThere(track, params_.takes_tentative)) continue;
      const bool is_by_returns = track.kind == track_t::KIND_STRUCTURE && has_returns && std::ranges::any_of(track.segment_ids, is_of_first);
      if (is_by_returns) continue;
      auto outline_m = OutlineAfter(track, ahead_s);
      if (!outline_m) {
        ++counts_["outlines_refused"];
        track_t middle = track;
        middle.outline_east_m.clear();
        middle.outline_north_m.clear();
        outline_m = OutlineAfter(middle, ahead_s);
      }
      if (!outline_m) continue;
      for (auto& corner_m : *outline_m) {
        corner_m = vessel_from_map * (Eigen::Vector3d(corner_m.x(), corner_m.y(), now.position_map_m.z()) - now.position_map_m);
      }
      if (!Contains(*outline_m, Eigen::Vector2d::Zero())) look.sectors.AddOutline(*outline_m);
    }
  }
}

// Beams meet a beach higher or lower as the boat rolls: what was seen of it before may be nearer than what is seen now.
void Surroundings::AddLand(const tracks_t& tracks, const Pose& now, Look& look) {
  const Utime time(microseconds(tracks.end_utime_us));
  const Datum datum{tracks.datum_latitude_deg, tracks.datum_longitude_deg, tracks.datum_ellipsoid_height_m};
  if (!tracks.waterline_east_m.empty()) {
    waterline_ = {time, datum, {}};
    for (std::size_t i = 0; i < tracks.waterline_east_m.size(); ++i) {
      const Eigen::Vector2d cell_m(tracks.waterline_east_m[i], tracks.waterline_north_m[i]);
      if (cell_m.allFinite() && cell_m.norm() < kMostM) waterline_.cells_m.push_back(cell_m);
    }
  }
  if (std::chrono::abs(time - waterline_.time) > kWaterlineLasts || !waterline_.datum.IsSameAs(now.datum)) return;
  const Eigen::Matrix<double, 2, 3> vessel_from_map = VesselFromHere(now.heading_rad) * now.R_map_here.transpose();
  for (const auto& cell_m : waterline_.cells_m) {
    look.sectors.AddPoint(vessel_from_map * (Eigen::Vector3d(cell_m.x(), cell_m.y(), now.position_map_m.z()) - now.position_map_m));
  }
}

Look Surroundings::LookAt(std::span<const tracks_t> tracks) {
  Look look;
  look.reach_m = params_.reach_m;
  ++counts_["looks"];
  const Pose* now = poses_.newest();
  if (now != nullptr && !now->is_placed) now = nullptr;
  if (now == nullptr) ++counts_["looks_without_pose"];
  std::vector<const LidarSight*> sights(lidars_.size(), nullptr);
  for (std::size_t i = 0; i < lidars_.size(); ++i) {
    const auto found = i == 0 ? FirstOf(tracks.front()) : SecondOf(tracks.front());
    if (found.scan == nullptr || found.labels == nullptr) {
      if (i == 0) ++counts_["looks_without_scan"];
      continue;
    }
    // Segment ids in TRACKS are ids of the first lidar.
    const auto is_taken = TakenSegments(*found.labels, i == 0 ? tracks : std::span<const tracks_t>());
    if (AddReturns(lidars_[i], found, is_taken, now, look)) sights[i] = &*lidars_[i].sight;
  }
  if (now != nullptr) {
    AddTracks(tracks, *now, sights.front() != nullptr, look);
    AddLand(tracks.front(), *now, look);
  }
  // Without the scan that TRACKS are of nobody knows what else is there.
  if (sights.front() != nullptr) look.is_looked = sector_sight_.Looked(sights);
  return look;
}

void Surroundings::AppendTo(std::vector<Counter>& counters) const {
  counts_.AppendTo(counters);
  scans_refused_.AppendTo(counters);
  labels_refused_.AppendTo(counters);
}

}  // namespace lookout::plotter
