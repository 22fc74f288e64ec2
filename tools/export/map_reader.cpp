#include "tools/export/map_reader.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <variant>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/config/text_config.hpp"
#include "common/messages/checks.hpp"
#include "common/messages/pose_message.hpp"
#include "common/messages/run_info_files.hpp"
#include "config/schema/segmenter.pb.h"
#include "lookout/pose_t.hpp"
#include "lookout/run_info_t.hpp"
#include "services/tracker/wire.hpp"
#include "tools/export/boat_of_log.hpp"

namespace lookout::exporter {

namespace {

constexpr std::size_t kMostWaitingScans = 64;  // 6 s
constexpr std::size_t kMostSweeps = 16;        // one a second
constexpr double kMostDatumHeightM = 1e5;
constexpr const char* kSegmenterFile = "segmenter.txtpb";

std::int64_t SecondOf(Utime time) { return std::chrono::floor<std::chrono::seconds>(time).time_since_epoch().count(); }

std::vector<Eigen::Vector2d> WaterlineOf(const tracks_t& message) {
  std::vector<Eigen::Vector2d> middles_m;
  const auto num = std::min(message.waterline_east_m.size(), message.waterline_north_m.size());
  middles_m.reserve(num);
  for (std::size_t i = 0; i < num; ++i) middles_m.emplace_back(message.waterline_east_m[i], message.waterline_north_m[i]);
  return middles_m;
}

}  // namespace

Taken MapReader::Take(std::string_view channel, Bytes bytes) {
  if (channel == bus::kTracks.name) return TakeTracks(bytes);
  if (channel == bus::kLidarScan.name) return TakeBeams(bytes);
  if (channel == bus::kPose.name) return TakePose(bytes);
  return TakeBoat(bytes);
}

Taken MapReader::TakeTracks(Bytes bytes) {
  const auto message = bus::Decode<tracks_t>(bytes);
  if (!message) return Taken::kUndecodable;
  if (!messages::IsWellFormed(*message) || !UtimeFromWire(message->end_utime_us) || !UtimeFromWire(message->begin_utime_us)) {
    return Taken::kInconsistent;
  }
  const auto ended = tracks_parts_.Add(*message);
  if (!ended.incomplete.empty()) AddTracks(ended.incomplete, false);
  if (!ended.whole.empty()) AddTracks(ended.whole, true);
  return Taken::kOk;
}

void MapReader::AddTracks(std::span<const tracks_t> parts, bool is_whole) {
  const auto& head = parts.front();
  Waiting waiting;
  waiting.begin = {*UtimeFromWire(head.begin_utime_us), head.begin_seq};
  waiting.key = tracker::KeyOf(head);
  const auto [newest, is_first] = newest_.try_emplace(waiting.begin, waiting.key);
  if (!is_first && waiting.key.time <= newest->second.time && waiting.key.seq <= newest->second.seq) return;
  newest->second = waiting.key;
  auto& scan = waiting.scan;
  scan.time = waiting.key.time;
  scan.end_time = *UtimeFromWire(head.end_utime_us);
  scan.datum = {head.datum_latitude_deg, head.datum_longitude_deg, head.datum_ellipsoid_height_m};
  if (!(std::abs(head.datum_latitude_deg) <= 90.0 && std::abs(head.datum_longitude_deg) <= 180.0)) return;  // then there are no tracks
  if (std::abs(head.datum_ellipsoid_height_m) > kMostDatumHeightM) return;                                  // NaN: not known
  for (const auto& part : parts) {
    for (const auto& track : part.tracks) {
      if (auto standing = ToStandingTrack(track)) scan.tracks.push_back(std::move(*standing));
    }
    if (part.num_waterline > 0) merge_.AddLand(scan.end_time, scan.datum, WaterlineOf(part));
  }
  std::ranges::stable_sort(scan.tracks, {}, &StandingTrack::id);
  const bool is_first_of_second = tracks_second_ != SecondOf(scan.time);
  tracks_second_ = SecondOf(scan.time);
  waiting.is_looked = is_first_of_second && is_whole && head.sight == tracks_t::SIGHT_KNOWN;
  waiting_.push_back(std::move(waiting));
  Release(kMostWaitingScans);
}

Taken MapReader::TakeBeams(Bytes bytes) {
  const auto message = bus::Decode<lidar_scan_t>(bytes);
  if (!message) return Taken::kUndecodable;
  if (messages::FaultOf(*message, bus::kMaxMessageBytes)) return Taken::kInconsistent;
  const auto ended = beams_parts_.Add(*message);
  if (ended.whole.empty()) return Taken::kOk;
  const auto second = SecondOf(tracker::KeyOf(*message).time);
  if (beams_second_ == second) return Taken::kOk;
  beams_second_ = second;
  auto beams = tracker::ToBeams(ended.whole);
  if (!beams) return Taken::kInconsistent;
  sweeps_.emplace_back(beams->key, std::move(beams->sweep));
  if (sweeps_.size() > kMostSweeps) sweeps_.pop_front();
  Release(kMostWaitingScans);
  return Taken::kOk;
}

Taken MapReader::TakePose(Bytes bytes) {
  const auto message = bus::Decode<pose_t>(bytes);
  if (!message) return Taken::kUndecodable;
  const auto pose = messages::ToPose(*message);
  if (std::holds_alternative<messages::Fault>(pose)) return Taken::kInconsistent;
  const auto* const newest = poses_.newest();
  if (newest != nullptr && std::get<Pose>(pose).time == newest->time) return Taken::kOk;  // the same POSE came twice
  if (newest != nullptr && std::get<Pose>(pose).time < newest->time) poses_.Clear();
  poses_.Add(std::get<Pose>(pose));
  Release(kMostWaitingScans);
  return Taken::kOk;
}

Taken MapReader::TakeBoat(Bytes bytes) {
  // The beams of another boat, or of another mounting, say nothing of this one.
  boat_.reset();
  max_range_m_.reset();
  sight_.reset();
  const auto taken = TakeRunInfo(bytes, boat_);
  if (taken != Taken::kOk) return taken;
  const auto info = bus::Decode<run_info_t>(bytes);
  if (const auto* const text = messages::FileTextOf(*info, kSegmenterFile)) {
    try {
      config::Segmenter segmenter;
      config::ParseText(*text, kSegmenterFile, segmenter);
      max_range_m_ = segmenter.max_range_m();
    } catch (const config::ConfigError&) {
      return Taken::kInconsistent;
    }
  }
  if (boat_ && max_range_m_) sight_.emplace(boat_->T_vessel_lidar, boat_->reference_point_above_water_m, *max_range_m_);
  return Taken::kOk;
}

bool MapReader::IsReady(const Waiting& waiting) const {
  if (!waiting.is_looked) return true;
  const auto* const pose = poses_.newest();
  return pose != nullptr && pose->time >= waiting.scan.end_time && !sweeps_.empty() && waiting.key.time <= sweeps_.back().first.time;
}

void MapReader::Release(std::size_t most_waiting) {
  while (!waiting_.empty() && (waiting_.size() > most_waiting || IsReady(waiting_.front()))) {
    const auto& front = waiting_.front();
    merge_.Add(front.begin, front.scan, SightOf(front));
    waiting_.pop_front();
  }
}

const tracker::Sight* MapReader::SightOf(const Waiting& waiting) {
  if (!waiting.is_looked || !sight_) return nullptr;
  const auto sweep = std::ranges::find(sweeps_, waiting.key, &std::pair<tracker::ScanKey, tracker::Sweep>::first);
  if (sweep == sweeps_.end()) return nullptr;
  const auto pose_at = [this, &waiting](Utime time) {
    auto pose = poses_.At(time);
    if (pose && !(pose->is_placed && pose->datum.IsSameAs(waiting.scan.datum))) pose.reset();
    return pose;
  };
  looked_ = {};
  looked_.time = waiting.scan.time;
  looked_.end_time = waiting.scan.end_time;
  looked_.datum = waiting.scan.datum;
  looked_.own_at_start = pose_at(looked_.time);
  looked_.own = pose_at(looked_.end_time);
  looked_.sweep = std::move(sweep->second);
  sweeps_.erase(sweeps_.begin(), std::next(sweep));
  if (!sight_->Begin(looked_)) return nullptr;
  ++num_looks_;
  return &*sight_;
}

void MapReader::Finish() { Release(0); }

}  // namespace lookout::exporter
