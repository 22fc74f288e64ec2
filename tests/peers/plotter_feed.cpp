// What the plotter reads, of a scene whose truth is known: POSE at 50 Hz; LIDAR_SCAN, SEGMENTS, TRACKS and ALERTS at 10 Hz, on the bus of this
// computer, in real time.
//   plotter_feed SECONDS TRUTH_FILE LATITUDE_DEG LONGITUDE_DEG
// The truth file gets a line of JSON for each POSE (where all are then), and one for each acknowledgement that comes.
// Its geodesy is its own, so that an error of the library does not hide itself.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "lookout/alert_ack_t.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/support/messages.hpp"

namespace lookout::peers_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Vector {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};
struct Place {
  double latitude_rad = 0.0;
  double longitude_rad = 0.0;
};

constexpr double kEquatorM = 6378137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);

// On the ellipsoid, earth-centred.
Vector EarthOf(const Place& place) {
  const double sine = std::sin(place.latitude_rad);
  const double normal_m = kEquatorM / std::sqrt(1.0 - kEccentricity2 * sine * sine);
  const double cosine = std::cos(place.latitude_rad);
  return {normal_m * cosine * std::cos(place.longitude_rad), normal_m * cosine * std::sin(place.longitude_rad),
          normal_m * (1.0 - kEccentricity2) * sine};
}

// East, north and up at a place, in earth-centred axes.
struct Axes {
  explicit Axes(const Place& place)
      : east{-std::sin(place.longitude_rad), std::cos(place.longitude_rad), 0.0},
        north{-std::sin(place.latitude_rad) * std::cos(place.longitude_rad), -std::sin(place.latitude_rad) * std::sin(place.longitude_rad),
              std::cos(place.latitude_rad)} {}
  Vector east;
  Vector north;
};

double Dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Of a point near the ellipsoid. Repeated until nothing changes.
Place PlaceOf(const Vector& earth_m) {
  const double radius_m = std::hypot(earth_m.x, earth_m.y);
  double latitude_rad = std::atan2(earth_m.z, radius_m * (1.0 - kEccentricity2));
  for (int i = 0; i < 10; ++i) {
    const double sine = std::sin(latitude_rad);
    const double normal_m = kEquatorM / std::sqrt(1.0 - kEccentricity2 * sine * sine);
    latitude_rad = std::atan2(earth_m.z + kEccentricity2 * normal_m * sine, radius_m);
  }
  return {latitude_rad, std::atan2(earth_m.y, earth_m.x)};
}

// On the plane that touches the earth at the datum.
Place Offset(const Place& datum, double east_m, double north_m) {
  const Axes axes(datum);
  Vector earth_m = EarthOf(datum);
  earth_m.x += east_m * axes.east.x + north_m * axes.north.x;
  earth_m.y += east_m * axes.east.y + north_m * axes.north.y;
  earth_m.z += east_m * axes.east.z + north_m * axes.north.z;
  return PlaceOf(earth_m);
}

struct RangeAndBearing {
  double range_m = 0.0;
  double bearing_rad = 0.0;
};
RangeAndBearing Between(const Place& from, const Place& to) {
  const Axes axes(from);
  const Vector a = EarthOf(from);
  const Vector b = EarthOf(to);
  const Vector way{b.x - a.x, b.y - a.y, b.z - a.z};
  const double east_m = Dot(way, axes.east);
  const double north_m = Dot(way, axes.north);
  const double bearing_rad = std::atan2(east_m, north_m);
  return {std::hypot(east_m, north_m), bearing_rad < 0.0 ? bearing_rad + 2.0 * kPi : bearing_rad};
}

// The own boat: a straight way, while its bow turns.
constexpr double kOwnEastMps = 1.9;
constexpr double kOwnNorthMps = -0.8;
constexpr double kFirstHeadingRad = 5.9;
constexpr double kTurnRadps = 0.05;
double HeadingAt(double time_s) { return std::fmod(kFirstHeadingRad + kTurnRadps * time_s, 2.0 * kPi); }

// What moves in a straight line in the map frame, or stands. From the datum, at the start.
struct Track {
  std::int64_t id = 0;
  std::int32_t kind = track_t::KIND_UNKNOWN;
  double east_m = 0.0;
  double north_m = 0.0;
  double velocity_east_mps = 0.0;
  double velocity_north_mps = 0.0;
  float length_m = 1.0F;
  float width_m = 0.5F;
  float cpa_m = 50.0F;
  float tcpa_s = 0.0F;
  float cpa_probability = 0.0F;
  double from_s = 0.0;
  double lost_s = 1e9;  // told LOST in the scan of this time, and never again
  std::int32_t status = track_t::STATUS_CONFIRMED;
};

std::vector<Track> Scene() {
  return {
      {.id = 1, .kind = track_t::KIND_BUOY, .east_m = 30.0, .north_m = 40.0},
      {.id = 2,
       .kind = track_t::KIND_BOAT,
       .east_m = -71.0,
       .north_m = 70.5,
       .velocity_east_mps = 2.25,
       .velocity_north_mps = 0.5,
       .length_m = 7.5F,
       .width_m = 2.5F,
       .cpa_m = 12.25F,
       .tcpa_s = 21.5F},
      {.id = 17,
       .kind = track_t::KIND_BOAT,
       .east_m = 60.0,
       .north_m = -52.25,
       .velocity_east_mps = -3.0,
       .velocity_north_mps = 2.0,
       .length_m = 11.0F,
       .width_m = 3.5F,
       .cpa_m = 2.5F,
       .tcpa_s = 18.75F,
       .cpa_probability = 0.75F},
      {.id = 18,
       .kind = track_t::KIND_STRUCTURE,
       .east_m = -90.0,
       .north_m = -4.0,
       .length_m = 30.0F,
       .width_m = 4.0F,
       .status = track_t::STATUS_COASTING},
      {.id = 19, .east_m = 2.0, .north_m = 12.0, .velocity_east_mps = 0.25, .velocity_north_mps = -0.5, .lost_s = 7.0},
      {.id = 20, .east_m = 240.0, .north_m = 3.0},
      {.id = 21, .east_m = 15.0, .north_m = 20.0, .status = track_t::STATUS_TENTATIVE},
      {.id = 123456, .kind = track_t::KIND_BOAT, .east_m = -25.0, .north_m = -66.0, .velocity_north_mps = 1.5, .from_s = 3.0},
  };
}

class Feed {
 public:
  /// @param num_brief  tracks beside those of Scene(): two more each second, each for 4 s
  Feed(const Place& datum, const std::string& truth_file, int num_brief) : datum_(datum), bus_(bus::DefaultLcmUrl()), truth_(truth_file) {
    truth_.exceptions(std::ios::failbit | std::ios::badbit);
    truth_.precision(12);
    for (int i = 0; i < num_brief; ++i)
      scene_.push_back({.id = 200'000 + i, .east_m = 20.0 + i % 50, .north_m = 60.0, .from_s = 0.5 * i, .lost_s = 0.5 * i + 4.0});
    bus::Subscribe<alert_ack_t>(bus_, bus::kAlertAck, [this](const alert_ack_t& ack) { OnAck(ack); });
  }

  void Run(double duration_s) {
    using std::chrono::microseconds;
    const auto now_us = std::chrono::duration_cast<microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
    start_us_ = (now_us / kPoseUs + 1) * kPoseUs;
    const auto start = std::chrono::steady_clock::now() + microseconds(start_us_ - now_us);
    const auto num_poses = static_cast<std::int64_t>(duration_s * 1e6) / kPoseUs;
    end_s_ = duration_s;
    for (std::int64_t seq = 0; seq < num_poses; ++seq) {
      const auto due = start + microseconds(seq * kPoseUs);
      for (auto left = due - std::chrono::steady_clock::now(); left.count() > 0; left = due - std::chrono::steady_clock::now()) {
        bus_.HandleOnce(std::chrono::ceil<std::chrono::milliseconds>(left));
      }
      SendPose(seq);
      if (seq % kPosesPerScan == 0) SendScan(seq);
    }
  }

 private:
  static constexpr std::int64_t kPoseUs = 20'000;
  static constexpr std::int64_t kPosesPerScan = 5;
  static constexpr std::int64_t kAlertId = 4;

  double Seconds(std::int64_t seq) const { return static_cast<double>(seq * kPoseUs) * 1e-6; }

  void SendPose(std::int64_t seq) {
    const double time_s = Seconds(seq);
    const double east_m = kOwnEastMps * time_s;
    const double north_m = kOwnNorthMps * time_s;
    const auto place = Offset(datum_, east_m, north_m);
    pose_t pose{};
    pose.utime_us = start_us_ + seq * kPoseUs;
    pose.seq = seq;
    pose.status = pose_t::STATUS_OK;
    pose.heading_source = pose_t::HEADING_HDT;
    pose.has_attitude = 1;
    pose.datum_latitude_deg = datum_.latitude_rad / kDegree;
    pose.datum_longitude_deg = datum_.longitude_rad / kDegree;
    pose.latitude_deg = place.latitude_rad / kDegree;
    pose.longitude_deg = place.longitude_rad / kDegree;
    pose.position_map_m[0] = east_m;
    pose.position_map_m[1] = north_m;
    pose.velocity_map_mps[0] = kOwnEastMps;
    pose.velocity_map_mps[1] = kOwnNorthMps;
    pose.heading_rad = HeadingAt(time_s);
    for (int i = 0; i < 9; ++i) pose.covariance[i][i] = 0.01;
    bus::Publish(bus_, bus::kPose, pose);
    WriteTruth(seq, place);
  }

  bool IsThere(const Track& track, double time_s) const { return time_s >= track.from_s && time_s < track.lost_s; }

  Place PlaceAt(const Track& track, double time_s) const {
    return Offset(datum_, track.east_m + track.velocity_east_mps * time_s, track.north_m + track.velocity_north_mps * time_s);
  }

  track_t ToMessage(const Track& track, std::int64_t seq) const {
    const double time_s = Seconds(seq);
    const auto place = PlaceAt(track, time_s);
    track_t message{};
    message.id = track.id;
    message.status = time_s >= track.lost_s ? track_t::STATUS_LOST : track.status;
    message.kind = track.kind;
    message.first_utime_us = start_us_ + static_cast<std::int64_t>(track.from_s * 1e6);
    message.seen_utime_us = start_us_ + seq * kPoseUs;
    message.latitude_deg = place.latitude_rad / kDegree;
    message.longitude_deg = place.longitude_rad / kDegree;
    message.position_map_m[0] = track.east_m + track.velocity_east_mps * time_s;
    message.position_map_m[1] = track.north_m + track.velocity_north_mps * time_s;
    message.velocity_map_mps[0] = track.velocity_east_mps;
    message.velocity_map_mps[1] = track.velocity_north_mps;
    for (int i = 0; i < 4; ++i) message.covariance[i][i] = 0.01;
    message.covariance_relative_m2[0] = message.covariance_relative_m2[2] = 0.01;
    const bool is_moving = track.velocity_east_mps != 0.0 || track.velocity_north_mps != 0.0;
    message.speed_mps = static_cast<float>(std::hypot(track.velocity_east_mps, track.velocity_north_mps));
    message.course_rad = static_cast<float>(is_moving ? std::atan2(track.velocity_east_mps, track.velocity_north_mps) : kNan);
    message.turn_rate_radps = static_cast<float>(kNan);
    message.existence_probability = 0.99F;
    message.moving_probability = is_moving ? 0.99F : 0.01F;
    message.length_m = track.length_m;
    message.width_m = track.width_m;
    message.num_seen = message.num_looks = 15;
    message.distance_m = static_cast<float>(std::hypot(message.position_map_m[0], message.position_map_m[1]));
    message.range_m = message.distance_m;
    message.cpa_m = track.cpa_m;
    message.tcpa_s = track.tcpa_s;
    message.cpa_probability = track.cpa_probability;
    return message;
  }

  // A round of two beams that meet nothing, and its labels: somebody looks, and all is water but for the tracks.
  void SendBeams(const tracks_t& tracks) {
    constexpr int kColumns = 1800;
    auto scan = support::OfScan<lidar_scan_t>(tracks.utime_us, tracks.seq, tracks.end_utime_us - tracks.utime_us);
    std::vector<float> azimuth_rad;
    std::vector<std::int32_t> time_ns;
    for (int i = 0; i < kColumns; ++i) {
      azimuth_rad.push_back(static_cast<float>(2.0 * kPi * i / kColumns));
      time_ns.push_back(static_cast<std::int32_t>((scan.end_utime_us - scan.utime_us) * 1000 * i / kColumns));
    }
    support::FillColumns(scan, std::move(azimuth_rad), std::move(time_ns), 0);
    scan.elevation_rad = {-0.01F, 0.01F};
    const auto labels = support::LabelsOf(scan, 0);
    bus::Publish(bus_, bus::kLidarScan, scan);
    bus::Publish(bus_, bus::kSegments, labels);
  }

  void SendScan(std::int64_t seq) {
    const double time_s = Seconds(seq);
    tracks_t tracks{};
    tracks.utime_us = start_us_ + seq * kPoseUs - 100'000;
    tracks.end_utime_us = start_us_ + seq * kPoseUs;
    tracks.seq = tracks.raw_seq = seq / kPosesPerScan;
    tracks.begin_utime_us = start_us_;
    tracks.num_parts = 1;
    tracks.sight = tracks_t::SIGHT_KNOWN;
    tracks.datum_latitude_deg = datum_.latitude_rad / kDegree;
    tracks.datum_longitude_deg = datum_.longitude_rad / kDegree;
    for (const auto& track : scene_) {
      const bool ends_now = time_s >= track.lost_s && time_s < track.lost_s + 0.1;
      if (IsThere(track, time_s) || ends_now) tracks.tracks.push_back(ToMessage(track, seq));
    }
    tracks.num_tracks = tracks.num_scan_tracks = static_cast<std::int32_t>(tracks.tracks.size());
    SendBeams(tracks);
    bus::Publish(bus_, bus::kTracks, tracks);

    alerts_t alerts{};
    alerts.utime_us = tracks.utime_us;
    alerts.end_utime_us = tracks.end_utime_us;
    alerts.seq = alerts.raw_seq = tracks.seq;
    alerts.begin_utime_us = start_us_;
    AdvanceAlert(time_s, tracks.end_utime_us);
    if (alert_) alerts.alerts.push_back(*alert_);
    alerts.num_alerts = static_cast<std::int32_t>(alerts.alerts.size());
    if (alert_ && alert_->state == alert_t::STATE_ACTIVE) alerts.sounding_alert_id = kAlertId;
    bus::Publish(bus_, bus::kAlerts, alerts);
    if (alert_ && alert_->state == alert_t::STATE_CLEARED) alert_.reset();
  }

  // One alert of track 17: raised at 2 s, over 2 s before the end.
  void AdvanceAlert(double time_s, std::int64_t utime_us) {
    if (!alert_ && !is_over_ && time_s >= 2.0) {
      alert_.emplace();
      alert_->id = kAlertId;
      alert_->cause = alert_t::CAUSE_CLOSEST_APPROACH;
      alert_->level = alert_t::LEVEL_WARNING;
      alert_->state = alert_t::STATE_ACTIVE;
      alert_->track_id = 17;
      alert_->raised_utime_us = alert_->changed_utime_us = utime_us;
      alert_->cpa_m = 2.5F;
      alert_->tcpa_s = 18.75F;
      alert_->cpa_probability = 0.75F;
      alert_->text = "boat 17, \"Nu*$\\,^!~\": closest approach 2.5 m in 19 s \xc3\xa9";
    } else if (alert_ && time_s >= end_s_ - 2.0) {
      alert_->state = alert_t::STATE_CLEARED;
      alert_->changed_utime_us = utime_us;
      is_over_ = true;
    } else if (alert_ && is_acknowledged_ && alert_->state == alert_t::STATE_ACTIVE) {
      alert_->state = alert_t::STATE_ACKNOWLEDGED;
      alert_->changed_utime_us = utime_us;
    }
  }

  void OnAck(const alert_ack_t& ack) {
    const bool is_right = alert_ && ack.alert_id == alert_->id && ack.alert_raised_utime_us == alert_->raised_utime_us;
    is_acknowledged_ = is_acknowledged_ || is_right;
    truth_ << R"({"ack":)" << ack.alert_id << R"(,"source":")" << ack.source << R"(","is_right":)" << (is_right ? "true" : "false")
           << R"(,"utime_us":)" << ack.utime_us << "}" << std::endl;
  }

  void WriteTruth(std::int64_t seq, const Place& own) {
    const double time_s = Seconds(seq);
    const Axes axes(own);
    const auto write_motion = [this, &axes](double velocity_east_mps, double velocity_north_mps) {
      const Axes datum_axes(datum_);
      const Vector velocity{velocity_east_mps * datum_axes.east.x + velocity_north_mps * datum_axes.north.x,
                            velocity_east_mps * datum_axes.east.y + velocity_north_mps * datum_axes.north.y,
                            velocity_east_mps * datum_axes.east.z + velocity_north_mps * datum_axes.north.z};
      const double east_mps = Dot(velocity, axes.east);
      const double north_mps = Dot(velocity, axes.north);
      truth_ << R"("speed_mps":)" << std::hypot(east_mps, north_mps) << R"(,"course_rad":)";
      if (velocity_east_mps == 0.0 && velocity_north_mps == 0.0) {
        truth_ << "null";
      } else {
        truth_ << std::fmod(std::atan2(east_mps, north_mps) + 2.0 * kPi, 2.0 * kPi);
      }
    };
    truth_ << R"({"utime_us":)" << start_us_ + seq * kPoseUs << R"(,"own":{"latitude_deg":)" << own.latitude_rad / kDegree << R"(,"longitude_deg":)"
           << own.longitude_rad / kDegree << R"(,"heading_rad":)" << HeadingAt(time_s) << ",";
    write_motion(kOwnEastMps, kOwnNorthMps);
    truth_ << R"(},"targets":{)";
    const char* separator = "";
    for (const auto& track : scene_) {
      if (!IsThere(track, time_s) || track.status == track_t::STATUS_TENTATIVE) continue;
      const auto place = PlaceAt(track, time_s);
      const auto relative = Between(own, place);
      truth_ << separator << '"' << track.id << R"(":{"latitude_deg":)" << place.latitude_rad / kDegree << R"(,"longitude_deg":)"
             << place.longitude_rad / kDegree << R"(,"range_m":)" << relative.range_m << R"(,"bearing_rad":)" << relative.bearing_rad
             << R"(,"cpa_m":)" << track.cpa_m << R"(,"tcpa_s":)" << track.tcpa_s << ",";
      write_motion(track.velocity_east_mps, track.velocity_north_mps);
      truth_ << "}";
      separator = ",";
    }
    truth_ << "}}" << std::endl;
  }

  Place datum_;
  bus::LcmBus bus_;
  std::ofstream truth_;
  std::vector<Track> scene_ = Scene();
  std::int64_t start_us_ = 0;
  double end_s_ = 0.0;
  std::optional<alert_t> alert_;
  bool is_acknowledged_ = false;
  bool is_over_ = false;
};

}  // namespace
}  // namespace lookout::peers_test

int main(int argc, char** argv) {
  if (argc != 5 && argc != 6) {
    std::cerr << "usage: plotter_feed SECONDS TRUTH_FILE LATITUDE_DEG LONGITUDE_DEG [NUMBER_OF_BRIEF_TRACKS]\n";
    return 2;
  }
  try {
    using namespace lookout::peers_test;
    Feed feed({std::stod(argv[3]) * kDegree, std::stod(argv[4]) * kDegree}, argv[2], argc == 6 ? std::stoi(argv[5]) : 0);
    feed.Run(std::stod(argv[1]));
  } catch (const std::exception& error) {
    std::cerr << "plotter_feed: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
