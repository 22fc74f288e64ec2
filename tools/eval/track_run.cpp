#include "tools/eval/track_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/messages/pieces.hpp"
#include "tools/eval/outcome.hpp"

namespace lookout::eval {
namespace {

// A scan waits for its obstacles, and then for its tracks, for some seconds of scans at most.
constexpr std::size_t kMaxWaiting = 256;
constexpr int kLandLabel = 1;
constexpr int kFirstLabel = 2;  // of other segments and tracks
// Returns stand in the truth in the order of time, and scans come in theirs.
constexpr std::int64_t kKeptUs = 2'000'000;

// As lookout-export has it: the nearest microsecond.
std::int64_t ToMicroseconds(std::int64_t time_ns) { return static_cast<std::int64_t>(std::floor((static_cast<double>(time_ns) + 500.0) / 1000.0)); }

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

// Tracks merge segments and split off land; a segment that no track explains keeps its own label. So these differ from the labels of SEGMENTS only
// where the tracker says something of its own.
std::map<int, int> LabelsOf(const std::vector<TrackState>& tracks, const std::set<int>& land) {
  std::map<int, int> labels;
  int label = kFirstLabel;
  for (const auto& track : tracks) {
    if (track.status == TrackStatus::kLost) continue;
    for (const auto segment : track.segment_ids) labels[segment] = label;
    ++label;
  }
  for (const int segment : land) labels[segment] = kLandLabel;
  return labels;
}

// Labels by what TRACKS say of pieces, from 1 on; 0 = the return keeps the label of its segment.
struct PieceLabels {
  std::vector<int> of_piece;  // by its number
  int last = kLandLabel;
};

// Empty where TRACKS say nothing of pieces.
PieceLabels PieceLabelsOf(const std::vector<tracks_t>& parts) {
  PieceLabels labels;
  std::map<std::int64_t, int> label_of_track;
  for (const auto& part : parts) {
    if (part.num_pieces == 0) continue;
    const auto first = static_cast<std::size_t>(part.first_piece);
    labels.of_piece.resize(std::max(labels.of_piece.size(), first + part.track_of_piece.size()), 0);
    for (std::size_t i = 0; i < part.track_of_piece.size(); ++i) {
      const auto track_id = part.track_of_piece[i];
      if (track_id < tracks_t::PIECE_LAND) continue;
      const auto next = kFirstLabel + static_cast<int>(label_of_track.size());
      const int label = track_id == tracks_t::PIECE_LAND ? kLandLabel : label_of_track.try_emplace(track_id, next).first->second;
      labels.of_piece[first + i] = label;
      labels.last = std::max(labels.last, label);
    }
  }
  return labels;
}

void AddTo(Mean& mean, const std::optional<double>& value) {
  if (value) mean.Add(*value);
}

}  // namespace

// @param labels  outlives what is returned
std::function<int(const TrackRun::LabelledReturn&)> TrackRun::BySegment(const std::map<int, int>& labels) {
  int last = kFirstLabel;
  for (const auto& [segment, label] : labels) last = std::max(last, label);
  return [&labels, last](const LabelledReturn& one) {
    const auto label = labels.find(one.label);
    return label == labels.end() ? last + one.label : label->second;
  };
}

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

TrackRun::TrackRun(Truth& truth, MultiObjectTrackers trackers, Returns returns, const ApproachLimits& limits)
    : truth_(truth),
      used_returns_(returns),
      limits_(limits),
      objects_(ObjectsOf(truth)),
      trackers_(std::move(trackers)),
      collector_([](const messages::ScanMessages& scan) { return messages::HasAllParts(scan.obstacles); },
                 messages::ScanCollector::Order::kOfCompletion, kMaxWaiting,
                 [this](const messages::ScanMessages& scan) {
                   if (messages::HasAllParts(scan.obstacles)) OnScan(scan);
                 }) {
  for (const auto& tracker : trackers_) said_.push_back({tracker->name(), {}, {}, {}});
  own_.tracker = "lookout";
  const bool has_structures = std::ranges::any_of(objects_, [](const auto& object) { return object.first > 0 && !object.second.is_in_water; });
  own_.labels.has_structures = has_structures;
  for (auto& said : said_) said.labels.has_structures = has_structures;
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
  return message && OnTracks(*message);
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
    std::size_t cell = 0;
    for (std::size_t column = 0; column < static_cast<std::size_t>(part.num_columns); ++column) {
      for (std::size_t ring = 0; ring < static_cast<std::size_t>(part.num_rings); ++ring) {
        for (int k = 0; k < part.num_returns; ++k, ++cell) {
          if (part.range[cell] == 0) continue;
          ++num_returns_;
          const std::int64_t time_ns = std::int64_t{part.time_ns[column]} + part.time_offset_ns[ring];
          const auto* truth = truth_.Find(part.utime_us + ToMicroseconds(time_ns), static_cast<int>(ring), k);
          if (truth == nullptr) continue;
          ++num_joined_;
          if (truth->object_id != importer::kOwnVesselObject) {
            returns.push_back({truth->object_id, is_labelled ? found->second.label[cell] : 0, piece[cell]});
          }
        }
      }
    }
  }
  if (used_returns_ == Returns::kForgotten) truth_.ForgetReturnsBefore(scan.utime_us - kKeptUs);
  return returns;
}

std::optional<double> TrackRun::IouOf(const std::vector<LabelledReturn>& returns, bool is_land_one,
                                      const std::function<int(const LabelledReturn&)>& label_of) const {
  // Objects of Confusion are above 0.
  const int land_id = objects_.rbegin()->first + 1;
  Confusion confusion;
  std::map<int, int> object_of;  // asked for each return: land or not
  for (const auto& [id, object] : objects_) object_of[id] = is_land_one && id > 0 && IsLand(object) ? land_id : id;
  for (const auto& one : returns) {
    const auto object = object_of.find(one.object);
    confusion.Add(object == object_of.end() ? 0 : object->second, one.label > 0 ? label_of(one) : 0);
  }
  Mean iou;
  for (const auto& [id, object] : confusion.Match().objects) iou.Add(object.iou);
  return iou.count > 0 ? std::optional(iou.value()) : std::nullopt;
}

void TrackRun::OnScan(const messages::ScanMessages& scan) {
  const auto& head = scan.obstacles.begin()->second;
  std::vector<std::vector<TrackState>> tracks;
  for (const auto& tracker : trackers_) tracks.push_back(tracker->Update(scan));
  const MapOrigin origin{head.datum_latitude_deg, head.datum_longitude_deg, head.datum_ellipsoid_height_m};
  const bool is_placed = std::ranges::all_of(origin, [](double value) { return std::isfinite(value); });
  if (!is_placed || messages::IsCut(head.scan_flags) || (truth_scans_.empty() && !IsPlacedAsAWhole(scan))) return;
  if (!track_truth_ || origin != origin_) {
    origin_ = origin;
    track_truth_ = std::make_unique<TrackTruth>(truth_, origin);
  }
  Waiting waiting{truth_scans_.size(), Join(scan), {}, {}};
  std::map<int, int> num_returns;
  for (const auto& one : waiting.returns) ++num_returns[one.object];
  truth_scans_.push_back(track_truth_->At(head.end_utime_us, num_returns));

  const auto land = LandOf(scan);
  if (!scan.segments.empty()) {
    AddTo(waiting.own_labels.segments, IouOf(waiting.returns, false, [](const LabelledReturn& one) { return one.label; }));
    AddTo(waiting.own_labels.segments_land_one,
          IouOf(waiting.returns, true, [&](const LabelledReturn& one) { return land.contains(one.label) ? kLandLabel : kFirstLabel + one.label; }));
  }
  for (std::size_t i = 0; i < said_.size(); ++i) {
    auto& said = said_[i];
    said.labels.segments.Add(waiting.own_labels.segments);
    said.labels.segments_land_one.Add(waiting.own_labels.segments_land_one);
    const auto labels = LabelsOf(tracks[i], land);
    if (!scan.segments.empty()) AddTo(said.labels.tracks_land_one, IouOf(waiting.returns, true, BySegment(labels)));
    said.tracks.push_back(std::move(tracks[i]));
  }
  own_.tracks.emplace_back();
  own_.alerts.emplace_back();
  scan_at_[scan.utime_us] = waiting.index;
  own_.labels.segments.Add(waiting.own_labels.segments);
  own_.labels.segments_land_one.Add(waiting.own_labels.segments_land_one);
  waiting_[scan.utime_us] = std::move(waiting);
  if (waiting_.size() > kMaxWaiting) waiting_.erase(waiting_.begin());
}

bool TrackRun::OnTracks(const tracks_t& message) {
  if (!messages::IsWellFormed(message)) return false;
  has_own_ = true;
  const auto found = waiting_.find(message.utime_us);
  if (found == waiting_.end()) return true;  // of a scan that is not scored
  auto& waiting = found->second;
  waiting.parts.push_back(message);
  if (!std::cmp_equal(waiting.parts.size(), message.num_parts)) return true;
  TakeTracks(waiting);
  waiting_.erase(found);
  return true;
}

bool TrackRun::OnAlerts(const alerts_t& message) {
  const auto scan = scan_at_.find(message.utime_us);
  if (scan == scan_at_.end() || message.is_watch) return true;
  for (const auto& alert : message.alerts) {
    const bool holds = alert.state == alert_t::STATE_ACTIVE || alert.state == alert_t::STATE_ACKNOWLEDGED;
    own_.alerts[scan->second].push_back({alert.id, alert.track_id, alert.cause == alert_t::CAUSE_CLOSEST_APPROACH, holds});
  }
  return true;
}

void TrackRun::TakeTracks(const Waiting& waiting) {
  auto& tracks = own_.tracks[waiting.index];
  std::set<int> land;
  for (const auto& part : waiting.parts) {
    for (const auto& track : part.tracks) tracks.push_back(ToTrackState(track));
    land.insert(part.land_segment_ids.begin(), part.land_segment_ids.end());
  }
  if (waiting.own_labels.segments.count == 0) return;
  const auto pieces = PieceLabelsOf(waiting.parts);
  if (!pieces.of_piece.empty()) {
    const auto by_piece = [&pieces](const LabelledReturn& one) {
      const auto piece = static_cast<std::size_t>(one.piece);
      const int label = piece < pieces.of_piece.size() ? pieces.of_piece[piece] : 0;
      return label > 0 ? label : pieces.last + one.label;
    };
    AddTo(own_.labels.tracks_land_one, IouOf(waiting.returns, true, by_piece));
    return;
  }
  const auto labels = LabelsOf(tracks, land);
  AddTo(own_.labels.tracks_land_one, IouOf(waiting.returns, true, BySegment(labels)));
}

std::vector<TrackRun::Row> TrackRun::Rows() const {
  std::vector<Row> rows;
  if (has_own_) rows.push_back({own_.tracker, ScoreTracks(truth_scans_, own_.tracks, own_.alerts, limits_), own_.labels});
  for (const auto& said : said_) rows.push_back({said.tracker, ScoreTracks(truth_scans_, said.tracks, {}, limits_), said.labels});
  return rows;
}

}  // namespace lookout::eval
