#include "lab/eval/tracks/track_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/messages/pieces.hpp"
#include "lab/eval/methods/outcome.hpp"

namespace lookout::eval {
namespace {

// A scan waits for its obstacles, and then for its tracks, for some seconds of scans at most.
constexpr std::size_t kMaxWaiting = 256;
// Returns stand in the truth in the order of time, and scans come in theirs.
constexpr std::int64_t kKeptUs = 2'000'000;

std::set<int> LandOf(const messages::ScanMessages& scan) {
  std::set<int> land;
  for (const auto& [part_index, message] : scan.segments) {
    for (const auto& segment : message.segments) {
      if (segment.kind == segment_t::KIND_LAND) land.insert(segment.id);
    }
  }
  return land;
}

// At the beginning of a run the pose comes in mid-scan, and obstacles before that moment have no place.
bool IsPlacedAsAWhole(const messages::ScanMessages& scan) {
  return std::ranges::all_of(scan.obstacles, [](const auto& part) {
    return std::ranges::all_of(part.second.obstacles, [](const auto& obstacle) { return obstacle.status == obstacle_t::STATUS_OK; });
  });
}

}  // namespace

TrackState ToTrackState(const track_t& track) {
  TrackState state;
  state.id = track.id;
  state.status = static_cast<TrackStatus>(track.status);
  state.position_m = {track.position_map_m[0], track.position_map_m[1]};
  state.velocity_mps = {track.velocity_map_mps[0], track.velocity_map_mps[1]};
  state.is_moving = state.velocity_mps.norm() > 0.0;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) state.covariance(row, column) = track.covariance[row][column];
  }
  for (std::size_t i = 0; i < track.outline_east_m.size(); ++i) {
    state.outline_m.emplace_back(static_cast<double>(track.outline_east_m[i]), static_cast<double>(track.outline_north_m[i]));
  }
  state.segment_ids = track.segment_ids;
  state.cpa_m = static_cast<double>(track.cpa_m);
  state.tcpa_s = static_cast<double>(track.tcpa_s);
  state.cpa_probability = static_cast<double>(track.cpa_probability);
  return state;
}

TrackRun::TrackRun(Truth& truth, MultiObjectTrackers trackers, Returns returns, const ApproachLimits& limits,
                   const std::vector<std::string>& variants, CountReturns count)
    : truth_(truth),
      used_returns_(returns),
      limits_(limits),
      count_(std::move(count)),
      objects_(ObjectsOf(truth)),
      trackers_(std::move(trackers)),
      collector_([](const messages::ScanMessages& scan) { return messages::HasAllParts(scan.obstacles); },
                 messages::ScanCollector::Order::kOfCompletion, kMaxWaiting,
                 [this](const messages::ScanMessages& scan) {
                   if (messages::HasAllParts(scan.obstacles)) OnScan(scan);
                 }),
      own_(Begun(variants)) {
  for (const auto& tracker : trackers_) said_.push_back({tracker->name(), {}, {}, {}});
}

std::vector<TrackRun::Said> TrackRun::Begun(const std::vector<std::string>& variants) {
  std::vector<Said> own{{"lookout", {}, {}, {}}};
  for (const auto& variant : variants) own.push_back({variant, {}, {}, {}});
  return own;
}

bool TrackRun::Add(std::string_view channel, Bytes bytes) {
  const auto take = [&](auto message) { return message && collector_.Add(*std::move(message)); };
  if (channel == bus::kLidarScan.name) return take(bus::Decode<lidar_scan_t>(bytes));
  if (channel == bus::kSegments.name) return take(bus::Decode<segments_t>(bytes));
  if (channel == bus::kObstacles.name) return take(bus::Decode<obstacles_t>(bytes));
  if (channel == bus::kAlerts.name) {
    const auto message = bus::Decode<alerts_t>(bytes);
    return message && OnAlerts(*message);
  }
  if (channel != kTracksChannel) return true;
  const auto message = bus::Decode<tracks_t>(bytes);
  return message && OnTracks(0, *message);
}

bool TrackRun::AddTracksOf(std::string_view variant, Bytes bytes) {
  const auto own = std::ranges::find(own_, variant, &Said::tracker);
  const auto message = bus::Decode<tracks_t>(bytes);
  return own != own_.end() && message && OnTracks(static_cast<std::size_t>(own - own_.begin()), *message);
}

void TrackRun::Finish() {
  collector_.Finish();
  waiting_.clear();
}

std::vector<TrackRun::LabelledReturn> TrackRun::Join(const messages::ScanMessages& scan) {
  std::vector<LabelledReturn> returns;
  for (const auto& [part_index, part] : scan.scans) {
    const auto found = scan.segments.find(part_index);
    const bool is_labelled = found != scan.segments.end() && found->second.num_cells == part.num_cells;
    const auto piece = is_labelled ? messages::PiecesOf(found->second) : std::vector<std::int16_t>(part.range.size(), 0);
    truth_.ForEachReturn(part, [&](std::size_t cell, std::int64_t /*time_ns*/, const Truth::Return* truth) {
      ++num_returns_;
      if (truth == nullptr) return;
      ++num_joined_;
      if (truth->object_id == data::kOwnVesselObject) return;
      returns.push_back({truth->object_id, is_labelled ? found->second.label[cell] : 0, piece[cell]});
    });
  }
  if (used_returns_ == Returns::kForgotten) truth_.ForgetReturnsBefore(scan.utime_us - kKeptUs);
  return returns;
}

LabelFigures TrackRun::FiguresOf(const std::vector<LabelledReturn>& returns, bool is_land_one,
                                 const std::function<int(const LabelledReturn&)>& label_of) const {
  // Objects of Confusion are above 0.
  const int land_id = objects_.rbegin()->first + 1;
  Confusion confusion;
  std::set<int> land;
  std::map<int, int> object_of;  // asked for each return: land or not
  for (const auto& [id, object] : objects_) {
    const bool is_land = id > 0 && IsLand(object);
    object_of[id] = is_land && is_land_one ? land_id : id;
    if (is_land) land.insert(object_of[id]);
  }
  for (const auto& one : returns) {
    const auto object = object_of.find(one.object);
    confusion.Add(object == object_of.end() ? 0 : object->second, one.label > 0 ? label_of(one) : 0);
  }
  return LabelFiguresOf(confusion.Match(), land);
}

LabelFigures TrackRun::FiguresOf(const std::vector<LabelledReturn>& returns, const TrackLabels& labels) const {
  return FiguresOf(returns, true, [&labels](const LabelledReturn& one) { return labels.Of(one.label, one.piece); });
}

void TrackRun::OnScan(const messages::ScanMessages& scan) {
  const auto& head = scan.obstacles.begin()->second;
  std::vector<std::vector<TrackState>> tracks;
  for (const auto& tracker : trackers_) tracks.push_back(tracker->Update(scan));
  const MapOrigin origin{head.datum_latitude_deg, head.datum_longitude_deg, head.datum_ellipsoid_height_m};
  const bool is_on_earth = std::ranges::all_of(origin, [](double value) { return std::isfinite(value); });
  const bool is_relative = std::isnan(origin[0]) && std::isfinite(origin[2]) && frame_placement_;
  const auto map = is_on_earth ? MapPlacement{origin} : is_relative ? frame_placement_(origin[2]) : std::nullopt;
  if (!map || messages::IsCut(head.scan_flags) || (truth_scans_.empty() && !IsPlacedAsAWhole(scan))) return;
  if (!track_truth_ || map->origin != origin_) {
    origin_ = map->origin;
    track_truth_ = std::make_unique<TrackTruth>(truth_, *map);
  }
  Waiting waiting{.index = truth_scans_.size(),
                  .returns = count_ ? std::vector<LabelledReturn>() : Join(scan),
                  .own_labels = {},
                  .parts = std::vector<std::vector<tracks_t>>(own_.size())};
  auto num_returns = count_ ? count_({head.utime_us, head.end_utime_us}) : std::map<int, int>();
  for (const auto& one : waiting.returns) ++num_returns[one.object];
  truth_scans_.push_back(track_truth_->At(head.end_utime_us, num_returns));

  const auto land = LandOf(scan);
  const bool has_labels = !scan.segments.empty() && !count_;
  if (has_labels) {
    const auto apart = FiguresOf(waiting.returns, false, [](const LabelledReturn& one) { return one.label; });
    waiting.own_labels.segments = apart.iou;
    waiting.own_labels.single = FiguresOf(waiting.returns, TrackLabels({}, land));
    waiting.own_labels.single.land_too_many = apart.land_too_many;
  }
  for (std::size_t i = 0; i < said_.size(); ++i) {
    auto& said = said_[i];
    said.labels.segments.Add(waiting.own_labels.segments);
    said.labels.single.Add(waiting.own_labels.single);
    if (has_labels) said.labels.by_tracks.Add(FiguresOf(waiting.returns, TrackLabels(tracks[i], land)));
    said.tracks.push_back(std::move(tracks[i]));
  }
  for (auto& own : own_) {
    own.tracks.emplace_back();
    own.alerts.emplace_back();
    own.labels.segments.Add(waiting.own_labels.segments);
    own.labels.single.Add(waiting.own_labels.single);
  }
  scan_at_[scan.utime_us] = waiting.index;
  waiting_[scan.utime_us] = std::move(waiting);
  if (waiting_.size() > kMaxWaiting) waiting_.erase(waiting_.begin());
}

bool TrackRun::OnTracks(std::size_t own, const tracks_t& message) {
  if (!messages::IsWellFormed(message)) return false;
  own_[own].has_come = true;
  const auto found = waiting_.find(message.utime_us);
  if (found == waiting_.end()) return true;  // of a scan that is not scored
  auto& waiting = found->second;
  auto& parts = waiting.parts[own];
  parts.push_back(message);
  if (!std::cmp_equal(parts.size(), message.num_parts)) return true;
  TakeTracks(own_[own], parts, waiting);
  if (++waiting.num_done == own_.size()) waiting_.erase(found);
  return true;
}

bool TrackRun::OnAlerts(const alerts_t& message) {
  const auto scan = scan_at_.find(message.utime_us);
  if (scan == scan_at_.end() || message.is_watch) return true;
  for (const auto& alert : message.alerts) {
    const bool holds = alert.state == alert_t::STATE_ACTIVE || alert.state == alert_t::STATE_ACKNOWLEDGED;
    own_.front().alerts[scan->second].push_back({alert.id, alert.track_id, alert.cause == alert_t::CAUSE_CLOSEST_APPROACH, holds});
  }
  return true;
}

void TrackRun::TakeTracks(Said& own, const std::vector<tracks_t>& parts, const Waiting& waiting) {
  auto& tracks = own.tracks[waiting.index];
  for (const auto& part : parts) {
    for (const auto& track : part.tracks) tracks.push_back(ToTrackState(track));
  }
  if (waiting.own_labels.segments.count == 0) return;
  own.labels.by_tracks.Add(FiguresOf(waiting.returns, TrackLabels(parts, TrackLabels::Land::kOne)));
}

std::vector<TrackRun::Row> TrackRun::Rows() const {
  std::vector<Row> rows;
  for (const auto& own : own_) {
    if (own.has_come) rows.push_back({own.tracker, ScoreTracks(truth_scans_, own.tracks, own.alerts, limits_), own.labels});
  }
  for (const auto& said : said_) rows.push_back({said.tracker, ScoreTracks(truth_scans_, said.tracks, {}, limits_), said.labels});
  return rows;
}

}  // namespace lookout::eval
