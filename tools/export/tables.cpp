#include "tools/export/tables.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/segments_t.hpp"
#include "tools/export/csv.hpp"
#include "tools/export/returns.hpp"
#include "tools/export/scan_joiner.hpp"
#include "tools/export/velocity.hpp"
#include "tools/export/words.hpp"

namespace lookout::exporter {

namespace {

// Decimals of a fixed number of metres (0.1 mm) and of geodetic degrees (0.1 mm on the earth).
constexpr int kMetreDecimals = 4;
constexpr int kDegreeDecimals = 9;
// Shares of some thousand columns.
constexpr int kShareDecimals = 4;

constexpr std::string_view kReturnsHeader = "scan_utime_us,utime_us,ring,return_index,azimuth_deg,range_m,x_m,y_m,z_m,reflectivity,label,reason";

void WriteReturns(const LabelledScan& part, CsvWriter& csv) {
  ForEachReturn(part, [&](const Return& one) {
    csv.Integer(part.scan.utime_us);
    csv.Integer(one.utime_us);
    csv.Integer(one.ring);
    csv.Integer(one.return_index);
    csv.Direction(one.azimuth_rad);
    csv.Fixed(one.range_m, 3);  // the wire counts in 2 mm
    for (const double coordinate_m : {one.p_lidar_m.x(), one.p_lidar_m.y(), one.p_lidar_m.z()}) csv.Fixed(coordinate_m, kMetreDecimals);
    csv.Integer(one.reflectivity);
    if (one.has_label) {
      csv.Integer(one.label);
      csv.Text(one.reason);
    } else {
      csv.Empty();
      csv.Empty();
    }
    csv.EndRow();
  });
}

void WriteSegments(const segments_t& message, CsvWriter& csv) {
  for (const auto& segment : message.segments) {
    csv.Integer(message.utime_us);
    csv.Integer(segment.id);
    csv.Integer(segment.utime_us);
    csv.Integer(segment.num_points);
    for (const float coordinate_m : segment.centroid_m) csv.Fixed(static_cast<double>(coordinate_m), kMetreDecimals);
    const Eigen::Vector3d p_nearest_m = Eigen::Vector3f(segment.nearest_m).cast<double>();
    csv.Fixed(p_nearest_m.norm(), kMetreDecimals);
    csv.Fixed(static_cast<double>(segment.length_m), kMetreDecimals);
    csv.Fixed(static_cast<double>(segment.width_m), kMetreDecimals);
    csv.Fixed(static_cast<double>(segment.max_z_m) - static_cast<double>(segment.min_z_m), kMetreDecimals);
    csv.Text(words::WordOf(words::kConfidence, segment.confidence));
    csv.Text(words::WordsOf(words::kGround, segment.grounds));
    csv.Text(words::WordOf(words::kKind, segment.kind));
    csv.Fixed(static_cast<double>(segment.seen_share), kShareDecimals);
    csv.EndRow();
  }
}

void WriteObstacles(const obstacles_t& message, CsvWriter& csv) {
  for (const auto& obstacle : message.obstacles) {
    csv.Integer(message.utime_us);
    csv.Integer(obstacle.utime_us);
    csv.Integer(obstacle.id);
    csv.Fixed(obstacle.latitude_deg, kDegreeDecimals);
    csv.Fixed(obstacle.longitude_deg, kDegreeDecimals);
    csv.Fixed(obstacle.top_above_water_m, kMetreDecimals);
    for (const double coordinate_m : obstacle.position_map_m) csv.Fixed(coordinate_m, kMetreDecimals);
    for (const double covariance_m2 : obstacle.covariance_m2) csv.Shortest(covariance_m2);
    csv.Fixed(static_cast<double>(obstacle.length_m), kMetreDecimals);
    csv.Fixed(static_cast<double>(obstacle.width_m), kMetreDecimals);
    csv.Integer(obstacle.num_points);
    csv.Text(words::WordOf(words::kObstacleStatus, obstacle.status));
    csv.Text(words::WordOf(words::kConfidence, obstacle.confidence));
    csv.Text(words::WordOf(words::kKind, obstacle.kind));
    csv.EndRow();
  }
}

// Of pose_t::covariance: velocity east, then north.
constexpr int kVelocityRow = 3;
// Chi-square of two degrees of freedom that chance exceeds in one of 20 cases (Abramowitz and Stegun, table 26.8).
constexpr double kChiSquare95 = 5.99;

void WritePose(const pose_t& pose, CsvWriter& csv) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector2d velocity_mps = VelocityHere(pose);
  const double speed_mps = velocity_mps.norm();
  // A boat at rest has no course: of a speed that is not told from 0 the direction is noise.
  const double variance_mps2 = std::max(pose.covariance[kVelocityRow][kVelocityRow], pose.covariance[kVelocityRow + 1][kVelocityRow + 1]);
  const bool is_at_rest = speed_mps == 0.0 || speed_mps * speed_mps < kChiSquare95 * variance_mps2;
  const double course_rad = is_at_rest ? kUnknown : std::atan2(velocity_mps.x(), velocity_mps.y());
  csv.Integer(pose.utime_us);
  csv.Fixed(pose.latitude_deg, kDegreeDecimals);
  csv.Fixed(pose.longitude_deg, kDegreeDecimals);
  csv.Fixed(pose.ellipsoid_height_m, kMetreDecimals);
  csv.Direction(pose.heading_rad);
  csv.Fixed(pose.has_attitude ? RadToDeg(pose.roll_rad) : kUnknown, 4);  // without attitude they are 0 on the wire
  csv.Fixed(pose.has_attitude ? RadToDeg(pose.pitch_rad) : kUnknown, 4);
  csv.Fixed(speed_mps, kMetreDecimals);
  csv.Direction(course_rad);
  csv.Text(words::WordOf(words::kPoseStatus, pose.status));
  csv.EndRow();
}

// -1 stands for "not known" in these counts.
void WriteCount(std::int64_t count, CsvWriter& csv) {
  if (count < 0) {
    csv.Empty();
  } else {
    csv.Integer(count);
  }
}

void WriteClock(const lidar_clock_t& clock, CsvWriter& csv) {
  csv.Integer(clock.utime_us);
  csv.Integer(clock.seq);
  csv.Text(words::WordOf(words::kTimeSource, clock.time_source));
  csv.Text(words::WordOf(words::kClockState, clock.state));
  WriteCount(clock.pps, csv);
  WriteCount(clock.rmc_age_us, csv);
  csv.Shortest(clock.offset_s);
  csv.Shortest(clock.drift_ppm);
  csv.Shortest(clock.rotation_rpm);
  for (const auto count : {clock.num_packets, clock.num_lost_packets, clock.num_duplicate_packets, clock.num_reordered_packets}) {
    csv.Integer(count);
  }
  csv.EndRow();
}

void WriteFix(const gnss_fix_t& fix, CsvWriter& csv) {
  csv.Integer(fix.utime_us);
  csv.Integer(fix.arrival_utime_us);
  csv.Integer(fix.is_time_from_sentence);
  csv.Text(fix.source);
  csv.Text(fix.sentence_type);
  csv.Text(words::WordOf(words::kFixQuality, fix.quality));
  WriteCount(fix.num_satellites, csv);
  csv.Shortest(fix.hdop);
  csv.Fixed(fix.horizontal_sd_m, kMetreDecimals);
  csv.Fixed(fix.latitude_deg, kDegreeDecimals);
  csv.Fixed(fix.longitude_deg, kDegreeDecimals);
  csv.Fixed(fix.msl_height_m, kMetreDecimals);
  csv.Fixed(fix.geoid_separation_m, kMetreDecimals);
  csv.Fixed(fix.speed_mps, kMetreDecimals);
  csv.Direction(fix.course_rad);
  csv.EndRow();
}

void WriteAttitude(const attitude_t& attitude, CsvWriter& csv) {
  csv.Integer(attitude.utime_us);
  csv.Integer(attitude.arrival_utime_us);
  csv.Integer(attitude.is_time_from_sentence);
  csv.Text(attitude.source);
  csv.Text(attitude.sentence_type);
  csv.Direction(attitude.heading_rad);
  for (const double angle_rad : {attitude.roll_rad, attitude.pitch_rad}) csv.Fixed(RadToDeg(angle_rad), 4);
  csv.Fixed(attitude.heave_m, kMetreDecimals);
  for (const double sd_rad : {attitude.heading_sd_rad, attitude.roll_sd_rad, attitude.pitch_sd_rad}) csv.Fixed(RadToDeg(sd_rad), 4);
  csv.EndRow();
}

void WriteHealth(const health_t& health, CsvWriter& csv) {
  csv.Integer(health.utime_us);
  csv.Text(health.process);
  csv.Text(words::WordOf(words::kHealthState, health.state));
  csv.Text(health.reason);
  csv.Fixed(health.cpu_fraction, 4);
  csv.Integer(health.resident_bytes);
  csv.Fixed(health.uptime_s, 3);
  csv.Fixed(health.interval_s, 3);
  csv.Text(health.host);
  csv.Integer(health.pid);
  csv.EndRow();
}

void WriteTraffic(const health_t& health, CsvWriter& csv) {
  for (const auto& channel : health.channels) {
    csv.Integer(health.utime_us);
    csv.Text(health.process);
    csv.Text(channel.channel);
    csv.Text(channel.is_input ? "in" : "out");
    csv.Integer(channel.num_messages);
    csv.Integer(channel.num_undecodable);
    csv.Integer(channel.num_lost);
    csv.Fixed(channel.rate_hz, 3);
    WriteCount(channel.queue_depth, csv);
    csv.Integer(channel.queue_limit);
    WriteCount(channel.handling_p50_us, csv);
    WriteCount(channel.handling_p99_us, csv);
    // A latency may be negative, where the sensor's clock is ahead.
    for (const auto latency_us : {channel.latency_p50_us, channel.latency_p99_us}) {
      if (latency_us == -1) {
        csv.Empty();
      } else {
        csv.Integer(latency_us);
      }
    }
    csv.EndRow();
  }
}

void WriteCounters(const health_t& health, CsvWriter& csv) {
  for (const auto& counter : health.counters) {
    csv.Integer(health.utime_us);
    csv.Text(health.process);
    csv.Text(counter.name);
    csv.Integer(counter.count);
    csv.EndRow();
  }
}

// A table whose rows come out of single messages of one channel.
template <typename Message, void (*Write)(const Message&, CsvWriter&)>
bool WriteMessage(Bytes bytes, std::string& text) {
  const auto message = bus::Decode<Message>(bytes);
  if (!message) return false;
  CsvWriter csv(text);
  Write(*message, csv);
  return true;
}

struct Table {
  std::string_view name;
  std::string_view header;
  bus::Channel channel;
  bool (*write)(Bytes, std::string&);  // nullptr: returns, which needs two channels
};

constexpr std::array kTables{
    Table{"returns", kReturnsHeader, bus::kLidarScan, nullptr},
    Table{"segments",
          "scan_utime_us,segment_id,utime_us,num_points,x_m,y_m,z_m,nearest_m,length_m,width_m,height_m,confidence,grounds,kind,seen_share",
          bus::kSegments, WriteMessage<segments_t, WriteSegments>},
    Table{"obstacles",
          "scan_utime_us,utime_us,obstacle_id,latitude_deg,longitude_deg,top_above_water_m,east_m,north_m,cov_ee_m2,cov_en_m2,cov_nn_m2,"
          "length_m,width_m,num_points,status,confidence,kind",
          bus::kObstacles, WriteMessage<obstacles_t, WriteObstacles>},
    Table{"pose", "utime_us,latitude_deg,longitude_deg,ellipsoid_height_m,heading_deg,roll_deg,pitch_deg,speed_mps,course_deg,status", bus::kPose,
          WriteMessage<pose_t, WritePose>},
    Table{"clock",
          "utime_us,seq,time_source,state,pps,rmc_age_us,offset_s,drift_ppm,rotation_rpm,num_packets,num_lost_packets,num_duplicate_packets,"
          "num_reordered_packets",
          bus::kLidarClock, WriteMessage<lidar_clock_t, WriteClock>},
    Table{"fixes",
          "utime_us,arrival_utime_us,is_time_from_sentence,source,sentence_type,quality,num_satellites,hdop,horizontal_sd_m,latitude_deg,"
          "longitude_deg,msl_height_m,geoid_separation_m,speed_mps,course_deg",
          bus::kGnssFix, WriteMessage<gnss_fix_t, WriteFix>},
    Table{"attitude",
          "utime_us,arrival_utime_us,is_time_from_sentence,source,sentence_type,heading_deg,roll_deg,pitch_deg,heave_m,heading_sd_deg,"
          "roll_sd_deg,pitch_sd_deg",
          bus::kAttitude, WriteMessage<attitude_t, WriteAttitude>},
    Table{"health", "utime_us,process,state,reason,cpu_fraction,resident_bytes,uptime_s,interval_s,host,pid", bus::kHealth,
          WriteMessage<health_t, WriteHealth>},
    Table{"traffic",
          "utime_us,process,channel,direction,num_messages,num_undecodable,num_lost,rate_hz,queue_depth,queue_limit,handling_p50_us,"
          "handling_p99_us,latency_p50_us,latency_p99_us",
          bus::kHealth, WriteMessage<health_t, WriteTraffic>},
    Table{"counters", "utime_us,process,name,count", bus::kHealth, WriteMessage<health_t, WriteCounters>}};

const Table* FindTable(std::string_view name) {
  const auto table = std::ranges::find(kTables, name, &Table::name);
  return table == kTables.end() ? nullptr : &*table;
}

class MessageSink final : public Sink {
 public:
  explicit MessageSink(const Table& table) : table_(table) {}

  std::vector<bus::Channel> Channels() const override { return {table_.channel}; }

  Taken Take(std::string_view, Bytes bytes, std::string& text) override { return table_.write(bytes, text) ? Taken::kOk : Taken::kUndecodable; }

  void Finish(std::string&) override {}

 private:
  const Table& table_;
};

class ReturnsSink final : public Sink {
 public:
  std::vector<bus::Channel> Channels() const override { return {bus::kLidarScan, bus::kSegments}; }

  Taken Take(std::string_view channel, Bytes bytes, std::string& text) override {
    target_ = &text;
    return channel == bus::kLidarScan.name ? Add<lidar_scan_t>(bytes) : Add<segments_t>(bytes);
  }

  void Finish(std::string& text) override {
    target_ = &text;
    joiner_.Flush();
  }

  std::vector<std::string> Remarks() const override {
    if (joiner_.num_orphans() == 0) return {};
    return {std::to_string(joiner_.num_orphans()) + " messages of SEGMENTS have no LIDAR_SCAN in the log"};
  }

 private:
  template <typename Message>
  Taken Add(Bytes bytes) {
    auto message = bus::Decode<Message>(bytes);
    if (!message) return Taken::kUndecodable;
    if (!IsConsistent(*message)) return Taken::kInconsistent;
    joiner_.Add(std::move(*message));
    return Taken::kOk;
  }

  std::string* target_ = nullptr;  // of the call in progress
  ScanJoiner joiner_{[this](const LabelledScan& part) {
    CsvWriter csv(*target_);
    WriteReturns(part, csv);
  }};
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
  return found == nullptr ? std::string_view() : found->header;
}

std::unique_ptr<Sink> MakeCsvSink(std::string_view table) {
  const auto* found = FindTable(table);
  if (found == nullptr) return nullptr;
  if (found->write == nullptr) return std::make_unique<ReturnsSink>();
  return std::make_unique<MessageSink>(*found);
}

}  // namespace lookout::exporter
