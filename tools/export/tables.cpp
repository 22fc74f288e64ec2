#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/messages/returns.hpp"
#include "common/messages/words.hpp"
#include "lookout/ais_t.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/segments_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tools/export/csv.hpp"
#include "tools/export/map_geometry.hpp"
#include "tools/export/map_table.hpp"
#include "tools/export/outlines.hpp"
#include "tools/export/sinks.hpp"
#include "tools/export/velocity.hpp"

namespace lookout::exporter {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

Fixed Metres(double value_m) { return {value_m, 4}; }               // 0.1 mm
Fixed GeodeticDegrees(double angle_deg) { return {angle_deg, 9}; }  // 0.1 mm on the earth
Fixed Degrees(double angle_rad) { return {RadToDeg(angle_rad), 4}; }
Fixed Share(double share) { return {share, 4}; }  // or a probability

// Tracks of one scan, by number of the piece, else by id of the segment; 0 for remembered land.
struct TracksOfScan {
  std::map<std::int32_t, std::int64_t> of_piece;  // as in TRACKS; empty: TRACKS do not name pieces
  std::map<std::int32_t, std::int64_t> of_segment;

  std::optional<std::int64_t> Of(const messages::Return& one) const {
    const auto& tracks = of_piece.empty() ? of_segment : of_piece;
    const auto found = tracks.find(of_piece.empty() ? one.label : one.piece);
    return found == tracks.end() || found->second == tracks_t::PIECE_NO_TRACK ? std::nullopt : std::optional(found->second);
  }
};

TracksOfScan TracksOf(const ScanMessages& scan) {
  TracksOfScan tracks;
  for (const auto& [part_index, part] : scan.tracks) {
    for (const auto& track : part.tracks) {
      for (const auto segment_id : track.segment_ids) tracks.of_segment[segment_id] = track.id;
    }
    for (const auto segment_id : part.land_segment_ids) tracks.of_segment[segment_id] = 0;
    for (std::int32_t i = 0; i < part.num_pieces; ++i) tracks.of_piece[part.first_piece + i] = part.track_of_piece[static_cast<std::size_t>(i)];
  }
  return tracks;
}

void AppendReturns(const ScanMessages& scan, std::string& text) {
  const auto tracks = TracksOf(scan);
  for (const auto& [part_index, part] : scan.scans) {
    messages::ForEachReturn(part, LabelsOf(scan, part), [&, &columns = part](const messages::Return& one) {
      const auto append = [&](const auto& label, const auto& reason, const auto& track_id, const auto& piece) {
        // The wire counts ranges in 2 mm.
        AppendRow(text, columns.utime_us, one.utime_us, one.ring, one.return_index, Direction{one.azimuth_rad}, Fixed{one.range_m, 3},
                  Metres(one.p_lidar_m.x()), Metres(one.p_lidar_m.y()), Metres(one.p_lidar_m.z()), one.reflectivity, label, reason, track_id, piece);
      };
      const auto track_id = one.has_label && one.label > 0 ? tracks.Of(one) : std::nullopt;
      if (track_id) {
        append(one.label, one.reason, *track_id, one.piece);
      } else if (one.has_label) {
        append(one.label, one.reason, Empty{}, one.piece);
      } else {
        append(Empty{}, Empty{}, Empty{}, Empty{});
      }
    });
  }
}

void Append(const segments_t& message, std::string& text) {
  for (const auto& segment : message.segments) {
    const Eigen::Vector3d p_nearest_m = Eigen::Vector3f(segment.nearest_m).cast<double>();
    AppendRow(text, message.utime_us, segment.id, segment.utime_us, segment.num_points, Metres(segment.centroid_m[0]), Metres(segment.centroid_m[1]),
              Metres(segment.centroid_m[2]), Metres(p_nearest_m.norm()), Metres(segment.length_m), Metres(segment.width_m),
              Metres(double{segment.max_z_m} - double{segment.min_z_m}), words::WordOf(words::kConfidence, segment.confidence),
              words::WordsOf(words::kGround, segment.grounds), words::WordOf(words::kKind, segment.kind), Share(segment.seen_share),
              Share(segment.thing_probability), Share(segment.land_probability));
  }
}

void Append(const obstacles_t& message, const Near* near, std::string& text) {
  const auto map = MapOf(message);
  for (const auto& obstacle : message.obstacles) {
    const auto outline = map ? OutlineOf(obstacle, *map) : std::nullopt;
    const auto place = PlaceOf(obstacle.latitude_deg, obstacle.longitude_deg);
    if (near != nullptr && !(place && near->Holds(*place)) && !(outline && near->Holds(*outline))) continue;
    const auto& covariance_m2 = obstacle.covariance_m2;
    AppendRow(text, message.utime_us, obstacle.utime_us, obstacle.id, GeodeticDegrees(obstacle.latitude_deg), GeodeticDegrees(obstacle.longitude_deg),
              Metres(obstacle.top_above_water_m), Metres(obstacle.position_map_m[0]), Metres(obstacle.position_map_m[1]), Shortest{covariance_m2[0]},
              Shortest{covariance_m2[1]}, Shortest{covariance_m2[2]}, Metres(obstacle.length_m), Metres(obstacle.width_m), obstacle.num_points,
              words::WordOf(words::kObstacleStatus, obstacle.status), words::WordOf(words::kConfidence, obstacle.confidence),
              words::WordOf(words::kKind, obstacle.kind), Share(obstacle.thing_probability), Metres(obstacle.range_m),
              Direction{obstacle.bearing_rad}, Metres(obstacle.height_m), outline ? Wkt(*outline) : std::string());
  }
}

void Append(const tracks_t& message, const Near* near, std::string& text) {
  for (const auto& track : message.tracks) {
    const auto place = PlaceOf(track.latitude_deg, track.longitude_deg);
    if (near != nullptr && !(place && near->Holds(*place))) continue;
    const auto& covariance = track.covariance;
    AppendRow(text, message.end_utime_us, track.id, GeodeticDegrees(track.latitude_deg), GeodeticDegrees(track.longitude_deg),
              Metres(track.speed_mps), Direction{track.course_rad}, Metres(track.cpa_m), Fixed{track.tcpa_s, 2},
              words::WordOf(words::kTrackStatus, track.status), words::WordOf(words::kTrackKind, track.kind), message.utime_us, track.first_utime_us,
              track.seen_utime_us, Metres(track.position_map_m[0]), Metres(track.position_map_m[1]), Shortest{covariance[0][0]},
              Shortest{covariance[0][1]}, Shortest{covariance[1][1]}, Metres(track.velocity_map_mps[0]), Metres(track.velocity_map_mps[1]),
              Share(track.existence_probability), Share(track.moving_probability), Metres(track.length_m), Metres(track.width_m),
              Degrees(track.length_bearing_rad), Metres(track.top_above_water_m), Share(track.seen_share), track.num_seen, track.num_looks,
              Fixed{track.mean_returns, 1}, Metres(track.range_m), Direction{track.bearing_rad}, Metres(track.distance_m),
              Share(track.cpa_probability), words::WordOf(words::kEncounter, track.encounter), Degrees(track.bearing_drift_radps));
  }
}

void Append(const ais_t& message, std::string& text) {
  for (const auto& ship : message.ships) {
    AppendRow(text, message.end_utime_us, ship.mmsi, ship.name, ship.call_sign, words::WordOf(words::kAisState, ship.state), ship.track_id,
              Share(ship.track_probability), words::WordOf(words::kAisSender, ship.sender), ship.ship_type, GeodeticDegrees(ship.latitude_deg),
              GeodeticDegrees(ship.longitude_deg), Metres(ship.position_map_m[0]), Metres(ship.position_map_m[1]), Shortest{ship.covariance_m2[0]},
              Shortest{ship.covariance_m2[1]}, Shortest{ship.covariance_m2[2]}, Metres(ship.range_m), Direction{ship.bearing_rad},
              Metres(ship.report_speed_mps), Direction{ship.report_course_rad}, Direction{ship.heading_rad}, CountOrEmpty{ship.navigational_status},
              Metres(ship.bow_m), Metres(ship.stern_m), Metres(ship.port_m), Metres(ship.starboard_m), static_cast<int>(ship.has_reference),
              static_cast<int>(ship.is_virtual), static_cast<int>(ship.is_accurate), ship.report_utime_us,
              static_cast<int>(ship.is_report_time_known), ship.arrival_utime_us, message.scan_seq);
  }
}

void Append(const alerts_t& message, std::string& text) {
  for (const auto& alert : message.alerts) {
    AppendRow(text, message.end_utime_us, alert.id, words::WordOf(words::kAlertCause, alert.cause), words::WordOf(words::kAlertLevel, alert.level),
              words::WordOf(words::kAlertState, alert.state), alert.track_id, alert.raised_utime_us, alert.changed_utime_us, Metres(alert.distance_m),
              Direction{alert.bearing_rad}, Metres(alert.cpa_m), Fixed{alert.tcpa_s, 2}, Share(alert.cpa_probability), alert.text, alert.name,
              static_cast<int>(alert.is_in_zone), static_cast<int>(alert.comes_near), Fixed{alert.time_left_s, 2},
              GeodeticDegrees(alert.latitude_deg), GeodeticDegrees(alert.longitude_deg), words::WordOf(words::kAlertSight, alert.sight),
              alert.seen_utime_us, words::WordOf(words::kAlertEnd, alert.end), static_cast<int>(alert.id == message.sounding_alert_id));
  }
}

void Append(const pose_t& pose, const Near* near, std::string& text) {
  const auto place = PlaceOf(pose.latitude_deg, pose.longitude_deg);
  if (near != nullptr && !(place && near->Holds(*place))) return;
  constexpr int kVelocityRow = 3;  // of pose_t::covariance: velocity east, then north
  // Chi-square of two degrees of freedom that chance exceeds in one of 20 cases (Abramowitz and Stegun, table 26.8).
  constexpr double kChiSquare95 = 5.99;
  const Eigen::Vector3d velocity_mps = Velocity3dHere(pose);
  const double speed_mps = velocity_mps.head<2>().norm();
  // A boat at rest has no course: the direction of a speed that may be 0 is noise.
  const double variance_mps2 = std::max(pose.covariance[kVelocityRow][kVelocityRow], pose.covariance[kVelocityRow + 1][kVelocityRow + 1]);
  const bool is_at_rest = speed_mps == 0.0 || speed_mps * speed_mps < kChiSquare95 * variance_mps2;
  const double course_rad = is_at_rest ? kUnknown : std::atan2(velocity_mps.x(), velocity_mps.y());
  const auto covariance = [&pose](int row, int column) { return Shortest{pose.covariance[row][column]}; };
  // Without attitude roll and pitch are 0 on the wire.
  AppendRow(text, pose.utime_us, GeodeticDegrees(pose.latitude_deg), GeodeticDegrees(pose.longitude_deg), Metres(pose.ellipsoid_height_m),
            Direction{pose.heading_rad}, Degrees(pose.has_attitude ? pose.roll_rad : kUnknown),
            Degrees(pose.has_attitude ? pose.pitch_rad : kUnknown), Metres(speed_mps), Direction{course_rad},
            words::WordOf(words::kPoseStatus, pose.status), Metres(velocity_mps.x()), Metres(velocity_mps.y()), Metres(velocity_mps.z()),
            covariance(0, 0), covariance(0, 1), covariance(1, 1), covariance(2, 2), covariance(3, 3), covariance(3, 4), covariance(4, 4),
            covariance(5, 5), covariance(6, 6), covariance(7, 7), covariance(8, 8), words::WordOf(words::kHeadingSource, pose.heading_source));
}

void Append(const lidar_clock_t& clock, std::string& text) {
  AppendRow(text, clock.utime_us, clock.seq, words::WordOf(words::kTimeSource, clock.time_source), words::WordOf(words::kClockState, clock.state),
            CountOrEmpty{clock.pps}, CountOrEmpty{clock.rmc_age_us}, Shortest{clock.offset_s}, Shortest{clock.drift_ppm},
            Shortest{clock.rotation_rpm}, clock.num_packets, clock.num_lost_packets, clock.num_duplicate_packets, clock.num_reordered_packets);
}

void Append(const gnss_fix_t& fix, std::string& text) {
  AppendRow(text, fix.utime_us, fix.arrival_utime_us, fix.is_time_from_sentence, fix.source, fix.sentence_type,
            words::WordOf(words::kFixQuality, fix.quality), CountOrEmpty{fix.num_satellites}, Shortest{fix.hdop}, Metres(fix.horizontal_sd_m),
            GeodeticDegrees(fix.latitude_deg), GeodeticDegrees(fix.longitude_deg), Metres(fix.msl_height_m), Metres(fix.geoid_separation_m),
            Metres(fix.speed_mps), Direction{fix.course_rad});
}

void Append(const attitude_t& attitude, std::string& text) {
  AppendRow(text, attitude.utime_us, attitude.arrival_utime_us, attitude.is_time_from_sentence, attitude.source, attitude.sentence_type,
            Direction{attitude.heading_rad}, Degrees(attitude.roll_rad), Degrees(attitude.pitch_rad), Metres(attitude.heave_m),
            Degrees(attitude.heading_sd_rad), Degrees(attitude.roll_sd_rad), Degrees(attitude.pitch_sd_rad));
}

void Append(const health_t& health, std::string& text) {
  AppendRow(text, health.utime_us, health.process, words::WordOf(words::kHealthState, health.state), health.reason, Fixed{health.cpu_fraction, 4},
            health.resident_bytes, Fixed{health.uptime_s, 3}, Fixed{health.interval_s, 3}, health.host, health.pid);
}

void AppendTraffic(const health_t& health, std::string& text) {
  // -1 is not known; others below 0 are where the sensor's clock is ahead.
  const auto latency = [](std::int64_t latency_us) { return latency_us == -1 ? std::string() : std::to_string(latency_us); };
  for (const auto& channel : health.channels) {
    AppendRow(text, health.utime_us, health.process, channel.channel, channel.is_input ? "in" : "out", channel.num_messages, channel.num_undecodable,
              channel.num_lost, Fixed{channel.rate_hz, 3}, CountOrEmpty{channel.queue_depth}, channel.queue_limit,
              CountOrEmpty{channel.handling_p50_us}, CountOrEmpty{channel.handling_p99_us}, latency(channel.latency_p50_us),
              latency(channel.latency_p99_us));
  }
}

void AppendCounters(const health_t& health, std::string& text) {
  for (const auto& counter : health.counters) AppendRow(text, health.utime_us, health.process, counter.name, counter.count);
}

// A table whose rows come out of single messages of one channel.
template <typename Message, void (*AppendRows)(const Message&, std::string&) = Append>
bool AppendMessage(Bytes bytes, const Near* /*near*/, std::string& text) {
  const auto message = bus::Decode<Message>(bytes);
  if (!message) return false;
  AppendRows(*message, text);
  return true;
}

// Appends the rows of obstacles that have a place.
template <typename Message>
bool AppendPlaced(Bytes bytes, const Near* near, std::string& text) {
  const auto message = bus::Decode<Message>(bytes);
  if (!message) return false;
  Append(*message, near, text);
  return true;
}

struct Table {
  std::string_view name;
  std::string_view header;
  bus::Channel channel;
  bool (*append)(Bytes, const Near*, std::string&);  // nullptr: returns, map and merges, which need two channels or all of the log
};

const std::array kTables{
    Table{"returns", "scan_utime_us,utime_us,ring,return_index,azimuth_deg,range_m,x_m,y_m,z_m,reflectivity,label,reason,track_id,piece",
          bus::kLidarScan, nullptr},
    Table{"segments",
          "scan_utime_us,segment_id,utime_us,num_points,x_m,y_m,z_m,nearest_m,length_m,width_m,height_m,confidence,grounds,kind,seen_share,"
          "thing_probability,land_probability",
          bus::kSegments, AppendMessage<segments_t>},
    Table{"obstacles",
          "scan_utime_us,utime_us,obstacle_id,latitude_deg,longitude_deg,top_above_water_m,east_m,north_m,cov_ee_m2,cov_en_m2,cov_nn_m2,"
          "length_m,width_m,num_points,status,confidence,kind,thing_probability,range_m,bearing_deg,height_m,outline_wkt",
          bus::kObstacles, AppendPlaced<obstacles_t>},
    Table{"tracks",
          "utime_us,track_id,latitude_deg,longitude_deg,speed_mps,course_deg,cpa_m,tcpa_s,status,kind,scan_utime_us,first_utime_us,seen_utime_us,"
          "east_m,"
          "north_m,cov_ee_m2,cov_en_m2,cov_nn_m2,velocity_east_mps,velocity_north_mps,existence_probability,moving_probability,length_m,width_m,"
          "length_bearing_deg,top_above_water_m,seen_share,num_seen,num_looks,mean_returns,range_m,bearing_deg,distance_m,cpa_probability,encounter,"
          "bearing_drift_degps",
          bus::kTracks, AppendPlaced<tracks_t>},
    Table{"ais",
          "utime_us,mmsi,name,call_sign,state,track_id,track_probability,sender,ship_type,latitude_deg,longitude_deg,east_m,north_m,cov_ee_m2,"
          "cov_en_m2,cov_nn_m2,range_m,bearing_deg,speed_mps,course_deg,heading_deg,navigational_status,bow_m,stern_m,port_m,starboard_m,"
          "has_reference,is_virtual,is_accurate,report_utime_us,is_report_time_known,arrival_utime_us,scan_seq",
          bus::kAis, AppendMessage<ais_t>},
    Table{"alerts",
          "utime_us,alert_id,cause,level,state,track_id,raised_utime_us,changed_utime_us,distance_m,bearing_deg,cpa_m,tcpa_s,cpa_probability,text,"
          "name,in_zone,comes_near,time_left_s,latitude_deg,longitude_deg,sight,seen_utime_us,end,sounds",
          bus::kAlerts, AppendMessage<alerts_t>},
    Table{"pose",
          "utime_us,latitude_deg,longitude_deg,ellipsoid_height_m,heading_deg,roll_deg,pitch_deg,speed_mps,course_deg,status,velocity_east_mps,"
          "velocity_north_mps,velocity_up_mps,cov_ee_m2,cov_en_m2,cov_nn_m2,cov_uu_m2,velocity_cov_ee_m2ps2,velocity_cov_en_m2ps2,"
          "velocity_cov_nn_m2ps2,velocity_cov_uu_m2ps2,roll_var_rad2,pitch_var_rad2,heading_var_rad2,heading_source",
          bus::kPose, AppendPlaced<pose_t>},
    Table{"clock",
          "utime_us,seq,time_source,state,pps,rmc_age_us,offset_s,drift_ppm,rotation_rpm,num_packets,num_lost_packets,num_duplicate_packets,"
          "num_reordered_packets",
          bus::kLidarClock, AppendMessage<lidar_clock_t>},
    Table{"fixes",
          "utime_us,arrival_utime_us,is_time_from_sentence,source,sentence_type,quality,num_satellites,hdop,horizontal_sd_m,latitude_deg,"
          "longitude_deg,msl_height_m,geoid_separation_m,speed_mps,course_deg",
          bus::kGnssFix, AppendMessage<gnss_fix_t>},
    Table{"attitude",
          "utime_us,arrival_utime_us,is_time_from_sentence,source,sentence_type,heading_deg,roll_deg,pitch_deg,heave_m,heading_sd_deg,"
          "roll_sd_deg,pitch_sd_deg",
          bus::kAttitude, AppendMessage<attitude_t>},
    Table{"health", "utime_us,process,state,reason,cpu_fraction,resident_bytes,uptime_s,interval_s,host,pid", bus::kHealth, AppendMessage<health_t>},
    Table{"traffic",
          "utime_us,process,channel,direction,num_messages,num_undecodable,num_lost,rate_hz,queue_depth,queue_limit,handling_p50_us,"
          "handling_p99_us,latency_p50_us,latency_p99_us",
          bus::kHealth, AppendMessage<health_t, AppendTraffic>},
    Table{"counters", "utime_us,process,name,count", bus::kHealth, AppendMessage<health_t, AppendCounters>},
    Table{"map", MapHeader(), bus::kTracks, nullptr},
    Table{"merges", "", bus::kLidarScan, nullptr}};  // the header has the names of all features: MergesHeader

const Table* FindTable(std::string_view name) {
  const auto table = std::ranges::find(kTables, name, &Table::name);
  return table == kTables.end() ? nullptr : &*table;
}

class MessageSink final : public Sink {
 public:
  MessageSink(const Table& table, const std::optional<Circle>& circle) : table_(table), circle_(circle) {
    if (circle) near_.emplace(circle->place, circle->radius_m);
  }

  std::vector<bus::Channel> Channels() const override { return {table_.channel}; }

  Taken Take(std::string_view, Bytes bytes, std::string& text) override {
    const auto num_before = text.size();
    const bool is_taken = table_.append(bytes, near_ ? &*near_ : nullptr, text);
    has_rows_ |= text.size() > num_before;
    return is_taken ? Taken::kOk : Taken::kUndecodable;
  }

  void Finish(std::string&) override {
    if (circle_ && !has_rows_) throw std::runtime_error("nothing lies " + TextOf(*circle_));
  }

 private:
  const Table& table_;
  std::optional<Circle> circle_;
  std::optional<Near> near_;
  bool has_rows_ = false;
};

class ReturnsSink final : public Sink {
 public:
  std::vector<bus::Channel> Channels() const override { return {bus::kLidarScan, bus::kSegments, bus::kTracks}; }

  Taken Take(std::string_view channel, Bytes bytes, std::string& text) override {
    target_ = &text;
    return AddTo(collector_, channel, bytes);
  }

  void Finish(std::string& text) override {
    target_ = &text;
    collector_.Finish();
  }

  std::vector<std::string> Remarks() const override {
    if (num_orphans_ == 0) return {};
    return {std::to_string(num_orphans_) + " messages of SEGMENTS have no LIDAR_SCAN in the log"};
  }

 private:
  void Append(const ScanMessages& scan) {
    AppendReturns(scan, *target_);
    num_orphans_ += NumOrphans(scan);
  }

  std::string* target_ = nullptr;  // of the call in progress
  std::int64_t num_orphans_ = 0;
  messages::ScanCollector collector_ = MakeCollector(IsTracked, [this](const ScanMessages& scan) { Append(scan); });
};

}  // namespace

std::vector<std::string_view> TableNames() {
  std::vector<std::string_view> names;
  names.reserve(std::size(kTables));
  for (const auto& table : kTables) names.push_back(table.name);
  return names;
}

std::string_view TableHeader(std::string_view table) {
  const auto* found = FindTable(table);
  return found == nullptr ? std::string_view() : found->name == "merges" ? MergesHeader() : found->header;
}

std::unique_ptr<Sink> MakeCsvSink(std::string_view table, const std::optional<Circle>& near) {
  const auto* found = FindTable(table);
  if (found == nullptr || found->name == "merges") return nullptr;
  if (found->name == "map") return MakeMapSink(false);
  if (found->append == nullptr) return std::make_unique<ReturnsSink>();
  return std::make_unique<MessageSink>(*found, near);
}

}  // namespace lookout::exporter
